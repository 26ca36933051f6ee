//! Shell and shear panel elements.

/// Shape and family of a shell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum ShellShape {
    Quad4,
    QuadR,
    Quad8,
    Tria3,
    TriaR,
    Tria6,
}

impl ShellShape {
    /// Returns the number of grids, mid-side grids included.
    pub fn n_grids(self) -> usize {
        match self {
            Self::Quad4 | Self::QuadR => 4,
            Self::Quad8 => 8,
            Self::Tria3 | Self::TriaR => 3,
            Self::Tria6 => 6,
        }
    }

    /// Returns the number of corners.
    pub fn n_corners(self) -> usize {
        match self {
            Self::Quad4 | Self::QuadR | Self::Quad8 => 4,
            Self::Tria3 | Self::TriaR | Self::Tria6 => 3,
        }
    }

    /// Returns the card name.
    pub fn card(self) -> &'static str {
        match self {
            Self::Quad4 => "CQUAD4",
            Self::QuadR => "CQUADR",
            Self::Quad8 => "CQUAD8",
            Self::Tria3 => "CTRIA3",
            Self::TriaR => "CTRIAR",
            Self::Tria6 => "CTRIA6",
        }
    }
}

/// Field THETA/MCID of a shell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MaterialAngle {
    /// A real field: degrees from side 1-2. Blank is 0.
    Theta(f64),
    /// An integer field: coordinate system whose x axis is projected on the element.
    Mcid(u32),
}

/// CQUAD4, CQUADR, CQUAD8, CTRIA3, CTRIAR, CTRIA6.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shell {
    /// Element id.
    pub id: u32,
    /// Property id; `None` where blank (the element id).
    pub pid: Option<u32>,
    /// Shape.
    pub shape: ShellShape,
    /// Grid ids, corners first; the first `shape.n_grids()` count. A missing mid-side grid is 0.
    pub grids: [u32; 8],
    /// Material orientation.
    pub angle: MaterialAngle,
    /// Offset of the reference plane from the grid plane, along the element z axis.
    pub zoffs: Option<f64>,
    /// TFLAG: corner thicknesses are factors of the property's thickness.
    pub tflag: bool,
    /// Corner thicknesses.
    pub thickness: [Option<f64>; 4],
}

impl Shell {
    /// Returns the card with its stated thicknesses times `factor`. Returns `None` if the card states no thickness, or states shares of the
    /// property's thickness.
    pub fn with_thickness_times(&self, factor: f64) -> Option<Shell> {
        let stated = !self.tflag && self.thickness.iter().any(Option::is_some);
        let thickness = self.thickness.map(|t| t.map(|t| t * factor));
        stated.then_some(Shell { thickness, ..*self })
    }
}

/// CSHEAR.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct ShearPanel {
    pub id: u32,
    pub pid: Option<u32>,
    pub grids: [u32; 4],
}

/// SNORM: the normal of the shells at a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Snorm {
    pub grid: u32,
    /// Coordinate system of `n`.
    pub cid: u32,
    pub n: [f64; 3],
}
