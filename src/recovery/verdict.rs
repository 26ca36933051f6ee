//! Tests whether stated noise and model error explain the residual, and if not, whether the loads are usable.

use super::dynamic::AddedCovariance;
use super::errors::ErrorModel;
use super::outlier;
use super::residuals::{Joint, Pattern, PatternTest, Projection, RemovedLoads};
use super::run_estimates::RunEstimates;
use super::types::{Readings, RunEstimate, Widening};
use crate::estimate::chi_square_tail;
use crate::estimate::{NORMAL_95, student_95};
use crate::finding::{Finding, Severity, list_few};
use crate::linalg::{Matrix, dense};
use crate::sensitivity::Sensitivity;
use crate::units::{MICROSTRAIN, number};

/// Code of strain that the loads certainly do not explain.
pub const UNEXPLAINED: &str = "strain-not-explained";
/// Code of runs whose gauges don't determine some of the loads.
pub const NOT_SOLVABLE: &str = "run-not-solvable";
/// Probability below which a sum of squares counts as larger than stated errors or scatter.
pub(super) const SIGNIFICANT: f64 = 1e-3;
/// Probability below which the residual is certainly larger than the stated errors explain.
pub(super) const CERTAIN_CHANCE: f64 = 1e-6;
/// Residual over readings (root mean squares): a right model with the wrong mesh is below this limit, a missing load is above.
const EXPLAINED_LIMIT: f64 = 0.05;
/// `sqrt(chi2 / dof)` below which a misfit is small relative to stated errors, regardless of its share of the strain.
const BIRGE_LIMIT: f64 = 3.0;
/// Sets of runs with one set of missing gauges that are tested together; further sets contain a few runs each.
const PATTERNS: usize = 4;
/// Degrees of freedom from which residuals may be reported as too small.
const ENOUGH: usize = 10;

/// Findings on residuals, and the widening of the intervals.
pub(super) struct Verdict {
    pub findings: Vec<Finding>,
    /// Whether the residuals exceed stated errors.
    pub misfit: bool,
    /// Widening for all runs.
    pub widening: Widening,
    /// Widening of each run.
    pub by_run: Vec<Widening>,
}

/// Returns the probability of a sum of squares at least as large, if the stated errors are right.
pub fn chance(chi2: f64, dof: usize) -> f64 {
    chi_square_tail(chi2, dof as f64)
}

/// Evidence that residuals exceed stated errors.
struct Evidence {
    /// Probability of residuals at least as large; `low` is the probability of residuals as small.
    high: f64,
    low: f64,
    /// `sqrt(chi2 / dof)` of the test with this evidence.
    excess: f64,
    /// `sqrt(chi2 / dof)` of the runs without their correlation, which widens the intervals.
    pooled: f64,
    /// Effective number of independent errors in the evidence.
    effective: f64,
}

/// Returns findings on rank, redundancy and the size of the residuals. `beyond` contains errors of the readings beyond noise, by run, or is empty.
/// `share` is the share of independent runs.
pub(super) fn check(
    s: &Sensitivity,
    readings: &[Readings],
    solved: &RunEstimates,
    errors: ErrorModel,
    (beyond, share): (&[AddedCovariance], f64),
) -> Verdict {
    let runs = &solved.runs;
    let mut verdict = Verdict {
        findings: report_undetermined_loads(s, solved),
        misfit: false,
        widening: Widening::none(),
        by_run: vec![Widening::none(); runs.len()],
    };
    if runs.iter().all(|r| r.dof == 0) {
        verdict.findings.push(Finding::new(
            Severity::Warning,
            "no-redundancy",
            "gauges",
            "there are no more gauges than loads: the residual is always zero, and a faulty gauge cannot be detected",
            "add gauges: each gauge above the number of loads tests the others",
        ));
        return verdict;
    }
    let pattern_tests = test_patterns(s, readings, (solved, beyond, share), errors);
    let joints: Vec<&Joint> = pattern_tests.iter().map(|j| &j.joint).collect();
    let mut evidence = combine_tests(s, runs, &joints);
    if !beyond.is_empty() {
        // Errors that all samples share are overestimated, so small residuals are not evidence.
        evidence.low = 1.0;
    }
    verdict.misfit = evidence.high < SIGNIFICANT;
    if verdict.misfit && evidence.pooled > 1.0 {
        verdict.widening = widening_from_birge(evidence.pooled, evidence.effective);
    }
    verdict.by_run = runs
        .iter()
        .map(|r| {
            let own = r.chi2 / r.dof.max(1) as f64;
            let alone = chance(r.chi2, r.dof) < SIGNIFICANT / runs.len() as f64;
            match verdict.misfit && alone && own.sqrt() > evidence.pooled {
                true => widening_from_birge(own.sqrt(), r.dof as f64),
                false => verdict.widening.clone(),
            }
        })
        .collect();
    let sizes = Sizes::from_runs(s, readings, runs);
    verdict
        .findings
        .extend(size_finding(&evidence, &sizes, errors));
    let gauges = outlier::check(s, readings, (solved, beyond), errors, pattern_tests.first());
    verdict.findings.extend(gauges.findings);
    for w in verdict.by_run.iter_mut().chain([&mut verdict.widening]) {
        w.shifts.clone_from(&gauges.shifts);
    }
    verdict
}

