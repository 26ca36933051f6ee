//! Static states.

use super::answer::{AdditionalResults, RecoveredRuns};
use super::calibration_range;
use super::compare;
use super::known_payload::{self, KnownLoads};
use super::listed_loads::{ListedLoads, list_load_columns};
use super::recorded_run_loads;
use super::sections;
use super::task::Task;
use super::validation::{self, ValidationGauge};
use super::vertical_loads::VerticalLoads;
use crate::finding::{Finding, Severity, list_few};
use crate::host::fault::Faults;
use crate::host::work::Work;
use crate::input_faults::identical_columns::identical_readings;
use crate::input_faults::not_explained_by;
use crate::job::correct::channel_of;
use crate::job::{LoadActs, Reference};
use crate::measured::columns::columns_of;
use crate::measured::faults::no_gauge_column;
use crate::measured::strain_table::StrainTable;
use crate::measured::wheels::wheels_of;
use crate::measured::zero::{RowZeros, zeros_by_row};
use crate::recovery::{Readings, Recovery, recover_with_alternatives};
use crate::sensitivity::Sensitivity;
use crate::strain_chain::{LoadUnits, alternative_rows};
use crate::units::MICROSTRAIN;
use std::collections::{HashMap, HashSet};

/// Returns the readings of the runs after subtraction of their zeros and of the strain of known loads, together with these loads.
pub(super) fn read(
    work: &mut Work,
    task: &Task,
    table: &StrainTable,
) -> Result<(Vec<Readings>, KnownLoads), Faults> {
    let s = &task.prepared.sensitivity;
    let named = &task.measured.strain;
    let names = table.runs();
    let columns = columns_of(work, named, &table.gauges, &s.gauges);
    if columns.iter().all(Option::is_none) {
        return Err(no_gauge_column(task.job, &named.given, &table.gauges, &s.gauges).into());
    }
    let zeros = zeros_by_row(work, task.job, task.measured, table)?;
    let mut readings = readings_of(table, names, &columns, task, zeros.as_ref());
    // Gauges that the job ignores are not missing.
    let asked: Vec<(usize, &str)> = (task.estimating.iter())
        .map(|g| (columns[*g], &s.gauges[*g]))
        .filter(|(_, gauge)| !channel_of(&task.job.corrections, gauge).ignore)
        .filter_map(|(column, gauge)| Some((column?, gauge.as_str())))
        .collect();
    work.findings.extend(blanks(table, names, &asked));
    let known = known_payload::take_out(work, task, &mut readings)?;
    Ok((readings, known))
}

/// Returns warnings of blank readings, of runs in which all gauges give one and the same number, and of copies of other runs.
fn blanks(table: &StrainTable, names: &[String], gauges: &[(usize, &str)]) -> Vec<Finding> {
    /// Smallest number of gauges whose readings are not equal to the last digit by chance.
    const MANY: usize = 3;
    /// Smallest number of different values in a table, per gauge, for the search for copies. With fewer values the logger rounds so much that runs
    /// may be equal by chance.
    const FINE: usize = 8;
    let all = (0..names.len()).flat_map(|i| {
        let row = table.row(i);
        gauges.iter().filter_map(move |(c, _)| row.get(*c))
    });
    let different: HashSet<u64> = all.map(|v| v.to_bits()).collect();
    let fine = different.len() >= (FINE * gauges.len()).min(names.len() * gauges.len() / 2);
    let (mut blank, mut n, mut alike) = (Vec::new(), 0_usize, Vec::new());
    let (mut first_with, mut repeated) = (HashMap::new(), Vec::new());
    for (i, name) in names.iter().enumerate() {
        let row = table.row(i);
        let read = gauges.iter().filter_map(|(c, _)| row.get(*c));
        let numbers: Vec<f64> = read.copied().filter(|v| v.is_finite()).collect();
        let first = numbers.first().filter(|_| numbers.len() >= MANY);
        if let Some(first) = first
            && numbers.iter().all(|v| v == first)
        {
            alike.push(name.as_str());
        } else if fine && numbers.len() >= MANY && numbers.len() == gauges.len() {
            let bits: Vec<u64> = numbers.iter().map(|v| v.to_bits()).collect();
            let first = *first_with.entry(bits).or_insert(name);
            if first != name {
                repeated.push(format!("{first} and {name}"));
            }
        }
        for (c, gauge) in gauges {
            if row.get(*c).is_none_or(|v| !v.is_finite()) {
                n += 1;
                blank.push(format!("{gauge} in {name}"));
            }
        }
    }
    let mut out = Vec::new();
    if n > 0 {
        out.push(
            Finding::new(
                Severity::Warning,
                "readings-missing",
                list_few(&blank),
                format!("{n} readings of `{}` are blank. Loads of these runs are computed from the other gauges, with wider intervals", table.file),
                "repair the channel, or exclude its gauge: [[correction]] ignore = true",
            )
            .with_numbers(n as f64, 0.0),
        );
    }
    if !repeated.is_empty() {
        out.push(
            Finding::new(
                Severity::Warning,
                "readings-repeated",
                list_few(&repeated),
                "the readings of these runs agree at all gauges to the last digit. Two measurements never agree to this precision. One run is a copy",
                "check the runs in the files of the logger",
            )
            .with_numbers(repeated.len() as f64, 0.0),
        );
    }
    if !alike.is_empty() {
        out.push(
            Finding::new(
                Severity::Warning,
                "readings-all-alike",
                list_few(&alike),
                "in these runs all gauges have one common reading, as a logger without signal gives. The readings are used",
                "leave the run out if nothing was measured; leave missing readings blank",
            )
            .with_numbers(alike.len() as f64, 0.0),
        );
    }
    out
}

