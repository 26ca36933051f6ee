//! Strain of solids from displacements.

use super::SolidField;
use super::element::solid::{SolidStrain, solid_strain};
use super::error::{FeError, Refusal};
use super::prepared_model::PreparedModel;
use super::temperature::Temperatures;
use rayon::prelude::*;
use std::sync::Arc;

/// Computes the mechanical strain of every solid, one field for each displacement field (basic frame, by grid) with its temperatures.
///
/// # Errors
/// Solids that can't be formed.
pub(super) fn solid_fields(
    prepared: &PreparedModel<'_>,
    u: &[Vec<[f64; 6]>],
    temperatures: &[Option<Temperatures>],
) -> Result<Vec<SolidField>, FeError> {
    let model = prepared.model;
    let elements = Arc::new((0..model.solids.len()).collect::<Vec<_>>());
    let by_solid: Result<Vec<Vec<SolidStrain>>, Refusal> = (0..model.solids.len())
        .into_par_iter()
        .map(|i| {
            let grids = model.solids[i].all_grids();
            let fields: Vec<(&[[f64; 6]], Vec<f64>)> = u
                .iter()
                .zip(temperatures)
                .map(|(u, t)| {
                    let rise = t
                        .as_ref()
                        .map_or_else(Vec::new, |t| t.solid_rise(model, i, &grids));
                    (u.as_slice(), rise)
                })
                .collect();
            solid_strain(model, i, &fields)
        })
        .collect();
    let by_solid = by_solid.map_err(|r| FeError::Refused(vec![r]))?;
    Ok((0..u.len())
        .map(|case| {
            let of_case = || by_solid.iter().filter_map(|s| s.get(case));
            SolidField {
                elements: elements.clone(),
                centre: of_case().map(|s| s.centre).collect(),
                corners: of_case().map(|s| s.corners).collect(),
            }
        })
        .collect())
}
