//! The figure of damage by vehicle on the report of `fleet`.

use crate::finding::{Finding, Severity};
use crate::host::outcome::Outcome;
use crate::report::figure::{Ends, IntervalRow, MOST_RATIO, interval_trace, intervals};
use crate::report::page::{Section, figure_section};
use crate::workflow::fleet::{Fleet, VehicleAnswer, VehicleLoadAnswer};
use serde_json::{Value, json};

/// Rows of the figure for one choice, the largest.
const MOST_ROWS: usize = 24;

/// Returns a section with the damage per hour of each vehicle, the largest first: all loads relative to the mean of the fleet, then each load in its
/// unit. `None` without vehicles.
pub(super) fn damage_section(o: &Outcome<Fleet>) -> Option<Section> {
    let per_hour = |l: &VehicleLoadAnswer, scale: f64| {
        [l.damage_low, l.damage, l.damage_high].map(|d| d * scale)
    };
    let against_mean = |(v, l): (&VehicleAnswer, &VehicleLoadAnswer)| {
        let name = format!("{} {}", v.name, l.load);
        (v.name.clone(), name, per_hour(l, l.relative / l.damage))
    };
    let all: Vec<Row> = o.rows().map(against_mean).collect();
    let n = all.len();
    let mut choices = vec![("all loads, mean of the fleet = 1".to_owned(), all)];
    for (v, l) in o.rows() {
        let row = (v.name.clone(), v.name.clone(), per_hour(l, 1.0 / l.hours));
        let title = format!("{}, ({})^{} an hour", l.load, l.unit, o.slope);
        match choices.iter_mut().find(|c| c.0 == title) {
            Some(choice) => choice.1.push(row),
            None => choices.push((title, vec![row])),
        }
    }
    let mut figure = intervals(
        &[],
        "damage an hour",
        Ends::Interval,
        "Damage per hour of each vehicle with its 95 % interval, the largest first: smaller is better. Red: a finding names the vehicle or one of its records.",
    );
    for (_, rows) in &mut choices {
        sort(rows);
        rows.truncate(MOST_ROWS);
    }
    figure.height = 110 + 24 * choices.iter().map(|c| c.1.len()).max()?;
    let known = choices.iter().flat_map(|c| &c.1).flat_map(|r| r.2);
    let known: Vec<f64> = known.collect();
    let is_wide = choices.iter().any(|(_, rows)| {
        let sizes = || rows.iter().map(|r| r.2[1]);
        sizes().fold(0.0, f64::max) > MOST_RATIO * sizes().fold(f64::INFINITY, f64::min)
    });
    if is_wide && known.iter().all(|v| *v > 0.0) {
        figure.layout["xaxis"]["type"] = json!("log");
    }
    let with_findings = o.vehicles.iter().filter(|v| has_finding(v, o));
    let found: Vec<&str> = with_findings.map(|v| v.name.as_str()).collect();
    figure.choices = choices
        .into_iter()
        .map(|(name, rows)| (name, mark_found_vehicles(&rows, &found)))
        .collect();
    let note = match n > MOST_ROWS {
        true => format!("The {MOST_ROWS} largest of {n}; all are in fleet.csv."),
        false => String::new(),
    };
    (n > 0).then(|| figure_section("Damage by vehicle", figure, &note))
}

/// Vehicle, name of a row, low, value and high.
type Row = (String, String, [f64; 3]);

fn sort(rows: &mut [Row]) {
    rows.sort_by(|a, b| b.2[1].total_cmp(&a.2[1]));
}

/// Returns the rows in their order. Rows of the vehicles in `found` have a separate trace.
fn mark_found_vehicles(rows: &[Row], found: &[&str]) -> Vec<Value> {
    let trace = |is_found: bool, name: &str| {
        let of_kind = rows
            .iter()
            .filter(|r| found.contains(&r.0.as_str()) == is_found);
        let of_kind: Vec<IntervalRow> = of_kind.map(|r| (r.1.clone(), r.2)).collect();
        let mut trace = interval_trace(&of_kind, "an hour", Ends::Interval);
        if !found.is_empty() {
            trace["name"] = json!(name);
        }
        (!of_kind.is_empty()).then_some(trace)
    };
    // A trace without values sets the order of the names.
    let order: Vec<IntervalRow> = rows.iter().map(|r| (r.1.clone(), [f64::NAN; 3])).collect();
    let mut traces = vec![interval_trace(&order, "", Ends::Interval)];
    traces.extend(trace(false, "no finding"));
    traces.extend(trace(true, "with a finding").map(|mut t| {
        t["marker"] = json!({ "size": 11, "color": "#c0392b", "symbol": "diamond-open" });
        t
    }));
    traces
}

/// Returns whether a warning or an error names the vehicle or one of its records, or its damage is unreliable.
fn has_finding(v: &VehicleAnswer, o: &Outcome<Fleet>) -> bool {
    let names = |f: &Finding| {
        f.subject.split(", ").any(|s| {
            s.split(' ').next() == Some(v.name.as_str())
                || v.records.iter().any(|r| s.contains(r.path.as_str()))
        })
    };
    let serious = o.findings.iter().filter(|f| f.severity != Severity::Info);
    !v.doubtful_days.is_empty() || serious.into_iter().any(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vehicles_with_findings_are_red_and_all_keep_their_order() {
        let row = |name: &str, damage: f64| {
            let ends = [0.9 * damage, damage, 1.1 * damage];
            (name.to_owned(), format!("{name} FZ"), ends)
        };
        let mut rows = [row("A", 1.0), row("B", 3.0), row("C", 2.0)];
        sort(&mut rows);
        let traces = mark_found_vehicles(&rows, &["B"]);
        assert_eq!(traces[0]["y"], json!(["B FZ", "C FZ", "A FZ"]));
        assert_eq!(traces[1]["y"], json!(["C FZ", "A FZ"]));
        assert_eq!(traces[2]["y"], json!(["B FZ"]));
        assert_eq!(traces[2]["marker"]["color"], "#c0392b");
        assert_eq!(traces[2]["name"], "with a finding");
        // Without findings, the legend needs no names.
        assert_eq!(mark_found_vehicles(&rows, &[]).len(), 2);
        assert!(mark_found_vehicles(&rows, &[])[1]["name"].is_null());
    }
}
