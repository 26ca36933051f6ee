//! `inputs-exchanged`: two gauges that read each other's strain, in a record that the loads don't explain.

use crate::finding::{Finding, Severity};
use crate::linalg::Matrix;
use crate::linalg::dense::svd;
use crate::sensitivity::Sensitivity;
use crate::units::MICROSTRAIN;

/// Largest ratio of the residual of exchanged readings to the residual without both gauges, rms.
const AS_GOOD: f64 = 1.5;
/// Ratio of residuals (rms) that identifies an exchange. The residual of the readings as they are, and of any other exchange, must be larger by this
/// factor.
const BETTER: f64 = 4.0;
/// Largest number of gauges that are tried: the gauges that contradict the other gauges most.
const TRIED: usize = 12;

/// Two gauges whose readings explain each other.
pub(super) struct Exchange {
    pub gauges: [usize; 2],
    /// Residual of the readings without the exchange, rms, strain.
    pub before: f64,
    /// Residual with the readings of the two exchanged.
    pub after: f64,
}

impl Exchange {
    /// Returns the finding on the exchange; `names` by gauge.
    pub fn finding(&self, names: &[String]) -> Finding {
        let [a, b] = self.gauges.map(|g| names.get(g).map_or("", String::as_str));
        let [before, after] = [self.before, self.after].map(|v| v / MICROSTRAIN);
        Finding::new(
            Severity::Warning,
            "inputs-exchanged",
            format!("{a}, {b}"),
            format!(
                "`{a}` and `{b}` have each other's strain: with their readings exchanged the residual is {after:.1} microstrain instead of \
                 {before:.1} microstrain"
            ),
            "exchange their columns, or their plugs: [[correction]] exchanged_with; until then loads of these days are wrong",
        )
        .with_numbers(after, before / BETTER)
    }
}

/// Returns the pair of gauges whose readings must be exchanged for the loads to explain all readings; `noise` is the noise of a reading, strain.
///
/// With `P = I - U U'`, U an orthonormal basis of the columns of S, and `M = sum of y y'` over the samples, the squares of the residuals sum to
/// `tr(P M)`. Exchanged readings have M with rows and columns exchanged. Without the gauges a and b the sum is less by `tr(P_ab^-1 (P M P)_ab)`.
/// Returns `None` if no pair or more than one pair explains the readings, or if the gauges are too few.
pub(super) fn find_exchange<'a>(
    s: &Sensitivity,
    samples: impl Iterator<Item = &'a [f64]>,
    noise: f64,
) -> Option<Exchange> {
    let (n, k) = (s.gauges.len(), s.loads.len());
    if n < k + 3 {
        return None;
    }
    let mut moments = Matrix::zeros(n, n);
    let mut rows = 0.0;
    for y in samples.filter(|y| y.len() == n && y.iter().all(|v| v.is_finite())) {
        rows += 1.0;
        for (i, a) in y.iter().enumerate() {
            for (j, b) in y.iter().enumerate() {
                moments[(i, j)] += a * b;
            }
        }
    }
    // The columns of S are scaled to unit norm, so that their units do not matter.
    let size = |l: usize| (0..n).map(|g| s.values[(g, l)].powi(2)).sum::<f64>().sqrt();
    let sizes: Vec<f64> = (0..k).map(size).collect();
    if rows == 0.0 || sizes.iter().any(|v| !(*v > 0.0)) {
        return None;
    }
    let basis = svd(&Matrix::from_fn(n, k, |g, l| s.values[(g, l)] / sizes[l]))?.u;
    let projector = Matrix::identity(n, n) - &basis * basis.transpose();
    let residuals = &projector * &moments * &projector;
    let before = residuals.trace();
    let size = |g: usize| residuals[(g, g)] / projector[(g, g)].max(1e-6);
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|a, b| size(*b).total_cmp(&size(*a)));
    order.truncate(TRIED);
    let mut pairs: Vec<(f64, [usize; 2])> = Vec::new();
    for (i, &a) in order.iter().enumerate() {
        for &b in order.iter().skip(i + 1) {
            let turned = |g: usize| match g {
                g if g == a => b,
                g if g == b => a,
                g => g,
            };
            let mut sum = 0.0;
            for i in 0..n {
                for j in 0..n {
                    sum += projector[(i, j)] * moments[(turned(i), turned(j))];
                }
            }
            pairs.push((sum, [a.min(b), a.max(b)]));
        }
    }
    pairs.sort_by(|x, y| x.0.total_cmp(&y.0));
    let (after, gauges) = *pairs.first()?;
    let rms = |sum: f64, gauges: usize| (sum.max(0.0) / (rows * (gauges - k) as f64)).sqrt();
    let [a, b] = gauges;
    let own = projector[(a, a)] * projector[(b, b)] - projector[(a, b)] * projector[(b, a)];
    let taken = (projector[(b, b)] * residuals[(a, a)] + projector[(a, a)] * residuals[(b, b)]
        - 2.0 * projector[(a, b)] * residuals[(a, b)])
        / own.max(1e-12);
    let floor = AS_GOOD * rms(before - taken, n - 2).max(noise);
    let next = pairs.get(1).map_or(f64::INFINITY, |p| p.0);
    let [was, is, other] = [before, after, next].map(|sum| rms(sum, n));
    (is < floor && is.max(noise) * BETTER < was.min(other)).then_some(Exchange {
        gauges,
        before: was,
        after: is,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensitivity::Load;

    /// Six gauges and two loads; each sample 100 parts of one load and some of the other.
    fn records() -> (Vec<[f64; 2]>, Vec<Vec<f64>>) {
        let s = vec![
            [10.0, 1.0],
            [-8.0, 3.0],
            [2.0, 9.0],
            [1.0, -11.0],
            [6.0, 6.0],
            [4.0, -5.0],
        ];
        let sample = |i: i32| {
            let f = [f64::from(i % 17) - 8.0, f64::from(i % 5) - 2.0];
            s.iter().map(|r| r[0] * f[0] + r[1] * f[1]).collect()
        };
        let samples = (0..100).map(sample).collect();
        (s, samples)
    }

    fn find_exchanged_gauges(samples: &[Vec<f64>], s: &[[f64; 2]]) -> Option<[usize; 2]> {
        let s = Sensitivity {
            gauges: (0..s.len()).map(|g| format!("G{g}")).collect(),
            loads: ["A", "B"].map(Load::from_name).to_vec(),
            values: Matrix::from_fn(s.len(), 2, |g, l| s[g][l]),
            uncertainty: None,
            noise: None,
        };
        let found = find_exchange(&s, samples.iter().map(Vec::as_slice), 0.1);
        found.map(|e| e.gauges)
    }

    #[test]
    fn every_pair_that_is_exchanged_is_named_and_no_other_fault() {
        let (s, right) = records();
        assert_eq!(find_exchanged_gauges(&right, &s), None);
        for a in 0..6 {
            for b in a + 1..6 {
                let mut wrong = right.clone();
                wrong.iter_mut().for_each(|y| y.swap(a, b));
                assert_eq!(find_exchanged_gauges(&wrong, &s), Some([a, b]));
            }
            let mut turned = right.clone();
            turned.iter_mut().for_each(|y| y[a] = -y[a]);
            assert_eq!(find_exchanged_gauges(&turned, &s), None, "{a}");
        }
    }
}
