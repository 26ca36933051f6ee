//! Calibration of gauges that may differ from their nominal position. A row of S is not linear in the moves of its gauge. It is computed again at the
//! estimated position until the position converges.

use super::fit::calibrate;
use super::types::{Calibration, ModelPrior, Move, MoveKind, Task};
use crate::linalg::Matrix;

/// Tolerance of the position and angle of gauges, 1 sd.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlueTolerance {
    /// Along and across, length.
    pub position: f64,
    /// Rotation, radians.
    pub angle_rad: f64,
}

/// Number of rounds. Each round computes the rows at the positions that the round before it found.
const ROUNDS: usize = 4;
/// Half step of the central differences, divided by the tolerance. Within this step, rows change almost linearly.
const STEP: f64 = 0.5;

/// Computes S from runs of known load with gauges that may differ from their nominal position. `row(gauge, [along, across, angle])` is the model's
/// row at this offset, strain per job unit; a gauge without such a row (`None`) keeps its nominal position.
///
/// # Errors
/// The errors of [`calibrate`].
pub fn calibrate_installed_gauges(
    task: &Task,
    tolerance: GlueTolerance,
    row: impl Fn(usize, [f64; 3]) -> Option<Vec<f64>>,
) -> Result<Calibration, String> {
    let (n, k) = (task.gauges.len(), task.loads.len());
    let Some(drawn) = &task.model else {
        return calibrate(task);
    };
    let kinds: Vec<(MoveKind, f64)> = [
        (MoveKind::Along, tolerance.position),
        (MoveKind::Across, tolerance.position),
        (MoveKind::Turned, tolerance.angle_rad),
    ]
    .into_iter()
    .filter(|m| m.1 > 0.0)
    .collect();
    // S may contain more than the field gives, such as a correction for the mesh. This part moves with the gauge.
    let corrections: Vec<Vec<f64>> = (0..n)
        .map(|g| match row(g, [0.0; 3]) {
            Some(r) => (0..k).map(|l| drawn.values[(g, l)] - r[l]).collect(),
            None => vec![0.0; k],
        })
        .collect();
    let mut at = vec![[0.0; 3]; n];
    let mut gain = vec![1.0; n];
    let mut found = None;
    for _ in 0..ROUNDS {
        let mut values = drawn.values.clone();
        let mut changes = vec![Matrix::zeros(n, k); kinds.len()];
        for g in 0..n {
            let Some(here) = row(g, at[g]) else { continue };
            (0..k).for_each(|l| values[(g, l)] = here[l] + corrections[g][l]);
            for (change, (kind, sd)) in changes.iter_mut().zip(&kinds) {
                let side = |sign: f64| {
                    let mut place = at[g];
                    place[*kind as usize] += sign * STEP * sd;
                    row(g, place)
                };
                let (Some(more), Some(less)) = (side(1.0), side(-1.0)) else {
                    continue;
                };
                for l in 0..k {
                    change[(g, l)] = gain[g] * (more[l] - less[l]) / (2.0 * STEP * sd);
                }
            }
        }
        let moves = kinds.iter().zip(changes).map(|((kind, sd), change)| Move {
            kind: *kind,
            change,
            sd: *sd,
            at: at.iter().map(|a| a[*kind as usize]).collect(),
        });
        let mut task = task.clone();
        task.model = Some(ModelPrior {
            values,
            moves: moves.collect(),
            off_drawing: drawn.off_drawing.clone(),
            uncertainty_rel: drawn.uncertainty_rel,
        });
        let calibration = calibrate(&task)?;
        for (g, glued) in calibration.as_glued.iter().enumerate() {
            gain[g] = glued.gain.value;
            for (kind, m) in &glued.moves {
                at[g][*kind as usize] = m.value;
            }
        }
        found = Some(calibration);
    }
    found.ok_or_else(|| "no round was made".to_owned())
}
