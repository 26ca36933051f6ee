//! Fields of a table that make a row, by table name and fields.

use super::table::Table;
use crate::results::{ElementType, Quantity, columns as c};

/// Form in which records become rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// One row for each record.
    Plain,
    /// One row for each record, numbered within its element.
    Station,
    /// One row for each ply.
    Ply,
    /// Two rows for each record, one for each fibre.
    ShellCentre,
    /// Two rows for each location: the centre, then the corners of array GRID.
    ShellCorner,
    /// One row for each station of array GRID.
    Beam,
    /// One row for each location of array GRID.
    Solid,
}

/// Meaning of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layout {
    pub kind: Kind,
    pub quantity: Quantity,
    pub element: Option<ElementType>,
    /// Name of the id field.
    pub id: &'static str,
    /// Fields of the columns, in order; an empty name is a column that the table lacks.
    pub fields: &'static [&'static str],
    pub columns: &'static [&'static str],
}

const NODAL: &[&str] = &["X", "Y", "Z", "RX", "RY", "RZ"];
const SHELL: &[&str] = &["FD1", "X1", "Y1", "TXY1", "FD2", "X2", "Y2", "TXY2"];

/// Returns the layout of `/NASTRAN/RESULT/NODAL/<name>`.
pub(super) fn nodal(name: &str) -> Option<Layout> {
    let quantity = match name {
        "DISPLACEMENT" => Quantity::Displacement,
        "VELOCITY" => Quantity::Velocity,
        "ACCELERATION" => Quantity::Acceleration,
        "EIGENVECTOR" => Quantity::Eigenvector,
        "SPC_FORCE" => Quantity::SpcForce,
        "MPC_FORCE" => Quantity::MpcForce,
        "APPLIED_LOAD" => Quantity::AppliedLoad,
        _ => return None,
    };
    Some(Layout {
        kind: Kind::Plain,
        quantity,
        element: None,
        id: "ID",
        fields: NODAL,
        columns: c::NODAL,
    })
}

/// Returns the layout of `/NASTRAN/RESULT/ELEMENTAL/STRAIN/<name>` or `STRESS`.
pub(super) fn elemental_layout(
    quantity: Quantity,
    name: &str,
    table: &Table<'_>,
) -> Option<Layout> {
    let strain = quantity == Quantity::Strain;
    let with_corners = table.field("FD1").is_some_and(|f| f.count > 1);
    let number = match (name, with_corners) {
        ("QUAD4_CN" | "QUAD_CN", _) | ("QUAD4", true) => 144,
        ("QUAD4", false) => 33,
        ("QUAD8", _) => 64,
        ("QUADR" | "QUADR_CN", true) => 82,
        ("QUADR", false) => 228,
        ("TRIA3", _) => 74,
        ("TRIA6", _) => 75,
        ("TRIAR" | "TRIAR_CN", true) => 70,
        ("TRIAR", false) => 227,
        ("QUAD4_COMP", _) => 95,
        ("QUAD8_COMP", _) => 96,
        ("TRIA3_COMP", _) => 97,
        ("TRIA6_COMP", _) => 98,
        ("QUADR_COMP", _) => 232,
        ("TRIAR_COMP", _) => 233,
        ("BAR", _) => 34,
        ("BARS", _) => 100,
        ("BEAM", _) => 2,
        ("ROD", _) => 1,
        ("TUBE", _) => 3,
        ("CONROD", _) => 10,
        ("ELAS1", _) => 11,
        ("ELAS2", _) => 12,
        ("ELAS3", _) => 13,
        ("ELAS4", _) => 14,
        ("BUSH", _) => 102,
        ("SHEAR", _) => 4,
        ("TETRA", _) => 39,
        ("HEXA", _) => 67,
        ("PENTA", _) => 68,
        ("PYRAM" | "PYRA", _) => 255,
        _ => return None,
    };
    let (kind, fields, columns): (_, &[&str], _) = match number {
        33 | 64 | 70 | 74 | 75 | 82 | 144 | 227 | 228 => {
            let kind = if with_corners {
                Kind::ShellCorner
            } else {
                Kind::ShellCentre
            };
            (
                kind,
                SHELL,
                if strain {
                    c::SHELL_STRAIN
                } else {
                    c::SHELL_STRESS
                },
            )
        }
        95..=98 | 232 | 233 => (
            Kind::Ply,
            &["X1", "Y1", "T1", "L1", "L2", "", "", "", ""],
            c::PLY,
        ),
        34 => (
            Kind::Plain,
            &[
                "X1A", "X2A", "X3A", "X4A", "AX", "MAXA", "MINA", "MST", "X1B", "X2B", "X3B",
                "X4B", "MAXB", "MINB", "MSC",
            ],
            c::BAR,
        ),
        100 => (
            Kind::Station,
            &["SD", "XC", "XD", "XE", "XF", "AX", "MAX", "MIN", "MS"],
            c::BAR_STATION,
        ),
        2 => (
            Kind::Beam,
            &["SD", "XC", "XD", "XE", "XF", "MAX", "MIN", "MST", "MSC"],
            c::BEAM,
        ),
        3 => (Kind::Plain, &["AS", "MSA", "TS", "MST"], c::ROD),
        1 | 10 => (Kind::Plain, &["A", "MSA", "T", "MST"], c::ROD),
        11..=14 => (Kind::Plain, &["S"], c::SPRING),
        102 => (Kind::Plain, &["TX", "TY", "TZ", "RX", "RY", "RZ"], c::NODAL),
        4 => (Kind::Plain, &["TMAX", "TAVG", "MS"], c::SHEAR_PANEL),
        _ => (
            Kind::Solid,
            &["X", "Y", "Z", "TXY", "TYZ", "TZX", "", "", "", ""],
            c::SOLID,
        ),
    };
    let quantity = match (kind, strain) {
        (Kind::Ply, true) => Quantity::PlyStrain,
        (Kind::Ply, false) => Quantity::PlyStress,
        _ => quantity,
    };
    Some(Layout {
        kind,
        quantity,
        element: Some(ElementType(number)),
        id: "EID",
        fields,
        columns,
    })
}
