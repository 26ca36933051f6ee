//! Rigid elements and multi-point constraints.

use super::Dofs;

/// RBE2.
#[derive(Clone, Debug, PartialEq)]
pub struct Rbe2 {
    /// Element id.
    pub id: u32,
    /// Independent grid.
    pub independent: u32,
    /// Dependent dofs at the dependent grids, in their displacement frames.
    pub dofs: Dofs,
    /// Dependent grids.
    pub dependent: Vec<u32>,
    /// Thermal expansion coefficient.
    pub alpha: f64,
}

/// RBE3: the reference grid moves as the weighted mean of the other grids.
#[derive(Clone, Debug, PartialEq)]
pub struct Rbe3 {
    /// Element id.
    pub id: u32,
    /// Reference grid.
    pub reference: u32,
    /// REFC: dofs of the reference grid.
    pub refc: Dofs,
    /// Weight, dofs, grids.
    pub groups: Vec<Rbe3Group>,
    /// UM: dofs made dependent instead of REFC.
    pub um: Vec<(u32, Dofs)>,
    /// Thermal expansion coefficient.
    pub alpha: f64,
}

/// One WT, C, G list of an RBE3.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Rbe3Group {
    pub weight: f64,
    pub dofs: Dofs,
    pub grids: Vec<u32>,
}

/// RBE1.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Rbe1 {
    pub id: u32,
    pub independent: Vec<(u32, Dofs)>,
    pub dependent: Vec<(u32, Dofs)>,
    pub alpha: f64,
}

/// RBAR.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rbar {
    /// Element id.
    pub id: u32,
    /// Ends A, B.
    pub grids: [u32; 2],
    /// CNA, CNB: independent dofs at A and B.
    pub independent: [Dofs; 2],
    /// CMA, CMB: dependent dofs; both empty: all dofs that are not independent.
    pub dependent: [Dofs; 2],
    /// Thermal expansion coefficient.
    pub alpha: f64,
}

/// RSPLINE: an elastic tube through grids. The first grid, the last grid and the grids without dependent dofs carry the other grids.
#[derive(Clone, Debug, PartialEq)]
pub struct Rspline {
    /// Element id.
    pub id: u32,
    /// D/L: diameter of the tube over the length of all segments.
    pub diameter: f64,
    /// Grids in order along the line, each with its dependent dofs (none: independent).
    pub grids: Vec<(u32, Dofs)>,
}

/// MPC: sum of coefficient times dof = 0; the first term is the dependent one.
#[derive(Clone, Debug, PartialEq)]
pub struct Mpc {
    /// Set id.
    pub sid: u32,
    /// Grid, component (0 for scalar points), coefficient.
    pub terms: Vec<(u32, u8, f64)>,
}
