//! Layout of the words of a row, by quantity, element type and number of words.

use crate::results::{ElementType, Quantity, columns as c};

/// Form in which an entry of the file becomes rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::op2) enum Shape {
    /// `10 id + device, grid type, reals`.
    Nodal,
    /// `10 id + device, reals`: one row.
    Plain,
    /// `10 id + device, reals`: consecutive entries of one bar, one for each station.
    Stations,
    /// `10 id + device, reals, reals`: a row at each of two fibres.
    ShellCentre,
    /// `10 id + device, CEN/, n`, then the centre and the corners with 16 reals each; a corner begins with its grid id.
    ShellCorners,
    /// Entries like `ShellCorners`, with one row for each location.
    ForceCorners,
    /// `10 id + device`, then 11 stations: `grid, reals`.
    Beam,
    /// `10 id + device, cid, GRID, n`, then the centre and the corners with 21 words each.
    Solid,
    /// `10 id + device, ply, reals`.
    Ply,
    /// `10 grid + device, element, 2 words of text, reals`.
    GridPoint,
}

/// Layout of the words of an entry.
#[derive(Clone, Copy, Debug)]
pub(in crate::op2) struct Layout {
    pub shape: Shape,
    /// Number of words in an entry.
    pub wide: usize,
    pub columns: &'static [&'static str],
}

/// Returns the layout of real SORT1 rows; `None` if this element type and width have no known layout.
pub(in crate::op2) fn layout(
    quantity: Quantity,
    element: Option<ElementType>,
    num_wide: u32,
) -> Option<Layout> {
    use Quantity as Q;
    use Shape as S;
    let e = element.map_or(0, |e| e.0);
    let (shape, columns) = match (quantity, e, num_wide) {
        (
            Q::Displacement
            | Q::Velocity
            | Q::Acceleration
            | Q::Eigenvector
            | Q::SpcForce
            | Q::MpcForce
            | Q::AppliedLoad,
            _,
            8,
        ) => (S::Nodal, c::NODAL),
        (Q::GridPointForce, _, 10) => (S::GridPoint, c::NODAL),

        (Q::Strain, 33 | 74 | 227 | 228, 17) => (S::ShellCentre, c::SHELL_STRAIN),
        (Q::Stress, 33 | 74 | 227 | 228, 17) => (S::ShellCentre, c::SHELL_STRESS),
        (Q::Strain, 64 | 82 | 144, 87) | (Q::Strain, 70 | 75, 70) => {
            (S::ShellCorners, c::SHELL_STRAIN)
        }
        (Q::Stress, 64 | 82 | 144, 87) | (Q::Stress, 70 | 75, 70) => {
            (S::ShellCorners, c::SHELL_STRESS)
        }
        (Q::PlyStrain, 95..=98 | 232 | 233, 11) => (S::Ply, c::PLY),
        (Q::PlyStress, 95..=98 | 232 | 233, 11) => (S::Ply, c::PLY),

        (Q::Strain | Q::Stress, 34, 16) => (S::Plain, c::BAR),
        (Q::Strain | Q::Stress, 100, 10) => (S::Stations, c::BAR_STATION),
        (Q::Strain | Q::Stress, 2, 111) => (S::Beam, c::BEAM),
        (Q::Strain | Q::Stress, 1 | 3 | 10, 5) => (S::Plain, c::ROD),
        (Q::Strain | Q::Stress, 11..=14, 2) => (S::Plain, c::SPRING),
        (Q::Strain | Q::Stress, 4, 4) => (S::Plain, c::SHEAR_PANEL),
        (Q::Strain | Q::Stress, 102 | 126, 7) => (S::Plain, c::NODAL),
        (Q::Strain | Q::Stress, 39, 109) | (Q::Strain | Q::Stress, 255, 130) => {
            (S::Solid, c::SOLID)
        }
        (Q::Strain | Q::Stress, 68, 151) | (Q::Strain | Q::Stress, 67, 193) => (S::Solid, c::SOLID),

        (Q::ElementForce, 33 | 74 | 227 | 228, 9) => (S::Plain, c::SHELL_FORCE),
        (Q::ElementForce, 64 | 82 | 144, 47) | (Q::ElementForce, 70 | 75, 38) => {
            (S::ForceCorners, c::SHELL_FORCE)
        }
        (Q::ElementForce, 34, 9) => (S::Plain, c::BAR_FORCE),
        (Q::ElementForce, 100, 8) => (S::Stations, c::BAR_STATION_FORCE),
        (Q::ElementForce, 2, 100) => (S::Beam, c::BEAM_FORCE),
        (Q::ElementForce, 1 | 3 | 10, 3) => (S::Plain, c::ROD_FORCE),
        (Q::ElementForce, 11..=14, 2) => (S::Plain, c::SPRING),
        (Q::ElementForce, 102 | 126, 7) => (S::Plain, c::NODAL),
        _ => return None,
    };
    Some(Layout {
        shape,
        wide: usize::try_from(num_wide).ok()?,
        columns,
    })
}
