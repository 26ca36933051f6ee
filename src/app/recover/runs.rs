//! Static states.

use super::Task;
use super::answer::RecoveredRuns;
use super::combined::{Listed, listed};
use super::derived::{write_arrows, write_nastran_runs};
use super::known_payload;
use crate::app::fault::{Fault, Faults};
use crate::app::job::strain::{StrainRows, StrainTable, read_strain};
use crate::app::job::{Job, LoadActs, LoadFile, Measured, NamedFile};
use crate::app::spreadsheets::write_spreadsheet;
use crate::app::strain::LoadUnits;
use crate::app::work::Work;
use crate::app::{JobArguments, Session};
use crate::finding::{Finding, Severity};
use crate::recovery::net::effective_samples;
use crate::recovery::{NORMAL_95, Readings, Recovery, recover};
use crate::report::csv_cell;
use crate::report::figure::GaugePoints;
use crate::report::scene::{Shown, run_arrows, scene_of_job};
use crate::report::spreadsheet::{residual_sheet, runs_sheet};
use crate::report::strain::{Recovered, RecoveredRun, recover_page};
use crate::units::MICROSTRAIN;
use std::io::Write;

/// Where a gauge's column stands; `None`: it has none.
pub(super) fn columns_of(
    session: &mut Work,
    named: &NamedFile,
    header: &[String],
    gauges: &[String],
) -> Vec<Option<usize>> {
    let columns: Vec<Option<usize>> = gauges
        .iter()
        .map(|g| header.iter().position(|h| h == g))
        .collect();
    let mut note = |code, list: Vec<&str>, message: &str, remedy: &str| {
        if !list.is_empty() {
            session.findings.push(Finding::new(
                Severity::Warning,
                code,
                list.join(", "),
                format!("`{}`: {message}", named.given),
                remedy,
            ));
        }
    };
    note(
        "gauge-without-strain",
        gauges
            .iter()
            .zip(&columns)
            .filter(|(_, c)| c.is_none())
            .map(|(g, _)| g.as_str())
            .collect(),
        "gauges without a column are left out",
        "name the columns after the gauges",
    );
    note(
        "strain-without-gauge",
        header
            .iter()
            .filter(|h| !gauges.contains(h))
            .map(String::as_str)
            .collect(),
        "columns that belong to no gauge are left out",
        "add the gauges, or drop the columns",
    );
    columns
}

/// The zero readings, strain by gauge, and the effective number of samples behind them; zeros and `None` without a file.
pub(super) fn zero_of(
    session: &mut Work,
    job: &Job,
    measured: &Measured,
    gauges: &[String],
) -> Result<(Vec<f64>, Option<f64>), Faults> {
    let Some(named) = &measured.zero else {
        return Ok((vec![0.0; gauges.len()], None));
    };
    let table = read_strain(&mut session.inputs, job, named)?;
    let columns = columns_of(session, named, &table.gauges, gauges);
    let mut effective = f64::INFINITY;
    let mut zero = vec![0.0; gauges.len()];
    for (z, c) in zero.iter_mut().zip(&columns) {
        let Some(c) = c else { continue };
        let v: Vec<f64> = (0..table.n_rows())
            .filter_map(|i| table.row(i).get(*c).copied())
            .filter(|v| v.is_finite())
            .collect();
        if v.is_empty() {
            *z = f64::NAN;
            continue;
        }
        *z = v.iter().sum::<f64>() / v.len() as f64 * MICROSTRAIN;
        effective = effective.min(effective_samples(&v));
    }
    Ok((zero, effective.is_finite().then_some(effective)))
}

/// Reads the strain of the runs and recovers their loads.
pub(super) fn solve(session: &mut Work, task: &Task) -> Result<(Vec<Readings>, Recovery), Faults> {
    let s = &task.prepared.sensitivity;
    let named = &task.measured.strain;
    let table = session.stage("read strain", |x| {
        read_strain(&mut x.inputs, task.job, named)
    })?;
    let StrainRows::Runs(names) = &table.rows else {
        return Err(Faults::from(Fault::of(
            &*named.given,
            "time",
            "a record can't be read as runs",
            "name the column of runs `run`",
        )));
    };
    let columns = columns_of(session, named, &table.gauges, &s.gauges);
    if columns.iter().all(Option::is_none) {
        return Err(Faults::from(Fault::at(
            &*named.given,
            1,
            "gauge",
            "no column is named after a gauge of the job",
            "name the columns after the gauges",
        )));
    }
    let mut readings = readings_of(&table, names, &columns, task);
    known_payload::take_out(session, task, &mut readings)?;
    let recovery = session.stage("recover", |_| recover(s, &readings, task.errors));
    session.findings.extend(recovery.findings.iter().cloned());
    Ok((readings, recovery))
}

