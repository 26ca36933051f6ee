//! A model with what all its elements need: computed once, shared by stiffness, mass, loads and strain.

use super::element::shell::{CornerDirectors, shared_normals};
use super::grid_frames::grid_axes;
use crate::model::{Mat3, Model};

/// A model with further data that its elements need.
#[derive(Debug)]
pub(crate) struct PreparedModel<'a> {
    pub(crate) model: &'a Model,
    /// Displacement frames of the grids.
    pub(crate) axes: Vec<Option<Mat3>>,
    /// Directors by shell.
    pub(crate) directors: Vec<CornerDirectors>,
}

impl<'a> PreparedModel<'a> {
    pub(crate) fn new(model: &'a Model) -> Self {
        Self {
            model,
            axes: grid_axes(model),
            directors: shared_normals(model),
        }
    }
}