/// Loads of the runs, with the data from which they were estimated.
pub(super) struct RunRecovery {
    /// S of the gauges that loads are estimated from.
    pub s: Sensitivity,
    pub readings: Vec<Readings>,
    pub recovery: Recovery,
    pub validation: Vec<ValidationGauge>,
    /// Loads that the runs file states and that were not recovered.
    pub known: KnownLoads,
}

/// Reads the strain of the runs and recovers their loads.
pub(super) fn solve(
    work: &mut Work,
    task: &Task,
    table: &StrainTable,
) -> Result<RunRecovery, Faults> {
    let mut s = task.prepared.sensitivity.of_gauges(&task.estimating);
    let (all, known) = read(work, task, table)?;
    let readings: Vec<Readings> = all.iter().map(|r| r.of_gauges(&task.estimating)).collect();
    let mut recovery = work.stage("recover", |work| {
        let fields = task.prepared.fields.as_ref();
        let mut others = || alternative_rows(work, task.job, fields, &s.gauges);
        recover_with_alternatives(&s, &readings, task.errors, &mut others)
    });
    work.findings.extend(find_identical_readings(&s, &readings));
    s = recovery.s(&s);
    let validation = validation::of_runs(task, (&s, &readings), &all, &recovery);
    work.findings
        .extend(validation::report_contradictions(&validation));
    let wrong = recorded_run_loads::wrong_records(work, task, (&s, &readings), &recovery, &known)?;
    work.findings
        .extend(not_explained_by(&recovery.findings, wrong));
    for (run, loads) in recovery.runs.iter_mut().zip(&known) {
        for (l, value) in loads {
            if let Some(found) = run.estimate.values.get_mut(*l) {
                *found += value;
            }
        }
    }
    work.findings.extend(recovery.findings.iter().cloned());
    Ok(RunRecovery {
        s,
        readings,
        recovery,
        validation,
        known,
    })
}

fn readings_of(
    table: &StrainTable,
    names: &[String],
    columns: &[Option<usize>],
    task: &Task,
    zeros: Option<&RowZeros>,
) -> Vec<Readings> {
    names
        .iter()
        .enumerate()
        .map(|(i, run)| {
            let row = table.row(i);
            let strain = columns.iter().zip(&task.zero).map(|(c, z)| {
                let reading = c.and_then(|c| {
                    let own = zeros.map_or(Some(0.0), |z| z.zero[i].get(c).copied())?;
                    Some((row.get(c)? - own) * MICROSTRAIN)
                });
                reading.unwrap_or(f64::NAN) - z
            });
            Readings {
                run: run.clone(),
                strain: strain.collect(),
                noise_factor: zeros.map_or(task.noise_factor, |z| z.noise_factor[i]),
            }
        })
        .collect()
}

