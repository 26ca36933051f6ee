//! Readings of the runs: net strain with its noise, changes of the wheel forces, known places.

use super::task::Task;
use crate::finding::{Finding, Severity, list_few};
use crate::host::fault::{Fault, Faults};
use crate::host::outcome::finite_or_none;
use crate::host::work::Work;
use crate::job::{Measured, NamedFile};
use crate::measured::common_zero::common_zero;
use crate::measured::faults::no_gauge_column;
use crate::measured::means::{StrainFile, read_strain_file};
use crate::measured::runs_file::{RunRow, read_runs};
use crate::measured::strain_file::wanted_columns;
use crate::measured::strain_table::{StrainRows, StrainTable};
use crate::measured::zero::{no_zero_runs, note_columns, zeros_by_row};
use crate::payload::{PayloadModel, PayloadRun, Place};
use crate::reconcile::strain::WheelForces;
use crate::recovery::net::{Net, WEAK, mean_of, net};
use crate::units::MICROSTRAIN;
use serde::Serialize;

/// Noise of a wheel force over the largest wheel force, if the job states no noise.
pub(super) const ASSUMED_NOISE: f64 = 0.01;

/// Net reading of a gauge in a run: reading minus zero.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NetReading {
    /// The run.
    pub run: String,
    /// The gauge.
    pub name: String,
    /// Net reading, microstrain.
    pub net_microstrain: Option<f64>,
    /// Standard deviation of the net reading, microstrain.
    pub sigma_microstrain: Option<f64>,
    /// Net reading divided by its standard deviation.
    pub signal_to_noise: Option<f64>,
}

/// Readings of all runs.
pub(super) struct Readings {
    /// The runs to be weighed.
    pub runs: Vec<PayloadRun>,
    /// Net reading of each gauge in each run: reading minus zero.
    pub net: Vec<NetReading>,
}

/// Returns the runs to be weighed.
///
/// # Errors
/// Tables that can't be read, and runs that lack data for the answer.
pub(super) fn runs_of(
    work: &mut Work,
    task: &Task,
    model: &PayloadModel,
    use_strain: bool,
    use_reactions: bool,
) -> Result<Readings, Faults> {
    let job = task.job;
    let rows = match &job.runs {
        Some(runs) => read_runs(&mut work.inputs, job, runs)?,
        None => Vec::new(),
    };
    // If the job has no wheels and strain is used, no wheel forces are needed.
    let asked = use_reactions && !(use_strain && task.wheels.is_empty());
    let reactions = asked && accept_wheel_forces(work, task, use_strain);
    if !use_strain && !reactions {
        return Err(Faults::from(Fault::with_line(
            &*job.file,
            task.payload.line,
            "payload.use",
            "the wheel forces are computed, not measured, and there is no strain",
            "give measured strain or wheel forces",
        )));
    }
    let unloaded = find_unloaded_run(task, &rows)?;
    let mut out: Vec<PayloadRun> = Vec::new();
    let mut net = Vec::new();
    if use_strain {
        let read = strain(work, task, model)?;
        if let Some(name) = &task.payload.unloaded
            && rows.is_empty()
            && !read.iter().any(|(run, _)| run == name)
        {
            return Err(no_unloaded_run(task, "the strain file", name));
        }
        net = net_rows(model, &read);
        for (run, nets) in read {
            if Some(&run) == task.payload.unloaded.as_ref() {
                continue;
            }
            out.push(PayloadRun {
                run,
                strain: nets.iter().map(|n| n.value).collect(),
                sigma: nets.iter().map(|n| n.sigma).collect(),
                reactions: Vec::new(),
                shift: [0.0; 2],
            });
        }
    } else {
        let others = rows
            .iter()
            .filter(|r| Some(&r.run) != task.payload.unloaded.as_ref());
        out.extend(others.map(|r| PayloadRun {
            run: r.run.clone(),
            strain: Vec::new(),
            sigma: Vec::new(),
            reactions: Vec::new(),
            shift: [0.0; 2],
        }));
    }
    same_runs(work, task, &rows, &out)?;
    let without = shifts_and_reactions(task, &rows, unloaded, reactions, &mut out);
    if !without.is_empty() {
        if model.floor.is_none() || !use_strain {
            return Err(Faults::from(Fault::with_line(
                &*job.file,
                job.runs.as_ref().map_or(0, |r| r.line),
                "runs",
                format!("no force of some wheel for {}", list_few(&without)),
                "add their rows and columns",
            )));
        }
        work.findings.push(Finding::new(
            Severity::Warning,
            "run-without-wheel-forces",
            list_few(&without),
            "these runs do not contain the force of every wheel: all runs are weighed by strain on a flat floor",
            "add their rows and columns to the runs file",
        ));
    } else if !reactions && model.floor.is_none() {
        return Err(Faults::from(Fault::with_line(
            &*job.file,
            task.payload.line,
            "payload",
            "a given S contains no floor: without measured wheel forces the payload is not determined",
            "give a [model], or measured wheel forces with `use = [\"strain\", \"reactions\"]`",
        )));
    }
    if out.is_empty() {
        return Err(Faults::from(Fault::new(
            &*job.file,
            "run",
            "there is no run with a payload",
            "add rows to the strain or runs file",
        )));
    }
    // All runs are weighed by the same rule: if one run lacks wheel forces, no run uses them.
    if !without.is_empty() {
        out.iter_mut().for_each(|r| r.reactions.clear());
    }
    Ok(Readings { runs: out, net })
}

