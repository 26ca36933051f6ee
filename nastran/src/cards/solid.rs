//! Solid elements.

/// Shape of a solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum SolidShape {
    Tetra,
    Penta,
    Hexa,
    Pyram,
}

impl SolidShape {
    /// Returns the number of corners.
    pub fn n_corners(self) -> usize {
        match self {
            Self::Tetra => 4,
            Self::Penta => 6,
            Self::Hexa => 8,
            Self::Pyram => 5,
        }
    }

    /// Returns the card name.
    pub fn card(self) -> &'static str {
        match self {
            Self::Tetra => "CTETRA",
            Self::Penta => "CPENTA",
            Self::Hexa => "CHEXA",
            Self::Pyram => "CPYRAM",
        }
    }
}

/// CTETRA, CPENTA, CHEXA, CPYRAM.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solid {
    /// Element id.
    pub id: u32,
    /// Property id; `None` where blank (the element id).
    pub pid: Option<u32>,
    /// Shape.
    pub shape: SolidShape,
    /// Grid ids, corners first; unused and missing mid-side grids are 0.
    pub grids: [u32; 20],
}
