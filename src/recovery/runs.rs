//! Static states, or samples of a record: one estimate each, with a common test of the residuals.

use super::dynamic::AddedCovariance;
use super::errors::ErrorModel;
use super::misfit::Alternatives;
use super::noise::{ShownNoise, share_of_samples, shown_noise};
use super::run_estimates::{RunEstimates, root_mean_squares, solve_beyond};
use super::types::{GAUGE_SUSPECT, Readings, Recovery, RunEstimate, Widening};
use super::{by_calibration, load_determinacy, misfit, reading_plausibility, verdict};
use crate::estimate::student_95;
use crate::finding::Finding;
use crate::input_faults::FaultTreatment;
use crate::sensitivity::{Sensitivity, Uncertainty};

/// Returns the loads of every run with intervals, and findings on the residuals.
///
/// If the residuals are larger than stated noise and model error explain, all covariances are multiplied by `chi2 / dof` (Birge). The
/// intervals then take Student's factor, and a finding reports it. A single run with large residuals takes its own factor.
///
/// # Reference
/// R. T. Birge, Phys. Rev. 40 (1932) 207; A. C. Aitken, Proc. R. Soc. Edinburgh 55 (1935) 42.
///
/// # Example
/// ```
/// use strainbridge::linalg::Matrix;
/// use strainbridge::recovery::{ErrorModel, Readings, recover};
/// use strainbridge::sensitivity::{Load, Sensitivity};
///
/// let s = Sensitivity {
///     gauges: ["G1", "G2", "G3"].map(str::to_owned).to_vec(),
///     loads: vec![Load::from_name("left"), Load::from_name("right")],
///     values: 1e-6 * Matrix::from_row_slice(3, 2, &[1.0, 0.0, 0.0, 1.0, 1.0, 1.0]),
///     uncertainty: None,
///     noise: None,
/// };
/// let run = |strain: [f64; 3]| Readings {
///     run: "R1".to_owned(),
///     strain: strain.map(|v| 1e-6 * v).to_vec(),
///     noise_factor: 1.0,
/// };
/// let errors = ErrorModel { noise: 1e-6, model_rel: 0.0 };
/// let found = recover(&s, &[run([100.0, 50.0, 150.3])], errors);
/// let loads = &found.runs[0].estimate;
/// // Least squares by hand: S'S = [[2, 1], [1, 2]], so the excess of 0.3 adds 0.1 to each load.
/// assert!((loads.values[0] - 100.1).abs() < 1e-9 && (loads.values[1] - 50.1).abs() < 1e-9);
/// // The covariance is noise^2 (S'S)^-1 = [[2, -1], [-1, 2]] / 3.
/// assert!((loads.covariance[0] - 2.0 / 3.0).abs() < 1e-9);
/// assert!((loads.covariance[1] + 1.0 / 3.0).abs() < 1e-9);
/// ```
pub fn recover(s: &Sensitivity, readings: &[Readings], errors: ErrorModel) -> Recovery {
    recover_with_alternatives(s, readings, errors, &mut Vec::new)
}

/// Recovers the loads of every run like [`recover`], and also searches for faults of the installation.
pub fn recover_with_alternatives(
    s: &Sensitivity,
    readings: &[Readings],
    errors: ErrorModel,
    alternatives: &mut Alternatives,
) -> Recovery {
    let faults = (FaultTreatment::LeftOut, alternatives);
    recover_beyond(s, readings, errors, (&[], Order::Runs), faults)
}

/// Relation between consecutive readings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Order {
    /// Runs, independent of each other.
    Runs,
    /// Samples of a record, in order of time.
    Samples,
}

