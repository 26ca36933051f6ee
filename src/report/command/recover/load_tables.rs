//! Recovered loads on the first screen of a page, and by run below it.

use super::load_comparison;
use crate::host::outcome::Outcome;
use crate::report::console::ConsoleTable;
use crate::report::page::KeyNumber;
use crate::units::{half_width, number, percent, plus_minus};
use crate::workflow::recover::{LoadSpan, RecoveredLoad, RecoveredLoads, RecoveredRuns, States};

/// Returns the key numbers: the largest load, the residual, the number of gauges and the least certain load.
pub(super) fn key_numbers(outcome: &Outcome<RecoveredLoads>) -> Vec<KeyNumber> {
    let spans = outcome.spans();
    let known = || spans.iter().filter(|s| s.share().is_finite());
    let mut numbers = Vec::new();
    let size = |s: &LoadSpan| s.peak().abs() / s.size;
    let largest = known().max_by(|a, b| size(a).total_cmp(&size(b)));
    numbers.extend(largest.map(|s| {
        // Each run has a separate interval.
        let of_runs = outcome.runs().map_or(&[][..], |r| &r.loads);
        let of_load = of_runs
            .iter()
            .filter(|l| l.name == s.name && l.value.is_finite());
        let run = of_load.max_by(|a, b| a.value.abs().total_cmp(&b.value.abs()));
        let half = run.map_or(s.half, RecoveredLoad::half_width);
        let at = run.map_or_else(String::new, |r| format!(", run {}", r.run));
        let value = format!("{} {}", plus_minus(s.peak(), half), s.unit);
        let meaning = format!("largest load relative to its typical size: {}{at}", s.name);
        KeyNumber::new(value, meaning)
    }));
    let residual = |rms: f64, more: String| {
        let value = format!("{} µε", number(rms));
        KeyNumber::new(value, format!("residual of the gauges, rms{more}"))
    };
    let (gauges, of_what) = match &outcome.states {
        States::Runs(runs) => {
            numbers.push(residual(
                runs.residual_rms_microstrain,
                format_expected_residual(runs),
            ));
            (&runs.gauges, format!("{}", runs.runs.len()))
        }
        States::Record(record) => {
            let rms = record.residual_rms_microstrain;
            numbers.push(residual(rms, String::new()));
            let seconds = number(record.duration_s);
            (&record.gauges, format!("{seconds} s"))
        }
    };
    let used = gauges.iter().filter(|g| g.leverage > 0.0).count();
    numbers.push(KeyNumber::new(
        format!("{used} of {}", gauges.len()),
        "gauges used",
    ));
    let meaning = match &outcome.states {
        States::Runs(_) => "runs".to_owned(),
        States::Record(r) => format!("of record, {} samples", r.samples),
    };
    numbers.push(KeyNumber::new(of_what, meaning));
    let widest = known().max_by(|a, b| a.share().total_cmp(&b.share()));
    numbers.extend(widest.map(|s| {
        let share = percent(s.share());
        let meaning = format!("least certain: {}, {share} of its typical size", s.name);
        KeyNumber::new(format!("{} {}", half_width(s.half), s.unit), meaning)
    }));
    numbers
}

/// Formats the expected residual.
fn format_expected_residual(runs: &RecoveredRuns) -> String {
    let chi2: f64 = runs.runs.iter().map(|r| r.chi2).sum();
    let dof: usize = runs.runs.iter().map(|r| r.degrees_of_freedom).sum();
    match dof {
        0 => String::new(),
        n => {
            let times = (chi2 / n as f64).sqrt();
            let expected = runs.residual_rms_microstrain / times;
            match expected.is_finite() {
                true => format!(", expected {}", number(expected)),
                false => String::new(),
            }
        }
    }
}

