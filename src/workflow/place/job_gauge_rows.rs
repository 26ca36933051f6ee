//! Gauges of the job as `recover` will read them: by the model, or by the S that was given or calibrated.

use super::pool::scatter;
use super::task::Task;
use crate::gauge::{Bridge, Gauge};
use crate::host::fault::Faults;
use crate::host::work::Work;
use crate::job::{Job, JobGauge, StatedPlace};
use crate::linalg::spd;
use crate::placement::candidates::{Angles, Choice, Scatter};
use crate::placement::sites::{Site, bridges};
use crate::sensitivity::{NoStrain, Sensitivity, from_cases};
use crate::strain_chain::read_given;
use crate::units::MICROSTRAIN;

/// Returns the S of `[sensitivity]`, if the job has one.
///
/// # Errors
/// Faults of its table and of its covariance.
pub(super) fn read_given_sensitivity(
    work: &mut Work,
    job: &Job,
) -> Result<Option<Sensitivity>, Faults> {
    match job.sensitivity {
        Some(_) => read_given(work, job).map(Some),
        None => Ok(None),
    }
}

/// Rows of gauges in the candidates' order.
pub(super) struct Rows {
    /// Strain of loads of expected size, microstrain.
    pub strain: Vec<Vec<f64>>,
    /// Rows `W^-1/2` times `strain`, with `W` the covariance of readings. The result has independent rows of unit variance with the same
    /// information on the loads.
    pub over_sd: Vec<Vec<f64>>,
    /// Standard deviation of each reading, microstrain.
    pub sd: Vec<f64>,
}

impl Task<'_> {
    /// Returns S of gauges, in job order of the loads: the given rows of gauges that have one, the model's rows of all other gauges.
    ///
    /// # Errors
    /// Gauges without strain on the model.
    pub fn s_of(&self, gauges: &[Gauge]) -> Result<Sensitivity, Vec<NoStrain>> {
        let mut s = from_cases(gauges, &self.cases)?;
        for (g, gauge) in gauges.iter().enumerate() {
            let Some((own, row)) = self.given_row(gauge) else {
                continue;
            };
            for (l, load) in self.cases.iter().enumerate() {
                let column = own.loads.iter().position(|x| x.name == load.load.name);
                if let Some(c) = column {
                    s.values[(g, l)] = own.values[(row, c)];
                }
            }
        }
        Ok(s)
    }

    /// Returns whether all given gauges have a row in a calibrated S.
    pub fn all_calibrated(&self, gauges: &[Gauge]) -> bool {
        let has = |g| {
            self.given_row(g)
                .is_some_and(|(own, _)| own.uncertainty.is_some())
        };
        gauges.iter().all(has)
    }

    /// Returns the noise of a gauge, microstrain: for a spot the noise of its wiring.
    fn noise_of(&self, gauge: &Gauge) -> f64 {
        let p = &self.job.placement;
        let spots = self.job.candidates.spots.iter().flatten();
        let mut stated = spots.map(|s| &s.gauge).filter(|g| is_of(gauge, g));
        let bridge = stated.next().map(|g| g.bridge);
        let own = p.noise_by_bridge.iter().find(|n| Some(n.0) == bridge);
        own.map_or(p.noise_microstrain, |n| n.1)
    }

    fn given_row(&self, gauge: &Gauge) -> Option<(&Sensitivity, usize)> {
        let own = self.given.as_ref()?;
        let row = own.gauges.iter().position(|n| *n == gauge.name)?;
        Some((own, row))
    }

    /// Returns the rows of gauges with S `s`. Strain of the model has the relative error `model_rel`, 1 sd, and its estimated remaining mesh error.
    /// Strain of a calibrated S has the covariance of S, with loads of expected size that are independent of each other. `more` is an additional
    /// variance of each gauge, microstrain squared. It may be empty.
    pub fn rows_of(&self, gauges: &[Gauge], s: &Sensitivity, model_rel: f64, more: &[f64]) -> Rows {
        let row = |g: usize| -> Vec<f64> {
            let of = |&l: &usize| s.values[(g, l)] * self.scales[l] / MICROSTRAIN;
            self.order.iter().map(of).collect()
        };
        let strain: Vec<Vec<f64>> = (0..gauges.len()).map(row).collect();
        let n = gauges.len();
        let mut w = vec![0.0; n * n];
        for (g, (gauge, row)) in gauges.iter().zip(&strain).enumerate() {
            let noise = self.noise_of(gauge);
            let sd = match self.given_row(gauge) {
                Some((own, _)) => match &own.uncertainty {
                    // `scale` is a factor on the whole standard deviation, here as in the test of left-out runs.
                    Some(u) => noise * u.scale,
                    None => noise.hypot(model_rel * spd::dot(row, row).sqrt()),
                },
                None => {
                    let noise = self.with_mesh_error(gauge, noise);
                    noise.hypot(model_rel * spd::dot(row, row).sqrt())
                }
            };
            w[g * n + g] = sd * sd + more.get(g).copied().unwrap_or(0.0);
        }
        if let Some(own) = &self.given
            && let Some(u) = &own.uncertainty
        {
            let scale = |name: &str| {
                let at = self.cases.iter().position(|c| c.load.name == name);
                at.map_or(0.0, |l| self.scales[l])
            };
            let scales: Vec<f64> = own.loads.iter().map(|l| scale(&l.name)).collect();
            let n_own = own.gauges.len();
            let c = u.expected_covariance(n_own, &scales);
            let at: Vec<Option<usize>> = gauges
                .iter()
                .map(|g| self.given_row(g).map(|r| r.1))
                .collect();
            for (g, a) in at.iter().enumerate() {
                for (h, b) in at.iter().enumerate() {
                    if let (Some(a), Some(b)) = (a, b) {
                        w[g * n + h] += c[a * n_own + b] / (MICROSTRAIN * MICROSTRAIN);
                    }
                }
            }
        }
        let over_sd = whiten_rows(&w, &strain, self.order.len());
        let sd = (0..n).map(|g| w[g * n + g].sqrt()).collect();
        Rows {
            strain,
            over_sd,
            sd,
        }
    }
}

