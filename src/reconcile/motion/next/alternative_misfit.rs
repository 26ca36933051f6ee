//! Misfit of one explanation to a record that obeys another.

use super::view::RecordEquations;
use crate::reconcile::motion::design::Bins;
use rustfft::num_complex::Complex64;

/// Returns, by equation and bin, the residual of the equations of `other` in a record that obeys the equations of `truth`. That record is the present
/// record minus channel errors that explain the residual of `truth`. Of all such errors, these are the smallest relative to the noise. Noise that is
/// common to both residuals cancels.
///
/// In a bin, r is the residual of the truth. H and G are the responses of truth and other, and N is the noise power of the channels. C and D are the
/// factors by which truth and other multiply readings. Then e = N H' (H N H')^-1 r, and the result is the residual of other - G (D / C) e. For the
/// reading of a new channel, `r - H e` of the truth is subtracted from it. `None` if both have different equations.
pub(super) fn residual_of_other(
    other: &RecordEquations,
    truth: &RecordEquations,
) -> Option<Vec<Bins>> {
    if other.is_new != truth.is_new || other.left.len() != truth.left.len() {
        return None;
    }
    let old: Vec<usize> = (0..truth.left.len())
        .filter(|&i| !truth.is_new[i])
        .collect();
    let pairs: Vec<(usize, usize)> = (truth.channels.iter().enumerate())
        .filter_map(|(k, c)| {
            let there = other.channels.iter().position(|o| o.name == c.name)?;
            Some((k, there))
        })
        .collect();
    let n_bins = other.left.first().map_or(0, Vec::len);
    let mut out = other.left.clone();
    for k in 0..n_bins {
        let response = |of: &RecordEquations, channel: usize, equation: usize| -> Complex64 {
            let own = of
                .channels
                .get(channel)
                .and_then(|c| c.responses.get(equation));
            own.and_then(|b| b.get(k)).copied().unwrap_or_default()
        };
        let residual = |i: usize| truth.left.get(i).and_then(|l| l.get(k)).copied();
        let errors = errors(truth, &old, &pairs, &response, &residual)?;
        for (i, out) in out.iter_mut().enumerate() {
            let Some(cell) = out.get_mut(k) else { continue };
            for (&(here, there), e) in pairs.iter().zip(&errors) {
                let ratio = match (
                    truth.channels[here].undone.get(k),
                    other.channels[there].undone.get(k),
                ) {
                    (Some(c), Some(d)) => d / c,
                    _ => Complex64::new(1.0, 0.0),
                };
                *cell -= response(other, there, i) * ratio * e;
            }
            if truth.is_new[i] {
                let obeyed: Complex64 = pairs
                    .iter()
                    .zip(&errors)
                    .map(|(&(here, _), e)| response(truth, here, i) * e)
                    .sum();
                *cell -= residual(i)? - obeyed;
            }
        }
    }
    Some(out)
}

/// Returns the channel errors, smallest relative to their noise, that explain the residual of the equations `old` of the truth in a bin.
fn errors(
    truth: &RecordEquations,
    old: &[usize],
    pairs: &[(usize, usize)],
    response: &dyn Fn(&RecordEquations, usize, usize) -> Complex64,
    residual: &dyn Fn(usize) -> Option<Complex64>,
) -> Option<Vec<Complex64>> {
    let n = old.len();
    let power = |c: usize| truth.channels[c].power;
    let mut a = vec![Complex64::default(); n * n];
    for (i, &p) in old.iter().enumerate() {
        for (j, &q) in old.iter().enumerate() {
            a[i * n + j] = pairs
                .iter()
                .map(|&(c, _)| response(truth, c, p) * response(truth, c, q).conj() * power(c))
                .sum();
        }
    }
    let r: Option<Vec<Complex64>> = old.iter().map(|&i| residual(i)).collect();
    let x = solve_linear(a, r?)?;
    let error = |&(c, _): &(usize, usize)| -> Complex64 {
        let heard = old.iter().zip(&x);
        heard
            .map(|(&i, x)| response(truth, c, i).conj() * x * power(c))
            .sum()
    };
    Some(pairs.iter().map(error).collect())
}

