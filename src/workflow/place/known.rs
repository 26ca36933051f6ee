//! Gauges of the job as `recover` will read them: by the model, or by the S that was given or calibrated.

use super::task::Task;
use crate::gauge::Gauge;
use crate::host::fault::Faults;
use crate::host::work::Work;
use crate::job::Job;
use crate::linalg::spd;
use crate::sensitivity::{NoStrain, Sensitivity, from_cases};
use crate::strain_chain::read_given;
use crate::units::MICROSTRAIN;

/// The S of `[sensitivity]`, where the job has one.
///
/// # Errors
/// Faults of its table and of its covariance.
pub(super) fn given(work: &mut Work, job: &Job) -> Result<Option<Sensitivity>, Faults> {
    match job.sensitivity {
        Some(_) => read_given(work, job).map(Some),
        None => Ok(None),
    }
}

/// Rows of gauges in the candidates' order.
pub(super) struct Rows {
    /// Strain of loads of expected size, microstrain.
    pub strain: Vec<Vec<f64>>,
    /// `W^-1/2` times these, with `W` the covariance of readings: independent rows of unit variance that tell as much of the loads.
    pub over_sd: Vec<Vec<f64>>,
}

impl Task<'_> {
    /// S of gauges, in job order of the loads: the given rows of those that it has, the model's of the others.
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

    /// Whether every one of some gauges has a row in a calibrated S.
    pub fn all_calibrated(&self, gauges: &[Gauge]) -> bool {
        let has = |g| {
            self.given_row(g)
                .is_some_and(|(own, _)| own.uncertainty.is_some())
        };
        gauges.iter().all(has)
    }

    fn given_row(&self, gauge: &Gauge) -> Option<(&Sensitivity, usize)> {
        let own = self.given.as_ref()?;
        let row = own.gauges.iter().position(|n| *n == gauge.name)?;
        Some((own, row))
    }

    /// Rows of gauges with S `s`. Strain of the model is off by `model_rel`, 1 sd, and by what may be left of its mesh error; that of a calibrated S
    /// by its covariance, with loads of expected size that are independent of each other.
    pub fn rows_of(&self, gauges: &[Gauge], s: &Sensitivity, model_rel: f64) -> Rows {
        let noise = self.job.placement.noise_microstrain;
        let row = |g: usize| -> Vec<f64> {
            let of = |&l: &usize| s.values[(g, l)] * self.scales[l] / MICROSTRAIN;
            self.order.iter().map(of).collect()
        };
        let strain: Vec<Vec<f64>> = (0..gauges.len()).map(row).collect();
        let n = gauges.len();
        let mut w = vec![0.0; n * n];
        for (g, (gauge, row)) in gauges.iter().zip(&strain).enumerate() {
            let sd = match self.given_row(gauge) {
                Some((own, _)) => match &own.uncertainty {
                    // As runs that were left out have it: `scale` is a factor on all of sigma.
                    Some(u) => noise * u.scale,
                    None => noise.hypot(model_rel * spd::dot(row, row).sqrt()),
                },
                None => {
                    let noise = self.with_mesh_error(gauge, noise);
                    noise.hypot(model_rel * spd::dot(row, row).sqrt())
                }
            };
            w[g * n + g] = sd * sd;
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
        let over_sd = whitened(&w, &strain, self.order.len());
        Rows { strain, over_sd }
    }
}

/// `L^-1 A` with `L L' = w`; over the roots of the diagonal where rounding leaves `w` without a factor.
fn whitened(w: &[f64], rows: &[Vec<f64>], k: usize) -> Vec<Vec<f64>> {
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
