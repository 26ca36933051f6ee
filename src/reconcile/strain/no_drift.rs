//! Test of zeros that a set identifies as drifting. The cause may instead be noise of that gauge alone, or a reading that depends on the load.

use super::covariance::{Selection, patterns_read};
use super::explanation::Explanation;
use super::frame::StrainFrame;
use super::likelihood::Fit;
use super::prediction::predict;
use super::size::{RunBlocks, amplitudes_by_run};
use crate::estimate::f_tail;
use crate::linalg::{Matrix, dense};
use crate::reconcile::effect::{Candidate, FaultKind, Member, SizedAmplitudes, full_id};
use crate::reconcile::search::ScoredSet;

/// Probability that the F tests reject a zero that does drift.
const CHANCE: f64 = 1e-3;
/// Probability that a zero which only scatters about its former value is identified as moved.
const MOVED: f64 = 0.01;
/// Limit of a slope, in standard deviations of the stated uncertainty of a gauge's influence. A model error exceeds it at one gauge in a thousand.
const MAX_SLOPE_SD: f64 = 3.3;

/// Zero that a set identifies as drifting and that does not drift.
pub(super) struct NoDrift {
    /// Candidate number.
    pub candidate: usize,
    /// Reason against the drift.
    pub words: String,
}

/// Returns the first zero of `scored` that is identified as drifting and scattering but fails a test, with the reason; `None` if all zeros pass.
///
/// The reading minus the contribution of the other effects is compared with `a + b p`, with p the predicted strain of the gauge. The zero passes if F
/// tests find no dependence on `p |p|` and no `b` beyond its scatter and the model uncertainty. A zero that moved also shows a constant, a line or a
/// parabola beyond its scatter, over the runs in their order.
pub(super) fn no_drift(
    frame: &StrainFrame,
    candidates: &[Candidate],
    scored: &ScoredSet<Fit>,
) -> Option<NoDrift> {
    let scatters = |c: &Candidate| {
        let e = c.effect.as_ref();
        let own = e.kind() == FaultKind::Zero && !e.parameters().is_empty();
        own && e.amplitudes(frame).is_some()
    };
    let uncertainty = frame.relative_uncertainty();
    scored.set.iter().find_map(|&c| {
        let candidate = candidates.get(c).filter(|c| scatters(c))?;
        let &[gauge] = candidate.effect.gauges().as_slice() else {
            return None;
        };
        let read = split_reading(frame, candidates, scored, c, gauge);
        let id = full_id(candidate.effect.as_ref());
        let uncertainty = uncertainty.get(gauge).copied().unwrap_or(0.0);
        let words = if read.bends() {
            format!(
                "the drift of {id} is a curved function of the load. This indicates an amplifier near its limit or a gauge that yields, \
                 not a drifted zero"
            )
        } else if read.goes_with_load(MAX_SLOPE_SD * uncertainty) {
            format!("the drift of {id} is proportional to the load. This indicates a wrong gain, not a drifted zero")
        } else if read.has_not_moved() {
            format!("the drift of {id} scatters about zero. This indicates noise of this gauge alone, not a drifted zero")
        } else {
            return None;
        };
        Some(NoDrift { candidate: c, words })
    })
}

/// Reading of a gauge by run, split into the prediction with the other effects and the remaining reading.
struct ReadingSplit {
    /// Run number over the number of runs.
    at: Vec<f64>,
    /// Predicted reading with the other effects, amplitudes included, microstrain.
    model: Vec<f64>,
    /// Reading less `model`, microstrain.
    rest: Vec<f64>,
}

/// Returns the reading of `gauge`, split into the prediction with all members except `but` and the remaining reading.
fn split_reading(
    frame: &StrainFrame,
    candidates: &[Candidate],
    scored: &ScoredSet<Fit>,
    but: usize,
    gauge: usize,
) -> ReadingSplit {
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
    let amplitudes = of_amplitudes(frame, candidates, scored, but, gauge);
    let n_g = frame.n_gauges();
    let n_r = frame.n_runs().max(1) as f64;
    let mut out = ReadingSplit {
        at: Vec::new(),
        model: Vec::new(),
        rest: Vec::new(),
    };
    for run in 0..frame.n_runs() {
        let read = frame.observations.value(run, gauge);
        if let Some(model) = predicted
            .get(run * n_g + gauge)
            .filter(|_| read.is_finite())
        {
            let model = model + amplitudes[run];
            out.at.push(run as f64 / n_r);
            out.model.push(model);
            out.rest.push(read - model);
        }
    }
    out
}

