//! Whole calibration: one fit of all runs, runs left out, exclusion of contradicting runs, and findings.

use super::common_zero::{add_zero_column, remove_zero_column, zero_of};
use super::label_exchange::LabelExchange;
use super::state::State;
use super::types::{CalibratedRange, Calibration, CommonZero, Coverage, LeftOut, ModelError, Task};
use super::{
    excluded_runs, held_out, identical_columns, installed_position, known_load_faults,
    label_exchange, lack_of_fit, runs, shift, undetermined_combinations,
};
use crate::finding::{Finding, Severity};

/// Largest share of the runs that may be refused. If more contradict each other, the runs are not the cause.
const MOST_REFUSED: f64 = 0.25;

/// Computes S from runs with known loads.
///
/// # Errors
/// A sentence if there are no runs, or if numbers are not finite.
pub fn calibrate(task: &Task) -> Result<Calibration, String> {
    let readings = task
        .runs
        .iter()
        .flat_map(|r| &r.strain)
        .filter(|v| v.is_finite());
    if task.gauges.is_empty() || task.loads.is_empty() || readings.clone().count() == 0 {
        return Err("there is no run with known loads and strain".to_owned());
    }
    if readings.clone().all(|v| *v == 0.0) {
        return Err("the strain of all runs of known load is zero".to_owned());
    }
    match task.common_zero {
        CommonZero::Sought => {
            let found = calibrate_columns(&add_zero_column(task))?;
            Ok(remove_zero_column(found, task.loads.len()))
        }
        CommonZero::None | CommonZero::Column => calibrate_columns(task),
    }
}

/// Calibrates with the common zero as one more column, if the task asks for it.
fn calibrate_columns(task: &Task) -> Result<Calibration, String> {
    let mut fitted = ConsistentFit::from_task(task, &[])?;
    let mut shifts = shift::check(task, &fitted.state);
    // Too few runs let a wrong gauge look like an error of all rows or of some runs.
    let hidden = known_load_faults::hidden_gauge_faults(task, &shifts, !fitted.refused.is_empty());
    let changed = known_load_faults::with_prior_of_faults(task, &hidden);
    let (stated, task) = (task, changed.as_ref().unwrap_or(task));
    if !hidden.is_empty() {
        fitted = ConsistentFit::from_task(task, &[])?;
        shifts = shift::check(task, &fitted.state);
        known_load_faults::add_faults(&mut shifts, stated, &hidden);
    }
    let mut wrongly_wired = shift::wrongly_wired(&shifts);
    if task.model.is_some() && !wrongly_wired.is_empty() {
        // A gauge with reversed polarity contains no information on the error of the model.
        fitted = ConsistentFit::from_task(task, &wrongly_wired)?;
        shifts = shift::check(task, &fitted.state);
        known_load_faults::add_faults(&mut shifts, stated, &hidden);
        wrongly_wired = shift::wrongly_wired(&shifts);
    }
    let ConsistentFit {
        mut state,
        mut left_out,
        refused,
        exchanged,
    } = fitted;
    let lack = lack_of_fit::check(task, &state);
    if !lack.covariance.is_empty() {
        state.lack = lack.covariance;
        left_out = held_out::leave_out(task, &state);
    }
    let coverage_test = held_out::test_coverage(&left_out, state.scatter.dof);
    let mut sensitivity = state.sensitivity(task, coverage_test.factor);
    if let Some(uncertainty) = &mut sensitivity.uncertainty {
        uncertainty.is_tested = !left_out.is_empty();
        uncertainty.add_common_scale(&sensitivity.values, task.scale_sd);
    }
    let undetermined = undetermined_combinations::check(task, &state);
    let model_error = state.error_evidence.as_ref();
    let model_error = model_error.map(|e| e.most_probable(&wrongly_wired));
    let mut findings: Vec<Finding> = exchanged
        .iter()
        .map(|e| label_exchange::finding(task, e))
        .collect();
    findings.extend(runs::findings(task, &left_out, &refused));
    findings.extend(lack.findings);
    findings.extend(identical_columns::findings(task));
    let gone = exchanged.iter().filter(|e| e.certain).count() + refused.len();
    let suspect = held_out::suspects(&left_out).len();
    findings.extend(excluded_runs::too_many(gone + suspect, task.runs.len()));
    findings.extend(excluded_runs::held_too_few(&coverage_test));
    findings.extend(statements(
        task,
        &state,
        model_error,
        &coverage_test,
        &left_out,
    ));
    findings.extend(undetermined_combinations::findings(task, &undetermined));
    if undetermined.is_empty() || task.model.is_some() {
        findings.extend(undetermined_combinations::too_wide(
            task,
            &state,
            &sensitivity,
        ));
    }
    // If the known loads have a wrong unit or sign, every gauge is far from the model for that reason.
    let wrong_loads = known_load_faults::wrong_loads(task, &state.used, wrongly_wired);
    if wrong_loads.is_empty() {
        findings.extend(shift::findings(task, &shifts));
        findings.extend(known_load_faults::wrong_gauges(task, &state.used, &shifts));
    }
    findings.extend(wrong_loads);
    let signal = state.lefts.iter().map(|l| l.q2).sum::<f64>() / state.lefts.len().max(1) as f64;
    Ok(Calibration {
        sensitivity,
        common_zero: match task.is_extended() {
            true => zero_of(task, &state.posterior),
            false => Vec::new(),
        },
        lack_of_fit: lack.answer,
        range: CalibratedRange::from_runs(task, &state.used, &zero_of(task, &state.posterior)),
        model_error,
        shifts,
        as_glued: installed_position::estimate_installed_positions(task, &state, model_error),
        repeat_scatter_rel: state.scatter.dof.is_finite().then(|| state.scatter.rms()),
        noise_rel: task.noise / signal.sqrt(),
        left_out,
        coverage: coverage_test,
        refused: {
            let certain = exchanged.iter().filter(|e| e.certain);
            let labels = certain.flat_map(|e| e.runs);
            refused.iter().map(|r| r.0).chain(labels).collect()
        },
        undetermined,
        findings,
    })
}