pub(super) fn run(
    session: &mut Session,
    arguments: &JobArguments,
    task: &Task,
) -> Result<(), Faults> {
    let s = &task.prepared.sensitivity;
    let (readings, recovery, listed) = listed_runs(session, task)?;
    let units = listed.units;
    let answer = RecoveredRuns::of(s, &recovery, &units);
    session.put("loads", &answer.loads)?;
    session.put("residual_rms_microstrain", answer.residual_rms_microstrain)?;
    session.put("gauges", &answer.gauges)?;
    session.put("runs", &answer.runs)?;
    let shown: Vec<RecoveredRun> = recovery.runs.iter().map(|r| shown_run(r, &units)).collect();
    let points: Vec<GaugePoints> = (0..s.gauges.len())
        .map(|g| GaugePoints {
            name: s.gauges[g].clone(),
            residual: recovery.gauge_residual_rms[g] / MICROSTRAIN,
            points: [0.0, recovery.gauge_leverage[g]].map(|leverage| {
                let pairs = recovery.runs.iter().zip(&readings);
                pairs
                    .map(|(r, y)| {
                        let (predicted, measured) = (r.predicted[g], y.strain[g]);
                        (
                            held_out(predicted, measured, leverage) / MICROSTRAIN,
                            measured / MICROSTRAIN,
                        )
                    })
                    .collect()
            }),
        })
        .collect();
    let by_gauge: Vec<(String, f64, f64)> = (0..s.gauges.len())
        .map(|g| {
            (
                s.gauges[g].clone(),
                recovery.gauge_residual_rms[g] / MICROSTRAIN,
                recovery.gauge_leverage[g],
            )
        })
        .collect();
    let numbers = vec![
        ("Runs".to_owned(), recovery.runs.len().to_string()),
        (
            "Residual, microstrain rms".to_owned(),
            format!("{:.3}", recovery.residual_rms / MICROSTRAIN),
        ),
        (
            "Condition number, scaled".to_owned(),
            format!("{:.2}", s.condition_number_scaled()),
        ),
    ];
    let scene = scene_of_job(task.job, task.prepared).map(|mut scene| {
        scene.arrows = run_arrows(task.job, scene.model, &shown, Shown::Interval);
        scene
    });
    let found = Recovered {
        sensitivity: s,
        runs: &shown,
        points: &points,
        traces: &[],
        by_gauge: &by_gauge,
        numbers: &numbers,
    };
    let page = recover_page(&task.job.title, scene.as_ref(), &found, &session.findings);
    for r in &recovery.runs {
        let list: Vec<String> = units
            .iter()
            .enumerate()
            .map(|(l, u)| {
                let half = r.estimate.coverage_factor * r.estimate.sigma(l);
                format!(
                    "{} {:.4} +- {:.4} {}",
                    r.estimate.names[l],
                    r.estimate.values[l] * u.factor,
                    half * u.factor,
                    u.name
                )
            })
            .collect();
        session.say(format!("{}: {}", r.estimate.run, list.join(", ")));
    }
    let out = session.output_for(&arguments.job)?;
    out.write("loads.csv", |w| loads_csv(w, &recovery, &units))
        .map_err(Faults::from)?;
    session.write_page(&arguments.job, page)?;
    let names = listed.names;
    let files = &task.job.recover.files;
    if files
        .as_ref()
        .is_none_or(|f| f.contains(&LoadFile::Nastran))
    {
        write_nastran_runs(session, arguments, task, &names, &recovery)?;
    }
    write_arrows(session, arguments, task, &names, &units, &recovery)?;
    let sheets = [runs_sheet(&shown), residual_sheet(&by_gauge)];
    write_spreadsheet(session, task.job, &arguments.job, "loads.xlsx", &sheets)
}

/// What all other gauges predict of this one, from its own prediction and leverage; NaN where the others say nothing of it.
fn held_out(predicted: f64, measured: f64, leverage: f64) -> f64 {
    /// Leverage from which the others say next to nothing.
    const ALONE: f64 = 0.999;
    if leverage < ALONE {
        measured - (measured - predicted) / (1.0 - leverage)
    } else {
        f64::NAN
    }
}