/// Solves a x = b by elimination with pivots; `None` if a is singular. a is stored by rows.
fn solve_linear(mut a: Vec<Complex64>, mut b: Vec<Complex64>) -> Option<Vec<Complex64>> {
    let n = b.len();
    for k in 0..n {
        let best = (k..n).max_by(|&i, &j| {
            let size = |i: usize| a[i * n + k].norm_sqr();
            size(i).total_cmp(&size(j))
        })?;
        if !(a[best * n + k].norm_sqr() > 0.0) {
            return None;
        }
        (0..n).for_each(|j| a.swap(k * n + j, best * n + j));
        b.swap(k, best);
        for i in k + 1..n {
            let share = a[i * n + k] / a[k * n + k];
            for j in k..n {
                let above = a[k * n + j];
                a[i * n + j] -= share * above;
            }
            let above = b[k];
            b[i] -= share * above;
        }
    }
    for k in (0..n).rev() {
        let rest: Complex64 = (k + 1..n).map(|j| a[k * n + j] * b[j]).sum();
        b[k] = (b[k] - rest) / a[k * n + k];
    }
    Some(b)
}

#[cfg(test)]
mod tests {
    use super::super::view::ChannelResponse;
    use super::*;
    use crate::reconcile::motion::noise::Whitener;

    fn c(re: f64, im: f64) -> Complex64 {
        Complex64::new(re, im)
    }

    /// Returns equations of one bin that are linear in three channels: residual = rows times readings.
    fn linear_record(
        rows: &[[Complex64; 3]],
        readings: [Complex64; 3],
        is_new: &[bool],
    ) -> RecordEquations {
        let left = rows.iter().map(|row| {
            let sum: Complex64 = row.iter().zip(&readings).map(|(h, y)| h * y).sum();
            vec![sum]
        });
        let channel = |k: usize| ChannelResponse {
            name: format!("c{k}"),
            power: [1.0, 4.0, 0.25][k],
            responses: rows.iter().map(|row| vec![row[k]]).collect(),
            undone: vec![c(1.0, 0.0)],
        };
        RecordEquations {
            left: left.collect(),
            is_new: is_new.to_vec(),
            channels: (0..3).map(channel).collect(),
            whitener: Whitener::from_covariance(&[vec![c(1.0, 0.0)]], 1),
            own: vec![],
            fresh: vec![],
            scale: vec![],
            weight: None,
            repeats: 1.0,
        }
    }

    /// Tests that two equations which differ only by a scale have no misfit in each other's records, at any noise.
    #[test]
    fn an_exact_alias_misses_nothing() {
        let readings = [c(1.0, 0.5), c(-0.3, 2.0), c(0.7, -1.1)];
        let rows = [
            [c(1.0, 0.0), c(0.2, -0.4), c(0.0, 1.0)],
            [c(0.0, 0.3), c(2.0, 0.0), c(-1.0, 0.1)],
        ];
        let turned = [rows[0].map(|h| h * 1.07), rows[1].map(|h| h * c(0.0, -3.0))];
        let old = [false, false];
        let (truth, other) = (
            linear_record(&rows, readings, &old),
            linear_record(&turned, readings, &old),
        );
        let missed = residual_of_other(&other, &truth).unwrap();
        assert!(truth.left.iter().flatten().all(|l| l.norm() > 0.1));
        assert!(
            missed.iter().flatten().all(|m| m.norm() < 1e-12),
            "{missed:?}"
        );
    }

    /// Tests that the misfit of the other equals the residual of its equations in a record that obeys the truth.
    #[test]
    fn what_is_missed_is_what_is_left_of_a_record_that_obeys() {
        let truth_rows = [[c(1.0, 0.0), c(0.5, 0.0), c(0.0, 0.0)]; 1];
        let other_rows = [[c(1.0, 0.0), c(0.9, 0.0), c(0.0, 0.2)]; 1];
        // A record that obeys the truth has c0 = -c1 / 2.
        let readings = [c(-1.0, 0.0), c(2.0, 0.0), c(3.0, 0.0)];
        let (truth, other) = (
            linear_record(&truth_rows, readings, &[false]),
            linear_record(&other_rows, readings, &[false]),
        );
        let missed = residual_of_other(&other, &truth).unwrap();
        // Expected misfit: -1 + 1.8 + 0.6 j.
        assert!((missed[0][0] - c(0.8, 0.6)).norm() < 1e-12, "{missed:?}");
    }

    /// Tests that the misfit in a new channel is the difference between the readings under both explanations.
    #[test]
    fn a_new_channel_is_missed_by_the_difference() {
        let truth_rows = [[c(1.0, 0.0), c(0.0, 0.0), c(0.0, 0.0)]; 1];
        let other_rows = [[c(1.1, 0.0), c(0.0, 0.0), c(0.0, 0.0)]; 1];
        let readings = [c(2.0, 0.0), c(0.0, 0.0), c(0.0, 0.0)];
        let (truth, other) = (
            linear_record(&truth_rows, readings, &[true]),
            linear_record(&other_rows, readings, &[true]),
        );
        let missed = residual_of_other(&other, &truth).unwrap();
        assert!((missed[0][0] - c(0.2, 0.0)).norm() < 1e-12, "{missed:?}");
    }
}
