//! Records: samples streamed through one filter, pieces in parallel, a few pieces in memory at a time.

use super::content::{check_content, content_of_loads};
use super::csv_record::{self, Layout};
use super::runs::columns_of;
use super::{MICRO, Task};
use crate::cli::fault::{Fault, Faults};
use crate::cli::files::FileBytes;
use crate::cli::strain::{LoadUnits, load_units};
use crate::cli::{JobArguments, Session};
use crate::finding::{Finding, Severity};
use crate::linalg::Matrix;
use crate::recovery::history::{Filter, Sums};
use crate::recovery::{NORMAL_95, Readings, recover};
use crate::report::strain::{RecoveredRun, recover_page};
use crate::sensitivity::Sensitivity;
use crate::series::binary::{self, Header};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::io::Write;

/// Samples a piece of a binary record.
const SAMPLES: usize = 16_384;
/// Bytes a piece of a CSV record.
const BYTES: usize = 4 << 20;
/// Pieces in memory at a time.
const GROUP: usize = 8;
/// Rows of `loads.csv` at most; longer records are thinned there and written whole to `loads.bin`.
const MOST_ROWS: usize = 200_000;
/// Samples on which the residual is judged.
const JUDGED: usize = 200;
/// Samples from which typical loads are taken for the weights of a stated model error.
const TYPICAL: usize = 20_000;

enum Source {
    Binary(Header),
    Csv(Layout, Vec<(usize, usize)>),
}

struct Record {
    bytes: FileBytes,
    file: String,
    source: Source,
    columns: Vec<Option<usize>>,
    /// Strain of one unit of the file.
    unit: f64,
}

impl Record {
    fn n_pieces(&self) -> usize {
        match &self.source {
            Source::Binary(h) => h.samples.div_ceil(SAMPLES),
            Source::Csv(_, pieces) => pieces.len(),
        }
    }

    /// Times and readings of a piece.
    fn piece(&self, i: usize) -> Result<(Vec<f64>, Vec<f64>), Fault> {
        let (mut times, mut values) = (Vec::new(), Vec::new());
        match &self.source {
            Source::Binary(h) => {
                let (from, to) = (i * SAMPLES, ((i + 1) * SAMPLES).min(h.samples));
                values.reserve((to - from) * self.columns.len());
                binary::read_samples(h, &self.bytes, from, to, &self.columns, &mut values);
                times.extend((from..to).map(|s| h.t0 + h.dt * s as f64));
            }
            Source::Csv(l, pieces) => {
                csv_record::read_piece(
                    &self.file,
                    &self.bytes,
                    pieces[i],
                    l,
                    &self.columns,
                    &mut times,
                    &mut values,
                )?;
            }
        }
        Ok((times, values))
    }
}