/// Checks that the runs file has a row for at least one run of the strain file. Adds a warning if it gives a known place for only some of the runs.
///
/// # Errors
/// A runs file without a row for any run of the strain file.
fn same_runs(
    work: &mut Work,
    task: &Task,
    rows: &[RunRow],
    read: &[PayloadRun],
) -> Result<(), Faults> {
    let Some(runs) = task.job.runs.as_ref().filter(|_| !rows.is_empty()) else {
        return Ok(());
    };
    let row = |run: &PayloadRun| rows.iter().find(|row| row.run == run.run);
    let names = |some: &mut dyn Iterator<Item = &PayloadRun>| {
        let names: Vec<&str> = some.map(|r| r.run.as_str()).collect();
        list_few(&names)
    };
    // The strain of a single record has the name of its file, which the runs file may lack.
    if read.len() > 1 && !read.iter().any(|run| row(run).is_some()) {
        let all = names(&mut read.iter());
        return Err(Fault::with_line(
            &*runs.file.given,
            1,
            "run",
            format!("no row for any run of the strain file ({all})"),
            "give the runs the same names in both files",
        )
        .into());
    }
    let is_placed = |run: &&PayloadRun| {
        row(run).is_some_and(|r| r.payload_x_m.is_some() || r.payload_y_m.is_some())
    };
    let (placed, unplaced): (Vec<&PayloadRun>, Vec<&PayloadRun>) = read.iter().partition(is_placed);
    if task.payload.position == Place::Known && !placed.is_empty() && !unplaced.is_empty() {
        work.findings.push(
            Finding::new(
                Severity::Warning,
                "payload-place-assumed",
                names(&mut unplaced.iter().copied()),
                "the runs file gives no place of the payload in these runs: the nominal place is used",
                "give payload_x and payload_y of every run",
            )
            .with_numbers(unplaced.len() as f64, 0.0),
        );
    }
    Ok(())
}

/// Adds the known places of the runs and, if requested, their wheel forces. Returns the names of the runs that lack wheel forces.
fn shifts_and_reactions(
    task: &Task,
    rows: &[RunRow],
    unloaded: Option<&RunRow>,
    reactions: bool,
    out: &mut [PayloadRun],
) -> Vec<String> {
    let job = task.job;
    let metre = job.report_units.length.si;
    let newton = job.report_units.force.si;
    let mut without: Vec<String> = Vec::new();
    for run in out {
        let row = rows.iter().find(|r| r.run == run.run);
        let known = task.payload.position == Place::Known;
        if let Some(row) = row.filter(|_| known) {
            for (k, at) in [row.payload_x_m, row.payload_y_m].into_iter().enumerate() {
                if let Some(at) = at {
                    run.shift[k] = at / metre - task.nominal[k];
                }
            }
        }
        if let (true, None, Some(at)) = (known, row, task.payload.nominal_x) {
            run.shift[0] = at * task.length - task.nominal[0];
        }
        if reactions {
            let of = |row: &RunRow| -> Vec<f64> {
                task.wheels
                    .iter()
                    .map(|w| row.loads_si.get(w).map_or(f64::NAN, |v| v / newton))
                    .collect()
            };
            let values = row.map_or_else(|| vec![f64::NAN; task.wheels.len()], of);
            let values: Vec<f64> = match unloaded {
                Some(u) => values.iter().zip(of(u)).map(|(v, u)| v - u).collect(),
                None => values,
            };
            if values.iter().all(|v| v.is_finite()) {
                run.reactions = values;
            } else {
                without.push(run.run.clone());
            }
        }
    }
    without
}

