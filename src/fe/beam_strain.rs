//! Axial strain of bars and beams at their recovery points.

use super::BeamField;
use super::beam_field::{BeamShape, SolvedBeams};
use super::element::beam::{beam_forces, modulus_and_length, strain_at};
use super::error::{FeError, Refusal};
use super::line_load::BeamLoads;
use super::prepared_model::PreparedModel;
use crate::model::{BeamIx, Model};
use rayon::prelude::*;
use std::sync::Arc;

/// Computes the strain at C, D, E, F of every bar and beam, one field for each displacement field (basic frame, by grid).
///
/// # Errors
/// Beams that can't be formed.
pub(super) fn beam_fields(
    prepared: &PreparedModel<'_>,
    u: &[Vec<[f64; 6]>],
    between: &[BeamLoads<'_>],
) -> Result<Vec<BeamField>, FeError> {
    let model = prepared.model;
    let n = model.beams.len();
    let elements = Arc::new((0..n as u32).map(BeamIx).collect::<Vec<_>>());
    let shapes = Arc::new(shapes_of(model).map_err(|r| FeError::Refused(vec![r]))?);
    u.iter()
        .zip(between)
        .map(|(u, between)| {
            let forces: Result<Vec<_>, Refusal> = (0..n)
                .into_par_iter()
                .map(|i| beam_forces(model, i, u, &between.loads_on_beam(model, i)))
                .collect();
            let forces = forces.map_err(|r| FeError::Refused(vec![r]))?;
            let loads = between.loads_by_beam(model);
            let (mut stations, mut axial) = (Vec::with_capacity(n), Vec::with_capacity(n));
            for (i, (shape, forces)) in shapes.iter().zip(&forces).enumerate() {
                let along = (shape.sections.as_slice(), shape.e, shape.length);
                let loads = loads.get(&i).map_or(&[][..], Vec::as_slice);
                let all = own_stations(model, i);
                let all: Vec<_> = all.map(|x| strain_at(along, forces, loads, x)).collect();
                stations.push(all.iter().map(|s| (s.station, s.points)).collect());
                axial.push(all.iter().map(|s| s.axial).collect());
            }
            Ok(BeamField {
                elements: elements.clone(),
                stations,
                axial,
                solved: Some(SolvedBeams {
                    shapes: shapes.clone(),
                    forces,
                    loads,
                }),
                ..BeamField::default()
            })
        })
        .collect()
}

/// Stations of the output of beam `i`: the ends of a CBAR, all sections of a CBEAM.
fn own_stations(model: &Model, i: usize) -> impl Iterator<Item = f64> {
    let beam = &model.beams[i];
    let sections = &model.beam_properties[beam.property.us()].sections;
    let ends = [0.0, 1.0].into_iter().filter(|_| !beam.is_beam);
    let all = sections.iter().map(|s| s.0).filter(|_| beam.is_beam);
    ends.chain(all)
}

fn shapes_of(model: &Model) -> Result<Vec<BeamShape>, Refusal> {
    let properties = model.beam_properties.iter();
    let sections: Vec<_> = properties.map(|p| Arc::new(p.sections.clone())).collect();
    let shape = |i: usize| {
        let (e, length) = modulus_and_length(model, i)?;
        Ok(BeamShape {
            sections: sections[model.beams[i].property.us()].clone(),
            e,
            length,
        })
    };
    (0..model.beams.len()).map(shape).collect()
}