pub(super) fn run(
    session: &mut Session,
    arguments: &JobArguments,
    task: &Task,
    bytes: FileBytes,
) -> Result<(), Faults> {
    let all = &task.prepared.sensitivity;
    let named = &task.measured.strain;
    let file = named.given.clone();
    let (source, names, unit) = if binary::is_record(&bytes) {
        let h = binary::read_header(&bytes).map_err(|e| {
            let remedy = "write the record again as README.md describes it";
            vec![Fault::of(&*file, "header", e.to_string(), remedy)]
        })?;
        let (names, unit) = (h.names.clone(), h.unit);
        (Source::Binary(h), names, unit)
    } else {
        let l = csv_record::layout(&bytes).ok_or_else(|| {
            vec![Fault::at(
                &*file,
                1,
                "time",
                "no column `time`",
                "add a column `time` in seconds",
            )]
        })?;
        let pieces = csv_record::pieces(&bytes, l.start, BYTES);
        let names = l.names.clone();
        (Source::Csv(l, pieces), names, MICRO)
    };
    let found = columns_of(session, named, &names, &all.gauges);
    // Gauges without a column take no part.
    let used: Vec<usize> = (0..found.len())
        .filter(|&g| found[g].is_some() && task.zero[g].is_finite())
        .collect();
    if used.is_empty() {
        return Err(vec![Fault::at(
            &*file,
            1,
            "gauge",
            "no column is named after a gauge of the job",
            "name the columns after the gauges",
        )]);
    }
    let s = Sensitivity {
        gauges: used.iter().map(|&g| all.gauges[g].clone()).collect(),
        loads: all.loads.clone(),
        values: Matrix::from_fn(used.len(), all.loads.len(), |i, l| all.values[(used[i], l)]),
    };
    let zero: Vec<f64> = used.iter().map(|&g| task.zero[g]).collect();
    let record = Record {
        bytes,
        file: file.clone(),
        source,
        columns: used.iter().map(|&g| found[g]).collect(),
        unit,
    };
    let units = load_units(
        task.job,
        &s.loads.iter().map(|l| l.name.clone()).collect::<Vec<_>>(),
    );
    let judged = judge(task, &record, &s, &zero)?;
    session.findings.extend(judged.1.iter().cloned());
    let filter =
        Filter::new(&s, zero, task.errors, task.noise_factor, &judged.0).ok_or_else(|| {
            vec![Fault::of(
                &*file,
                "sensitivity",
                "S holds numbers that are not finite",
                "check the results of the unit loads",
            )]
        })?;
    if filter.rank < s.loads.len() {
        session.findings.push(Finding::new(
            Severity::Error,
            "run-not-solvable",
            &file,
            "the gauges of this record don't separate the loads: some of the values are arbitrary",
            "add gauges, drop loads, or state `expected` for loads with role \"nuisance\"",
        ));
    }
    let total = match &record.source {
        Source::Binary(h) => Some(h.samples),
        Source::Csv(..) => None,
    };
    // A CSV record's rows are not counted beforehand: a row is at least two bytes a column.
    let about = total.unwrap_or(record.bytes.len() / (6 * (names.len() + 1)));
    let stride = about.div_ceil(MOST_ROWS).max(1);
    let whole = stride > 1;
    let mut sums = Sums::new(s.gauges.len(), s.loads.len());
    let mut first_fault = None;
    let dt = match &record.source {
        Source::Binary(h) => (h.t0, h.dt),
        Source::Csv(..) => record.piece(0).ok().map_or((0.0, 0.0), |p| {
            (
                p.0.first().copied().unwrap_or(0.0),
                if p.0.len() > 1 { p.0[1] - p.0[0] } else { 0.0 },
            )
        }),
    };
    let names_of: Vec<String> = s.loads.iter().map(|l| l.name.clone()).collect();
    if let Some(first_mode) = task.prepared.fields.as_ref().and_then(|f| f.first_mode) {
        let sigma = filter.sigma(&vec![0.0; s.loads.len()]);
        let pieces = sampled_pieces(&record, &filter, &units).map_err(|f| vec![f])?;
        let content = content_of_loads(&pieces, &sigma, if dt.1 > 0.0 { 1.0 / dt.1 } else { 0.0 });
        session
            .findings
            .extend(check_content(&names_of, &content, first_mode));
        session.put("first_elastic_mode_hz", first_mode)?;
        session.put("content_hz", &content)?;
    }
    let out = session.output_for(&arguments.job)?;
    let mut written = 0u64;
    let folder = out.folder().to_owned();
    let part = folder.join(".loads.bin.body");
    let mut body = if whole {
        std::fs::File::create(&part)
            .ok()
            .map(|f| std::io::BufWriter::with_capacity(1 << 20, f))
    } else {
        None
    };
    out.write("loads.csv", |w| {
        write!(w, "time")?;
        for name in &names_of {
            write!(w, ",{name},{name}.low,{name}.high")?;
        }
        writeln!(w)?;
        let mut index = 0usize;
        for group in (0..record.n_pieces()).collect::<Vec<_>>().chunks(GROUP) {
            let done: Vec<Result<Piece, Fault>> = group
                .par_iter()
                .map(|&i| process(&record, &filter, &units, i))
                .collect();
            for piece in done {
                let piece = match piece {
                    Ok(p) => p,
                    Err(f) => {
                        first_fault = Some(f);
                        return Ok(());
                    }
                };
                sums.merge(&piece.sums);
                let k = names_of.len();
                for (i, (t, f)) in piece
                    .times
                    .iter()
                    .zip(piece.loads.chunks_exact(k))
                    .enumerate()
                {
                    if (index + i).is_multiple_of(stride) {
                        write_row(w, *t, f, &filter, &units)?;
                    }
                }
                index += piece.times.len();
                if let Some(b) = &mut body {
                    b.write_all(&piece.bytes)?;
                    written += piece.times.len() as u64;
                }
            }
        }
        Ok(())
    })
    .map_err(|f| vec![f])?;
    if let Some(f) = first_fault {
        let _ = std::fs::remove_file(&part);
        return Err(vec![f]);
    }
    if let Some(mut b) = body {
        let done = b.flush();
        drop(b);
        let unit_names: Vec<String> = names_of
            .iter()
            .zip(&units)
            .map(|(n, u)| {
                if u.name.is_empty() {
                    n.clone()
                } else {
                    format!("{n} [{}]", u.name)
                }
            })
            .collect();
        let copied = out.write("loads.bin", |w| {
            done?;
            binary::write_header(w, &unit_names, written, dt.0, dt.1, 1.0)?;
            std::io::copy(&mut std::fs::File::open(&part)?, w).map(|_| ())
        });
        let _ = std::fs::remove_file(&part);
        copied.map_err(|f| vec![f])?;
    }
    finish(
        session,
        arguments,
        task,
        &s,
        &filter,
        &sums,
        &units,
        &file,
        whole.then_some(stride),
    )
}

