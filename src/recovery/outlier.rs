//! Gauge whose error is larger than the errors of the other gauges, and its effect on the loads.

use super::dynamic::AddedCovariance;
use super::errors::ErrorModel;
use super::gain::Gain;
use super::residuals::{GaugeTest, PatternTest};
use super::run_estimates::RunEstimates;
use super::types::{GAUGE_SUSPECT, Readings, Shift, ShiftKind, Widening};
use crate::estimate::{NORMAL_95, student_95};
use crate::estimate::{chi_square_tail, student_tail};
use crate::finding::{Finding, Severity};
use crate::sensitivity::Sensitivity;
use crate::units::MICROSTRAIN;
use statrs::distribution::{ContinuousCDF, Normal};

/// Probability, over all gauges of a job, below which the largest error counts as real. It is half of the 1 % of correct jobs that may be stopped.
pub const ALARM: f64 = 0.005;
/// Probability, over all gauges of a job, below which a finding reports the error and the intervals widen: it affects one right job in twenty.
const NOTE: f64 = 0.05;
/// Share of the excess of the residuals that one gauge must account for, if the remaining residual exceeds stated errors. With less, there is a
/// further fault, and the gauge nearest to it would be blamed.
const ACCOUNTS_FOR: f64 = 0.5;
/// Probability below which the remaining residual counts as larger than stated errors.
const REST: f64 = 0.05;
/// Number of gauges, largest errors first, that are tried with the loads from the other gauges and their corrected readings.
const TRIED: usize = 3;
/// Loads and the size of a gauge's error depend on each other; the second round moves t by a tenth or less.
const ROUNDS: usize = 2;
/// Smallest |t| of a gauge that is tested. The fitted loads hide a part of the error of a gauge, but not most of it.
const WORTH_TRYING: f64 = 2.0;
/// Least share of its strain that a gauge reads, if its gain corrects its reading.
const LEAST_GAIN: f64 = 0.5;

/// Findings and widening of suspected gauges.
pub(super) struct Suspects {
    pub findings: Vec<Finding>,
    pub shifts: Vec<Shift>,
}

/// Returns the gauge with the most significant gain or zero error, if chance does not explain it.
///
/// The finding is an error if the interval of the gauge error excludes zero, and the error exceeds the half width of a load's interval. Otherwise it
/// is a warning, or a note if chance remains possible. In all cases the error widens the intervals.
pub(super) fn check(
    s: &Sensitivity,
    readings: &[Readings],
    (solved, beyond): (&RunEstimates, &[AddedCovariance]),
    errors: ErrorModel,
    pattern_test: Option<&PatternTest>,
) -> Suspects {
    let mut out = Suspects {
        findings: Vec::new(),
        shifts: Vec::new(),
    };
    let Some(pattern_test) = pattern_test.filter(|j| j.joint.dof > 1) else {
        return out;
    };
    let Some(suspect) = suspect(pattern_test) else {
        return out;
    };
    let test = suspect.test;
    let p = pattern_test.joint.gauges.len() as f64 * suspect.chance();
    if !(p < NOTE && suspect.accounts_for_it()) {
        return out;
    }
    let shift = Shift {
        gauge: test.gauge,
        kind: test.kind,
        size: test.size,
    };
    let (ratio, load) = worst_shift(s, (solved, beyond), &shift);
    let name = s.gauges.get(test.gauge).map_or("", String::as_str);
    // The half width uses the stated errors, or the residual without this gauge if it is larger.
    let wider = suspect.half_width();
    let by_others = match test.kind {
        ShiftKind::Gain => by_others(s, readings, solved, errors, test.gauge),
        ShiftKind::Offset => None,
    };
    let [size, half] = match by_others {
        Some([size, sigma]) => [size, wider * sigma / pattern_test.projection.share().sqrt()],
        None => [test.size, wider * (test.size / test.t).abs()],
    };
    // An interval that contains zero is no evidence against a gauge, however rare its residuals are.
    let is_off = size.abs() > half;
    let size = match test.kind {
        ShiftKind::Gain => format!(
            "{:+.1} % (± {:.1} %) of the strain predicted from the other gauges",
            100.0 * size,
            100.0 * half
        ),
        ShiftKind::Offset => format!(
            "{:+.1} (± {:.1}) microstrain from the prediction of the other gauges",
            size / MICROSTRAIN,
            half / MICROSTRAIN
        ),
    };
    let (severity, then) = if p < ALARM && ratio > 1.0 && is_off {
        let then = format!(
            "this shifts load `{load}` by {ratio:.1} times the half width of its 95 % interval"
        );
        (Severity::Error, then)
    } else {
        let then = "the intervals are widened by the effect on the loads".to_owned();
        let severity = if p < ALARM {
            Severity::Warning
        } else {
            Severity::Info
        };
        (severity, then)
    };
    out.findings.push(
        Finding::new(
            severity,
            GAUGE_SUSPECT,
            name,
            format!("gauge `{name}` deviates by {size}: {then}"),
            "check its position, direction, gauge factor, bridge factor and wiring; state a known error in [[correction]], or exclude the \
             gauge with `ignore = true`",
        )
        .with_numbers(ratio, 1.0)
        .with_chance(p),
    );
    out.shifts.push(shift);
    out
}

