//! Strain of shells from displacements.

use super::ShellField;
use super::element::Prepared;
use super::element::shell::{AnyShell, Parts, shell_matrices, surfaces};
use super::error::{FeError, Refusal};
use crate::model::{GridIx, ShellIx};
use rayon::prelude::*;
use std::sync::Arc;

/// Shells at a time: bounds the memory beside the result.
const BATCH: usize = 16_384;

/// Where strain is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Corners {
    /// At centre and corners.
    #[default]
    Compute,
    /// At the centre only: a fifth of the memory.
    Leave,
}

type Strains = ([[f64; 3]; 2], [[[f64; 3]; 2]; 4]);

fn local<const M: usize>(u: &[[f64; 6]], grids: &[GridIx]) -> [f64; M] {
    let mut out = [0.0; M];
    for (o, g) in out.chunks_exact_mut(6).zip(grids) {
        o.copy_from_slice(&u[g.us()]);
    }
    out
}

/// Strain of every shell, one field a displacement field (basic frame, by grid).
///
/// # Errors
/// Shells that can't be formed.
pub(crate) fn shell_fields(
    prepared: &Prepared<'_>,
    u: &[Vec<[f64; 6]>],
    corners: Corners,
) -> Result<Vec<ShellField>, FeError> {
    let model = prepared.model;
    let n = model.shells.len();
    let elements = Arc::new((0..n as u32).map(ShellIx).collect::<Vec<_>>());
    let mut fields: Vec<ShellField> = u
        .iter()
        .map(|_| ShellField {
            elements: elements.clone(),
            centre: Vec::with_capacity(n),
            ..ShellField::default()
        })
        .collect();
    let all: Vec<usize> = (0..n).collect();
    for batch in all.chunks(BATCH) {
        let rows: Vec<Result<Vec<Strains>, Refusal>> = batch
            .par_iter()
            .map(|&i| {
                let shell = &model.shells[i];
                let z = model.shell_properties[shell.property.us()].z;
                Ok(
                    match shell_matrices(prepared, i, Parts::WithoutStiffness)? {
                        AnyShell::Quad(m) => u
                            .iter()
                            .map(|u| {
                                let local = local::<24>(u, &shell.grids[..4]);
                                (
                                    surfaces(&m.centre, z, &local),
                                    m.corners.each_ref().map(|rows| surfaces(rows, z, &local)),
                                )
                            })
                            .collect(),
                        AnyShell::Tria(m) => u
                            .iter()
                            .map(|u| {
                                let centre =
                                    surfaces(&m.centre, z, &local::<18>(u, &shell.grids[..3]));
                                (centre, [centre, centre, centre, [[f64::NAN; 3]; 2]])
                            })
                            .collect(),
                    },
                )
            })
            .collect();
        for row in rows {
            let row = row.map_err(|r| FeError::Refused(vec![r]))?;
            for (field, (centre, at_corners)) in fields.iter_mut().zip(row) {
                field.centre.push(centre);
                if corners == Corners::Compute {
                    field.corners.push(at_corners);
                }
            }
        }
    }
    Ok(fields)
}
