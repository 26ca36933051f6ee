//! The next known load worth applying: the load whose readings give the most information on S.

use super::types::Calibration;
use crate::linalg::spd;
use crate::recovery::{ErrorModel, Readings, estimate};
use crate::sensitivity::{Sensitivity, Uncertainty};
use rayon::prelude::*;

/// A load that could be applied, with its benefit.
#[derive(Clone, Debug, PartialEq)]
pub struct NextRun {
    /// Loads, job units.
    pub loads: Vec<f64>,
    /// Information gained on S, natural units: half the log of the ratio of determinants.
    pub information: f64,
    /// Number of the load that gains most from this run.
    pub load: usize,
    /// Present standard deviation of that load, recovered at its size in `loads`.
    pub sigma_before: f64,
    /// Standard deviation of that load after the run.
    pub sigma_after: f64,
}

/// Returns candidates for the next run, sorted by the information that they add, the best first. Without a calibrated S the list is empty. `sizes`
/// states the size of each load. Each load alone and all loads together are tried.
///
/// # Errors
/// `sizes` does not contain one finite number for each load.
pub fn next_runs(
    calibration: &Calibration,
    noise: f64,
    sizes: &[f64],
) -> Result<Vec<NextRun>, String> {
    let s = &calibration.sensitivity;
    let k = s.loads.len();
    if sizes.len() != k {
        return Err(format!(
            "{} sizes are given for {k} loads: give one size for each load",
            sizes.len()
        ));
    }
    if let Some((load, size)) = s.loads.iter().zip(sizes).find(|(_, f)| !f.is_finite()) {
        return Err(format!(
            "the size of load `{}` is {size}: give a finite number",
            load.name
        ));
    }
    let Some(known) = &s.uncertainty else {
        return Ok(Vec::new());
    };
    let mut candidates: Vec<Vec<f64>> = (0..k)
        .map(|l| {
            (0..k)
                .map(|m| if l == m { sizes[l] } else { 0.0 })
                .collect()
        })
        .collect();
    if k > 1 {
        candidates.push(sizes.to_vec());
    }
    let before: Vec<f64> = (0..k)
        .map(|l| sigma(s, noise, sizes, l, &strain_covariance(s, known, sizes, l)))
        .collect();
    let mut out: Vec<NextRun> = candidates
        .par_iter()
        .filter_map(|f| evaluate_run(s, known, noise, f, sizes, &before))
        .collect();
    out.sort_by(|a, b| b.information.total_cmp(&a.information));
    Ok(out)
}

fn evaluate_run(
    s: &Sensitivity,
    known: &Uncertainty,
    noise: f64,
    f: &[f64],
    sizes: &[f64],
    before: &[f64],
) -> Option<NextRun> {
    let (n, k) = s.values.shape();
    let order = n * k;
    let mut own = Uncertainty {
        covariance: Vec::new(),
        scatter: known.scatter.clone(),
        mean_square: known.mean_square.clone(),
        additive: known.additive.clone(),
        center: Vec::new(),
        ..*known
    }
    .strain_covariance(n, f);
    for g in 0..n {
        own[g * n + g] += noise * noise;
    }
    // V A', by gauge of the run.
    let columns: Vec<Vec<f64>> = (0..n)
        .map(|g| {
            let mut c = vec![0.0; order];
            for (l, p) in f.iter().enumerate().filter(|(_, p)| **p != 0.0) {
                let row = known
                    .covariance
                    .get((g * k + l) * order..(g * k + l + 1) * order)
                    .unwrap_or(&[]);
                c.iter_mut().zip(row).for_each(|(o, v)| *o += p * v);
            }
            c
        })
        .collect();
    let mut total = own.clone();
    for (g, column) in columns.iter().enumerate() {
        for h in 0..n {
            total[g * n + h] += column[h * k..(h + 1) * k]
                .iter()
                .zip(f)
                .map(|(c, p)| c * p)
                .sum::<f64>();
        }
    }
    let lower = spd::cholesky(&total, n)?;
    let information = 0.5 * (spd::log_det(&lower, n) - spd::log_det(&spd::cholesky(&own, n)?, n));
    let root = spd::inverse_lower(&lower, n);
    // Rows of L^-1 A V. The covariance of S after the run is V minus the sum of their outer products.
    let rows: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            let mut row = vec![0.0; order];
            for (j, column) in columns.iter().enumerate().take(i + 1) {
                let w = root[i * n + j];
                row.iter_mut().zip(column).for_each(|(r, c)| *r += w * c);
            }
            row
        })
        .collect();
    let (mut load, mut best, mut sigmas) = (0, 0.0, (f64::NAN, f64::NAN));
    for (l, &before) in before.iter().enumerate() {
        let mut after = strain_covariance(s, known, sizes, l);
        for row in &rows {
            let of_load: Vec<f64> = (0..n).map(|g| sizes[l] * row[g * k + l]).collect();
            spd::add_outer(&mut after, &of_load, -1.0);
        }
        let then = sigma(s, noise, sizes, l, &after);
        let gain = before / then;
        if gain > best {
            (load, best, sigmas) = (l, gain, (before, then));
        }
    }
    Some(NextRun {
        loads: f.to_vec(),
        information,
        load,
        sigma_before: sigmas.0,
        sigma_after: sigmas.1,
    })
}

/// Returns the covariance of the strain of load `l` at its size, `n x n`: scatter plus the uncertainty of its column of S.
fn strain_covariance(s: &Sensitivity, known: &Uncertainty, sizes: &[f64], l: usize) -> Vec<f64> {
    let (n, k) = s.values.shape();
    let (order, square) = (n * k, sizes[l] * sizes[l]);
    let q2 = square * known.mean_square.get(l * k + l).copied().unwrap_or(0.0);
    let entry = |i: usize| {
        let at = (i / n * k + l) * order + i % n * k + l;
        let of_s = known.covariance.get(at).copied().unwrap_or(0.0);
        square * of_s + q2 * known.scatter.get(i).copied().unwrap_or(0.0)
    };
    (0..n * n).map(entry).collect()
}

/// Returns the standard deviation of load `l`, recovered from a run in which it acts alone at its size. `covariance` is the covariance of its strain
/// without noise.
fn sigma(s: &Sensitivity, noise: f64, sizes: &[f64], l: usize, covariance: &[f64]) -> f64 {
    let Some(known) = &s.uncertainty else {
        return f64::NAN;
    };
    let size = sizes[l];
    // The scatter of this loading replaces the mean scatter of all loadings.
    let k = sizes.len();
    let q2 = size * size * known.mean_square.get(l * k + l).copied().unwrap_or(0.0);
    if !(q2 > 0.0) {
        return f64::NAN;
    }
    let at_its_size = Sensitivity {
        gauges: s.gauges.clone(),
        loads: s.loads.clone(),
        values: s.values.clone(),
        noise: None,
        uncertainty: Some(Uncertainty {
            covariance: Vec::new(),
            scatter: covariance.iter().map(|c| c / q2).collect(),
            mean_square: known.mean_square.clone(),
            additive: known.additive.clone(),
            center: Vec::new(),
            ..*known
        }),
    };
    let readings = Readings {
        run: String::new(),
        strain: s.values.column(l).iter().map(|v| v * size).collect(),
        noise_factor: 1.0,
    };
    let errors = ErrorModel {
        noise,
        model_rel: 0.0,
    };
    estimate(&at_its_size, &readings, errors).estimate.sigma(l)
}