/// Returns whether the wheel forces count as evidence. Adds a finding if strain is used instead, or if their noise is assumed.
fn accept_wheel_forces(work: &mut Work, task: &Task, use_strain: bool) -> bool {
    let Some(runs) = &task.job.runs else {
        return false;
    };
    if runs.wheel_forces == WheelForces::Measured {
        if runs.noise.force.is_none_or(|s| s <= 0.0) {
            work.findings.push(Finding::new(
                Severity::Info,
                "reaction-noise-assumed",
                "runs.noise.force",
                "the job does not state the noise of the wheel forces: 1 % of the largest force is assumed",
                "state [runs] noise = { force = 0.06 }",
            ));
        }
        return true;
    }
    if use_strain {
        work.findings.push(Finding::new(
            Severity::Info,
            "wheel-forces-computed",
            "runs.wheel_forces",
            "the wheel forces were computed for flat ground, not measured. They are not evidence of the payload and are left out",
            "measure them, or use strain",
        ));
    }
    false
}

fn find_unloaded_run<'a>(task: &Task, rows: &'a [RunRow]) -> Result<Option<&'a RunRow>, Faults> {
    let Some(name) = &task.payload.unloaded else {
        return Ok(None);
    };
    match rows.iter().find(|r| r.run == *name) {
        Some(row) => Ok(Some(row)),
        None if task.job.runs.is_none() => Ok(None),
        None => Err(no_unloaded_run(task, "the runs file", name)),
    }
}

fn no_unloaded_run(task: &Task, file: &str, name: &str) -> Faults {
    Faults::from(Fault::with_line(
        &*task.job.file,
        task.payload.line,
        "payload.unloaded",
        format!("{file} has no run `{name}`"),
        "name the run without payload",
    ))
}

/// Returns the net strain of every run by gauge of the model. Adds a finding on gauges that are too weak.
fn strain(
    work: &mut Work,
    task: &Task,
    model: &PayloadModel,
) -> Result<Vec<(String, Vec<Net>)>, Faults> {
    let Some(measured) = &task.job.measured else {
        return Ok(Vec::new());
    };
    let wanted = wanted_columns(&mut work.inputs, task.job);
    let file = work.stage("read strain", |s| {
        read_strain_file(&mut s.inputs, task.job, &measured.strain, &wanted)
    })?;
    note_columns(work, task.job, &measured.strain, (file.gauges(), &wanted));
    let noise = noise_of_gauges(measured, model);
    let zero: Vec<Option<Net>> = match &measured.zero {
        Some(named) => {
            let zero = read_strain_file(&mut work.inputs, task.job, named, &wanted)?;
            means(&zero, model, &noise).into_iter().map(Some).collect()
        }
        None => vec![None; model.gauges.len()],
    };
    let all = means(&file, model, &noise);
    if all.iter().all(|v| !v.value.is_finite()) {
        return Err(no_gauge_column(
            task.job,
            &measured.strain.given,
            file.gauges(),
            &model.gauges,
        )
        .into());
    }
    let (mut runs, from_unloaded) = if let StrainFile::Table(table) = &file
        && let StrainRows::Runs(names) = &table.rows
    {
        of_runs(work, task, model, measured, (table, names), zero)?
    } else {
        no_zero_runs(task.job, measured, &measured.strain.given)?;
        let record = nets(all.into_iter(), &zero);
        (vec![(stem(&measured.strain), record)], false)
    };
    // The unloaded run contains the common zero too, so that it need not be subtracted.
    if !from_unloaded {
        let common = common_zero(work, task.job, &model.gauges)?;
        for (_, nets) in &mut runs {
            for (net, zero) in nets.iter_mut().zip(&common) {
                net.value -= zero;
            }
        }
    }
    report_weak_gauges(work, task, model, &runs);
    Ok(runs)
}

/// Returns one row for each run, and whether the reading of an unloaded run of the table is subtracted from it.
fn of_runs(
    work: &mut Work,
    task: &Task,
    model: &PayloadModel,
    measured: &Measured,
    (table, names): (&StrainTable, &[String]),
    zero: Vec<Option<Net>>,
) -> Result<(Vec<(String, Vec<Net>)>, bool), Faults> {
    let noise = noise_of_gauges(measured, model);
    let readings = by_gauge(table, model);
    // Without a zero file, an unloaded run of the same table is the zero.
    let own = task
        .payload
        .unloaded
        .as_ref()
        .and_then(|u| names.iter().position(|n| n == u))
        .filter(|_| measured.zero.is_none());
    let from_unloaded = own.is_some();
    let zero: Vec<Option<Net>> = match own {
        Some(i) => (readings.iter().zip(&noise))
            .map(|(v, noise)| Some(mean_of(&v[i..=i], *noise)))
            .collect(),
        None => zero,
    };
    let followed = zeros_by_row(work, task.job, measured, table)?;
    let of_run = |i: usize| -> Vec<Net> {
        let each = readings.iter().zip(&noise);
        let means = each.map(|(v, noise)| mean_of(&v[i..=i], *noise));
        let Some(z) = &followed else {
            return nets(means, &zero);
        };
        let column = |g: &String| table.gauges.iter().position(|h| h == g);
        let zeros = model.gauges.iter().zip(&noise).map(|(g, noise)| Net {
            value: column(g).map_or(f64::NAN, |c| z.zero[i][c] * MICROSTRAIN),
            sigma: noise * (z.noise_factor[i] - 1.0).sqrt(),
        });
        means.zip(zeros).map(|(m, z)| net(m, Some(z))).collect()
    };
    let empty = |name: &String| measured.zero_runs.contains(name);
    let runs = names.iter().enumerate().filter(|(_, n)| !empty(n));
    let runs = runs.map(|(i, name)| (name.clone(), of_run(i)));
    Ok((runs.collect(), from_unloaded))
}