/// Recovers the loads of readings with errors beyond noise, by run; `beyond` is empty without such errors. The test of the residuals includes them.
/// `handling` decides on gauges that contradict the other gauges by a calibrated S.
pub(super) fn recover_beyond(
    s: &Sensitivity,
    readings: &[Readings],
    errors: ErrorModel,
    (beyond, order): (&[AddedCovariance], Order),
    (handling, alternatives): (FaultTreatment, &mut Alternatives),
) -> Recovery {
    let (readings, mut findings) = reading_plausibility::check(&s.gauges, readings, errors);
    // Noise is estimated only without errors beyond noise, because these are correlated too.
    let shown = match beyond.is_empty() {
        true => shown_noise(s, &readings, errors),
        false => ShownNoise::default(),
    };
    let with_noise = shown.noise.as_ref().map(|noise| Sensitivity {
        noise: Some(noise.clone()),
        ..s.clone()
    });
    let s = with_noise.as_ref().unwrap_or(s);
    if let Some(known) = &s.uncertainty {
        findings.extend(shown.finding);
        let faults = (handling, alternatives);
        return Recovery {
            noise: shown.noise,
            ..recover_calibrated(s, &readings, errors, (known, faults), findings)
        };
    }
    let solved = solve_beyond(s, &readings, errors, beyond);
    let share = match order {
        Order::Samples if beyond.is_empty() => share_of_samples(s, &readings, errors),
        _ => 1.0,
    };
    let verdict = verdict::check(s, &readings, &solved, errors, (beyond, share));
    // Faults are identified by how well they explain residuals beyond noise. This is not possible with other errors beyond noise.
    let named = match verdict.misfit && beyond.is_empty() {
        true => misfit::faults_by_stated_errors(s, &readings, errors, alternatives),
        false => Vec::new(),
    };
    findings.extend(merge_gauge_findings(verdict.findings, named));
    // A misfit is already reported, with its own remedy.
    let is_stated = verdict.misfit && shown.noise.is_none();
    findings.extend(shown.finding.filter(|_| !is_stated));
    let RunEstimates {
        mut runs,
        patterns,
        typical,
    } = solved;
    for (pattern, gain) in &patterns {
        let Some(gain) = gain else { continue };
        for (&i, widening) in pattern
            .runs
            .iter()
            .filter_map(|i| Some((i, verdict.by_run.get(*i)?)))
        {
            let e = &mut runs[i].estimate;
            e.covariance = gain.covariance(&e.values, widening);
            e.coverage_factor = widening.coverage_factor;
            for l in (0..gain.n_loads()).filter(|&l| !gain.is_seen(l)) {
                e.values[l] = f64::NAN;
            }
        }
    }
    let (residual_rms, gauge_residual_rms, gauge_leverage) = residual_sizes(s.gauges.len(), &runs);
    findings.extend(load_determinacy::check(s, &runs));
    Recovery {
        runs,
        residual_rms,
        gauge_residual_rms,
        gauge_leverage,
        findings,
        widening: verdict.widening,
        typical,
        noise: shown.noise,
    }
}

/// Recovers the loads by a calibrated S like [`recover`]; its uncertainty and scatter replace all errors except noise.
fn recover_calibrated(
    s: &Sensitivity,
    readings: &[Readings],
    errors: ErrorModel,
    (known, faults): (&Uncertainty, (FaultTreatment, &mut Alternatives)),
    mut findings: Vec<Finding>,
) -> Recovery {
    let (runs, tested) = by_calibration::recover(s, readings, errors, (known, faults));
    findings.extend(tested);
    let (residual_rms, gauge_residual_rms, gauge_leverage) = residual_sizes(s.gauges.len(), &runs);
    findings.extend(load_determinacy::check(s, &runs));
    let determined = runs.iter().flat_map(|r| {
        let values = r.estimate.values.iter().enumerate();
        values
            .filter(|(l, _)| r.determines_load(*l))
            .map(|(l, v)| (l, *v))
    });
    let typical = root_mean_squares(s.loads.len(), determined);
    Recovery {
        residual_rms,
        gauge_residual_rms,
        gauge_leverage,
        findings,
        widening: Widening {
            coverage_factor: student_95(known.dof),
            ..Widening::none()
        },
        typical,
        runs,
        noise: None,
    }
}

/// Joins both lists without repeating a gauge. An identified cause replaces the finding that a gauge deviates; of two such findings, the one with the
/// size of the deviation stays. Findings on gauges come first, because a reader can correct them.
fn merge_gauge_findings(mut tested: Vec<Finding>, mut named: Vec<Finding>) -> Vec<Finding> {
    named.retain(|n| {
        n.code != GAUGE_SUSPECT
            || !tested
                .iter()
                .any(|f| f.code == n.code && f.subject == n.subject)
    });
    tested.retain(|f| f.code != GAUGE_SUSPECT || !named.iter().any(|n| n.subject == f.subject));
    let (of_gauges, general): (Vec<Finding>, Vec<Finding>) =
        tested.into_iter().partition(|f| f.code == GAUGE_SUSPECT);
    named.extend(of_gauges);
    named.extend(general);
    named
}

/// Returns the root mean square of all residuals over the degrees of freedom, the root mean square by gauge, and the mean leverages.
fn residual_sizes(n: usize, runs: &[RunEstimate]) -> (f64, Vec<f64>, Vec<f64>) {
    let (mut sum, mut dof) = (0.0, 0);
    let mut by_gauge = vec![(0.0, 0usize); n];
    let mut leverage = vec![0.0; n];
    for r in runs {
        dof += r.dof;
        for g in 0..n {
            leverage[g] += r.leverage[g] / runs.len() as f64;
            if r.residual[g].is_finite() {
                sum += r.residual[g].powi(2);
                by_gauge[g].0 += r.residual[g].powi(2);
                by_gauge[g].1 += 1;
            }
        }
    }
    let rms = |q: f64, m: usize| if m > 0 { (q / m as f64).sqrt() } else { 0.0 };
    let gauges = by_gauge.iter().map(|(q, m)| rms(*q, *m)).collect();
    (rms(sum, dof), gauges, leverage)
}