/// Returns whether a gauge on the model gives a reading of this gauge of the job.
fn is_of(gauge: &Gauge, stated: &JobGauge) -> bool {
    gauge.name == stated.name || gauge.name.starts_with(&format!("{}.", stated.name))
}

/// Returns the variance that the installation tolerances add to the reading of each gauge, microstrain squared at the expected loads. It is equal to
/// the variance of candidates at the same place. It is 0 for gauges whose S is calibrated as installed, and for gauges on bars.
pub(super) fn gluing_variance(task: &Task, gauges: &[Gauge]) -> Vec<f64> {
    let stated = |gauge: &Gauge| task.job.gauges.iter().find(|g| is_of(gauge, g));
    let pairs: Vec<(&Gauge, Option<&JobGauge>)> = gauges.iter().map(|g| (g, stated(g))).collect();
    let effects = gluing_effects(task, &pairs).into_iter();
    effects.map(|e| e.map_or(0.0, |e| e.variance)).collect()
}

/// Effect of gluing on the reading of a gauge.
pub(super) struct GluingEffect {
    /// Variance by the tolerances of gluing, microstrain squared at the expected loads.
    pub variance: f64,
    /// Change of the reading with the angle, microstrain per radian, rms over the expected loads.
    pub turn: f64,
    /// Angle of the first grid, radians from the element x axis.
    pub angle: f64,
    /// Side of the shell.
    pub site: Site,
}

/// Returns the effect of gluing on each gauge, with the gauge as its job states it. `None` for a gauge on a bar, and for a gauge that no job states.
pub(super) fn gluing_effects(
    task: &Task,
    gauges: &[(&Gauge, Option<&JobGauge>)],
) -> Vec<Option<GluingEffect>> {
    let (job, model) = (task.job, task.fields.model());
    let (loads, scales) = task.nuisance_first();
    let mut out: Vec<Option<GluingEffect>> = gauges.iter().map(|_| None).collect();
    // Neighbours of elements are found once for all gauges of a wiring.
    for bridge in Bridge::ALL {
        let of_shell = |g: &JobGauge| !matches!(g.place, StatedPlace::BeamPoint { .. });
        let of_bridge = |g: &&JobGauge| g.bridge == bridge && of_shell(g);
        let (at, sites): (Vec<usize>, Vec<Site>) = gauges
            .iter()
            .enumerate()
            .filter(|(_, (_, stated))| stated.filter(of_bridge).is_some())
            .filter_map(|(i, (g, _))| Some((i, (model.shell_ix(g.element)?, g.surface))))
            .unzip();
        if sites.is_empty() {
            continue;
        }
        let scatter = Scatter {
            noise: 0.0,
            model_rel: job.placement.gauge_factor_rel,
            ..scatter(job, model, &sites, bridge, &loads, &scales)
        };
        let angles = Angles::Continuous;
        let here = bridges(model, &sites, bridge, &loads, &scales, angles, scatter);
        // A candidate for a shear bridge has the angle of its first grid.
        let turn = match bridge {
            Bridge::Shear => std::f64::consts::FRAC_PI_4,
            _ => 0.0,
        };
        for (place, (i, site)) in at.into_iter().zip(sites).enumerate() {
            let (gauge, stated) = gauges[i];
            let choice = Choice {
                place: place as u32,
                step: 0,
                angle: gauge.angle_rad + turn,
            };
            let factor = stated.map_or(1.0, |s| s.bridge_factor);
            let own = task.given_row(gauge);
            let is_calibrated = own.is_some_and(|(s, _)| s.uncertainty.is_some());
            out[i] = Some(GluingEffect {
                variance: match is_calibrated {
                    true => 0.0,
                    false => (here.sd(choice) / factor).powi(2),
                },
                turn: here.turn_rms(choice) / factor.abs(),
                angle: choice.angle,
                site,
            });
        }
    }
    out
}

/// Returns `L^-1 A` with `L L' = w`. If rounding leaves `w` without a factor, divides the rows by the roots of the diagonal.
fn whiten_rows(w: &[f64], rows: &[Vec<f64>], k: usize) -> Vec<Vec<f64>> {
    let n = rows.len();
    let mut out = rows.to_vec();
    let Some(factor) = spd::cholesky(w, n) else {
        for (g, row) in out.iter_mut().enumerate() {
            row.iter_mut().for_each(|v| *v /= w[g * n + g].sqrt());
        }
        return out;
    };
    for c in 0..k {
        let mut column: Vec<f64> = rows.iter().map(|r| r[c]).collect();
        spd::solve_lower(&factor, &mut column);
        for (row, v) in out.iter_mut().zip(column) {
            row[c] = v;
        }
    }
    out
}
