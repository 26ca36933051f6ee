//! Candidates of the job: wirings, angles, scales, what scatters a reading.

use crate::finding::{Finding, Severity};
use crate::gauge::Bridge;
use crate::host::work::Work;
use crate::job::{AngleStep, Job, LoadRole};
use crate::model::{Model, ShellIx};
use crate::placement::angle_variance::Form;
use crate::placement::candidates::{Angles, Candidates, Scatter};
use crate::placement::gradient::forms;
use crate::placement::sites::{Site, bridge_strain, bridges};
use crate::sensitivity::LoadCaseOf;
use crate::strain_chain::left_squared;
use crate::units::MICROSTRAIN;

/// Strain, microstrain rms over the candidates, that a load without `expected` is taken to cause.
const ASSUMED_STRAIN: f64 = 100.0;

/// Candidates of one wiring.
pub(super) struct Kind {
    /// Wiring.
    pub bridge: Bridge,
    /// Candidates of the wiring, on all sites.
    pub candidates: Candidates,
}

/// Returns the sources of scatter of the readings of a wiring at these sites, in microstrain.
pub(crate) fn scatter(
    job: &Job,
    model: &Model,
    sites: &[Site],
    bridge: Bridge,
    loads: &[LoadCaseOf],
    scales: &[f64],
) -> Scatter {
    let p = &job.placement;
    let own = p.noise_by_bridge.iter().find(|(b, _)| *b == bridge);
    // The variance contains the position tolerance and the spread of strain over the grid. The mean square distance from the middle of the grid is a
    // twelfth of its squared length.
    let variance = p.position_tolerance.powi(2) + job.candidates.grid_length.powi(2) / 12.0;
    Scatter {
        angle_sd: p.angle_tolerance_deg.to_radians(),
        model_rel: p.model_uncertainty_rel.hypot(p.gauge_factor_rel),
        forms: if variance > 0.0 {
            forms(model, sites, bridge, loads, scales, variance)
        } else {
            Vec::new()
        },
        ..Scatter::with_uniform_noise(own.map_or(p.noise_microstrain, |n| n.1))
    }
}

/// Adds what may be left of the mesh error at each site to the forms of its scatter, microstrain squared at the expected loads.
fn add_mesh_error(
    forms: &mut Vec<Form>,
    sites: &[Site],
    bridge: Bridge,
    (loads, errors): (&[LoadCaseOf], &[LoadCaseOf]),
    scales: &[f64],
) {
    if errors.is_empty() {
        return;
    }
    forms.resize(sites.len(), [0.0; 6]);
    for (form, &site) in forms.iter_mut().zip(sites) {
        for (cases, left) in [errors, loads].into_iter().zip(left_squared()) {
            for (case, scale) in cases.iter().zip(scales) {
                let Some(strain) = bridge_strain(bridge, case.case, site) else {
                    continue;
                };
                let [x, y, g] = strain.map(|v| v * scale / case.applied / MICROSTRAIN);
                let squares = [x * x, y * y, g * g, x * y, x * g, y * g];
                for (f, v) in form.iter_mut().zip(squares) {
                    *f += left * v;
                }
            }
        }
    }
}

/// Candidates of every wiring that the job allows; `errors` are the mesh errors of the loads, where they are known.
pub(super) fn kinds(
    job: &Job,
    model: &Model,
    sites: &[Site],
    (loads, errors): (&[LoadCaseOf], &[LoadCaseOf]),
    scales: &[f64],
    angles: &Angles,
) -> Vec<Kind> {
    let mut wirings = job.candidates.bridges.clone();
    // The legs of rosettes are single grids.
    if job.candidates.rosette.is_some() && !wirings.contains(&Bridge::Quarter) {
        wirings.push(Bridge::Quarter);
    }
    wirings
        .into_iter()
        .map(|bridge| {
            let mut scatter = scatter(job, model, sites, bridge, loads, scales);
            add_mesh_error(&mut scatter.forms, sites, bridge, (loads, errors), scales);
            Kind {
                bridge,
                candidates: bridges(model, sites, bridge, loads, scales, angles.clone(), scatter),
            }
        })
        .collect()
}

/// The angles of a job.
pub(crate) fn angles(step: AngleStep) -> Angles {
    match step {
        AngleStep::Continuous => Angles::Continuous,
        AngleStep::Degrees(d) => {
            let n = (180.0 / d - 1e-9).ceil().max(1.0) as usize;
            Angles::Grid((0..n).map(|i| (d * i as f64).to_radians()).collect())
        }
    }
}

/// Loads in the order of the candidates' columns: nuisance loads first.
pub(crate) fn column_order(job: &Job) -> Vec<usize> {
    let mut order: Vec<usize> = (0..job.loads.len()).collect();
    order.sort_by_key(|&l| job.loads[l].role == LoadRole::Wanted);
    order
}

/// Column scales: `expected`; where a load states none, the size that strains the candidates by [`ASSUMED_STRAIN`] rms.
pub(crate) fn scales(work: &mut Work, cases: &[LoadCaseOf], common: &[ShellIx]) -> Vec<f64> {
    let mut assumed = Vec::new();
    let scales = cases
        .iter()
        .map(|l| {
            if let Some(e) = l.load.expected.filter(|e| *e > 0.0) {
                return e;
            }
            assumed.push(l.load.name.clone());
            let rows = common
                .iter()
                .filter_map(|ix| l.case.shells.elements.binary_search(ix).ok());
            let (mut sum, mut n) = (0.0, 0.0);
            for r in rows {
                for v in l.case.shells.centre.get(r).into_iter().flatten().flatten() {
                    sum += (v / l.applied).powi(2);
                    n += 1.0;
                }
            }
            let rms: f64 = if n > 0.0 { f64::sqrt(sum / n) } else { 0.0 };
            if rms > 0.0 {
                ASSUMED_STRAIN * MICROSTRAIN / rms
            } else {
                1.0
            }
        })
        .collect();
    if !assumed.is_empty() {
        work.findings.push(Finding::new(
            Severity::Info,
            "expected-assumed",
            assumed.join(", "),
            format!("the expected size of loads without `expected` is the size that strains the candidates by {ASSUMED_STRAIN} microstrain rms"),
            "state `expected`: the angle tolerance and the scaled condition number depend on it",
        ));
    }
    scales
}
