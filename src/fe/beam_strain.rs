//! Axial strain of bars and beams at their recovery points.

use super::BeamField;
use super::element::Prepared;

/// Strain at C, D, E, F of every bar and beam from displacements (basic frame, by grid).
pub(crate) fn beam_field(_prepared: &Prepared<'_>, _u: &[[f64; 6]]) -> BeamField {
    BeamField::default()
}
