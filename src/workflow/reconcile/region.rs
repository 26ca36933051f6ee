//! A small region of shells.

use crate::model::Vec3;

/// Shells within a radius of a point.
#[derive(Clone, Debug)]
pub(super) struct Region {
    /// Id of the shell in the middle of the region.
    pub(super) place: String,
    pub(super) centre: Vec3,
    pub(super) radius: f64,
    /// Indices of the shells of the region.
    pub(super) shells: Vec<usize>,
}
