//! Single-point constraints and supports.

use super::Dofs;

/// SPC: up to two grids with an enforced displacement each.
#[derive(Clone, Debug, PartialEq)]
pub struct Spc {
    /// Set id.
    pub sid: u32,
    /// Grid, dofs, enforced displacement.
    pub terms: Vec<(u32, Dofs, f64)>,
}

/// SPC1.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Spc1 {
    pub sid: u32,
    pub dofs: Dofs,
    pub grids: IdList,
}

/// Ids listed one by one, or as `a THRU b`.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub enum IdList {
    Each(Vec<u32>),
    /// Inclusive; ids that do not exist in between are left out.
    Thru(u32, u32),
}

/// SPCADD or MPCADD: a set that is the union of others.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct SetSum {
    pub sid: u32,
    pub sets: Vec<u32>,
}

/// SUPORT (`sid` none) or SUPORT1.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Suport {
    pub sid: Option<u32>,
    pub terms: Vec<(u32, Dofs)>,
}
