//! Zeros that are said to drift and scatter, but do not: noise of a gauge's own, or readings that bend with the load.

use super::frame::StrainFrame;
use super::likelihood::Fit;
use super::prediction::predict;
use crate::linalg::tail::f_tail;
use crate::linalg::{Matrix, dense};
use crate::reconcile::effect::{Candidate, FaultKind, Member, full_id};
use crate::reconcile::search::Scored;

/// Chance of a wrong doubt of a zero that drifts.
const CHANCE: f64 = 1e-3;
/// Chance that a zero which scatters about where it was passes for one that moved.
const MOVED: f64 = 0.01;

/// What speaks against a zero of `scored` that drifts and scatters, in words; `None` where nothing does.
///
/// What the gauge reads beside the other effects is held against `a + b p`, p the strain that the model has it read: a zero that has moved has
/// an `a` beyond its scatter (t test), and what is left does not follow `p |p|` (F test).
pub(super) fn no_drift(
    frame: &StrainFrame,
    candidates: &[Candidate],
    scored: &Scored<Fit>,
) -> Option<String> {
    let scatters = |c: &Candidate| {
        let e = c.effect.as_ref();
        let own = e.kind() == FaultKind::Zero && !e.parameters().is_empty();
        own && e.amplitudes(frame).is_some()
    };
    scored.set.iter().find_map(|&c| {
        let candidate = candidates.get(c).filter(|c| scatters(c))?;
        let &[gauge] = candidate.effect.gauges().as_slice() else {
            return None;
        };
        let (p, r) = beside_others(frame, candidates, scored, c, gauge);
        let id = full_id(candidate.effect.as_ref());
        if follows(&p, &r) {
            return Some(format!(
                "what {id} takes bends with the load: an amplifier near its limit or a gauge that yields, not a zero that moved"
            ));
        }
        has_not_moved(&r).then(|| {
            format!("what {id} takes scatters about nothing: noise of that gauge alone, not a zero that moved")
        })
    })
}

/// By run: strain that `gauge` would read with all members but one on, and what it reads besides.
fn beside_others(
    frame: &StrainFrame,
    candidates: &[Candidate],
    scored: &Scored<Fit>,
    but: usize,
    gauge: usize,
) -> (Vec<f64>, Vec<f64>) {
    let others = scored.set.iter().zip(&scored.fit.parameters);
    let member = |(&c, p): (&usize, &'_ Vec<f64>)| (c, p.clone());
    let others: Vec<(usize, Vec<f64>)> = others.filter(|(c, _)| **c != but).map(member).collect();
    let members: Vec<Member<'_>> = (others.iter())
        .filter_map(|(c, parameters)| {
            Some(Member {
                effect: candidates.get(*c)?.effect.as_ref(),
                parameters,
            })
        })
        .collect();
    let predicted = predict(frame, &members);
    let n_g = frame.n_gauges();
    let read = (0..frame.n_runs()).map(|r| (r, frame.observations.value(r, gauge)));
    read.filter(|(_, v)| v.is_finite())
        .filter_map(|(r, v)| predicted.get(r * n_g + gauge).map(|p| (*p, v - p)))
        .unzip()
}

/// Whether `r` follows `p |p|` beyond a straight line in `p`.
fn follows(p: &[f64], r: &[f64]) -> bool {
    let n = r.len();
    let scale = p.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    if n < 5 || scale <= 0.0 {
        return false;
    }
    let column = |i: usize, j: usize| {
        let x = p[i] / scale;
        [1.0, x, x * x.abs()][j]
    };
    let (line, bent) = (
        left(&Matrix::from_fn(n, 2, column), r),
        left(&Matrix::from_fn(n, 3, column), r),
    );
    let freedom = (n - 3) as f64;
    let ratio = (line - bent) / (bent / freedom);
    ratio.is_finite() && f_tail(ratio.max(0.0), 1.0, freedom) < CHANCE
}

/// Squared residual of `r` beside the columns of `x`.
fn left(x: &Matrix, r: &[f64]) -> f64 {
    let whole: f64 = r.iter().map(|v| v * v).sum();
    let Some(basis) = dense::svd(x) else {
        return whole;
    };
    let along = |k: usize| -> f64 { r.iter().enumerate().map(|(i, v)| basis.u[(i, k)] * v).sum() };
    let kept = (0..basis.s.len()).filter(|k| basis.s[*k] > 1e-9 * basis.s[0]);
    whole - kept.map(|k| along(k).powi(2)).sum::<f64>()
}

/// Whether the mean of `r` is one that its scatter makes.
fn has_not_moved(r: &[f64]) -> bool {
    let n = r.len() as f64;
    if n < 3.0 {
        return false;
    }
    let mean = r.iter().sum::<f64>() / n;
    let about: f64 = r.iter().map(|v| (v - mean).powi(2)).sum();
    let squared_t = n * mean * mean / (about / (n - 1.0));
    squared_t.is_finite() && f_tail(squared_t, 1.0, n - 1.0) > MOVED
}

#[cfg(test)]
mod tests {
    use super::{follows, has_not_moved};

    /// Scatter whose mean is none, of +-1 and +-2.
    const SCATTER: [f64; 8] = [1.0, -2.0, 2.0, -1.0, 1.0, 2.0, -2.0, -1.0];

    #[test]
    fn scatter_about_nothing_is_no_zero_that_moved_and_an_offset_is_one() {
        assert!(has_not_moved(&SCATTER));
        let moved = SCATTER.map(|v| v + 10.0);
        assert!(!has_not_moved(&moved));
    }

    #[test]
    fn readings_that_bend_follow_the_load_and_those_that_are_off_or_scaled_do_not() {
        let p: Vec<f64> = (0..8).map(|k| 100.0 * k as f64).collect();
        let with = |f: &dyn Fn(f64) -> f64| -> Vec<f64> {
            p.iter().zip(SCATTER).map(|(p, s)| f(*p) + s).collect()
        };
        assert!(follows(&p, &with(&|p| -3e-4 * p * p)));
        assert!(!follows(&p, &with(&|p| 40.0 + 0.1 * p)));
    }
}
