//! Files of a record: files derived from `loads.bin`, the page, `loads.xlsx`.

use super::columns::{by_gauge, columns_with_units};
use super::tables::{BIN, CSV, LoadTables, LoadsFile};
use super::{nastran, rpc, turning_points};
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::job::LoadFile;
use crate::report::command::{write_book, write_page};
use crate::report::csv_cell;
use crate::report::figure::LoadTrace;
use crate::report::page::{Page, number};
use crate::report::scene::{LoadRange, PickTargets, run_arrows, scene_of_job};
use crate::report::spreadsheet::{HistoryLoad, history_sheet, residual_sheet};
use crate::report::strain::{RecoveredRun, RecoveryPage as OnPage, recover_page};
use crate::units::format_fixed;
use crate::workflow::recover::{LoadDamage, RecoveredLoads, RecoveredRecord};
use std::io::Write;

/// Blocks formed at a time.
const GROUP: usize = 8;

/// Writes all files of a record. It writes `loads.csv` and `loads.bin` only if the outcome contains its history. Otherwise a [`super::RecordFolder`]
/// has written them.
///
/// # Errors
/// The first file that can't be written.
pub(super) fn write(
    out: &mut Output,
    outcome: &Outcome<RecoveredLoads>,
    record: &RecoveredRecord,
) -> Result<(), Faults> {
    let head = &record.head;
    if let Some(history) = &record.history {
        let mut tables = LoadTables::begin(out, head)?;
        for blocks in history.blocks().chunks(GROUP) {
            tables.take(out, blocks)?;
        }
        tables.end(out, record.samples)?;
    }
    if out.holds(CSV) {
        let columns = columns_with_units(["time", "s"], &head.names, &head.units);
        out.declare(CSV, columns);
    }
    if let Some(damage) = &record.damage {
        out.declare("rainflow.csv", RAINFLOW);
        out.write("rainflow.csv", |w| rainflow_csv(w, damage))?;
    }
    if head.is_read_again() && out.holds(BIN) {
        write_derived_files(out, outcome, record)?;
    }
    let loads: Vec<HistoryLoad> = record.loads.iter().map(of_history).collect();
    write_page(out, outcome)?;
    let sheets = [
        history_sheet(&loads),
        residual_sheet(&by_gauge(&record.gauges)),
    ];
    write_book(out, outcome, &outcome.job, "loads.xlsx", &sheets)
}

/// Files that are made of `loads.bin`.
fn write_derived_files(
    out: &mut Output,
    outcome: &Outcome<RecoveredLoads>,
    record: &RecoveredRecord,
) -> Result<(), Faults> {
    let loads = LoadsFile::read_back(out)?;
    for file in &record.head.files {
        match file {
            LoadFile::Rainflow => {}
            LoadFile::Rpc => rpc::write(out, record, &loads)?,
            LoadFile::Nastran => nastran::write_history(out, outcome, &record.head, &loads)?,
            #[cfg(feature = "parquet")]
            LoadFile::Parquet => super::parquet::write(out, &record.head, &loads)?,
            #[cfg(not(feature = "parquet"))]
            LoadFile::Parquet => {}
        }
    }
    if let Some(share) = record.head.turning_points {
        turning_points::write(out, record, &loads, share)?;
    }
    Ok(())
}

fn rate(record: &RecoveredRecord) -> f64 {
    record.sample_rate_hz.unwrap_or(f64::NAN)
}

/// Columns of rainflow.csv.
const RAINFLOW: [(&str, &str); 7] = [
    ("load", ""),
    ("unit", ""),
    ("range_from", "report unit of the load"),
    ("range_to", "report unit of the load"),
    ("cycles", ""),
    ("mean", "report unit of the load"),
    ("damage", "report unit to the power of the slope"),
];

fn rainflow_csv(w: &mut dyn Write, damage: &[LoadDamage]) -> std::io::Result<()> {
    writeln!(w, "{}", RAINFLOW.map(|c| c.0).join(","))?;
    for d in damage {
        let bins = &d.count.bins;
        let width = d.count.limit / bins.len() as f64;
        for (b, bin) in bins.iter().enumerate().filter(|(_, b)| b.cycles > 0.0) {
            writeln!(
                w,
                "{},{},{:.7e},{:.7e},{},{:.7e},{:.7e}",
                csv_cell(&d.name),
                d.unit,
                width * b as f64,
                width * (b + 1) as f64,
                bin.cycles,
                bin.sum_of_means / bin.cycles,
                bin.damage
            )?;
        }
    }
    Ok(())
}

fn of_history(l: &crate::workflow::recover::RecordLoad) -> HistoryLoad {
    HistoryLoad {
        name: l.name.clone(),
        unit: l.unit.clone(),
        min: l.min,
        mean: l.value,
        max: l.max,
        rms: l.rms,
        sigma: l.sigma,
    }
}

/// Returns the page.
pub(super) fn page(outcome: &Outcome<RecoveredLoads>, record: &RecoveredRecord) -> Page {
    let (job, file) = (&outcome.job, &record.head.file);
    let row = |name: &str, value: String| (name.to_owned(), value);
    let numbers = [
        row("Samples", record.samples.to_string()),
        row("Sample rate, Hz", format_fixed(rate(record), 4)),
        row("Duration, s", format_fixed(record.duration_s, 4)),
        row("Samples with gaps", record.gaps.to_string()),
        row(
            "Residual, microstrain rms",
            number(record.residual_rms_microstrain),
        ),
    ];
    let loads = record.loads.iter();
    let runs = [RecoveredRun {
        run: format!("{file}: smallest, mean, largest"),
        loads: loads
            .map(|l| (l.name.clone(), [l.min, l.value, l.max], l.unit.clone()))
            .collect(),
    }];
    let scene = scene_of_job(job, &outcome.prepared).map(|mut scene| {
        scene.arrows = run_arrows(job, scene.model, &runs, LoadRange::Extremes);
        scene.pointing = PickTargets::Gauges;
        scene
    });
    let found = OnPage {
        sensitivity: &record.sensitivity,
        runs: &runs,
        points: &[],
        traces: &traces(record),
        by_gauge: &by_gauge(&record.gauges),
        numbers: &numbers,
        table: Vec::new(),
        is_cut: false,
    };
    recover_page(&job.title, scene.as_ref(), &found, &outcome.findings)
}

/// Returns the loads over time, report units. The half width of their intervals comes from the root mean square of sigma over the samples.
fn traces(record: &RecoveredRecord) -> Vec<LoadTrace> {
    let spans = record.spans.list();
    let loads = record.loads.iter().zip(&record.head.units).enumerate();
    loads
        .map(|(l, (load, unit))| LoadTrace {
            name: load.name.clone(),
            unit: load.unit.clone(),
            times: spans.iter().map(|s| s.time).collect(),
            half: record.head.filter.coverage_factor() * load.sigma,
            spans: spans
                .iter()
                .map(|s| s.of_load(l).map(|v| v * unit.factor))
                .collect(),
        })
        .collect()
}