/// Largest share of noise in the sum of squares of the expected strain up to which a gain can be determined.
const OF_NOISE: f64 = 0.5;

/// Returns the gain error of a gauge predicted from the other gauges, and its standard deviation; `None` if the other gauges do not determine it.
///
/// Let `f` be the loads estimated from the other gauges in a run, `p = s f` the predicted strain of the gauge and `y` its reading. The gain is `1 + g
/// = sum y p / (sum p^2 - n v)`. `v` is the variance of `p` due to noise of the other gauges, without which p^2 would be too large (errors in
/// variables). Let `a` be the coefficients of the other readings in `p`, and `q_l = sum f_l p / sum p^2`. The variance of the gain is `(N + (1 + g)^2
/// v) / sum p^2` by noise and `(1 + g)^2 rel^2 sum_l q_l^2 (S_l^2 + sum_h a_h^2 S_hl^2)` by the errors of the coefficients, which all runs share.
///
/// # Reference
/// W.A. Fuller, Measurement Error Models (1987), eq. 1.2.3.
fn by_others(
    s: &Sensitivity,
    readings: &[Readings],
    solved: &RunEstimates,
    errors: ErrorModel,
    gauge: usize,
) -> Option<[f64; 2]> {
    let k = s.loads.len();
    let (pattern, _) = solved.patterns.first()?;
    let others: Vec<usize> = pattern
        .used
        .iter()
        .copied()
        .filter(|h| *h != gauge)
        .collect();
    let gain = Gain::new(s, &others, errors, pattern.noise_factor, &solved.typical)?;
    let own: Vec<f64> = s.values.row(gauge).iter().copied().collect();
    if (0..k).any(|l| own[l] != 0.0 && !gain.is_seen(l)) {
        return None;
    }
    let share = |i: usize| (0..k).map(|l| own[l] * gain.gain[(l, i)]).sum::<f64>();
    let shares: Vec<f64> = (0..others.len()).map(share).collect();
    let noise = errors.noise_of(s, gauge, pattern.noise_factor);
    let (of_others, common) = match &s.noise {
        None => (noise * shares.iter().map(|a| a * a).sum::<f64>(), 0.0),
        Some(of_gauges) => {
            let unit = errors.noise_variance(pattern.noise_factor);
            let with = |g: usize| {
                let parts = others.iter().zip(&shares);
                parts
                    .map(move |(h, a)| a * of_gauges.covariance_between(g, *h))
                    .sum::<f64>()
            };
            let each = others.iter().zip(&shares);
            let own: f64 = each.map(|(h, a)| a * with(*h)).sum();
            (unit * own, unit * with(gauge))
        }
    };
    let (mut runs, mut with, mut squares) = (0.0, 0.0, 0.0);
    let mut by_load = vec![0.0; k];
    for r in pattern.runs.iter().filter_map(|i| readings.get(*i)) {
        let loads = gain.loads(&r.strain);
        let p: f64 = own.iter().zip(&loads).map(|(s, f)| s * f).sum();
        runs += 1.0;
        with += r.strain[gauge] * p;
        squares += p * p;
        by_load
            .iter_mut()
            .zip(&loads)
            .for_each(|(q, f)| *q += f * p);
    }
    let expected = squares - runs * of_others;
    if !(expected > OF_NOISE * squares) {
        return None;
    }
    let factor = (with - runs * common) / expected;
    // The gauge may be suspect only because of runs with another set of gauges. The factor is then not finite.
    if !factor.is_finite() {
        return None;
    }
    let of_load = |l: usize| {
        let others = others.iter().zip(&shares);
        let others = others.map(|(h, a)| (a * s.values[(*h, l)]).powi(2));
        (by_load[l] / expected).powi(2) * (own[l] * own[l] + others.sum::<f64>())
    };
    let model = errors.model_rel.powi(2) * (0..k).map(of_load).sum::<f64>();
    let by_noise = (noise + factor * (factor * of_others - 2.0 * common)) / expected;
    Some([factor - 1.0, (by_noise + factor * factor * model).sqrt()])
}

/// Error of one gauge, with the residuals of all runs.
struct Suspect {
    test: GaugeTest,
    chi2: f64,
    dof: usize,
}

