//! Error of left-out runs with and without a common zero, on which the recommended terms of the model depend.

use super::loading::Loading;
use super::types::{HeldOutError, LackOfFit, Task};
use crate::linalg::{precision::Precision, spd};

/// Loadings beyond the coefficients of a gauge from which errors are compared.
const FEWEST: usize = 3;
/// Held-out error of the recommended model over the error of the simpler model. A smaller improvement is chance.
const BETTER: f64 = 0.9;

/// Returns the error of left-out loadings with and without a common zero, by least squares with weights of the gauges.
pub(super) fn held_out(task: &Task, loadings: &[Loading]) -> Option<HeldOutError> {
    let own = task.own_loads();
    let whole: Vec<&Loading> = (loadings.iter())
        .filter(|l| l.strain.iter().all(|v| v.is_finite()))
        .collect();
    Some(HeldOutError {
        linear: left_out_error(&whole, own, false)?,
        intercept: left_out_error(&whole, own, true)?,
    })
}

/// Returns the error of left-out loadings, divided by the largest value of the load: the root mean square over loadings and loads.
fn left_out_error(loadings: &[&Loading], k: usize, with_zero: bool) -> Option<f64> {
    let n = loadings.first()?.strain.len();
    let size = |l: usize| loadings.iter().fold(0.0_f64, |a, x| a.max(x.phi[l].abs()));
    let largest: Vec<f64> = (0..k).map(size).collect();
    let p = k + usize::from(with_zero);
    if loadings.len() < p + 1 + FEWEST {
        return None;
    }
    let row = |l: &Loading| -> Vec<f64> {
        let one = with_zero.then_some(1.0);
        l.phi[..k].iter().copied().chain(one).collect()
    };
    let weight: Vec<f64> = (0..n)
        .map(|g| loadings.iter().map(|l| l.weight[g]).sum::<f64>() / loadings.len() as f64)
        .collect();
    // Each loading has one weight for all gauges: the mean of the weights of the gauges.
    let of_loading = |l: &Loading| {
        let share = l.weight.iter().zip(&weight).map(|(a, b)| a / b);
        share.sum::<f64>() / n as f64
    };
    let (mut sum, mut count) = (0.0, 0.0);
    for (i, left) in loadings.iter().enumerate() {
        let mut gram = vec![0.0; p * p];
        let mut both = vec![0.0; p * n];
        for (_, l) in loadings.iter().enumerate().filter(|(j, _)| *j != i) {
            let (x, w) = (row(l), of_loading(l));
            spd::add_outer(&mut gram, &x, w);
            for (out, x) in both.chunks_exact_mut(n).zip(&x) {
                out.iter_mut()
                    .zip(&l.strain)
                    .for_each(|(o, y)| *o += w * x * y);
            }
        }
        let inverse = Precision::from_covariance(&gram, p)?;
        let column = |g: usize| -> Vec<f64> { (0..p).map(|l| both[l * n + g]).collect() };
        let rows: Vec<Vec<f64>> = (0..n).map(|g| inverse.apply(&column(g))).collect();
        let mut gram = vec![0.0; k * k];
        let mut right = vec![0.0; k];
        for (g, s) in rows.iter().enumerate() {
            spd::add_outer(&mut gram, &s[..k], weight[g]);
            let net = left.strain[g] - s.get(k).copied().unwrap_or(0.0);
            right
                .iter_mut()
                .zip(s)
                .for_each(|(r, s)| *r += weight[g] * s * net);
        }
        let found = Precision::from_covariance(&gram, k)?.apply(&right);
        for l in 0..k {
            if largest[l] > 0.0 {
                sum += ((found[l] - left.phi[l]) / largest[l]).powi(2);
                count += 1.0;
            }
        }
    }
    Some((sum / count).sqrt()).filter(|e: &f64| e.is_finite())
}

impl LackOfFit {
    /// Returns whether a common zero is recommended, because it reduces the error of left-out runs by more than chance.
    pub fn recommends_intercept(&self) -> Option<bool> {
        let held_out = self.held_out?;
        Some(held_out.intercept < BETTER * held_out.linear)
    }
}
