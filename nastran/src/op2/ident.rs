//! Identification records: 146 words in front of every record of rows.

use super::words::Words;
use crate::results::{Analysis, ElementType, Quantity, ShellForm};

/// Number of words in an identification record.
pub(super) const IDENT_WORDS: usize = 146;

/// Content of an identification record.
#[derive(Clone, Debug)]
pub(super) struct Ident {
    pub analysis: Analysis,
    pub table_code: i32,
    pub sort2: bool,
    pub complex: bool,
    pub random: bool,
    pub element: u32,
    pub subcase: u32,
    pub mode: i32,
    pub step: f64,
    pub num_wide: u32,
    pub stress_code: i64,
    pub thermal: i64,
    /// The entity of a SORT2 record, without the device code.
    pub entity: Option<u32>,
    pub titles: [String; 3],
}

/// Reads an identification record; `None` if the words cannot be one.
pub(super) fn read_ident(w: Words<'_>) -> Option<Ident> {
    let small = |i: usize| w.int(i).and_then(|v| i32::try_from(v).ok());
    let approach = small(0)?;
    let code = small(1)?;
    if w.len() < IDENT_WORDS || !(0..=999).contains(&approach) || code < 0 {
        return None;
    }
    let analysis = Analysis::from_code(approach / 10);
    let sort = code / 1000;
    let format = small(8).unwrap_or(0);
    let (mode, step) = match analysis {
        Analysis::Modes | Analysis::PostBuckling | Analysis::ComplexEigen => {
            (small(4).unwrap_or(0), w.real_at(5).unwrap_or(0.0))
        }
        Analysis::Frequency | Analysis::Transient | Analysis::NonlinearStatics => {
            (0, w.real_at(4).unwrap_or(0.0))
        }
        _ => (0, 0.0),
    };
    Some(Ident {
        analysis,
        table_code: code % 1000,
        sort2: matches!(sort, 2 | 3 | 5 | 6),
        complex: matches!(sort, 1 | 3) || matches!(format, 2 | 3),
        random: sort >= 4,
        element: small(2).and_then(|v| u32::try_from(v).ok()).unwrap_or(0),
        subcase: small(3).and_then(|v| u32::try_from(v).ok()).unwrap_or(0),
        mode,
        step,
        num_wide: small(9).and_then(|v| u32::try_from(v).ok()).unwrap_or(0),
        stress_code: w.int(10).unwrap_or(0),
        thermal: w.int(22).unwrap_or(0),
        entity: matches!(sort, 2 | 3 | 5 | 6)
            .then(|| w.int(4).and_then(|v| u32::try_from(v / 10).ok()))
            .flatten(),
        titles: [w.text(50, 32), w.text(82, 32), w.text(114, 32)],
    })
}

impl Ident {
    /// Returns the quantity. The stress code distinguishes strain from stress; the element type marks ply rows. The table's name distinguishes SPC
    /// from MPC forces, which share a code, and marks tables that are not plain results.
    pub(super) fn quantity(&self, table: &str) -> Quantity {
        if self.thermal != 0 || self.random || is_derived(table) {
            return Quantity::Other;
        }
        match self.table_code {
            1 => Quantity::Displacement,
            7 => Quantity::Eigenvector,
            10 => Quantity::Velocity,
            11 => Quantity::Acceleration,
            2 => Quantity::AppliedLoad,
            3 | 39 if is_mpc_force(table) => Quantity::MpcForce,
            3 => Quantity::SpcForce,
            4 => Quantity::ElementForce,
            5 => match (self.stress_code & 2 != 0, is_composite(self.element)) {
                (true, true) => Quantity::PlyStrain,
                (true, false) => Quantity::Strain,
                (false, true) => Quantity::PlyStress,
                (false, false) => Quantity::Stress,
            },
            19 => Quantity::GridPointForce,
            39 => Quantity::SpcForce,
            // Codes 14 to 17 are quantities of the solution set, whose ids are not grids.
            _ => Quantity::Other,
        }
    }

    /// Returns fibre or curvature form; `None` if the rows are not shell stress or strain.
    pub(super) fn form(&self, quantity: Quantity) -> Option<ShellForm> {
        let shell = matches!(self.element, 33 | 64 | 70 | 74 | 75 | 82 | 144 | 227 | 228);
        match quantity {
            Quantity::Stress if shell => Some(ShellForm::Fiber),
            Quantity::Strain if shell && self.stress_code & 4 == 0 => Some(ShellForm::Curvature),
            Quantity::Strain if shell => Some(ShellForm::Fiber),
            _ => None,
        }
    }

    /// Returns the element type of element results.
    pub(super) fn element_type(&self, quantity: Quantity) -> Option<ElementType> {
        use Quantity as Q;
        let of_elements = matches!(
            quantity,
            Q::ElementForce | Q::Stress | Q::Strain | Q::PlyStress | Q::PlyStrain | Q::Other
        );
        (of_elements && self.element != 0).then_some(ElementType(self.element))
    }
}

/// Returns whether the rows of an element type are plies.
fn is_composite(element: u32) -> bool {
    matches!(element, 95..=98 | 232 | 233)
}

fn is_mpc_force(table: &str) -> bool {
    table.starts_with("OQM") || table.starts_with("RAQM")
}

/// Returns whether a table shares codes with plain results but contains other data: random results, response spectra, contributions, contact forces,
/// glue forces.
fn is_derived(table: &str) -> bool {
    ["PSD", "ATO", "RMS", "CRM", "NO1", "NO2", "XNO", "XRM"]
        .iter()
        .any(|part| table.contains(part))
        || [
            "OUGMC", "OUGPC", "OUGGC", "OUGRC", "OQGCF", "OQGGF", "OFCON", "OPNL", "OCPSDF",
        ]
        .iter()
        .any(|head| table.starts_with(head))
}