/// Loads of some pieces spread over the record.
fn sampled_pieces(
    record: &Record,
    filter: &Filter,
    units: &[LoadUnits],
) -> Result<Vec<Vec<f64>>, Fault> {
    let n = record.n_pieces();
    let taken = n.min(GROUP);
    (0..taken)
        .into_par_iter()
        .map(|i| process(record, filter, units, i * n / taken).map(|p| p.loads))
        .collect()
}

struct Piece {
    times: Vec<f64>,
    loads: Vec<f64>,
    /// Loads in report units, f32.
    bytes: Vec<u8>,
    sums: Sums,
}

fn process(
    record: &Record,
    filter: &Filter,
    units: &[LoadUnits],
    i: usize,
) -> Result<Piece, Fault> {
    let (times, values) = record.piece(i)?;
    let mut loads = Vec::with_capacity(times.len() * filter.n_loads());
    let mut sums = Sums::new(filter.n_gauges(), filter.n_loads());
    filter.apply(&values, record.unit, &mut loads, &mut sums);
    let mut bytes = Vec::with_capacity(loads.len() * 4);
    for f in loads.chunks_exact(filter.n_loads()) {
        for (v, u) in f.iter().zip(units) {
            bytes.extend_from_slice(&((v * u.factor) as f32).to_le_bytes());
        }
    }
    Ok(Piece {
        times,
        loads,
        bytes,
        sums,
    })
}

fn write_row(
    w: &mut dyn Write,
    t: f64,
    f: &[f64],
    filter: &Filter,
    units: &[LoadUnits],
) -> std::io::Result<()> {
    write!(w, "{t}")?;
    for ((v, s), u) in f.iter().zip(filter.sigma(f)).zip(units) {
        if v.is_finite() {
            let half = NORMAL_95 * s;
            write!(
                w,
                ",{:.6e},{:.6e},{:.6e}",
                v * u.factor,
                (v - half) * u.factor,
                (v + half) * u.factor
            )?;
        } else {
            write!(w, ",,,")?;
        }
    }
    writeln!(w)
}

