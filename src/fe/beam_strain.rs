//! Axial strain of bars and beams at their recovery points.

use super::BeamField;
use super::element::beam::{StationStrain, beam_strain};
use super::error::{FeError, Refusal};
use super::line_load::Between;
use super::prepared::Prepared;
use crate::model::BeamIx;
use rayon::prelude::*;
use std::sync::Arc;

/// Strain at C, D, E, F of every bar and beam, one field a displacement field (basic frame, by grid).
///
/// # Errors
/// Beams that can't be formed.
pub(super) fn beam_fields(
    prepared: &Prepared<'_>,
    u: &[Vec<[f64; 6]>],
    between: &[Between<'_>],
) -> Result<Vec<BeamField>, FeError> {
    let model = prepared.model;
    let elements = Arc::new(
        (0..model.beams.len() as u32)
            .map(BeamIx)
            .collect::<Vec<_>>(),
    );
    u.iter()
        .zip(between)
        .map(|(u, between)| {
            let stations: Result<Vec<_>, Refusal> = (0..model.beams.len())
                .into_par_iter()
                .map(|i| beam_strain(model, i, u, &between.of(model, i)))
                .collect();
            let stations = stations.map_err(|r| FeError::Refused(vec![r]))?;
            let points = |s: &StationStrain| (s.station, s.points);
            let of_all = stations.iter();
            Ok(BeamField {
                elements: elements.clone(),
                axial: of_all
                    .clone()
                    .map(|b| b.iter().map(|s| s.axial).collect())
                    .collect(),
                stations: of_all.map(|b| b.iter().map(points).collect()).collect(),
            })
        })
        .collect()
}
