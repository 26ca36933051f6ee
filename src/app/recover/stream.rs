//! Records: samples streamed through one filter, pieces in parallel, a few pieces in memory at a time.

use super::Task;
use super::combined::{Listed, listed};
use super::content::{check_content, content_of_loads};
use super::derived::{self, History};
use super::history_files::{Form, Named, stream};
use super::record::{GROUP, Record, process};
use super::runs::columns_of;
use super::trace::Spans;
use crate::app::fault::{Fault, Faults};
use crate::app::files::FileBytes;
use crate::app::job::correct::channel_of;
use crate::app::outcome::finite;
use crate::app::solved::first_mode_of;
use crate::app::spreadsheets::write_spreadsheet;
use crate::app::strain::LoadUnits;
use crate::app::{JobArguments, Session};
use crate::finding::{Finding, Severity};
use crate::linalg::Matrix;
use crate::recovery::clock;
use crate::recovery::history::Filter;
use crate::recovery::{Readings, Recovery, Sums, recover};
use crate::report::csv_cell;
use crate::report::scene::{Shown, run_arrows, scene_of_job};
use crate::report::spreadsheet::{HistoryLoad, history_sheet, residual_sheet};
use crate::report::strain::{Recovered, RecoveredRun, recover_page};
use crate::sensitivity::Sensitivity;
use crate::series::binary;
use crate::units::MICROSTRAIN;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::io::{Seek, Write};

/// Rows of `loads.csv` at most; longer records are thinned there and written whole to `loads.bin`.
const MOST_ROWS: usize = 200_000;
/// Samples on which the residual of a long record is judged.
const JUDGED: usize = 200;
/// Samples up to which a record that is read in one piece is judged whole.
const JUDGED_OF_SHORT: usize = 2000;
/// Samples from which typical loads are taken for the weights of a stated model error.
const TYPICAL: usize = 20_000;

