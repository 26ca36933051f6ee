//! Solids of a model: stiffness, mass, thermal forces, strain.

use super::form::{DegenerateShape, SolidInput};
use super::law::{SolidLaw, strain_rotation};
use super::table::{Function, Tables};
use crate::fe::element::ElementMatrix;
use crate::fe::error::Refusal;
use crate::linalg::{DMatrix, Vector6};
use crate::model::{GridIx, Model, Solid, Vec3};
use nastran::cards::SolidShape;

/// Strain of a solid: xx yy zz xy yz zx, engineering shear. The frame is the basic frame, or the material frame if PSOLID names one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SolidStrain {
    pub(crate) centre: [f64; 6],
    /// Strain at each corner. NaN beyond the corners of the element.
    pub(crate) corners: [[f64; 6]; 8],
}

fn refuse(solid: &Solid, reason: &str, remedy: &str) -> Refusal {
    Refusal::new(
        format!("{} {}", solid.shape.card(), solid.id),
        solid.at,
        reason,
        remedy,
    )
}

fn refuse_folded(solid: &Solid) -> impl Fn(DegenerateShape) -> Refusal + '_ {
    |_| {
        refuse(
            solid,
            "its shape is flat or folded",
            "check the order of its grids and the place of its mid-side grids",
        )
    }
}

fn input(model: &Model, solid: &Solid) -> Result<SolidInput, Refusal> {
    if solid.shape == SolidShape::Pyram && solid.grids[5..].iter().any(Option::is_some) {
        return Err(refuse(
            solid,
            "the built-in solver has no pyramid with mid-side grids",
            "delete the mid-side grids, or solve with Nastran",
        ));
    }
    Ok(shape_of(model, solid, &solid.all_grids()))
}

/// Returns the shape of a solid through all its grids, or through its corners alone.
fn shape_of(model: &Model, solid: &Solid, grids: &[GridIx]) -> SolidInput {
    let n = solid.shape.n_corners();
    let all = grids.len() > n;
    SolidInput {
        shape: solid.shape,
        x: grids.iter().map(|g| model.grids[g.us()].x).collect(),
        mids: (0..20 - n)
            .filter(|i| all && solid.grids[n + i].is_some())
            .collect(),
    }
}

fn build_input_and_law(model: &Model, solid: &Solid) -> Result<(SolidInput, SolidLaw), Refusal> {
    let input = input(model, solid)?;
    let corners = &input.x[..solid.shape.n_corners()];
    let law = SolidLaw::new(model, solid, corners)
        .map_err(|why| refuse(solid, why, "correct PSOLID and its material"))?;
    Ok((input, law))
}

/// Returns whether solid `i` is numbered as its mirror image, inside out.
pub(crate) fn is_inverted(model: &Model, i: usize) -> bool {
    input(model, &model.solids[i]).is_ok_and(|input| input.hand() < 0.0)
}

/// Returns the stiffness of solid `i`, basic frame. Rotations have no stiffness.
///
/// # Errors
/// Folded shapes; properties and materials that make no solid.
pub(crate) fn solid_stiffness(model: &Model, i: usize) -> Result<ElementMatrix, Refusal> {
    let solid = &model.solids[i];
    let (input, law) = build_input_and_law(model, solid)?;
    let k = input
        .form(&law.g, None)
        .map_err(refuse_folded(solid))?
        .stiffness;
    let mut out = ElementMatrix::zeros(solid.all_grids());
    let n = out.n();
    for a in 0..k.nrows() {
        let row = 6 * (a / 3) + a % 3;
        for b in 0..k.ncols() {
            out.values[row * n + 6 * (b / 3) + b % 3] = k[(a, b)];
        }
    }
    Ok(out)
}

/// Returns the grids and the mass matrix by rows: integrals of density times products of shape functions, before WTMASS. Both are empty without
/// density. The mass of a pyramid is distributed over its corners, because the solver refuses its mid-side grids.
pub(crate) fn solid_mass(model: &Model, i: usize) -> (Vec<GridIx>, Vec<f64>) {
    let solid = &model.solids[i];
    let rho = model
        .solid_properties
        .get(solid.property as usize)
        .and_then(|p| model.materials.get(p.material.us()))
        .map_or(0.0, |m| m.rho);
    if rho == 0.0 {
        return (Vec::new(), Vec::new());
    }
    let mut grids = solid.all_grids();
    if solid.shape == SolidShape::Pyram {
        grids.truncate(solid.shape.n_corners());
    }
    let mut products = shape_of(model, solid, &grids).products();
    products.iter_mut().for_each(|v| *v *= rho);
    (grids, products)
}