fn readings_of(
    table: &StrainTable,
    names: &[String],
    columns: &[Option<usize>],
    task: &Task,
) -> Vec<Readings> {
    names
        .iter()
        .enumerate()
        .map(|(i, run)| {
            let row = table.row(i);
            let strain = columns
                .iter()
                .zip(&task.zero)
                .map(|(c, z)| {
                    c.and_then(|c| row.get(c))
                        .map_or(f64::NAN, |v| v * MICROSTRAIN - z)
                })
                .collect();
            Readings {
                run: run.clone(),
                strain,
                noise_factor: task.noise_factor,
            }
        })
        .collect()
}

/// Loads of the runs as they are listed, sums among them, with everything that is to be said of them.
pub(super) fn listed_runs(
    work: &mut Work,
    task: &Task,
) -> Result<(Vec<Readings>, Recovery, Listed), Faults> {
    let s = &task.prepared.sensitivity;
    let (readings, mut recovery) = solve(work, task)?;
    let listed = listed(task.job, s)?;
    let k = s.loads.len();
    work.findings
        .extend(sums(task, &recovery, &listed.units[..k]));
    for run in &mut recovery.runs {
        run.estimate.add_sums(&listed.names[k..], &listed.sums);
    }
    Ok((readings, recovery, listed))
}

fn shown_run(r: &crate::recovery::RunEstimate, units: &[LoadUnits]) -> RecoveredRun {
    RecoveredRun {
        run: r.estimate.run.clone(),
        loads: units
            .iter()
            .enumerate()
            .map(|(l, u)| {
                let [low, high] = r.estimate.interval(l);
                (
                    r.estimate.names[l].clone(),
                    [low, r.estimate.values[l], high].map(|v| v * u.factor),
                    u.name.clone(),
                )
            })
            .collect(),
    }
}

fn loads_csv(w: &mut dyn Write, recovery: &Recovery, units: &[LoadUnits]) -> std::io::Result<()> {
    write!(w, "run")?;
    for name in recovery.runs.first().map_or(&[][..], |r| &r.estimate.names) {
        for column in [name.clone(), format!("{name}.low"), format!("{name}.high")] {
            write!(w, ",{}", csv_cell(&column))?;
        }
    }
    writeln!(w)?;
    for r in &recovery.runs {
        write!(w, "{}", csv_cell(&r.estimate.run))?;
        for (l, u) in units.iter().enumerate() {
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

/// Equilibrium: the sum of all forces by direction, where it is far from zero in a run.
fn sums(task: &Task, recovery: &Recovery, units: &[LoadUnits]) -> Vec<Finding> {
    let mut worst: Vec<String> = Vec::new();
    let mut largest = 0.0_f64;
    for component in ["FX", "FY", "FZ"] {
        let members: Vec<usize> = task
            .job
            .loads
            .iter()
            .enumerate()
            .filter(|(_, l)| matches!(l.acts, LoadActs::AtGrid { component: c, cid: 0, .. } if c.name() == component))
            .map(|(i, _)| i)
            .collect();
        if members.len() < 2 {
            continue;
        }
        let k = units.len();
        for r in &recovery.runs {
            let sum: f64 = members.iter().map(|&l| r.estimate.values[l]).sum();
            let size: f64 = members.iter().map(|&l| r.estimate.values[l].abs()).sum();
            let var: f64 = members
                .iter()
                .flat_map(|&a| members.iter().map(move |&b| (a, b)))
                .map(|(a, b)| r.estimate.covariance[a * k + b])
                .sum();
            let sigma = var.max(0.0).sqrt();
            if sum.abs() > 4.0 * sigma && sum.abs() > 0.1 * size {
                let u = &units[members[0]];
                worst.push(format!(
                    "{} {component} {:+.3} +- {:.3} {}",
                    r.estimate.run,
                    sum * u.factor,
                    NORMAL_95 * sigma * u.factor,
                    u.name
                ));
                largest = largest.max(sum.abs() / size);
            }
        }
    }
    if worst.is_empty() {
        return Vec::new();
    }
    let more = worst.len().saturating_sub(6);
    worst.truncate(6);
    let rest = if more > 0 {
        format!(" and {more} more")
    } else {
        String::new()
    };
    vec![
        Finding::new(
            Severity::Info,
            "loads-not-in-balance",
            "equilibrium",
            format!("the recovered forces do not add up to zero: {}{rest}. Under inertia relief acceleration takes the rest", worst.join("; ")),
            "at a standstill they must: then a load is missing, or a sign or an `applied` is wrong",
        )
        .with_numbers(largest, 0.1),
    ]
}
