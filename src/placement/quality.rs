//! Quality of a layout: leverages, standard deviations of the loads, loss of a gauge.

use super::candidates::{Candidates, Choice};
use super::criterion::Criterion;
use crate::linalg::spd;

/// Quality of a layout.
#[derive(Clone, Debug, PartialEq)]
pub struct Quality {
    /// Leverage `h_i = a_i' M^-1 a_i`: the weight of a gauge's reading in its own prediction. The loss of the gauge multiplies `det` by `1 - h_i`.
    pub leverage: Vec<f64>,
    /// Standard deviation of each load, in shares of the column's scale (`expected`).
    pub sigma: Vec<f64>,
    /// Covariance of the loads in these shares, `k x k` by rows.
    pub covariance: Vec<f64>,
    /// Efficiency after the worst loss of one gauge, relative to all gauges: `(1 - max h)^(1/k)`. 0 means that no gauge may fail.
    pub worst_loss: f64,
    /// Gauge whose loss is worst.
    pub worst: usize,
}

/// Computes leverages and standard deviations of a layout with prior information `prior` (`k x k`); `None` if it is singular.
pub fn evaluate_layout(c: &Candidates, gauges: &[Choice], prior: &[f64]) -> Option<Quality> {
    let rows: Vec<Vec<f64>> = gauges.iter().map(|&g| c.row(g)).collect();
    evaluate_rows(&rows, prior, c.n_loads())
}

/// Computes the quality of rows that are divided by their standard deviation and whose columns are multiplied by `expected`.
pub fn evaluate_rows(rows: &[Vec<f64>], prior: &[f64], k: usize) -> Option<Quality> {
    let mut m = prior.to_vec();
    for r in rows {
        spd::add_outer(&mut m, r, 1.0);
    }
    let l = spd::cholesky(&m, k)?;
    let inv = spd::gram_of_lower(&spd::inverse_lower(&l, k), k);
    let mut u = vec![0.0; k];
    let leverage: Vec<f64> = rows
        .iter()
        .map(|r| {
            spd::times(&inv, r, &mut u);
            spd::dot(r, &u)
        })
        .collect();
    let worst =
        (0..leverage.len()).max_by(|&a, &b| leverage[a].total_cmp(&leverage[b]).then(b.cmp(&a)))?;
    // Leverages of exactly 1 differ from 1 by rounding.
    let left = (1.0 - leverage[worst]).max(0.0);
    let worst_loss = if left < 1e-9 {
        0.0
    } else {
        left.powf(1.0 / k as f64)
    };
    Some(Quality {
        leverage,
        sigma: (0..k).map(|i| inv[i * k + i].sqrt()).collect(),
        covariance: inv,
        worst_loss,
        worst,
    })
}

/// Returns the `n` gauges to exclude from the estimate, ascending. These are the gauges that the other gauges predict best. The second value is the
/// standard deviation of reading minus prediction, divided by the standard deviation of the reading, `sqrt(1 + a' M_rest^-1 a)`.
///
/// The gauges are chosen so that `det M_rest` is largest, greedily and then by exchange. This is equivalent to the smallest joint variance of the
/// predictions. `None` if `M_rest` would be singular.
pub fn reserve(rows: &[Vec<f64>], prior: &[f64], k: usize, n: usize) -> Option<Vec<(usize, f64)>> {
    let rest_of = |out: &[usize]| {
        let mut m = prior.to_vec();
        for (i, r) in rows.iter().enumerate() {
            if !out.contains(&i) {
                spd::add_outer(&mut m, r, 1.0);
            }
        }
        spd::cholesky(&m, k)
    };
    let value = |out: &[usize]| rest_of(out).map(|l| spd::log_det(&l, k));
    let best = |out: &[usize]| {
        (0..rows.len())
            .filter(|i| !out.contains(i))
            .filter_map(|i| {
                let mut with = out.to_vec();
                with.push(i);
                Some((i, value(&with)?))
            })
            .max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)))
    };
    let mut out: Vec<usize> = Vec::new();
    let mut now = f64::NEG_INFINITY;
    for _ in 0..n {
        let (i, v) = best(&out)?;
        out.push(i);
        now = v;
    }
    let mut gained = true;
    while gained {
        gained = false;
        for slot in 0..out.len() {
            let mut rest = out.clone();
            rest.swap_remove(slot);
            if let Some((i, v)) = best(&rest)
                && v > now + 1e-12
            {
                rest.push(i);
                (out, now, gained) = (rest, v, true);
            }
        }
    }
    out.sort_unstable();
    let l = rest_of(&out)?;
    let inverse = spd::gram_of_lower(&spd::inverse_lower(&l, k), k);
    let mut u = vec![0.0; k];
    Some(
        out.into_iter()
            .map(|i| {
                spd::times(&inverse, &rows[i], &mut u);
                (i, (1.0 + spd::dot(&rows[i], &u)).sqrt())
            })
            .collect(),
    )
}

/// Returns by gauge the largest change of a load for a reading error of one standard deviation. It is relative to the scale of the load column:
/// `max_l |(M^-1 a)_l|`.
pub fn influence(rows: &[Vec<f64>], prior: &[f64], k: usize) -> Option<Vec<f64>> {
    let mut m = prior.to_vec();
    rows.iter().for_each(|r| spd::add_outer(&mut m, r, 1.0));
    let l = spd::cholesky(&m, k)?;
    let inverse = spd::gram_of_lower(&spd::inverse_lower(&l, k), k);
    let mut u = vec![0.0; k];
    Some(
        rows.iter()
            .map(|r| {
                spd::times(&inverse, r, &mut u);
                u.iter().fold(0.0, |a: f64, v| a.max(v.abs()))
            })
            .collect(),
    )
}

/// Returns the criterion of these rows with the prior. `None` if the matrix is singular.
pub fn value(rows: &[Vec<f64>], prior: &[f64], k: usize, criterion: &Criterion) -> Option<f64> {
    let mut m = prior.to_vec();
    for r in rows {
        spd::add_outer(&mut m, r, 1.0);
    }
    criterion.evaluate_at(&m, k).map(|p| p.value)
}