/// Typical (rms) loads, and what samples over the record say of the loads asked for and of the gauges.
fn judge(
    task: &Task,
    record: &Record,
    s: &Sensitivity,
    zero: &[f64],
) -> Result<(Vec<f64>, Vec<Finding>), Faults> {
    let n = s.gauges.len();
    let pieces = record.n_pieces();
    let mut readings: Vec<Readings> = Vec::new();
    let spread = pieces.min(10);
    let each = JUDGED.div_ceil(spread.max(1));
    for p in 0..spread {
        let (times, values) = record.piece(p * pieces / spread).map_err(|f| vec![f])?;
        let take = times.len().min(TYPICAL);
        for i in (0..each).map(|i| i * take / each).filter(|i| *i < take) {
            let row = &values[i * n..(i + 1) * n];
            let strain = row
                .iter()
                .zip(zero)
                .map(|(v, z)| v * record.unit - z)
                .collect();
            readings.push(Readings {
                run: format!("t = {}", times[i]),
                strain,
                noise_factor: task.noise_factor,
            });
        }
    }
    let recovery = recover(s, &readings, task.errors);
    let k = s.loads.len();
    let typical = (0..k)
        .map(|l| {
            let q: f64 = recovery
                .runs
                .iter()
                .map(|r| r.estimate.values[l].powi(2))
                .sum();
            (q / recovery.runs.len().max(1) as f64).sqrt()
        })
        .collect();
    let mut findings = recovery.findings;
    findings.retain(|f| f.code != "run-not-solvable");
    Ok((typical, findings))
}

#[allow(clippy::too_many_arguments)]
fn finish(
    session: &mut Session,
    arguments: &JobArguments,
    task: &Task,
    s: &Sensitivity,
    filter: &Filter,
    sums: &Sums,
    units: &[LoadUnits],
    file: &str,
    thinned: Option<usize>,
) -> Result<(), Faults> {
    let count = sums.samples.max(1) as f64;
    let rms: Vec<f64> = sums
        .sum_of_squares
        .iter()
        .map(|q| (q / count).sqrt())
        .collect();
    let sigma = filter.sigma(&rms);
    let mut loads: Vec<Value> = Vec::new();
    let mut shown = Vec::new();
    for (l, u) in units.iter().enumerate() {
        let mean = sums.sum[l] / count;
        loads.push(json!({
            "run": file,
            "name": s.loads[l].name,
            "value": mean * u.factor,
            "sigma": sigma[l] * u.factor,
            "unit": u.name,
            "min": sums.min[l] * u.factor,
            "max": sums.max[l] * u.factor,
            "rms": rms[l] * u.factor,
        }));
        shown.push((
            s.loads[l].name.clone(),
            [sums.min[l], mean, sums.max[l]].map(|v| v * u.factor),
            u.name.clone(),
        ));
    }
    session.put("loads", loads)?;
    let dof = s.gauges.len().saturating_sub(filter.rank).max(1) as f64;
    let residual = (sums.residual.iter().sum::<f64>() / (count * dof)).sqrt() / MICRO;
    session.put("residual_rms_microstrain", residual)?;
    let by_gauge: Vec<(String, f64, f64)> = (0..s.gauges.len())
        .map(|g| {
            (
                s.gauges[g].clone(),
                (sums.residual[g] / count).sqrt() / MICRO,
                filter.leverage[g],
            )
        })
        .collect();
    let gauges: Vec<Value> = by_gauge
        .iter()
        .map(|(n, r, h)| json!({ "name": n, "residual_rms_microstrain": r, "leverage": h }))
        .collect();
    session.put("gauges", gauges)?;
    session.put("samples", sums.samples)?;
    session.put("gaps", sums.gaps)?;
    if sums.gaps > 0 {
        session.findings.push(
            Finding::new(
                Severity::Warning,
                "samples-with-gaps",
                file,
                format!(
                    "{} samples have a gauge without a reading: their loads are left blank",
                    sums.gaps
                ),
                "repair the channel, or leave its gauge out of the job",
            )
            .with_numbers(sums.gaps as f64, 0.0),
        );
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
        "{}: {} samples, residual {residual:.2} microstrain rms",
        file, sums.samples
    ));
    let numbers = vec![
        ("Samples".to_owned(), sums.samples.to_string()),
        (
            "Residual, microstrain rms".to_owned(),
            format!("{residual:.3}"),
        ),
    ];
    let runs = [RecoveredRun {
        run: format!("{file}: smallest, mean, largest"),
        loads: shown,
    }];
    let page = recover_page(
        &task.job.title,
        task.prepared.fields.as_ref().map(|f| f.model()),
        &task.prepared.gauges,
        s,
        &runs,
        &[],
        &by_gauge,
        &session.findings,
        &numbers,
    );
    session
        .output_for(&arguments.job)?
        .write_bytes("report.html", page.as_bytes())
        .map_err(|f| vec![f])
}
