//! A gauge on a mesh that was divided.

use super::arms::{Arm, Gauge, Spot};
use crate::fe::shell_frame::{ShellPlace, shell_axes};
use crate::model::{Model, RefinedModel, ShellIx};

/// The same gauge on `fine`, the refinement of `coarse`: the mean over the four parts of its shell, so that it reads the same place and
/// the same length; an arm at a corner stays at that corner. `None` where a shell has no area.
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
        let parts = fine.children.get(shell.us())?;
        let taken: Vec<(ShellIx, f64)> = match place {
            ShellPlace::Centre => parts.iter().map(|p| (*p, 0.25)).collect(),
            ShellPlace::Corner(c) => vec![(*parts.get(c)?, 1.0)],
        };
        for (part, weight) in taken {
            let coefficient = turned(
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

/// Coefficients of exx, eyy, gxy (engineering shear) in the output frame of `to` that take the same strain in the same direction as
/// `coefficient` does in that of `from`; the shells are taken as level with each other. With t the angle of the old x axis from the new
/// one: exx = c^2 Exx + s^2 Eyy + s c Gxy and so on.
pub(super) fn turned(
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
    // Seen from the other side angles turn the other way, and so does shear.
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