pub(super) fn run(
    session: &mut Session,
    arguments: &JobArguments,
    task: &Task,
    bytes: FileBytes,
) -> Result<(), Faults> {
    let all = &task.prepared.sensitivity;
    let named = &task.measured.strain;
    let file = named.given.clone();
    let corrections = &task.job.corrections;
    let record = Record::open(task.job, task.measured, bytes, &all.gauges)?;
    session.findings.extend(record.findings());
    let names = &record.names;
    let found = columns_of(session, named, names, &all.gauges);
    // Gauges without a column take no part.
    let mut used: Vec<usize> = (0..found.len())
        .filter(|&g| found[g].is_some() && task.zero[g].is_finite())
        .filter(|&g| !channel_of(corrections, &all.gauges[g]).ignore)
        .collect();
    if used.is_empty() {
        return Err(Faults::from(Fault::at(
            &*file,
            1,
            "gauge",
            "no column is named after a gauge of the job",
            "name the columns after the gauges",
        )));
    }
    let gauge = |g: usize| channel_of(corrections, &all.gauges[g]);
    let channels = used.iter().map(|&g| (found[g], gauge(g)));
    let mut record = record.with_columns(channels.collect());
    let silent = silent(&record)?;
    if silent.iter().any(|s| *s) {
        let dead = used.iter().zip(&silent).filter(|(_, s)| **s);
        let names: Vec<&str> = dead.map(|(g, _)| all.gauges[*g].as_str()).collect();
        session.findings.push(Finding::new(
            Severity::Warning,
            "gauge-silent",
            names.join(", "),
            "these gauges give nothing: the loads are those of the others, with wider intervals",
            "repair the channel, or leave its gauge out: [[correction]] ignore = true",
        ));
        let mut speaks = silent.iter().map(|s| !s);
        used.retain(|_| speaks.next().unwrap_or(true));
        let channels = used.iter().map(|&g| (found[g], gauge(g)));
        record = record.with_columns(channels.collect());
    }
    if used.is_empty() {
        return Err(Faults::from(Fault::of(
            &*file,
            "gauge",
            "no gauge gives a single reading",
            "check the export of the record",
        )));
    }
    let s = Sensitivity {
        gauges: used.iter().map(|&g| all.gauges[g].clone()).collect(),
        loads: all.loads.clone(),
        values: Matrix::from_fn(used.len(), all.loads.len(), |i, l| all.values[(used[i], l)]),
        uncertainty: all.uncertainty.as_ref().map(|u| u.of_gauges(&used)),
    };
    let zero: Vec<f64> = used.iter().map(|&g| task.zero[g]).collect();
    let Listed {
        names: names_of,
        units,
        sums: combinations,
    } = listed(task.job, &s)?;
    let judged = judge(task, &record, &s, &zero)?;
    session.findings.extend(judged.findings.iter().cloned());
    let mut filter = Filter::new(
        &s,
        zero,
        task.errors,
        task.noise_factor,
        &judged.typical,
        judged.widening.clone(),
    )
    .ok_or_else(|| {
        Faults::from(Fault::of(
            &*file,
            "sensitivity",
            "S holds numbers that are not finite",
            "check the results of the unit loads",
        ))
    })?;
    filter.combine(&combinations);
    let about = record.clock().samples;
    let stride = about.div_ceil(MOST_ROWS).max(1);
    let (t0, dt) = record.first_and_step();
    let fields = task.prepared.fields.as_ref();
    if record.is_time_unit_open() {
        let (_, readings) = record.piece(0).map_err(Faults::from)?;
        session
            .findings
            .extend(clock::check(dt, &readings, record.n_columns()));
    }
    let first_mode = fields.and_then(|f| {
        f.first_mode
            .or_else(|| first_mode_of(session, task.job, &f.deck))
    });
    if let Some(first_mode) = first_mode {
        let sigma = filter.sigma(&vec![0.0; filter.n_loads()]);
        let pieces = sampled_pieces(&record, &filter).map_err(Faults::from)?;
        let content = content_of_loads(&pieces, &sigma, if dt > 0.0 { 1.0 / dt } else { 0.0 });
        session
            .findings
            .extend(check_content(&names_of, &content, first_mode));
        session.put("first_elastic_mode_hz", first_mode)?;
        session.put("content_hz", &content)?;
    }
    let progress = session.cx.progress;
    let out = session.output_for(&arguments.job)?;
    let mut csv = Named {
        name: "loads.csv",
        file: out.open("loads.csv").map_err(Faults::from)?,
    };
    let wanted = derived::wanted(task, about);
    let mut bin = match stride > 1 || !wanted.is_empty() {
        true => Some(Named {
            name: "loads.bin",
            file: out.open("loads.bin").map_err(Faults::from)?,
        }),
        false => None,
    };
    let unit_names: Vec<String> = names_of.iter().zip(&units).map(named_with_unit).collect();
    let head = |bin: &mut Named, samples: u64| {
        binary::write_header(&mut bin.file, &unit_names, samples, t0, dt, 1.0)
    };
    let mut columns = "time".to_owned();
    for name in &names_of {
        for column in [name.clone(), format!("{name}.low"), format!("{name}.high")] {
            columns.push(',');
            columns.push_str(&csv_cell(&column));
        }
    }
    columns.push('\n');
    csv.put(columns.as_bytes())
        .and_then(|()| {
            bin.as_mut()
                .map_or(Ok(()), |b| head(b, 0).map_err(|e| (b.name, e)))
        })
        .map_err(|(name, e)| Faults::from(out.fault(name, &e)))?;
    let form = Form {
        filter: &filter,
        units: &units,
        stride,
        numbers: bin.is_some(),
    };
    let mut spans = Spans::new(filter.n_loads());
    let sums = stream(
        &record,
        &form,
        &mut csv,
        bin.as_mut(),
        out,
        progress,
        &mut spans,
    )
    .map_err(Faults::from)?;
    // How many samples a CSV record holds is known at its end: the header is written again.
    let mut written = csv.file.flush().map_err(|e| (csv.name, e));
    if let Some(mut b) = bin {
        written = written.and_then(|()| {
            b.file
                .rewind()
                .and_then(|()| head(&mut b, sums.samples + sums.gaps))
                .and_then(|()| b.file.flush())
                .map_err(|e| (b.name, e))
        });
    }
    written.map_err(|(name, e)| Faults::from(out.fault(name, &e)))?;
    drop(csv);
    if !wanted.is_empty() {
        let bytes = out.read_back("loads.bin").map_err(Faults::from)?;
        let header = binary::read_header(&bytes).map_err(|e| {
            let remedy = "report this as an error of the program";
            Faults::from(Fault::of("loads.bin", "header", e.to_string(), remedy))
        })?;
        let history = History {
            bytes,
            header,
            names: &names_of,
            units: &units,
            filter: &filter,
            sums: &sums,
        };
        session.stage("files of the history", |s| {
            derived::write_history(s, arguments, task, &history, &wanted)
        })?;
    }
    derived::note_left_out(session, task, sums.samples + sums.gaps, &wanted);
    finish(
        session,
        arguments,
        task,
        &s,
        &filter,
        &sums,
        &spans,
        &names_of,
        &units,
        &file,
        (stride > 1).then_some(stride),
    )
}

