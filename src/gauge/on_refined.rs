//! A gauge on a mesh that was divided.

use super::arms::{Arm, Gauge, Spot, shell_strain};
use crate::fe::shell_frame::{ShellPlace, shell_axes};
use crate::fe::strain_tensor::Surface;
use crate::fe::{BeamField, CaseResult, PlaneStrain, ShellField};
use crate::model::{Model, RefinedModel, ShellIx};
use rayon::prelude::*;

/// Returns `gauge` on `fine`, the refinement of `coarse`: the mean over the four parts of its shell, so that place and length are unchanged.
/// An arm at a corner remains at that corner. `None` if a shell has no area.
pub fn on_refined(gauge: &Gauge, coarse: &Model, fine: &RefinedModel) -> Option<Gauge> {
    let mut arms = Vec::new();
    for arm in &gauge.arms {
        let Spot::Shell {
            shell,
            surface,
            place,
        } = arm.spot
        else {
            arms.push(*arm);
            continue;
        };
        for (part, weight) in parts_at(fine, shell, place)? {
            let coefficient = transfer_coefficients(
                coarse,
                (shell, place),
                &fine.model,
                (part, place),
                arm.coefficient,
            )?;
            arms.push(Arm {
                spot: Spot::Shell {
                    shell: part,
                    surface,
                    place,
                },
                coefficient: coefficient.map(|c| weight * c),
            });
        }
    }
    Some(Gauge {
        arms,
        ..gauge.clone()
    })
}

/// Parts of a shell that give the strain at one of its places, with their weights.
fn parts_at(fine: &RefinedModel, shell: ShellIx, place: ShellPlace) -> Option<Vec<(ShellIx, f64)>> {
    let parts = fine.children.get(shell.us())?;
    Some(match place {
        ShellPlace::Centre => parts.iter().map(|p| (*p, 0.25)).collect(),
        ShellPlace::Corner(c) => vec![(*parts.get(c)?, 1.0)],
    })
}

/// Returns the strain on `fine` minus the strain on `coarse` by case, on the shells of `coarse` and in their output frames. The strain on `fine` is
/// averaged as in [`on_refined`]. Bars do not change, and solids are left out. The value is NaN if one of the meshes has no strain.
pub fn change_by_refining(
    coarse: &Model,
    fine: &RefinedModel,
    cases: &[(&CaseResult, &CaseResult)],
) -> Vec<CaseResult> {
    cases
        .iter()
        .map(|(own, refined)| CaseResult {
            subcase: own.subcase,
            label: own.label.clone(),
            shells: change_of_shells(coarse, fine, own, refined),
            beams: zero_beam_field(&own.beams),
            ..CaseResult::default()
        })
        .collect()
}

fn change_of_shells(
    coarse: &Model,
    fine: &RefinedModel,
    own: &CaseResult,
    refined: &CaseResult,
) -> ShellField {
    let sides = |shell: ShellIx, place: ShellPlace| {
        [Surface::Bottom, Surface::Top].map(|surface| {
            let now = shell_strain(own, shell, surface, place);
            let then = strain_on_parts((coarse, fine), refined, shell, (surface, place));
            match (now, then) {
                (Some(now), Some(then)) => std::array::from_fn(|c| then[c] - now[c]),
                _ => [f64::NAN; 3],
            }
        })
    };
    let elements = own.shells.elements.par_iter();
    let centre = elements.clone().map(|&s| sides(s, ShellPlace::Centre));
    let corners = elements.map(|&s| [0, 1, 2, 3].map(|c| sides(s, ShellPlace::Corner(c))));
    ShellField {
        elements: own.shells.elements.clone(),
        centre: centre.collect(),
        corners: match own.shells.corners.is_empty() {
            true => Vec::new(),
            false => corners.collect(),
        },
        from_stress: false,
    }
}

/// The strain of the refined mesh at a place of a shell of the coarse one, in that shell's output frame.
fn strain_on_parts(
    (coarse, fine): (&Model, &RefinedModel),
    case: &CaseResult,
    shell: ShellIx,
    (surface, place): (Surface, ShellPlace),
) -> Option<PlaneStrain> {
    let mut out = [0.0; 3];
    for (part, weight) in parts_at(fine, shell, place)? {
        let strain = shell_strain(case, part, surface, place)?;
        for (c, sum) in out.iter_mut().enumerate() {
            let mut unit = [0.0; 3];
            unit[c] = 1.0;
            let row =
                transfer_coefficients(coarse, (shell, place), &fine.model, (part, place), unit)?;
            *sum += weight * row.iter().zip(strain).map(|(a, e)| a * e).sum::<f64>();
        }
    }
    Some(out)
}

/// Returns a field of zero strain with the elements and stations of `field`.
fn zero_beam_field(field: &BeamField) -> BeamField {
    let stations = field.stations.iter();
    BeamField {
        elements: field.elements.clone(),
        stations: stations
            .map(|s| s.iter().map(|(x, _)| (*x, [0.0; 4])).collect())
            .collect(),
        axial: field.axial.iter().map(|a| vec![0.0; a.len()]).collect(),
        ..BeamField::default()
    }
}

/// Returns coefficients of exx, eyy, gxy (engineering shear) in the output frame of `to`. They give the strain in the same direction as `coefficient`
/// gives in the output frame of `from`. The shells are assumed to be parallel. Let t be the angle of the old x axis from the new one: exx = c^2 Exx +
/// s^2 Eyy + s c Gxy and so on.
pub(super) fn transfer_coefficients(
    from_model: &Model,
    from: (ShellIx, ShellPlace),
    to_model: &Model,
    to: (ShellIx, ShellPlace),
    coefficient: [f64; 3],
) -> Option<[f64; 3]> {
    let old = shell_axes(from_model, from_model.shells.get(from.0.us())?, from.1)?;
    let new = shell_axes(to_model, to_model.shells.get(to.0.us())?, to.1)?;
    let old_x = new * old.row(0).transpose();
    let length = old_x.x.hypot(old_x.y);
    if length == 0.0 {
        return None;
    }
    let (c, mut s) = (old_x.x / length, old_x.y / length);
    // Seen from the other side, angles and shear have the opposite sign.
    let facing = new.row(2).dot(&old.row(2));
    let [a, b, mut g] = coefficient;
    if facing < 0.0 {
        g = -g;
    }
    if s.abs() < f64::EPSILON {
        s = 0.0;
    }
    Some([
        a * c * c + b * s * s - 2.0 * g * s * c,
        a * s * s + b * c * c + 2.0 * g * s * c,
        (a - b) * s * c + g * (c * c - s * s),
    ])
}
