//! Loads and temperatures.

/// FORCE or MOMENT: `scale * n` at a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Force {
    pub sid: u32,
    pub grid: u32,
    /// Coordinate system of `n`.
    pub cid: u32,
    pub scale: f64,
    pub n: [f64; 3],
}

/// PLOAD: pressure on a face given by its grids.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Pload {
    pub sid: u32,
    pub pressure: f64,
    /// The fourth is 0 for a triangle.
    pub grids: [u32; 4],
}

/// PLOAD1: distributed or concentrated load on a bar or beam.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Pload1 {
    pub sid: u32,
    pub element: u32,
    /// Direction and kind: `FX` .. `MZ` basic, `FXE` .. `MZE` element.
    pub kind: [u8; 4],
    /// `LE`, `FR`, `LEPR`, `FRPR`.
    pub scale: [u8; 4],
    pub x1: f64,
    pub p1: f64,
    pub x2: Option<f64>,
    pub p2: Option<f64>,
}

/// PLOAD2: pressure on shells along their normal.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Pload2 {
    pub sid: u32,
    pub pressure: f64,
    pub elements: super::IdList,
}

/// PLOAD4: pressure on faces of shells and solids.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Pload4 {
    pub sid: u32,
    /// One element, or `first THRU last`.
    pub elements: super::IdList,
    /// P1..P4; blanks of 2 to 4 take P1.
    pub pressure: [Option<f64>; 4],
    /// Solids: a corner of the face, and the corner opposite (or the one not on it, for tetrahedra).
    pub face: [Option<u32>; 2],
    /// Direction where it is not the normal: system and vector.
    pub direction: Option<(u32, [f64; 3])>,
    /// SORL and LDIR as written, upper case; empty where blank.
    pub sorl: String,
    pub ldir: String,
}

/// GRAV: acceleration `scale * n`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Grav {
    pub sid: u32,
    pub cid: u32,
    pub scale: f64,
    pub n: [f64; 3],
}

/// ACCEL: acceleration `n` times a factor that varies along an axis.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Accel {
    pub sid: u32,
    pub cid: u32,
    pub n: [f64; 3],
    /// DIR: `X`, `Y` or `Z` of the system; empty where blank.
    pub direction: String,
    /// Location along DIR and factor there, in the order of the card.
    pub table: Vec<(f64, f64)>,
}

/// ACCEL1: acceleration `scale * n` of single grids.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Accel1 {
    pub sid: u32,
    pub cid: u32,
    pub scale: f64,
    pub n: [f64; 3],
    pub grids: Vec<super::IdList>,
}

/// RFORCE, RFORCE1: rotation about a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Rforce {
    /// RFORCE1.
    pub is_rforce1: bool,
    pub sid: u32,
    pub grid: u32,
    pub cid: u32,
    /// Revolutions per time.
    pub speed: f64,
    pub r: [f64; 3],
    pub method: Option<u32>,
    /// RACC: revolutions per time squared.
    pub acceleration: f64,
    /// IDRF of RFORCE, GROUPID of RFORCE1: the part of the structure that turns; 0: all of it.
    pub part: u32,
}

/// LOAD: `scale` times the sum of `factor * set`.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct LoadSum {
    pub sid: u32,
    pub scale: f64,
    pub terms: Vec<(f64, u32)>,
}

/// TEMP: one grid's temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Temp {
    pub sid: u32,
    pub grid: u32,
    pub t: f64,
}

/// TEMPD: the temperature of every grid that has no TEMP.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Tempd {
    pub sid: u32,
    pub t: f64,
}

/// TEMPP1: temperature of plates and its gradient through the thickness.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Tempp1 {
    pub sid: u32,
    pub elements: super::IdList,
    /// TBAR.
    pub mean: f64,
    /// TPRIME.
    pub gradient: f64,
    /// TS1 or TS2 is given.
    pub at_surfaces: bool,
}

/// TEMPRB: temperature of bars, beams and rods.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Temprb {
    pub sid: u32,
    pub elements: super::IdList,
    /// TA, TB.
    pub ends: [f64; 2],
    /// Gradient along element y at A and B, then along z.
    pub gradient: [[f64; 2]; 2],
    /// Temperatures of the stress recovery points are given.
    pub at_points: bool,
}

/// FORCE1, FORCE2, MOMENT1, MOMENT2: a magnitude, and a direction from grids.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct ForceAlong {
    pub sid: u32,
    pub grid: u32,
    pub size: f64,
    /// Two grids: from the first to the second; four: G1 to G2 crossed with G3 to G4 (0 if the card has two).
    pub points: [u32; 4],
    pub is_moment: bool,
}

/// SLOAD: a load on a scalar point, or on the first component of a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Sload {
    pub sid: u32,
    pub point: u32,
    pub load: f64,
}