/// Means over all rows of a strain file by gauge of the model, strain; NaN where the file has no column.
fn means(file: &StrainFile, model: &PayloadModel, noise: &[f64]) -> Vec<Net> {
    let readings = file.readings();
    let of = |(gauge, noise): (&String, &f64)| {
        let column = file.gauges().iter().position(|h| h == gauge);
        let series = column.and_then(|c| readings.get(c)).copied();
        let net = series.unwrap_or_default().net(noise / MICROSTRAIN);
        Net {
            value: net.value * MICROSTRAIN,
            sigma: net.sigma * MICROSTRAIN,
        }
    };
    model.gauges.iter().zip(noise).map(of).collect()
}

/// Returns the noise of a reading of each gauge of the model, strain.
fn noise_of_gauges(measured: &Measured, model: &PayloadModel) -> Vec<f64> {
    let noise = measured.noise_microstrain * MICROSTRAIN;
    match &model.noise {
        Some(of_gauges) => of_gauges.sd().iter().map(|sd| noise * sd).collect(),
        None => vec![noise; model.gauges.len()],
    }
}

fn nets(means: impl Iterator<Item = Net>, zero: &[Option<Net>]) -> Vec<Net> {
    means.zip(zero).map(|(m, z)| net(m, *z)).collect()
}

fn stem(named: &NamedFile) -> String {
    std::path::Path::new(&named.given)
        .file_stem()
        .map_or_else(|| named.given.clone(), |s| s.to_string_lossy().into_owned())
}

/// Readings of each gauge of the model by row, strain; NaN where the table has no column.
fn by_gauge(table: &StrainTable, model: &PayloadModel) -> Vec<Vec<f64>> {
    model
        .gauges
        .iter()
        .map(|g| {
            let column = table.gauges.iter().position(|h| h == g);
            (0..table.n_rows())
                .map(|i| {
                    column
                        .and_then(|c| table.row(i).get(c))
                        .map_or(f64::NAN, |v| v * MICROSTRAIN)
                })
                .collect()
        })
        .collect()
}

/// Returns the gauges too weak for the job in every run.
fn report_weak_gauges(
    work: &mut Work,
    task: &Task,
    model: &PayloadModel,
    runs: &[(String, Vec<Net>)],
) {
    let (mut weak, mut best) = (Vec::new(), f64::INFINITY);
    for (g, name) in model.gauges.iter().enumerate() {
        let unloaded = task.payload.unloaded.as_ref();
        let loaded = runs.iter().filter(|r| Some(&r.0) != unloaded);
        let ratios = loaded.map(|r| r.1[g].signal_to_noise());
        let most = ratios.filter(|s| s.is_finite()).fold(0.0, f64::max);
        if most < WEAK {
            weak.push(name.as_str());
            best = best.min(most);
        }
    }
    if !weak.is_empty() {
        work.findings.push(
            Finding::new(
                Severity::Warning,
                "gauges-too-weak",
                list_few(&weak),
                "the net reading does not exceed the noise in any run: these gauges do not measure the payload",
                "leave them out, or add gauges where the payload strains the structure (`place`)",
            )
            .with_numbers(best, WEAK),
        );
    }
}

/// Returns the net reading of each gauge in each run.
fn net_rows(model: &PayloadModel, runs: &[(String, Vec<Net>)]) -> Vec<NetReading> {
    let of_run = |(run, nets): &(String, Vec<Net>)| -> Vec<NetReading> {
        let gauges = model.gauges.iter().zip(nets);
        gauges
            .map(|(g, n)| NetReading {
                run: run.clone(),
                name: g.clone(),
                net_microstrain: finite_or_none(n.value / MICROSTRAIN),
                sigma_microstrain: finite_or_none(n.sigma / MICROSTRAIN),
                signal_to_noise: finite_or_none(n.signal_to_noise()),
            })
            .collect()
    };
    runs.iter().flat_map(of_run).collect()
}
