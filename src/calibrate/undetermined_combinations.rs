//! Combinations of loads that no run has shown: known from the model only, or not at all.

use super::common_zero::{less_zero, zero_of};
use super::start::is_known;
use super::state::State;
use super::types::{KnownRun, Task, UndeterminedCombination};
use super::unknown_directions::UnknownDirections;
use crate::estimate::LoadEstimate;
use crate::finding::{Finding, Severity, list_few};
use crate::linalg::spd;
use crate::recovery::{ErrorModel, Readings, estimate};
use crate::sensitivity::Sensitivity;

/// Share of a load in a combination from which it is named.
const NAMED: f64 = 0.1;

/// Returns the directions of the loads, in units of their sizes, along which no run has a known load.
pub(super) fn check(task: &Task, state: &State) -> Vec<UndeterminedCombination> {
    let runs: Vec<&KnownRun> = (state.used.iter())
        .filter_map(|r| task.runs.get(*r))
        .collect();
    let directions = UnknownDirections::from_runs(&runs, &state.scales).undetermined;
    let one = |z: &Vec<f64>| {
        let terms: Vec<f64> = z.iter().zip(&state.scales).map(|(v, c)| v * c).collect();
        let top = terms
            .iter()
            .copied()
            .fold(0.0_f64, |a, v| if v.abs() > a.abs() { v } else { a });
        UndeterminedCombination {
            terms: terms.iter().map(|v| v / top).collect(),
        }
    };
    directions.iter().map(one).collect()
}

/// Lists the task's sums of loads that no undetermined combination changes.
fn known_sums(task: &Task, all: &[UndeterminedCombination]) -> String {
    let is_known = |terms: &&Vec<f64>| {
        let size = |a: &[f64]| spd::dot(a, a).sqrt();
        let alone = |u: &UndeterminedCombination| {
            let along = spd::dot(terms, &u.terms).abs();
            along < UNCHANGED * size(terms) * size(&u.terms)
        };
        size(terms) > 0.0 && all.iter().all(alone)
    };
    let known = task.sums.iter().filter(is_known);
    let words: Vec<String> = known.map(|terms| combination(task, terms)).collect();
    match words.is_empty() {
        true => String::new(),
        false => format!(". The runs determine these sums: {}", words.join("; ")),
    }
}

/// Cosine under which a combination does not change a sum.
const UNCHANGED: f64 = 1e-6;

/// Returns a combination as text, such as `LF.FZ - 0.5 RF.FZ`; all loads if the shares are not numbers.
fn combination(task: &Task, terms: &[f64]) -> String {
    let mut out = String::new();
    for (load, t) in task
        .loads
        .iter()
        .zip(terms)
        .filter(|(_, t)| t.abs() >= NAMED)
    {
        let sign = match (out.is_empty(), *t < 0.0) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        let size = if (t.abs() - 1.0).abs() < 5e-3 {
            String::new()
        } else {
            format!("{:.2} ", t.abs())
        };
        out.push_str(&format!("{sign}{size}{}", load.name));
    }
    if out.is_empty() {
        let names: Vec<&str> = task.loads.iter().map(|l| l.name.as_str()).collect();
        out = names.join(", ");
    }
    out
}

/// Returns a finding on undetermined combinations: an error without a model, information with a model.
pub(super) fn findings(task: &Task, all: &[UndeterminedCombination]) -> Vec<Finding> {
    if all.is_empty() {
        return Vec::new();
    }
    let list: Vec<String> = all.iter().map(|u| combination(task, &u.terms)).collect();
    let finding = if task.model.is_some() {
        Finding::new(
            Severity::Info,
            "loads-from-model-only",
            list.join("; "),
            format!(
                "no run determines these combinations of loads: {}. They are known from the model only",
                list.join("; ")
            ),
            "apply one of these loads alone, if it matters",
        )
    } else {
        Finding::new(
            Severity::Error,
            "calibration-not-determined",
            list.join("; "),
            format!(
                "the runs do not determine S: no run contains information on {}, and there is no model{}",
                list.join("; "),
                known_sums(task, all)
            ),
            "add runs in which each of these loads acts alone, give a [model], or drop loads",
        )
    };
    vec![finding.with_numbers(all.len() as f64, 0.0)]
}

/// Half width of the 95 % interval over the largest load of the kind, from which a load counts as undetermined, as in
/// `crate::recovery::determined`.
const WIDE: f64 = 0.5;
/// Degrees of freedom of the scatter above which runs count as many. Student's factor is then less than a third above the factor of a normal
/// distribution.
const ENOUGH: f64 = 5.0;