/// Returns a table with a row for each load: the largest value by magnitude with its interval, and its share of the typical size.
pub(super) fn result_table(outcome: &Outcome<RecoveredLoads>) -> ConsoleTable {
    let spans = outcome.spans();
    if !outcome.comparison.loads.is_empty() {
        let row = |s: &LoadSpan| {
            let value = format!("{} {}", plus_minus(s.peak(), s.half), s.unit);
            let cells = load_comparison::cells(&outcome.comparison, &s.name);
            let cells = cells.into_iter().take(3);
            [s.name.clone(), value].into_iter().chain(cells).collect()
        };
        let title = "Largest load by magnitude ± half width of the 95 % interval, and its difference from the recorded one";
        let head = ["load", "largest", "bias", "rms", "within 95 %"];
        return ConsoleTable::new(title, &head, spans.iter().map(row).collect());
    }
    match &outcome.states {
        States::Runs(runs) => largest_of_runs(runs, &spans),
        States::Record(_) => of_record(&spans),
    }
}

fn largest_of_runs(runs: &RecoveredRuns, spans: &[LoadSpan]) -> ConsoleTable {
    let is_one = runs.runs.len() == 1;
    let row = |(l, span): (usize, &LoadSpan)| {
        let of_load = runs.loads.iter().skip(l).step_by(spans.len().max(1));
        let of_load = of_load.filter(|r| r.value.is_finite());
        let largest = of_load.max_by(|a, b| a.value.abs().total_cmp(&b.value.abs()));
        let mut row = vec![with_unit(&span.name, &span.unit)];
        row.extend(match largest {
            Some(r) => interval_cells(r, span.size),
            None => ["-"; 4].map(str::to_owned),
        });
        if !is_one {
            row.push(largest.map_or_else(String::new, |r| r.run.clone()));
        }
        row
    };
    let mut head = INTERVAL.to_vec();
    let title = match (is_one, runs.runs.first()) {
        (true, Some(run)) => format!("Loads of run {} with 95 % intervals", run.run),
        _ => {
            head.push("run");
            "Largest value of each load with its 95 % interval".to_owned()
        }
    };
    ConsoleTable::new(title, &head, spans.iter().enumerate().map(row).collect())
}

/// Columns of a load with its interval.
const INTERVAL: [&str; 5] = ["load", "low", "value", "high", "± of typical size"];

/// Low, value, high, share of the typical size.
fn interval_cells(r: &RecoveredLoad, size: f64) -> [String; 4] {
    let share = percent(r.half_width() / size);
    [number(r.low), number(r.value), number(r.high), share]
}

fn with_unit(name: &str, unit: &str) -> String {
    match unit {
        "" => name.to_owned(),
        unit => format!("{name}, {unit}"),
    }
}

fn of_record(spans: &[LoadSpan]) -> ConsoleTable {
    let row = |s: &LoadSpan| {
        let [smallest, mean, largest] = [s.smallest, s.mean, s.largest].map(number);
        let share = percent(s.share());
        let name = with_unit(&s.name, &s.unit);
        vec![name, smallest, mean, largest, half_width(s.half), share]
    };
    let head = [
        "load",
        "smallest",
        "mean",
        "largest",
        "± 95 %",
        "± of typical size",
    ];
    let title = "Loads of the record; ±: half width of the 95 % interval of a sample";
    ConsoleTable::new(title, &head, spans.iter().map(row).collect())
}

/// Runs whose loads are in a table of the page; all are in `loads.csv`.
const MOST_ROWS: usize = 600;

/// Returns a row for each run and load, for the table next to the figure, and whether some are left out.
pub(super) fn by_run(
    outcome: &Outcome<RecoveredLoads>,
    runs: &RecoveredRuns,
) -> (Vec<Vec<String>>, bool) {
    let spans = outcome.spans();
    let of_load = spans.iter().cycle();
    let row = |(r, span): (&RecoveredLoad, &LoadSpan)| {
        let mut row = vec![r.run.clone(), with_unit(&r.name, &r.unit)];
        row.extend(interval_cells(r, span.size));
        row
    };
    let whole_runs = MOST_ROWS / spans.len().max(1) * spans.len().max(1);
    let rows = runs.loads.iter().zip(of_load).take(whole_runs).map(row);
    (rows.collect(), runs.loads.len() > whole_runs)
}