/// Thermal strain at a point from the temperature rise of the grids.
fn expansion<'a>(law: &'a SolidLaw, rise: &'a [f64]) -> impl Fn(&[Function]) -> Vector6<f64> + 'a {
    move |functions| {
        let dt: f64 = functions.iter().zip(rise).map(|(f, t)| f[0] * t).sum();
        law.alpha * dt
    }
}

/// Returns the forces that a temperature rise causes: three components for each grid of the element, basic frame.
///
/// # Errors
/// The errors of `solid_stiffness`.
pub(crate) fn solid_thermal_force(
    model: &Model,
    i: usize,
    rise: &[f64],
) -> Result<Vec<(GridIx, Vec3)>, Refusal> {
    let solid = &model.solids[i];
    let (input, law) = build_input_and_law(model, solid)?;
    let strain = expansion(&law, rise);
    let force = input
        .form(&law.g, Some(&strain))
        .map_err(refuse_folded(solid))?
        .force;
    Ok(solid
        .all_grids()
        .into_iter()
        .zip(force.chunks_exact(3).map(Vec3::from_column_slice))
        .collect())
}

/// Computes the mechanical strain of solid `i`, one result per displacement field. Displacements are in the basic frame by grid of the model. The
/// temperature rise is by grid of the solid (empty: none).
///
/// # Errors
/// The errors of `solid_stiffness`.
pub(crate) fn solid_strain(
    model: &Model,
    i: usize,
    fields: &[(&[[f64; 6]], Vec<f64>)],
) -> Result<Vec<SolidStrain>, Refusal> {
    let solid = &model.solids[i];
    let (input, law) = build_input_and_law(model, solid)?;
    let tables = Tables::get(solid.shape);
    let turn = law.axes.as_ref().map(strain_rotation);
    let grids = solid.all_grids();
    let centre = input
        .strain_columns_at(&tables.centre)
        .map_err(refuse_folded(solid))?;
    let sampled: Vec<_> = tables
        .sampling
        .iter()
        .map(|p| input.strain_columns_at(p))
        .collect::<Result<_, DegenerateShape>>()
        .map_err(refuse_folded(solid))?;
    let share = match input.has_modes() {
        true => {
            input
                .form(&law.g, None)
                .map_err(refuse_folded(solid))?
                .share
        }
        false => DMatrix::zeros(0, 3 * grids.len()),
    };
    fields
        .iter()
        .map(|(u, rise)| {
            let local: Vec<f64> = grids
                .iter()
                .flat_map(|g| u[g.us()].into_iter().take(3))
                .collect();
            let strain = expansion(&law, rise);
            let mut modes: Vec<f64> = if rise.is_empty() || !input.has_modes() {
                vec![0.0; share.nrows()]
            } else {
                input
                    .form(&law.g, Some(&strain))
                    .map_err(refuse_folded(solid))?
                    .amount
            };
            for (m, amount) in modes.iter_mut().enumerate() {
                *amount -= local
                    .iter()
                    .enumerate()
                    .map(|(j, u)| share[(m, j)] * u)
                    .sum::<f64>();
            }
            let at = |at: &super::form::StrainColumns| -> [f64; 6] {
                let total: Vector6<f64> = at
                    .columns
                    .iter()
                    .zip(local.iter().chain(&modes))
                    .map(|(c, u)| c * *u)
                    .sum();
                let mechanical = total - strain(&at.functions);
                turn.map_or(mechanical, |t| t * mechanical).into()
            };
            let values: Vec<[f64; 6]> = sampled.iter().map(at).collect();
            let mut corners = [[f64::NAN; 6]; 8];
            for (corner, weights) in corners.iter_mut().zip(&tables.to_corner) {
                *corner = std::array::from_fn(|c| {
                    weights.iter().zip(&values).map(|(w, v)| w * v[c]).sum()
                });
            }
            Ok(SolidStrain {
                centre: at(&centre),
                corners,
            })
        })
        .collect()
}