/// Returns a finding on loads that S does not determine: in half of the runs or more, the half width of the interval exceeds [`WIDE`]. The number of
/// runs alone would be sufficient for S. With one run of known loads and many runs with a known sum, this single run decides by chance how the sum is
/// shared.
///
/// The finding is an error if only a sum is known for some runs, or if a load is undetermined. It is also an error if there are many runs, no model,
/// and a half width larger than the load: the runs do not fit their loads. With few runs of known loads it is a warning, because repeats would narrow
/// the intervals. With a model it is also a warning, because some gauges then have little strain under a load.
pub(super) fn too_wide(task: &Task, state: &State, s: &Sensitivity) -> Option<Finding> {
    let errors = ErrorModel {
        noise: task.noise,
        model_rel: 0.0,
    };
    let used: Vec<&KnownRun> = (state.used.iter())
        .filter_map(|r| task.runs.get(*r))
        .collect();
    let zero = zero_of(task, &state.posterior);
    let recovered = used.iter().map(|run| {
        let readings = Readings {
            run: run.run.clone(),
            strain: less_zero(&run.strain, &zero),
            noise_factor: run.noise_factor,
        };
        estimate(s, &readings, errors)
    });
    let k = s.loads.len();
    let (determined, undetermined_runs): (Vec<_>, Vec<_>) = recovered.partition(|r| r.rank == k);
    let unsolved = undetermined_runs.len();
    let determined: Vec<&LoadEstimate> = determined.iter().map(|r| &r.estimate).collect();
    let width = |l: usize| -> f64 {
        let kind = task.loads[l].quantity;
        let alike = (0..k).filter(|m| task.loads[*m].wanted && task.loads[*m].quantity == kind);
        let most = alike
            .clone()
            .flat_map(|m| used.iter().map(move |r| r.loads.mean[m].abs()));
        let most = most.fold(0.0, f64::max);
        let half = |e: &&LoadEstimate| {
            let [low, high] = e.interval(l);
            (high - low) / 2.0
        };
        let mut all: Vec<f64> = (determined.iter())
            .map(|e| half(e) / most)
            .chain(std::iter::repeat_n(f64::INFINITY, unsolved))
            .collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied().unwrap_or(0.0)
    };
    let wanted = (0..k).filter(|l| task.loads[*l].wanted);
    let wide: Vec<(usize, f64)> = wanted
        .map(|l| (l, width(l)))
        .filter(|w| w.1 > WIDE)
        .collect();
    let worst = wide.iter().map(|w| w.1).max_by(f64::total_cmp)?;
    let shared = used.iter().any(|r| !is_known(r, &state.scales));
    let contradicts = task.model.is_none() && worst > 1.0 && state.scatter.dof > ENOUGH;
    let error = shared || contradicts || !worst.is_finite();
    let names: Vec<&str> = (wide.iter())
        .map(|w| task.loads[w.0].name.as_str())
        .collect();
    let each: Vec<String> = (wide.iter())
        .map(|(l, w)| match w.is_finite() {
            true => format!("{} to {:.0} %", task.loads[*l].name, 100.0 * w),
            false => format!("{} not at all", task.loads[*l].name),
        })
        .collect();
    let why = match shared {
        true => "; most runs state a sum of loads, and few runs determine the share of each load",
        false => "",
    };
    let finding = Finding::new(
        if error {
            Severity::Error
        } else {
            Severity::Warning
        },
        "loads-not-determined",
        list_few(&names),
        format!(
            "with this S the gauges do not determine these loads. The half width of the 95 % interval in percent of the largest load is: {}{why}{}",
            each.join("; "),
            describe_determined_sums(task, &determined)
        ),
        "add runs in which each of these loads acts alone, repeats, or gauges at places where they differ; or use combinations of loads only",
    );
    Some(finding.with_numbers(worst, WIDE))
}

/// Returns, as text, the task's sums of loads that are determined better than [`WIDE`] in half of the runs.
fn describe_determined_sums(task: &Task, runs: &[&LoadEstimate]) -> String {
    let k = task.own_loads();
    let width = |terms: &[f64]| -> f64 {
        let terms = &terms[..k];
        let one = |e: &&LoadEstimate| {
            let entry = |i: usize| terms[i / k] * terms[i % k] * e.covariance[(i / k) * k + i % k];
            let variance: f64 = (0..k * k).map(entry).sum();
            e.coverage_factor * variance.sqrt() / spd::dot(terms, &e.values).abs()
        };
        let mut all: Vec<f64> = runs.iter().map(one).collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied().unwrap_or(f64::INFINITY)
    };
    let known: Vec<String> = (task.sums.iter())
        .map(|terms| (terms, width(terms)))
        .filter(|(_, w)| *w < WIDE)
        .map(|(terms, w)| format!("{} to {:.0} %", combination(task, terms), 100.0 * w))
        .collect();
    match known.is_empty() {
        true => String::new(),
        false => format!(". The runs determine these sums: {}", known.join("; ")),
    }
}
