//! Concentrated and non-structural masses.

use super::IdList;

/// CONM1: a symmetric 6 x 6 mass matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conm1 {
    /// Element id.
    pub id: u32,
    /// Grid.
    pub grid: u32,
    /// Coordinate system of the matrix.
    pub cid: u32,
    /// Lower triangle by rows: M11, M21, M22, M31 ... M66.
    pub m: [f64; 21],
}

/// CONM2: a rigid body at a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conm2 {
    /// Element id.
    pub id: u32,
    /// Grid.
    pub grid: u32,
    /// Coordinate system of offset and inertia; -1: `offset` is a location in basic.
    pub cid: i32,
    /// Mass, before PARAM,WTMASS.
    pub mass: f64,
    /// Offset of the centre of gravity from the grid.
    pub offset: [f64; 3],
    /// I11, I21, I22, I31, I32, I33 about the centre of gravity. Products are stored as the card states them, `I21 = integral x1 x2 dm`; the
    /// off-diagonal term of the tensor has the opposite sign.
    pub inertia: [f64; 6],
}

/// NSM, NSM1, NSML, NSML1: non-structural mass of properties or elements; it acts if case control selects the set.
#[derive(Clone, Debug, PartialEq)]
pub struct NonstructuralMass {
    /// Set id.
    pub sid: u32,
    /// NSML, NSML1: `value` is a mass that is spread over all listed items; otherwise it is mass per area or length.
    pub lumped: bool,
    /// PSHELL, PCOMP, PBAR .. or ELEMENT.
    pub of: String,
    /// Properties or elements; `None`: all of that type.
    pub ids: Option<Vec<IdList>>,
    /// Mass, or mass per area or length.
    pub value: f64,
}

/// CMASS1 to CMASS4: a mass that acts between two components, or at one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScalarMass {
    /// Element id.
    pub id: u32,
    /// PMASS, or the mass itself.
    pub mass: ScalarMassValue,
    /// Ends: grid id and component (0 for a scalar point); `None` is ground.
    pub ends: [Option<(u32, u8)>; 2],
}

/// CMASS1 and CMASS3 name a PMASS, CMASS2 and CMASS4 state the mass.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub enum ScalarMassValue {
    Property(Option<u32>),
    Direct(f64),
}

/// PMASS: the mass of CMASS1 and CMASS3.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Pmass {
    pub id: u32,
    pub mass: f64,
}
