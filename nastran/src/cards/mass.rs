//! Concentrated masses.

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
    /// I11, I21, I22, I31, I32, I33 about the centre of gravity; products are stored as the card states them
    /// (`I21 = integral x1 x2 dm`, the tensor's off-diagonal is its negative).
    pub inertia: [f64; 6],
}