fn named_with_unit((name, unit): (&String, &LoadUnits)) -> String {
    if unit.name.is_empty() {
        name.clone()
    } else {
        format!("{name} [{}]", unit.name)
    }
}

/// Loads of some pieces spread over the record.
fn sampled_pieces(record: &Record, filter: &Filter) -> Result<Vec<Vec<f64>>, Fault> {
    let n = record.n_pieces();
    let taken = n.min(GROUP);
    (0..taken)
        .into_par_iter()
        .map(|i| process(record, filter, i * n / taken).map(|p| p.loads.values))
        .collect()
}

/// Which columns give nothing anywhere over the record, looked at in ten pieces spread over it.
fn silent(record: &Record) -> Result<Vec<bool>, Faults> {
    let (n, pieces) = (record.n_columns(), record.n_pieces());
    let mut out = vec![true; n];
    for p in 0..pieces.min(10) {
        let (_, values) = record
            .piece(p * pieces / pieces.min(10))
            .map_err(Faults::from)?;
        for row in values.chunks_exact(n.max(1)) {
            out.iter_mut()
                .zip(row)
                .for_each(|(s, v)| *s &= !v.is_finite());
        }
        if out.iter().all(|s| !s) {
            break;
        }
    }
    Ok(out)
}

/// What samples over the record say of the loads asked for, of the gauges, and of the intervals.
fn judge(task: &Task, record: &Record, s: &Sensitivity, zero: &[f64]) -> Result<Recovery, Faults> {
    let n = s.gauges.len();
    let pieces = record.n_pieces();
    let mut readings: Vec<Readings> = Vec::new();
    let spread = pieces.min(10);
    // A short record is judged on all of its samples, as the same rows would be as runs.
    let each = match pieces {
        1 => JUDGED_OF_SHORT,
        _ => JUDGED.div_ceil(spread.max(1)),
    };
    for p in 0..spread {
        let (times, values) = record.piece(p * pieces / spread).map_err(Faults::from)?;
        let take = times.len().min(TYPICAL);
        let each = each.min(take);
        for i in (0..each).map(|i| i * take / each) {
            let row = &values[i * n..(i + 1) * n];
            let strain = row.iter().zip(zero).map(|(v, z)| v - z).collect();
            readings.push(Readings {
                run: format!("t = {}", times[i]),
                strain,
                noise_factor: task.noise_factor,
            });
        }
    }
    if readings.is_empty() {
        return Err(Faults::from(Fault::at(
            record.file(),
            1,
            "rows",
            "a header and no rows",
            "write a row a sample",
        )));
    }
    Ok(recover(s, &readings, task.errors))
}