/// Returns the strain at `gauge` by run from the amplitudes of all members except `but`, as the readings of all gauges show them. If the zero of the
/// gauge moves by run, its amplitude is a further unknown, and the readings determine this strain less well.
fn of_amplitudes(
    frame: &StrainFrame,
    candidates: &[Candidate],
    scored: &ScoredSet<Fit>,
    but: usize,
    gauge: usize,
) -> Vec<f64> {
    let mut out = vec![0.0; frame.n_runs()];
    let e = Explanation::from_fit(frame, candidates, scored);
    let read = |u: &SizedAmplitudes| {
        let mut read = u.clone();
        read.amplitudes.patterns = patterns_read(frame, &e.members, &u.amplitudes.patterns);
        read
    };
    let unknown: Vec<SizedAmplitudes> = e.unknown.iter().map(read).collect();
    if unknown.len() < 2 {
        return out;
    }
    let runs: Vec<usize> = (0..frame.n_runs()).collect();
    let selection = Selection::of_runs(frame, &runs);
    let n_g = frame.n_gauges();
    let readings = selection.pick(&frame.observations.values, n_g);
    let predicted = selection.pick(&predict(frame, &e.members), n_g);
    let residual: Vec<f64> = readings.iter().zip(predicted).map(|(y, p)| y - p).collect();
    let blocks = RunBlocks::from_selection(frame, &e.members, &selection);
    let mut read: Vec<usize> = selection.0.iter().map(|e| e.0).collect();
    read.dedup();
    // Reading of the gauge per unit amplitude by pattern; zero for the patterns of the tested effect `but`.
    let families = scored.fit.sizes.iter().zip(&unknown);
    let at_gauge = families.flat_map(|((c, _), u)| {
        let patterns = u.amplitudes.patterns.iter();
        patterns.map(move |p| if *c == but { 0.0 } else { p[gauge] })
    });
    let at_gauge: Vec<f64> = at_gauge.collect();
    let by_run = amplitudes_by_run(&blocks, &residual, &unknown);
    if by_run.len() == read.len() {
        for (run, own) in read.into_iter().zip(by_run) {
            out[run] = own.iter().zip(&at_gauge).map(|(a, p)| a[0] * p).sum();
        }
    }
    out
}

impl ReadingSplit {
    /// Returns the predicted strain over its largest magnitude; `None` if all predictions are zero.
    fn scale_strain(&self) -> Option<Vec<f64>> {
        let scale = self.model.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        (scale > 0.0).then(|| self.model.iter().map(|v| v / scale).collect())
    }

    /// Returns whether `rest` follows `p |p|` beyond a straight line in `p`.
    fn bends(&self) -> bool {
        self.scale_strain().is_some_and(|p| {
            let column = |i: usize, j: usize| [1.0, p[i], p[i] * p[i].abs()][j];
            chance(&self.rest, column, 2, 3) < CHANCE
        })
    }

    /// Returns whether `rest` follows `p` beyond a constant, with a slope above `uncertainty`.
    fn goes_with_load(&self, uncertainty: f64) -> bool {
        self.scale_strain().is_some_and(|p| {
            let column = |i: usize, j: usize| [1.0, p[i]][j];
            chance(&self.rest, column, 1, 2) < CHANCE
                && slope(&self.model, &self.rest).abs() > uncertainty
        })
    }

    /// Returns whether scatter alone explains the constant, line and parabola over the runs.
    fn has_not_moved(&self) -> bool {
        /// Constant, line, parabola.
        const FORMS: usize = 3;
        let power = |i: usize, j: usize| self.at[i].powi(j as i32);
        self.rest.len() > FORMS
            && (1..=FORMS).all(|n| chance(&self.rest, power, 0, n) > MOVED / FORMS as f64)
    }
}