/// A fit of the runs that do not contradict each other.
struct ConsistentFit {
    state: State,
    left_out: Vec<LeftOut>,
    /// Runs that contradict the other runs and are not used, with their numbers.
    refused: Vec<(usize, LeftOut)>,
    /// Pairs of runs with exchanged labels. They are not used if the exchange is certain.
    exchanged: Vec<LabelExchange>,
}

impl ConsistentFit {
    /// Refuses contradicting runs one after the other; see [`State::fit_runs`] on `wrongly_wired`.
    fn from_task(task: &Task, wrongly_wired: &[usize]) -> Result<Self, String> {
        let mut used: Vec<usize> = (0..task.runs.len()).collect();
        let most = (MOST_REFUSED * used.len() as f64).floor() as usize;
        let mut refused: Vec<(usize, LeftOut)> = Vec::new();
        let mut exchanged: Vec<LabelExchange> = Vec::new();
        loop {
            let state = State::fit_runs(task, &used, wrongly_wired)
                .ok_or("S cannot be computed: the runs give hardly any information on some gauge (is it blank in the runs of known loads?), or contain values that are not numbers")?;
            let known = exchanged.last().is_none_or(|e| e.certain);
            let pair = label_exchange::find(task, &state).filter(|_| known);
            if let Some(pair) = pair {
                let gone = refused.len() + 2 * exchanged.len() + 2;
                let takes = pair.certain && gone <= most.max(2);
                if takes {
                    used.retain(|r| !pair.runs.contains(r));
                }
                exchanged.push(LabelExchange {
                    certain: takes,
                    ..pair
                });
                if takes {
                    continue;
                }
            }
            let left_out = held_out::leave_out(task, &state);
            match held_out::find_contradicting_run(&left_out).filter(|_| refused.len() < most) {
                Some(run) => {
                    used.retain(|r| *r != run);
                    let out = left_out.into_iter().find(|l| l.number == run);
                    refused.extend(out.map(|out| (run, out)));
                }
                None => {
                    return Ok(Self {
                        state,
                        left_out,
                        refused,
                        exchanged,
                    });
                }
            }
        }
    }
}

