//! Bars, beams, rods, bushes and springs.

use super::Dofs;

/// The orientation vector of a bar, beam or bush.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Orientation {
    /// Components in the displacement frame of end A (or basic, by the offset flag).
    Vector([f64; 3]),
    /// From end A to this grid.
    Grid(u32),
    /// All fields blank: BAROR or BEAMOR decides.
    Blank,
}

/// CBAR.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    /// Element id.
    pub id: u32,
    /// Property id; `None`: BAROR, else the element id.
    pub pid: Option<u32>,
    /// End grids A, B.
    pub grids: [u32; 2],
    /// Orientation.
    pub orientation: Orientation,
    /// OFFT such as `GGG`, upper case; `None` where blank.
    pub offt: Option<[u8; 3]>,
    /// Pin flags at A and B.
    pub pins: [Dofs; 2],
    /// Offsets at A and B.
    pub offsets: [[f64; 3]; 2],
}

/// CBEAM.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Fields in common with CBAR.
    pub bar: Bar,
    /// Field 9 of the first line if it is a real: BIT.
    pub bit: Option<f64>,
    /// Warping points at A and B.
    pub warping: [Option<u32>; 2],
}

/// BAROR, BEAMOR.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct BarDefaults {
    pub pid: Option<u32>,
    pub orientation: Orientation,
    pub offt: Option<[u8; 3]>,
}

/// CROD or CTUBE.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Rod {
    pub id: u32,
    pub pid: Option<u32>,
    pub grids: [u32; 2],
    /// A CTUBE (its property is a PTUBE).
    pub is_tube: bool,
}

/// CONROD: a rod with its own property.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Conrod {
    pub id: u32,
    pub grids: [u32; 2],
    pub mid: u32,
    pub area: f64,
    pub torsion: f64,
    /// Torsional stress coefficient C.
    pub c: f64,
    pub nsm: f64,
}

/// CBUSH.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Bush {
    pub id: u32,
    pub pid: Option<u32>,
    /// End B is `None` when grounded.
    pub grids: (u32, Option<u32>),
    pub orientation: Orientation,
    /// CID: the element frame, 0 basic. It takes precedence over `orientation`.
    pub cid: Option<u32>,
    /// S: location of the spring between A and B, default 0.5.
    pub s: Option<f64>,
    /// OCID and offset S1 S2 S3.
    pub ocid: Option<i32>,
    pub offset: [f64; 3],
}

/// CELAS1 to CELAS4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    /// Element id.
    pub id: u32,
    /// Source of the stiffness.
    pub stiffness: SpringStiffness,
    /// Ends: grid id and component (0 for a scalar point); `None` is ground.
    pub ends: [Option<(u32, u8)>; 2],
}

/// CELAS1 names a PELAS, CELAS2 carries its own numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub enum SpringStiffness {
    Property(Option<u32>),
    Direct {
        k: f64,
        damping: f64,
        stress_coefficient: f64,
    },
}
