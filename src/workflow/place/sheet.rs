//! Data on each gauge for the technician: reference point, tolerance budget, strain by load.

use super::chosen_layout::ChosenLayout;
use super::outcome::{PlacedGauge, StrainOfLoad};
use super::task::{Task, by_load};
use crate::gauge::{Bridge, Gauge};
use crate::job::LoadActs;
use crate::placement::Role;
use crate::placement::angle_variance;
use crate::placement::gradient::forms;
use crate::placement::quality::{Quality, influence};
use crate::placement::sites::Site;
use crate::sensitivity::LoadCaseOf;

/// Error of a load, in shares of its expected size, for which the tolerance budget is stated.
const BUDGET: f64 = 0.05;

/// Returns the gauges with all data of the sheet; the gauges in `validation` are not used for estimating.
pub(super) fn list_placed_gauges(
    task: &Task,
    chosen: &ChosenLayout,
    prior: &[f64],
    quality: &Quality,
    validation: &[(usize, f64)],
) -> Vec<PlacedGauge> {
    let k = task.cases.len();
    let rows: Vec<Vec<f64>> = chosen.channels.iter().map(|c| c.row.clone()).collect();
    let influence = influence(&rows, prior, k).unwrap_or_default();
    let (ordered, scales) = task.nuisance_first();
    let steep = steepness(task, chosen, &ordered, &scales);
    let names: Vec<String> = task.job.loads.iter().map(|l| l.name.clone()).collect();
    chosen
        .channels
        .iter()
        .enumerate()
        .map(|(i, c)| {
            // An error of one microstrain of this gauge changes the load that it affects most by this share of its expected size.
            let moves = influence.get(i).copied().unwrap_or(0.0) / c.sd;
            let allowed = |change: f64| {
                let error = moves * change;
                (error > 0.0).then(|| BUDGET / error)
            };
            let strains = by_load(task, &c.gauge);
            let g = &c.gauge;
            PlacedGauge {
                name: g.name.clone(),
                element: g.element,
                surface: g.surface.word(),
                position: [g.position.x, g.position.y, g.position.z],
                direction: [g.direction.x, g.direction.y, g.direction.z],
                angle_deg: g.angle_rad.to_degrees(),
                angle_seen_deg: PlacedGauge::seen_deg(g),
                leverage: quality.leverage[i],
                expected_microstrain: strains.iter().map(|v| v.abs()).sum(),
                bridge: c.bridge,
                role: if validation.iter().any(|v| v.0 == i) {
                    Role::Validation
                } else {
                    Role::Estimate
                },
                sd_microstrain: c.sd,
                angle_budget_deg: allowed(c.turn).map(f64::to_degrees),
                position_budget: allowed(steep[i]),
                strain_by_load: names
                    .iter()
                    .zip(strains)
                    .map(|(name, microstrain)| StrainOfLoad {
                        name: name.clone(),
                        microstrain,
                    })
                    .collect(),
                reference: reference_of(task, g),
                spot: c.spot.clone(),
                gauge: g.clone(),
            }
        })
        .collect()
}

/// Returns the change of each channel's reading with its place: microstrain per length, rms over the expected loads.
fn steepness(
    task: &Task,
    chosen: &ChosenLayout,
    ordered: &[LoadCaseOf],
    scales: &[f64],
) -> Vec<f64> {
    let mut out = vec![0.0; chosen.channels.len()];
    for bridge in Bridge::ALL {
        let (at, sites): (Vec<usize>, Vec<Site>) = chosen
            .channels
            .iter()
            .enumerate()
            .filter(|(_, c)| c.bridge == bridge.name())
            .filter_map(|(i, c)| Some((i, c.site?)))
            .unzip();
        if sites.is_empty() {
            continue;
        }
        let forms = forms(task.fields.model(), &sites, bridge, ordered, scales, 1.0);
        for (i, form) in at.into_iter().zip(&forms) {
            let phases = angle_variance::phases(chosen.channels[i].angle);
            let square = angle_variance::value(&angle_variance::of_row(form), &phases);
            out[i] = square.max(0.0).sqrt();
        }
    }
    out
}

/// Returns the nearest reference point of the job, and the vector from this point. Without reference points, it is the nearest grid at which a load
/// acts.
fn reference_of(task: &Task, g: &Gauge) -> Option<(String, [f64; 3])> {
    let model = task.fields.model();
    let loads = task.job.loads.iter().filter_map(|l| match l.acts {
        LoadActs::AtGrid { grid, .. } => Some((grid.to_string(), grid)),
        LoadActs::Set(_) | LoadActs::Named => None,
    });
    let named = task.job.placement.references.iter();
    let points: Vec<(String, u32)> = if task.job.placement.references.is_empty() {
        loads.collect()
    } else {
        named.map(|(n, g)| (format!("{n} ({g})"), *g)).collect()
    };
    points
        .into_iter()
        .filter_map(|(name, grid)| {
            let x = model.grids.get(model.grid_ix(grid)?.us())?.x;
            let d = g.position - x;
            Some((name, [d.x, d.y, d.z]))
        })
        .min_by(|a, b| {
            let n = |v: &[f64; 3]| v.iter().map(|x| x * x).sum::<f64>();
            n(&a.1).total_cmp(&n(&b.1))
        })
}