/// Sentences on scatter, coverage and the model's error.
fn statements(
    task: &Task,
    state: &State,
    model_error: Option<ModelError>,
    coverage: &Coverage,
    left_out: &[LeftOut],
) -> Vec<Finding> {
    let mut out = Vec::new();
    let signal =
        (state.lefts.iter().map(|l| l.q2).sum::<f64>() / state.lefts.len().max(1) as f64).sqrt();
    let noise = 100.0 * task.noise / signal;
    if state.scatter.dof.is_finite() {
        let scatter = 100.0 * state.scatter.rms();
        let runs = match repeats(task, &state.used) {
            true => "runs with the same loads scatter",
            false => {
                "the strain of the runs scatters about the strain predicted from their known loads"
            }
        };
        let common = match state.scatter.common {
            0.0 => String::new(),
            c => format!(
                " ({:.0} % of the squared scatter is common to repeats, which therefore give less information)",
                100.0 * c
            ),
        };
        let message = format!(
            "{runs} by {scatter:.1} % of the strain{common}, and noise explains {noise:.2} %: intervals come from the scatter. In the \
             leave-one-out test {} of {} runs are within their intervals, with intervals {:.2} times as wide as the scatter alone gives",
            coverage.held, coverage.of, coverage.factor
        );
        let (severity, remedy) = if state.scatter.rms() > NO_CALIBRATION {
            (
                Severity::Error,
                "check the unit of the known loads ([runs] units), their signs, and the zero: the residual is larger than the strain",
            )
        } else {
            (Severity::Info, "")
        };
        out.push(
            Finding::new(severity, "repeat-scatter", "calibration", message, remedy)
                .with_numbers(scatter / 100.0, noise / 100.0),
        );
    } else if !left_out.is_empty() {
        let message = format!(
            "noise of {noise:.2} % of the strain explains the residuals of the runs. In the leave-one-out test {} of {} runs are within \
             their intervals, factor {:.2}",
            coverage.held, coverage.of, coverage.factor
        );
        out.push(Finding::new(
            Severity::Info,
            "repeat-scatter",
            "calibration",
            message,
            "",
        ));
    }
    if left_out.is_empty() {
        out.push(Finding::new(
            Severity::Error,
            "coverage-not-tested",
            "calibration",
            "no run can be left out, because each one is needed to determine S. The scatter of the runs is unknown, and the intervals do \
             not include it",
            "add runs; repeats of one loading cost least",
        ));
    }
    if let (Some(model), Some(e)) = (&task.model, model_error) {
        let message = format!(
            "the rows of the model deviate by {:.1} % common to a gauge and {:.1} % entry by entry; stated: {:.1} %",
            100.0 * e.common,
            100.0 * e.entry,
            100.0 * model.uncertainty_rel
        );
        let worst = e.common.max(e.entry);
        let far = worst > BEYOND_STATED * model.uncertainty_rel;
        let (severity, remedy) = if far {
            (
                Severity::Warning,
                "check for a wrong unit, `applied`, gauge position or load before you use the calibrated S",
            )
        } else {
            (Severity::Info, "")
        };
        out.push(
            Finding::new(severity, "model-error-estimated", "model", message, remedy)
                .with_numbers(worst, model.uncertainty_rel),
        );
    }
    out
}

/// Ratio of scatter to strain above which S does not explain the runs: S = 0 would leave smaller residuals.
const NO_CALIBRATION: f64 = 1.0;

/// Returns whether some runs contain a loading twice.
fn repeats(task: &Task, used: &[usize]) -> bool {
    let group = |r: &usize| task.runs.get(*r).map(|run| run.group);
    let groups: Vec<usize> = used.iter().filter_map(group).collect();
    (1..groups.len()).any(|i| groups[..i].contains(&groups[i]))
}

/// Ratio of estimated to stated model error above which something else is wrong.
const BEYOND_STATED: f64 = 3.0;
