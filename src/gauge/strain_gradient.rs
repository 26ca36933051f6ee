//! Change of a gauge's reading with its position.

use super::arms::{Arm, Gauge, Spot};
use super::grid_average::about_centre;
use super::on_refined::transfer_coefficients;
use super::side::same_side;
use super::surface::centre;
use crate::fe::shell_frame::{ShellPlace, shell_axes};
use crate::model::{Model, Vec3};

/// Returns a gauge that reads the change of `gauge` per unit of length (of the deck) if all its arms move along `direction`. The direction is in the
/// basic frame and is projected onto each arm's shell. The gradient is the best fit to the neighbours of the shell. `None` for arms on bars, at
/// corners of shells, and on shells without neighbours in that direction.
pub fn strain_gradient_gauge(gauge: &Gauge, model: &Model, direction: Vec3) -> Option<Gauge> {
    let mut arms = Vec::new();
    for arm in &gauge.arms {
        let Spot::Shell {
            shell,
            surface,
            place: ShellPlace::Centre,
        } = arm.spot
        else {
            return None;
        };
        let here = model.shells.get(shell.us())?;
        let normal = shell_axes(model, here, ShellPlace::Centre)?
            .row(2)
            .transpose();
        let axis = (direction - normal * direction.dot(&normal)).try_normalize(0.0)?;
        let weights = about_centre(model, shell, centre(model, here)? + axis, axis);
        if weights.len() < 2 {
            return None;
        }
        for (ix, w) in weights {
            // At the gauge's own shell, the value itself is not part of the change.
            let w = if ix == shell { w - 1.0 } else { w };
            arms.push(Arm {
                spot: Spot::Shell {
                    shell: ix,
                    surface: same_side(model, (shell, surface), ix)?,
                    place: ShellPlace::Centre,
                },
                coefficient: transfer_coefficients(
                    model,
                    (shell, ShellPlace::Centre),
                    model,
                    (ix, ShellPlace::Centre),
                    arm.coefficient,
                )?
                .map(|c| w * c),
            });
        }
    }
    Some(Gauge {
        arms,
        ..gauge.clone()
    })
}