fn widening_from_birge(birge: f64, dof: f64) -> Widening {
    Widening {
        variance_factor: birge * birge,
        coverage_factor: student_95(dof).max(NORMAL_95),
        shifts: Vec::new(),
    }
}

/// Returns the findings on runs whose gauges do not determine some of the loads.
fn report_undetermined_loads(s: &Sensitivity, solved: &RunEstimates) -> Vec<Finding> {
    let mut out = Vec::new();
    for (pattern, gain) in &solved.patterns {
        let unseen: Vec<&str> = s
            .loads
            .iter()
            .enumerate()
            .filter(|(l, load)| load.wanted && gain.as_ref().is_none_or(|g| !g.is_seen(*l)))
            .map(|(_, load)| load.name.as_str())
            .collect();
        if unseen.is_empty() {
            continue;
        }
        let names: Vec<&str> = pattern
            .runs
            .iter()
            .filter_map(|&i| solved.runs.get(i).map(|r| r.estimate.run.as_str()))
            .collect();
        let silent = s.gauges.len() - pattern.used.len();
        let why = match silent {
            0 => "the gauges do not separate".to_owned(),
            n => format!("{n} gauges have no readings, and the other gauges do not determine"),
        };
        out.push(Finding::new(
            Severity::Error,
            NOT_SOLVABLE,
            list_few(&names),
            format!("{why} {}: these loads are blank", unseen.join(", ")),
            "repair the gauges without readings, drop loads, or state `expected` for loads with role \"nuisance\"",
        ));
    }
    out
}

/// Returns the most frequent patterns of gauges without readings, each with a joint test of its runs. The residual excludes all loads, including
/// nuisance loads of a stated size. It is not known whether a nuisance load is equal in all runs.
fn test_patterns<'a>(
    s: &Sensitivity,
    readings: &'a [Readings],
    (solved, beyond, share): (&'a RunEstimates, &[AddedCovariance], f64),
    errors: ErrorModel,
) -> Vec<PatternTest<'a>> {
    let most = solved.patterns.iter().take(PATTERNS);
    most.filter_map(|(pattern, gain)| {
        let gain = gain.as_ref()?;
        let projection = Projection::new(s, pattern, errors, &solved.typical, RemovedLoads::All)?;
        // Round to a whole number of independent runs, so that squares and degrees of freedom are consistent.
        let runs = pattern.runs.len() as f64;
        let mut projection = projection.with_share((share * runs).round().max(1.0) / runs);
        if let Some(of_readings) = bound_shared_covariance(pattern, beyond) {
            projection = projection.with_reading_covariance(pattern, &of_readings)?;
        }
        let strain: Vec<&[f64]> = pattern
            .runs
            .iter()
            .map(|&i| readings.get(i).map_or(&[][..], |r| &r.strain))
            .collect();
        let loads: Vec<Vec<f64>> = pattern
            .runs
            .iter()
            .map(|&i| solved.runs[i].estimate.values.clone())
            .collect();
        let joint = projection.test_pattern(pattern, &strain, &loads)?;
        Some(PatternTest {
            pattern,
            gain,
            projection,
            strain,
            joint,
        })
    })
    .collect()
}

