//! Strain of shells from displacements.

use super::ShellField;
use super::element::shell::{AnyShell, Parts, shell_heat, shell_matrices, surfaces};
use super::error::{FeError, Refusal};
use super::options::Corners;
use super::prepared_model::PreparedModel;
use super::temperature::Temperatures;
use crate::model::{GridIx, ShellIx};
use rayon::prelude::*;
use std::sync::Arc;

/// Shells a task.
const CHUNK: usize = 512;

type Surfaces = [[f64; 3]; 2];

/// Part of a field: at the centre and, where wanted, at the corners.
type Piece<'a> = (&'a mut [Surfaces], &'a mut [[Surfaces; 4]]);

fn gather_displacements<const M: usize>(u: &[[f64; 6]], grids: &[GridIx]) -> [f64; M] {
    let mut out = [0.0; M];
    for (o, g) in out.chunks_exact_mut(6).zip(grids) {
        o.copy_from_slice(&u[g.us()]);
    }
    out
}

/// Computes the strain of every shell, one field for each displacement field (basic frame, by grid).
///
/// # Errors
/// Shells that can't be formed.
pub(super) fn shell_fields(
    prepared: &PreparedModel<'_>,
    u: &[Vec<[f64; 6]>],
    temperatures: &[Option<Temperatures>],
    corners: Corners,
) -> Result<Vec<ShellField>, FeError> {
    let model = prepared.model;
    let n = model.shells.len();
    let elements = Arc::new((0..n as u32).map(ShellIx).collect::<Vec<_>>());
    let at_corners = match corners {
        Corners::Compute => n,
        Corners::Leave => 0,
    };
    let mut fields: Vec<ShellField> = u
        .iter()
        .map(|_| ShellField {
            elements: elements.clone(),
            centre: vec![[[0.0; 3]; 2]; n],
            corners: vec![[[[0.0; 3]; 2]; 4]; at_corners],
            from_stress: false,
        })
        .collect();
    // For each chunk of shells: the part of every field that the chunk fills.
    let mut pieces: Vec<Vec<Piece<'_>>> = (0..n.div_ceil(CHUNK))
        .map(|_| Vec::with_capacity(u.len()))
        .collect();
    for field in &mut fields {
        let mut corners = field.corners.chunks_mut(CHUNK);
        for (centre, list) in field.centre.chunks_mut(CHUNK).zip(&mut pieces) {
            list.push((centre, corners.next().unwrap_or_default()));
        }
    }
    pieces
        .into_par_iter()
        .enumerate()
        .try_for_each(|(chunk, mut pieces)| {
            let first = chunk * CHUNK;
            (first..n.min(first + CHUNK))
                .try_for_each(|i| fill(prepared, i, i - first, (u, temperatures), &mut pieces))
        })
        .map_err(|r| FeError::Refused(vec![r]))?;
    Ok(fields)
}

/// Strain of shell `i` under every displacement field, put at row `at` of the pieces.
fn fill(
    prepared: &PreparedModel<'_>,
    i: usize,
    at: usize,
    (u, temperatures): (&[Vec<[f64; 6]>], &[Option<Temperatures>]),
    pieces: &mut [Piece<'_>],
) -> Result<(), Refusal> {
    let shell = &prepared.model.shells[i];
    let fibres = prepared.model.fibres(shell);
    let n = shell.shape.n_corners();
    let matrices = shell_matrices(prepared, i, Parts::WithoutStiffness, None)?;
    for ((u, t), (centre, corners)) in u.iter().zip(temperatures).zip(pieces) {
        let heat = t.as_ref().and_then(|t| shell_heat(prepared.model, i, t));
        // Thermal strain at the centre (`None`) or at a corner.
        let free = |corner: Option<usize>| {
            heat.as_ref().map_or([[0.0; 3]; 2], |h| {
                let rise = match corner {
                    Some(k) => h.rise[k],
                    None => h.rise[..n].iter().sum::<f64>() / n as f64,
                };
                h.free_strain(rise, fibres.distances_at(corner))
            })
        };
        match &matrices {
            AnyShell::Quad(m) => {
                let local = gather_displacements::<24>(u, &shell.grids[..4]);
                centre[at] = surfaces(&m.centre, fibres.centre, &local, &free(None));
                if let Some(slot) = corners.get_mut(at) {
                    *slot = std::array::from_fn(|k| {
                        surfaces(&m.corners[k], fibres.corners[k], &local, &free(Some(k)))
                    });
                }
            }
            AnyShell::Many(plain) => {
                // Temperature moves the eliminated centre, so each case needs its own rows.
                let heated = match &heat {
                    Some(h) => Some(shell_matrices(
                        prepared,
                        i,
                        Parts::WithoutStiffness,
                        Some(h),
                    )?),
                    None => None,
                };
                let m = match &heated {
                    Some(AnyShell::Many(m)) => m,
                    _ => plain,
                };
                let local: Vec<f64> = shell.all_grids().iter().flat_map(|g| u[g.us()]).collect();
                centre[at] = m.centre.surfaces(fibres.centre, &local, &free(None));
                if let Some(slot) = corners.get_mut(at) {
                    *slot = [[[f64::NAN; 3]; 2]; 4];
                    for (k, (slot, rows)) in slot.iter_mut().zip(&m.corners).enumerate() {
                        *slot = rows.surfaces(fibres.corners[k], &local, &free(Some(k)));
                    }
                }
            }
            AnyShell::Tria(m) => {
                let local = gather_displacements::<18>(u, &shell.grids[..3]);
                centre[at] = surfaces(&m.centre, fibres.centre, &local, &free(None));
                if let Some(slot) = corners.get_mut(at) {
                    *slot = [centre[at], centre[at], centre[at], [[f64::NAN; 3]; 2]];
                }
            }
        }
    }
    Ok(())
}