impl Suspect {
    /// Returns the residual chi-square without the gauge, over its degrees of freedom, if it exceeds stated errors.
    fn excess_of_rest(&self) -> Option<f64> {
        let free = self.dof - 1;
        let rest = self.chi2 - self.test.t * self.test.t;
        (chi_square_tail(rest, free as f64) < REST).then_some(rest / free as f64)
    }

    fn accounts_for_it(&self) -> bool {
        let share = self.test.t * self.test.t / (self.chi2 - self.dof as f64);
        self.excess_of_rest().is_none() || share > ACCOUNTS_FOR
    }

    /// Returns the half width of a 95 % interval over the standard deviation from stated errors. A larger residual without the gauge gives the scale.
    fn half_width(&self) -> f64 {
        self.excess_of_rest().map_or(NORMAL_95, |rest| {
            student_95((self.dof - 1) as f64) * rest.sqrt()
        })
    }

    /// Returns the probability that a gauge without fault shows an error of this size. If the residuals without the gauge are larger than stated,
    /// their scale is used.
    fn chance(&self) -> f64 {
        let t = self.test.t.abs();
        let tail = match self.excess_of_rest() {
            Some(rest) => student_tail(t / rest.sqrt(), (self.dof - 1) as f64),
            None => Normal::new(0.0, 1.0).map_or(1.0, |d| d.sf(t)),
        };
        2.0 * tail
    }
}

/// Returns the gauge with the largest error relative to its uncertainty. An error shifts the loads and their covariance, which hides a part of the
/// error. The largest errors are therefore tested with the loads from the corrected reading.
fn suspect(pattern_test: &PatternTest) -> Option<Suspect> {
    let joint = &pattern_test.joint;
    let mut order: Vec<&GaugeTest> = joint.gauges.iter().collect();
    order.sort_by(|a, b| b.t.abs().total_cmp(&a.t.abs()));
    let as_it_stands = Suspect {
        test: **order.first()?,
        chi2: joint.chi2,
        dof: joint.dof,
    };
    let worth = order.iter().take(TRIED);
    let worth = worth.filter(|t| t.t.abs() > WORTH_TRYING);
    let tried = worth.filter_map(|t| put_right(pattern_test, t));
    let best = tried.max_by(|a, b| a.test.t.abs().total_cmp(&b.test.t.abs()));
    Some(best.unwrap_or(as_it_stands))
}

/// Returns the error of a gauge computed again with the loads of all runs, after the reading of that gauge is corrected by the error.
fn put_right(pattern_test: &PatternTest, first: &GaugeTest) -> Option<Suspect> {
    let PatternTest {
        pattern,
        gain,
        projection,
        strain,
        joint,
    } = pattern_test;
    let i = pattern.used.binary_search(&first.gauge).ok()?;
    let mut suspect = Suspect {
        test: *first,
        chi2: joint.chi2,
        dof: joint.dof,
    };
    for _ in 0..ROUNDS {
        let size = suspect.test.size;
        if first.kind == ShiftKind::Gain && 1.0 + size < LEAST_GAIN {
            break;
        }
        let loads: Vec<Vec<f64>> = strain
            .iter()
            .map(|y| {
                let mut y = y.to_vec();
                y[first.gauge] = match first.kind {
                    ShiftKind::Gain => y[first.gauge] / (1.0 + size),
                    ShiftKind::Offset => y[first.gauge] - size,
                };
                gain.loads(&y)
            })
            .collect();
        let together = projection.joint_residuals(pattern, strain, &loads)?;
        suspect.test = projection.test(&together, pattern, &loads, i, first.kind)?;
        suspect.chi2 = together.chi2;
    }
    Some(suspect)
}

/// Returns the largest shift of a wanted load, divided by the half width of its interval from the stated errors, and that load.
fn worst_shift<'a>(
    s: &'a Sensitivity,
    (solved, beyond): (&RunEstimates, &[AddedCovariance]),
    shift: &Shift,
) -> (f64, &'a str) {
    let mut worst = (0.0, "");
    for (pattern, gain) in &solved.patterns {
        let Some(gain) = gain else { continue };
        for &i in &pattern.runs {
            let Some(r) = solved.runs.get(i) else {
                continue;
            };
            let f = &r.estimate.values;
            let Some(by_load) = gain.shift(f, shift) else {
                continue;
            };
            let sigma = match beyond.get(i) {
                Some(b) => gain
                    .with_noise(&b.total_covariance(&gain.used))
                    .sigma(f, &Widening::none()),
                None => gain.sigma(f, &Widening::none()),
            };
            for ((load, d), sd) in s.loads.iter().zip(&by_load).zip(&sigma) {
                let ratio = d.abs() / (NORMAL_95 * sd);
                if load.wanted && ratio > worst.0 {
                    worst = (ratio, load.name.as_str());
                }
            }
        }
    }
    worst
}