/// Returns a covariance that, if independent in every run, is no smaller than the covariance of errors that the runs of a pattern share. With `x`
/// over the runs, `(sum_i x_i d_i)^2 <= sum_i x_i^2 sum_j d_j^2` (Cauchy), so the sum over the runs replaces each error. The test then finds only
/// residuals that shared errors can't cause. `None` without such errors.
fn bound_shared_covariance(pattern: &Pattern, beyond: &[AddedCovariance]) -> Option<Matrix> {
    let mut runs = pattern.runs.iter().filter_map(|&i| beyond.get(i));
    let first = runs.next()?;
    let own = &first.noise + &first.shared;
    Some(runs.fold(own, |sum, b| sum + &b.shared))
}

/// Combines all tests, each against its share of the probability (Bonferroni).
fn combine_tests(s: &Sensitivity, runs: &[RunEstimate], joints: &[&Joint]) -> Evidence {
    let ratio = |chi2: f64, dof: usize| (chi2 / dof.max(1) as f64).sqrt();
    let (chi2, dof) = runs
        .iter()
        .fold((0.0, 0), |a, r| (a.0 + r.chi2, a.1 + r.dof));
    let mut tests: Vec<(f64, f64)> = joints
        .iter()
        .map(|j| (chance(j.chi2, j.dof), ratio(j.chi2, j.dof)))
        .collect();
    // Nuisance loads beyond their stated sizes appear only in the tests of single runs.
    if joints.is_empty() || s.priors().iter().any(Option::is_some) {
        let worst = runs
            .iter()
            .map(|r| (chance(r.chi2, r.dof), ratio(r.chi2, r.dof)))
            .min_by(|a, b| a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1)));
        tests.extend(worst.map(|(p, r)| ((p * runs.len() as f64).min(1.0), r)));
    }
    let n = tests.len() as f64;
    let (high, excess) = tests
        .iter()
        .map(|(p, r)| ((p * n).min(1.0), *r))
        .min_by(|a, b| a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1)))
        .unwrap_or((1.0, 1.0));
    let low = joints
        .iter()
        .filter(|j| j.dof >= ENOUGH)
        .map(|j| n * (1.0 - chance(j.chi2, j.dof)))
        .fold(1.0, f64::min);
    let effective: f64 = joints.iter().map(|j| j.effective).sum();
    let of_one = runs.iter().map(|r| r.dof).max().unwrap_or(1) as f64;
    Evidence {
        high,
        low,
        excess: if high < SIGNIFICANT {
            excess
        } else {
            ratio(
                joints.iter().map(|j| j.chi2).sum(),
                joints.iter().map(|j| j.dof).sum(),
            )
        },
        pooled: ratio(chi2, dof),
        effective: if joints.is_empty() { of_one } else { effective },
    }
}

/// Sizes of residuals against readings.
struct Sizes {
    /// Residual over readings, root mean squares, of all runs.
    share: f64,
    /// Runs whose own residuals are significant, and large against their readings.
    bad: Vec<String>,
    /// Runs.
    n: usize,
    /// Patterns among the residuals.
    patterns: usize,
}

impl Sizes {
    fn from_runs(s: &Sensitivity, readings: &[Readings], runs: &[RunEstimate]) -> Self {
        let pairs: Vec<(&Readings, &RunEstimate)> = readings.iter().zip(runs).collect();
        let each = runs.len() as f64;
        let bad = pairs
            .iter()
            .filter(|(_, r)| {
                each * chance(r.chi2, r.dof) < CERTAIN_CHANCE
                    && (r.chi2 / r.dof.max(1) as f64).sqrt() > BIRGE_LIMIT
            })
            .filter(|pair| share(&[**pair]) > EXPLAINED_LIMIT)
            .map(|(_, r)| r.estimate.run.clone())
            .collect();
        Self {
            share: share(&pairs),
            bad,
            n: runs.len(),
            patterns: patterns(s.gauges.len(), runs),
        }
    }
}