/// Returns the loads of the runs, sums among them, and adds all findings on them.
///
/// # Errors
/// Unreadable tables; sums of loads that S lacks.
pub(super) fn runs(
    work: &mut Work,
    task: &Task,
    table: &StrainTable,
) -> Result<(RecoveredRuns, AdditionalResults), Faults> {
    sections::without_record(task.job)?;
    let RunRecovery {
        s,
        readings,
        mut recovery,
        validation,
        known,
    } = solve(work, task, table)?;
    let ListedLoads {
        names,
        units,
        sums: combinations,
    } = list_load_columns(task.job, &s)?;
    let comparison = compare::runs(work, task, (&s, &readings), (&recovery, &units), &known)?;
    let k = s.loads.len();
    work.findings.extend(sums(task, &recovery, &units[..k]));
    let outside = calibration_range::of_runs(task, (&s, &readings), &recovery, &units[..k]);
    work.findings.extend(outside);
    let high = |l: usize| {
        let of_runs = recovery.runs.iter().map(|r| r.estimate.interval(l)[1]);
        of_runs.fold(f64::NEG_INFINITY, |m, v| {
            if v.is_nan() { f64::INFINITY } else { m.max(v) }
        })
    };
    let high: Vec<f64> = (0..k).map(high).collect();
    let states = format!("in all {} runs", recovery.runs.len());
    let vertical = VerticalLoads::of_job(task.job);
    work.findings
        .extend(vertical.check_sign(&states, &high, &units[..k]));
    for run in &mut recovery.runs {
        run.estimate.add_sums(&names[k..], &combinations);
    }
    let runs = RecoveredRuns::from_recovery(&s, readings, recovery, names, units);
    let beside = AdditionalResults {
        validation,
        comparison,
        sections: Vec::new(),
        reading_conditioning: Vec::new(),
    };
    Ok((runs, beside))
}

/// Returns axis and size of the weight that total loads carry; `None` if loads are changes. With the reference "gravity", wheels carry the
/// model.
fn weight_carried(task: &Task) -> Option<(usize, f64)> {
    let fields = task.prepared.fields.as_ref()?;
    if task.measured.reference != Reference::Gravity {
        return None;
    }
    let model = fields.model();
    let wheels = wheels_of(task.job, model).ok()?;
    Some((wheels.axis, model.weight().mass * task.job.gravity()))
}

/// Returns findings on equilibrium: the sum of all forces in a direction is far from the weight, or from zero, in a run.
fn sums(task: &Task, recovery: &Recovery, units: &[LoadUnits]) -> Vec<Finding> {
    let carried = weight_carried(task);
    let mut worst: Vec<String> = Vec::new();
    let mut largest = 0.0_f64;
    for (axis, component) in ["FX", "FY", "FZ"].into_iter().enumerate() {
        let weight = carried.filter(|w| w.0 == axis).map_or(0.0, |w| w.1);
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
            let half = r.estimate.coverage_factor * var.max(0.0).sqrt();
            let gap = (sum - weight).abs();
            let size = size.max(weight);
            if gap > 2.0 * half && gap > 0.1 * size {
                let u = &units[members[0]];
                let expected = match carried {
                    Some(_) => format!(" (expected {:.3})", weight * u.factor),
                    None => String::new(),
                };
                worst.push(format!(
                    "{} {component} {:+.3} ± {:.3} {}{expected}",
                    r.estimate.run,
                    sum * u.factor,
                    half * u.factor,
                    u.name
                ));
                largest = largest.max(gap / size);
            }
        }
    }
    if worst.is_empty() {
        return Vec::new();
    }
    vec![
        Finding::new(
            Severity::Info,
            "loads-not-in-balance",
            "equilibrium",
            format!(
                "the recovered forces do not add up to {}: {}. Under inertia relief acceleration balances the rest",
                if carried.is_some() { "the weight of the model" } else { "zero" },
                list_few(&worst)
            ),
            "if the vehicle was at standstill, check for a missing load, a wrong sign or a wrong `applied`",
        )
        .with_numbers(largest, 0.1),
    ]
}

/// Returns the finding on gauges with the same readings.
pub(super) fn find_identical_readings(s: &Sensitivity, readings: &[Readings]) -> Option<Finding> {
    let of_gauge = |g: usize| readings.iter().map(|r| r.strain[g]).collect();
    let columns: Vec<Vec<f64>> = (0..s.gauges.len()).map(of_gauge).collect();
    identical_readings(&s.gauges, &columns)
}
