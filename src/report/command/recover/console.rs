//! Recovered loads on a terminal.

use super::load_comparison;
use crate::host::outcome::Outcome;
use crate::host::words::count_of;
use crate::report::console::{Console, ConsoleTable};
use crate::units::{half_width, number, plus_minus};
use crate::workflow::recover::{LoadSpan, RecoveredLoads, RecoveredRuns, States};

/// Returns a row for each run if all columns fit, or else a row for each load.
pub(super) fn console(outcome: &Outcome<RecoveredLoads>) -> Console {
    let spans = outcome.spans();
    let (n, of_what) = match &outcome.states {
        States::Runs(runs) => (runs.runs.len(), count_of(runs.runs.len(), "run")),
        States::Record(r) => (usize::MAX, count_of(r.samples as usize, "sample")),
    };
    let by_load = by_load(&spans, &of_what);
    let compact = peak_load_table(&spans, n, &of_what);
    let mut tables = match &outcome.states {
        _ if !outcome.comparison.loads.is_empty() => vec![against_recorded(outcome, &spans)],
        States::Runs(runs) if n > 1 => vec![by_run(runs, &spans)],
        _ => Vec::new(),
    };
    // With one run, smallest and largest are equal.
    if n > 1 {
        tables.push(by_load);
    }
    tables.push(compact);
    Console {
        tables,
        next: next(outcome),
        file: Some("loads.csv"),
    }
}

/// Returns a table with a row for each run and a column for each load.
fn by_run(runs: &RecoveredRuns, spans: &[LoadSpan]) -> ConsoleTable {
    let mut units: Vec<&str> = spans.iter().map(|s| s.unit.as_str()).collect();
    units.dedup();
    let is_one = units.len() == 1;
    let name = |s: &LoadSpan| match is_one || s.unit.is_empty() {
        true => s.name.clone(),
        false => format!("{}, {}", s.name, s.unit),
    };
    let head: Vec<String> = std::iter::once("run".to_owned())
        .chain(spans.iter().map(name))
        .collect();
    let n = spans.len().max(1);
    let row = |(run, loads): (&str, &[_])| {
        let cell =
            |l: &crate::workflow::recover::RecoveredLoad| plus_minus(l.value, l.half_width());
        let cells = loads.iter().map(cell);
        std::iter::once(run.to_owned()).chain(cells).collect()
    };
    let names = runs.runs.iter().map(|r| r.run.as_str());
    let unit = match units.first() {
        Some(unit) if is_one && !unit.is_empty() => format!(", {unit}"),
        _ => String::new(),
    };
    ConsoleTable {
        title: format!("Recovered loads{unit} (± half width of the 95 % interval)"),
        head,
        rows: names.zip(runs.loads.chunks(n)).map(row).collect(),
    }
}

/// Returns a table with a row for each load and its differences from the recorded load.
fn against_recorded(outcome: &Outcome<RecoveredLoads>, spans: &[LoadSpan]) -> ConsoleTable {
    let row = |s: &LoadSpan| {
        let value = format!("{} {}", plus_minus(s.peak(), s.half), s.unit);
        let cells = load_comparison::cells(&outcome.comparison, &s.name);
        [s.name.clone(), value].into_iter().chain(cells).collect()
    };
    let head = [
        "load",
        "largest",
        "bias",
        "rms",
        "within 95 %",
        "damage ratio",
    ];
    ConsoleTable::new(
        "Recovered loads (± half width of the 95 % interval), and their differences from recorded ones",
        &head,
        spans.iter().map(row).collect(),
    )
}

/// A row a load: smallest, mean and largest of all runs or samples.
fn by_load(spans: &[LoadSpan], of_what: &str) -> ConsoleTable {
    let row = |s: &LoadSpan| {
        let [smallest, mean, largest] = [s.smallest, s.mean, s.largest].map(number);
        let half = half_width(s.half);
        vec![
            s.name.clone(),
            smallest,
            mean,
            largest,
            half,
            s.unit.clone(),
        ]
    };
    ConsoleTable::new(
        format!("Recovered loads of {of_what} (± half width of the 95 % interval, the widest)"),
        &["load", "smallest", "mean", "largest", "± 95 %", "unit"],
        spans.iter().map(row).collect(),
    )
}

/// A row a load with one value.
fn peak_load_table(spans: &[LoadSpan], n: usize, of_what: &str) -> ConsoleTable {
    let row = |s: &LoadSpan| {
        let value = plus_minus(s.peak(), s.half);
        vec![s.name.clone(), format!("{value} {}", s.unit)]
    };
    let which = match n {
        1 => String::new(),
        _ => format!(", the largest by magnitude of {of_what}"),
    };
    ConsoleTable::new(
        format!("Recovered loads{which} (± half width of the 95 % interval)"),
        &["load", "value"],
        spans.iter().map(row).collect(),
    )
}

/// Stress follows from loads where there is a model.
fn next(outcome: &Outcome<RecoveredLoads>) -> Option<String> {
    let job = &outcome.job;
    job.model.as_ref()?;
    Some(format!(
        "run `strainbridge respond {}` for stress",
        job.file
    ))
}