/// Returns the probability (F test) that scatter alone causes the better fit of `r` with the first `more` columns instead of the first `few`.
fn chance(r: &[f64], column: impl Fn(usize, usize) -> f64, few: usize, more: usize) -> f64 {
    if r.len() < more + 2 {
        return 1.0;
    }
    let freedom = (r.len() - more) as f64;
    let left = |n: usize| residual_sum_of_squares(&Matrix::from_fn(r.len(), n, &column), r);
    let (before, after) = (left(few), left(more));
    let ratio = (before - after) / (more - few) as f64 / (after / freedom);
    if ratio.is_nan() {
        return 1.0;
    }
    f_tail(ratio.max(0.0), (more - few) as f64, freedom)
}

/// Returns the least squares slope of `y` over `x`.
fn slope(x: &[f64], y: &[f64]) -> f64 {
    let n = x.len().max(1) as f64;
    let mean = x.iter().sum::<f64>() / n;
    let (mut xy, mut xx) = (0.0, 0.0);
    for (x, y) in x.iter().zip(y) {
        xy += (x - mean) * y;
        xx += (x - mean).powi(2);
    }
    if xx > 0.0 { xy / xx } else { 0.0 }
}

/// Returns the sum of squares of `r` after a least squares fit of the columns of `x`.
fn residual_sum_of_squares(x: &Matrix, r: &[f64]) -> f64 {
    let whole: f64 = r.iter().map(|v| v * v).sum();
    if x.ncols() == 0 {
        return whole;
    }
    let Some(basis) = dense::svd(x) else {
        return whole;
    };
    let along = |k: usize| -> f64 { r.iter().enumerate().map(|(i, v)| basis.u[(i, k)] * v).sum() };
    let kept = (0..basis.s.len()).filter(|k| basis.s[*k] > 1e-9 * basis.s[0]);
    whole - kept.map(|k| along(k).powi(2)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::ReadingSplit;

    /// Scatter of +-1 and +-2 without mean, slope or bend.
    const SCATTER: [f64; 8] = [1.0, -2.0, 2.0, -1.0, 1.0, 2.0, -2.0, -1.0];
    /// Strain of runs whose load is not sorted by run number, microstrain.
    const MODEL: [f64; 8] = [300.0, 0.0, 700.0, 100.0, 600.0, 200.0, 500.0, 400.0];

    fn reads(f: impl Fn(f64, f64) -> f64) -> ReadingSplit {
        let at: Vec<f64> = (0..8).map(|k| k as f64 / 8.0).collect();
        let parts = at.iter().zip(MODEL).zip(SCATTER);
        ReadingSplit {
            rest: parts.map(|((t, p), s)| f(*t, p) + s).collect(),
            model: MODEL.to_vec(),
            at,
        }
    }

    #[test]
    fn scatter_about_nothing_is_no_zero_that_moved_and_an_offset_is_one() {
        assert!(reads(|_, _| 0.0).has_not_moved());
        assert!(!reads(|_, _| 10.0).has_not_moved());
    }

    #[test]
    fn a_zero_that_drifts_evenly_from_minus_to_plus_or_out_and_back_has_moved() {
        assert!(!reads(|t, _| 40.0 * (t - 0.4375)).has_not_moved());
        assert!(!reads(|t, _| 100.0 * (t - 0.4375).powi(2) - 8.2).has_not_moved());
    }

    #[test]
    fn readings_that_bend_follow_the_load_and_those_that_are_off_or_scaled_do_not() {
        assert!(reads(|_, p| -3e-4 * p * p).bends());
        assert!(!reads(|_, p| 40.0 + 0.1 * p).bends());
    }

    #[test]
    fn a_slope_beyond_the_uncertainty_of_the_model_is_no_zero_drift() {
        assert!(reads(|_, p| 40.0 - 0.1 * p).goes_with_load(0.05));
        assert!(!reads(|_, p| 40.0 - 0.1 * p).goes_with_load(0.2));
        assert!(!reads(|t, _| 40.0 * t).goes_with_load(0.0));
    }
}