/// Returns the ratio of residual to readings, as root mean squares. The residual is relative to its degrees of freedom.
fn share(pairs: &[(&Readings, &RunEstimate)]) -> f64 {
    let (mut r2, mut y2, mut n, mut free) = (0.0, 0.0, 0usize, 0usize);
    for (y, r) in pairs {
        free += r.dof;
        for (v, e) in y
            .strain
            .iter()
            .zip(&r.residual)
            .filter(|(v, _)| v.is_finite())
        {
            y2 += v * v;
            r2 += e * e;
            n += 1;
        }
    }
    if y2 > 0.0 && free > 0 {
        (r2 / y2 * n as f64 / free as f64).sqrt()
    } else {
        0.0
    }
}

/// Returns the finding that the residuals are larger or smaller than expected from the stated errors.
fn size_finding(evidence: &Evidence, sizes: &Sizes, errors: ErrorModel) -> Option<Finding> {
    let noise = errors.noise / MICROSTRAIN;
    let stated = match errors.model_rel {
        r if r > 0.0 => format!(
            "noise of {noise} microstrain and a model uncertainty of {} %",
            r * 100.0
        ),
        _ => format!("noise of {noise} microstrain"),
    };
    let excess = evidence.excess;
    let beyond = evidence.high < CERTAIN_CHANCE && excess > BIRGE_LIMIT;
    if beyond && (sizes.share > EXPLAINED_LIMIT || !sizes.bad.is_empty()) {
        let subject = if sizes.bad.is_empty() || sizes.bad.len() == sizes.n {
            "all runs".to_owned()
        } else {
            list_few(&sizes.bad)
        };
        return Some(
            Finding::new(
                Severity::Error,
                UNEXPLAINED,
                subject,
                format!(
                    "the loads of the job leave {:.0} % of the measured strain unexplained, {} times the residual expected from {stated}. \
                     An unlisted load or effect strains the structure. Do not use these loads or their intervals",
                    sizes.share * 100.0,
                    number(excess)
                ),
                missing_load_remedy(sizes.patterns),
            )
            .with_numbers(excess, BIRGE_LIMIT),
        );
    }
    if evidence.high < SIGNIFICANT {
        let then = if evidence.pooled > 1.0 {
            format!("intervals are {} times as wide", number(evidence.pooled))
        } else {
            "intervals do not change, because the stated model error is most of their width"
                .to_owned()
        };
        return Some(
            Finding::new(
                Severity::Warning,
                "residual-above-stated-errors",
                "residual",
                format!(
                    "residuals are {} times the residual expected from {stated} ({:.1} % of the measured strain): {then}",
                    number(excess),
                    sizes.share * 100.0
                ),
                "state the actual noise and `model_uncertainty_rel`; if both are correct, a small load is missing or a gauge is wrong",
            )
            .with_numbers(excess, 1.0),
        );
    }
    (evidence.low < CERTAIN_CHANCE).then(|| {
        Finding::new(
            Severity::Info,
            "residual-below-stated-errors",
            "residual",
            format!("residuals are {} times the residual expected from {stated}: intervals are wider than necessary", number(excess)),
            "state a smaller noise or model uncertainty, if it is justified",
        )
        .with_numbers(excess, 1.0)
    })
}

fn missing_load_remedy(patterns: usize) -> String {
    match patterns {
        0 | 1 => "check for a load that acts and is not among the [[load]] (payload, lateral forces, temperature), or a faulty gauge".to_owned(),
        m => format!(
            "the residuals of the runs follow {m} patterns. Check for {m} loads or effects that are not among the [[load]] (payload and \
             its moments, lateral forces, temperature), then for a faulty gauge"
        ),
    }
}

/// Returns the number of patterns above noise among the residuals of the runs: singular values above the largest one of pure noise.
fn patterns(n: usize, runs: &[RunEstimate]) -> usize {
    let m = runs.len();
    let std = |g: usize, r: &RunEstimate| {
        let v = r.residual[g] / r.sd[g];
        if v.is_finite() { v } else { 0.0 }
    };
    // Use gauges by runs or runs by gauges, whichever has more rows. The singular values are equal, and there may be thousands of runs.
    let a = Matrix::from_fn(n.max(m), n.min(m), |row, column| {
        if n >= m {
            std(row, &runs[column])
        } else {
            std(column, &runs[row])
        }
    });
    let edge = (n as f64).sqrt() + (m as f64).sqrt() + 3.0;
    dense::svd(&a).map_or(0, |d| d.s.iter().filter(|&&s| s > edge).count())
}
