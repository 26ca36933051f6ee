//! Static states: `loads.csv`, `loads.xlsx`, the page, `loads.bdf`, `loads.vtu`.

use super::columns::{by_gauge, columns, columns_with_units};
use super::load_tables::by_run;
use super::{nastran, vtu};
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::job::LoadFile;
use crate::recovery::RunEstimate;
use crate::report::command::{write_book, write_page};
use crate::report::csv_cell;
use crate::report::figure::GaugePoints;
use crate::report::page::{Page, number};
use crate::report::scene::{LoadRange, PickTargets, run_arrows, scene_of_job};
use crate::report::spreadsheet::{residual_sheet, runs_sheet};
use crate::report::strain::{RecoveredRun, RecoveryPage as OnPage, recover_page};
use crate::units::MICROSTRAIN;
use crate::workflow::recover::{RecoveredLoads, RecoveredRuns};
use std::io::Write;

/// Writes everything.
///
/// # Errors
/// The first file that can't be written.
pub(super) fn write(
    out: &mut Output,
    outcome: &Outcome<RecoveredLoads>,
    runs: &RecoveredRuns,
) -> Result<(), Faults> {
    let job = &outcome.job;
    let columns = columns_with_units(["run", ""], &runs.names, &runs.units);
    out.declare("loads.csv", columns);
    out.write("loads.csv", |w| loads_csv(w, runs))?;
    let files = &job.recover.files;
    if files
        .as_ref()
        .is_none_or(|f| f.contains(&LoadFile::Nastran))
    {
        nastran::write_runs(out, outcome, runs)?;
    }
    vtu::write(out, outcome, runs)?;
    let shown = shown_runs(runs);
    write_page(out, outcome)?;
    let sheets = [runs_sheet(&shown), residual_sheet(&by_gauge(&runs.gauges))];
    write_book(out, outcome, job, "loads.xlsx", &sheets)
}

fn loads_csv(w: &mut dyn Write, runs: &RecoveredRuns) -> std::io::Result<()> {
    let names: Vec<String> = columns("run", &runs.names);
    let names: Vec<_> = names.iter().map(|n| csv_cell(n)).collect();
    writeln!(w, "{}", names.join(","))?;
    for r in &runs.recovery.runs {
        write!(w, "{}", csv_cell(&r.estimate.run))?;
        for (l, u) in runs.units.iter().enumerate() {
            let [low, high] = r.estimate.interval(l);
            for v in [r.estimate.values[l], low, high] {
                let v = v * u.factor;
                if v.is_finite() {
                    write!(w, ",{v}")?
                } else {
                    write!(w, ",")?
                }
            }
        }
        writeln!(w)?;
    }
    Ok(())
}

fn shown_runs(runs: &RecoveredRuns) -> Vec<RecoveredRun> {
    let of = |r| shown_run(runs, r);
    runs.recovery.runs.iter().map(of).collect()
}

fn shown_run(runs: &RecoveredRuns, r: &RunEstimate) -> RecoveredRun {
    let loads = runs.units.iter().enumerate().map(|(l, u)| {
        let [low, high] = r.estimate.interval(l);
        (
            r.estimate.names[l].clone(),
            [low, r.estimate.values[l], high].map(|v| v * u.factor),
            u.name.clone(),
        )
    });
    RecoveredRun {
        run: r.estimate.run.clone(),
        loads: loads.collect(),
    }
}

/// Returns the page.
pub(super) fn page(outcome: &Outcome<RecoveredLoads>, runs: &RecoveredRuns) -> Page {
    let shown = shown_runs(runs);
    let (job, s) = (&outcome.job, &outcome.prepared.sensitivity);
    let numbers = vec![
        ("Runs".to_owned(), runs.recovery.runs.len().to_string()),
        (
            "Residual, microstrain rms".to_owned(),
            number(runs.residual_rms_microstrain),
        ),
        (
            "Condition number, scaled".to_owned(),
            number(s.condition_number_scaled()),
        ),
    ];
    let scene = scene_of_job(job, &outcome.prepared).map(|mut scene| {
        scene.arrows = run_arrows(job, scene.model, &shown, LoadRange::Interval);
        scene.pointing = PickTargets::Gauges;
        scene
    });
    let (table, is_cut) = by_run(outcome, runs);
    let found = OnPage {
        sensitivity: s,
        runs: &shown,
        points: &points(runs),
        traces: &[],
        by_gauge: &by_gauge(&runs.gauges),
        numbers: &numbers,
        table,
        is_cut,
    };
    recover_page(&job.title, scene.as_ref(), &found, &outcome.findings)
}

/// Predicted and measured microstrain of each gauge, by all gauges and by all others.
fn points(runs: &RecoveredRuns) -> Vec<GaugePoints> {
    let of_gauge = |g: usize, leverage: f64| {
        let pairs = runs.recovery.runs.iter().zip(&runs.readings);
        let pairs = pairs.map(|(r, y)| {
            let (predicted, measured) = (r.predicted[g], y.strain[g]);
            (
                held_out(predicted, measured, leverage) / MICROSTRAIN,
                measured / MICROSTRAIN,
            )
        });
        pairs.collect()
    };
    let gauges = runs.gauges.iter().enumerate();
    gauges
        .map(|(g, of)| GaugePoints {
            name: of.name.clone(),
            residual: of.residual_rms_microstrain,
            points: [0.0, of.leverage].map(|leverage| of_gauge(g, leverage)),
        })
        .collect()
}

/// Returns the reading of a gauge predicted from the other gauges, by its own prediction and leverage. NaN if the other gauges do not determine it.
fn held_out(predicted: f64, measured: f64, leverage: f64) -> f64 {
    /// Leverage from which the other gauges practically do not determine a gauge.
    const ALONE: f64 = 0.999;
    if leverage < ALONE {
        measured - (measured - predicted) / (1.0 - leverage)
    } else {
        f64::NAN
    }
}