#[allow(clippy::too_many_arguments)]
fn finish(
    session: &mut Session,
    arguments: &JobArguments,
    task: &Task,
    s: &Sensitivity,
    filter: &Filter,
    sums: &Sums,
    spans: &Spans,
    names: &[String],
    units: &[LoadUnits],
    file: &str,
    thinned: Option<usize>,
) -> Result<(), Faults> {
    let known: Vec<f64> = (0..filter.n_loads())
        .map(|l| sums.known(l) as f64)
        .collect();
    let rms: Vec<f64> = sums
        .sum_of_squares
        .iter()
        .zip(&known)
        .map(|(q, n)| (q / n.max(1.0)).sqrt())
        .collect();
    let sigma = filter.sigma(&rms);
    let mut loads: Vec<Value> = Vec::new();
    let mut shown = Vec::new();
    let mut summary = Vec::new();
    for (l, u) in units.iter().enumerate() {
        let mean = sums.sum[l] / known[l];
        loads.push(json!({
            "run": file,
            "name": names[l],
            "value": mean * u.factor,
            "sigma": sigma[l] * u.factor,
            "unit": u.name,
            "min": sums.min[l] * u.factor,
            "max": sums.max[l] * u.factor,
            "rms": rms[l] * u.factor,
        }));
        summary.push(HistoryLoad {
            name: names[l].clone(),
            unit: u.name.clone(),
            min: sums.min[l] * u.factor,
            mean: mean * u.factor,
            max: sums.max[l] * u.factor,
            rms: rms[l] * u.factor,
            sigma: sigma[l] * u.factor,
        });
        shown.push((
            names[l].clone(),
            [sums.min[l], mean, sums.max[l]].map(|v| v * u.factor),
            u.name.clone(),
        ));
    }
    session.put("loads", loads)?;
    let dof = s.gauges.len().saturating_sub(filter.whole().rank).max(1) as f64;
    let free: f64 = (0..s.gauges.len())
        .map(|g| sums.read(g) as f64 * dof / s.gauges.len() as f64)
        .sum();
    let residual = (sums.residual.iter().sum::<f64>() / free.max(1.0)).sqrt() / MICROSTRAIN;
    session.put("residual_rms_microstrain", residual)?;
    let by_gauge: Vec<(String, f64, f64)> = (0..s.gauges.len())
        .map(|g| {
            (
                s.gauges[g].clone(),
                (sums.residual[g] / sums.read(g).max(1) as f64).sqrt() / MICROSTRAIN,
                filter.whole().leverage[g],
            )
        })
        .collect();
    let gauges: Vec<Value> = by_gauge
        .iter()
        .map(|(n, r, h)| json!({ "name": n, "residual_rms_microstrain": r, "leverage": h }))
        .collect();
    session.put("gauges", gauges)?;
    session.put("samples", sums.samples + sums.gaps)?;
    session.put("gaps", sums.gaps)?;
    let [from, to] = spans.time();
    let steps = (sums.samples + sums.gaps).saturating_sub(1) as f64;
    session.put("duration_s", to - from)?;
    session.put("sample_rate_hz", finite(steps / (to - from)))?;
    if sums.gaps > 0 {
        session.findings.push(
            Finding::new(
                Severity::Warning,
                "samples-with-gaps",
                file,
                format!(
                    "in {} samples some gauge gives nothing: their loads are those of the others, with wider intervals, or blank",
                    sums.gaps
                ),
                "repair the channel, or leave its gauge out: [[correction]] ignore = true",
            )
            .with_numbers(sums.gaps as f64, 0.0),
        );
    }
    if sums.impossible > 0 {
        session.findings.push(
            Finding::new(
                Severity::Error,
                "reading-impossible",
                file,
                format!(
                    "{} readings are too large to be strain: they are taken for no reading",
                    sums.impossible
                ),
                "check the unit (microstrain is expected), the channel's overload, and the file",
            )
            .with_numbers(sums.impossible as f64, 0.0),
        );
    }
    let unknown: Vec<&str> = (0..s.loads.len())
        .filter(|&l| s.loads[l].wanted && sums.known(l) == 0)
        .map(|l| names[l].as_str())
        .collect();
    if !unknown.is_empty() {
        session.findings.push(Finding::new(
            Severity::Error,
            "loads-without-values",
            unknown.join(", "),
            "in no sample do the gauges that read tell these loads",
            "bring the silent gauges back, or drop these loads",
        ));
    }
    if let Some(stride) = thinned {
        session.findings.push(Finding::new(
            Severity::Info,
            "history-thinned",
            "loads.csv",
            format!("loads.csv holds every {stride}th sample; loads.bin holds all of them (format in README.md)"),
            "",
        ));
    }
    session.say(format!(
        "{file}: {} samples at {:.4} Hz, {:.4} s, {} with gaps, residual {residual:.2} microstrain rms",
        sums.samples + sums.gaps,
        steps / (to - from),
        to - from,
        sums.gaps
    ));
    let numbers = vec![
        ("Samples".to_owned(), (sums.samples + sums.gaps).to_string()),
        (
            "Sample rate, Hz".to_owned(),
            format!("{:.4}", steps / (to - from)),
        ),
        ("Duration, s".to_owned(), format!("{:.4}", to - from)),
        ("Samples with gaps".to_owned(), sums.gaps.to_string()),
        (
            "Residual, microstrain rms".to_owned(),
            format!("{residual:.3}"),
        ),
    ];
    let runs = [RecoveredRun {
        run: format!("{file}: smallest, mean, largest"),
        loads: shown,
    }];
    let scene = scene_of_job(task.job, task.prepared).map(|mut scene| {
        scene.arrows = run_arrows(task.job, scene.model, &runs, Shown::Extremes);
        scene
    });
    let found = Recovered {
        sensitivity: s,
        runs: &runs,
        points: &[],
        traces: &spans.traces(names, units, filter, &rms),
        by_gauge: &by_gauge,
        numbers: &numbers,
    };
    let page = recover_page(&task.job.title, scene.as_ref(), &found, &session.findings);
    session.write_page(&arguments.job, page)?;
    let sheets = [history_sheet(&summary), residual_sheet(&by_gauge)];
    write_spreadsheet(session, task.job, &arguments.job, "loads.xlsx", &sheets)
}
