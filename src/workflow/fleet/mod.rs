//! `fleet`: records of many vehicles and days, one small result a file, merged by vehicle.
//!
//! [`kernel`] turns a record into a [`day::Day`] on any number of threads and without a file. [`stored_results`] stores the day by the digest of its
//! inputs. A second run therefore processes only new records, and many machines can share one folder. [`merge`] joins the days of a vehicle exactly.

mod calibration_range;
mod conditioned_record;
mod damage_references;
pub mod day;
mod days;
mod dead_parts;
mod drift;
mod gauge_history;
mod health;
mod job_kernel;
pub mod kernel;
pub mod merge;
mod mission;
pub mod name;
mod other_scale;
mod other_unit;
mod outcome;
mod quasi_static;
mod record_findings;
mod record_recovery;
pub mod records;
mod requested_records;
mod sample_tests;
mod sampled_readings;
mod scale;
pub mod stored_results;

pub use damage_references::ReferenceAnswer;
pub use gauge_history::{DeadPart, GaugeHistory};
pub use job_kernel::kernel_of;
pub use merge::{RecordOf, SampleOf};
pub use mission::{KindAnswer, MissionAnswer, MissionLoad};
pub use outcome::{FileAnswer, Fleet, VehicleAnswer, VehicleLoadAnswer};
pub use stored_results::digests_of;

use crate::finding::{Finding, Severity, list_few};
use crate::host::context::{Context, Files};
use crate::host::fault::{Fault, Faults};
use crate::host::files::OpenedFile;
use crate::host::outcome::{Outcome, StatedUnits};
use crate::host::words::count_of;
use crate::host::work::{Work, cancelled_fault};
use crate::job::{Fleet as FleetKeys, Job};
use conditioned_record::FleetRecord;
use damage_references::{DamageReferences, check_targets};
use day::{Day, FileHead, FileResult};
use days::DayOrder;
use drift::drift;
use kernel::Kernel;
use merge::{Status, sort_files, vehicle};
use name::{NameForm, Shard};
use other_scale::in_other_scale;
use other_unit::in_other_units;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use stored_results::{KeptDays, digest};

/// Inputs of a fleet run.
#[derive(Clone, Debug, Default)]
pub struct FleetSpec {
    /// Records, folders of records and patterns, relative to the working folder ([`records::records_of`]). If empty, the results in the output folder
    /// are merged.
    pub files: Vec<PathBuf>,
    /// Part of the records to process; all records if `None`.
    pub shard: Option<Shard>,
    /// Output folder, which also stores the results of single files.
    pub folder: PathBuf,
    /// SHA-256 of records by path, as computed by another process. A record with a stored result is not read again if its size and its time of change
    /// are unchanged. For a record that this process can't reach, the digest of the other process is used.
    pub digests: BTreeMap<String, String>,
}

/// Recovers the loads of many records and sums cycles, damage and channel faults by vehicle. A record that can't be read is a failed file
/// with an error finding, and all other records are processed.
///
/// # Errors
/// Returns every fault of the job and of the files that it names, or an output folder that can't be written.
///
/// # Example
/// Carrier B swings a fifth more than carrier A, so with the slope 5 its damage is `1.2^5` times as large:
/// ```
/// use strainbridge::workflow::fleet::FleetSpec;
/// use strainbridge::{Context, Disk, Job, fleet};
///
/// # let out = std::env::temp_dir().join(format!("strainbridge-fleet-{}", std::process::id()));
/// let folder = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/fleet"));
/// let job = Job::read(folder.join("fleet.toml"), &Disk)?;
/// let spec = FleetSpec {
///     files: ["A_2026-05-01.csv", "B_2026-05-01.csv"].map(|f| folder.join(f)).to_vec(),
///     folder: out.clone(),
///     ..FleetSpec::default()
/// };
/// let found = fleet(&job, &spec, &Context::new(&Disk))?;
/// let damage: Vec<f64> = found.vehicles.iter().map(|v| v.loads[0].damage).collect();
/// assert!((damage[1] / damage[0] / 1.2_f64.powi(5) - 1.0).abs() < 0.05);
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fleet(job: &Job, spec: &FleetSpec, cx: &Context) -> Result<Outcome<Fleet>, Faults> {
    let mut work = Work::of_job(cx, job);
    let Some(section) = &job.fleet else {
        let remedy = "add [fleet] file_name = \"{vehicle}_{day}.parquet\"";
        return Err(Fault::new(&*job.file, "fleet", "the job has no [fleet]", remedy).into());
    };
    let form = NameForm::parse(&section.file_name.given).map_err(|wrong| {
        let remedy = "write it as \"{vehicle}_{day}.parquet\"";
        Faults::from(Fault::with_line(
            &*job.file,
            section.file_name.line,
            "fleet.file_name",
            wrong,
            remedy,
        ))
    })?;
    let kernel = kernel_of(&mut work, job)?;
    let loads: Vec<&str> = kernel.listed.names.iter().map(String::as_str).collect();
    check_targets(&job.file, section, &loads)?;
    let kept = KeptDays::new(&spec.folder, job_digest(&mut work, job, section));
    let order = |names: &mut dyn Iterator<Item = &str>| {
        DayOrder::from_names(names).map_err(|e| {
            let line = section.file_name.line;
            Fault::with_line(&*job.file, line, "fleet.file_name", e.wrong, e.remedy)
        })
    };
    let spec = &FleetSpec {
        files: records::records_of(&spec.files, &form)?,
        ..spec.clone()
    };
    // The order of the days is checked first, because a fault would waste hours of work.
    let asked = spec.files.iter();
    let asked: Vec<name::VehicleDay> = asked
        .filter_map(|p| form.read(&p.display().to_string()))
        .collect();
    order(&mut asked.iter().map(|n| n.day.as_str()))?;
    let (files, reused) = if spec.files.is_empty() {
        read_stored_results(&mut work, &kept, &spec.folder)?
    } else {
        work.sources.extend(spec.files.iter().cloned());
        work.stage("records", |w| {
            evaluate_files(w, &kernel, &kept, &form, spec)
        })?
    };
    let days_in = order(
        &mut files
            .iter()
            .map(|f| f.day.as_str())
            .filter(|d| !d.is_empty()),
    )?;
    let MergedVehicles {
        vehicles,
        status,
        compared,
    } = work.stage("merge", |w| {
        merge_vehicles(w, &kept, &files, days_in, &job.file, section)
    })?;
    if spec.shard.is_none() {
        let is_all = spec.files.is_empty();
        let absent = compared.check(&job.file, section, is_all)?;
        work.findings.extend(absent);
    }
    let kept = count_of(reused, "result");
    work.notes.push(format!("{kept} stored by an earlier run"));
    let answer = Fleet::from_vehicles(job, &kernel, vehicles, &files, &status, compared);
    work.findings
        .extend(answer.findings(&files, &status, days_in));
    work.findings
        .extend(in_other_units(&answer.vehicles, &kernel.errors));
    for v in &answer.vehicles {
        work.findings.extend(drift(v, &kernel.errors));
        work.findings.extend(in_other_scale(v, &kernel.errors));
    }
    let units = StatedUnits::from_units(job.units, &job.report_units);
    Ok(work.finish(units, answer))
}

/// Result of merging the days.
struct MergedVehicles {
    vehicles: Vec<VehicleAnswer>,
    status: Vec<Status>,
    compared: DamageReferences,
}

/// Returns the vehicles by name, the status of every file, and the references for damage. The days of one vehicle are in memory at a time.
///
/// # Errors
/// A stored result that is gone, a day of two kinds of the mission, or one fault if the work is stopped.
fn merge_vehicles(
    work: &mut Work,
    kept: &KeptDays,
    files: &[FileHead],
    days_in: DayOrder,
    job: &str,
    keys: &FleetKeys,
) -> Result<MergedVehicles, Faults> {
    let (by_vehicle, status) = sort_files(files, days_in);
    let mut compared = DamageReferences::new(keys, kept, &by_vehicle);
    let mut vehicles = Vec::with_capacity(by_vehicle.len());
    for (name, list) in by_vehicle {
        work.go_on()?;
        let days: Result<Vec<(&FileHead, Day)>, Fault> = list
            .par_iter()
            .map(|file| match kept.day(file) {
                Some(day) => Ok((*file, day)),
                None => Err(Fault::new(
                    &*file.path,
                    "days",
                    "its stored result was deleted or changed while results were merged",
                    "run again",
                )),
            })
            .collect();
        let days = days?;
        if let Some(mission) = &mut compared.mission {
            for (file, day) in &days {
                mission.add(job, file, day)?;
            }
        }
        let v = vehicle(name, &days, compared.reference.as_ref());
        vehicles.push(VehicleAnswer::from_vehicle(v, keys));
    }
    VehicleAnswer::compare(&mut vehicles);
    Ok(MergedVehicles {
        vehicles,
        status,
        compared,
    })
}

/// Returns a digest of all inputs of a record except its bytes: the job's keys for single records, and every other file read so far.
fn job_digest(work: &mut Work, job: &Job, keys: &FleetKeys) -> String {
    let read = work.inputs.files_read();
    let others = read.iter().filter(|f| f.path != Path::new(&job.file));
    let others = others.map(|f| f.sha256.as_str());
    let parts: Vec<&str> = std::iter::once(keys.of_records.as_str())
        .chain(others)
        .collect();
    digest(&parts)
}

/// Reads the stored results of the output folder.
fn read_stored_results(
    work: &mut Work,
    kept: &KeptDays,
    folder: &Path,
) -> Result<(Vec<FileHead>, usize), Faults> {
    let shown = folder.display().to_string();
    let held = kept.read_all().map_err(|e| {
        Faults::from(Fault::new(
            &*shown,
            "folder",
            format!("cannot be read ({e})"),
            "check the path",
        ))
    })?;
    if held.files.is_empty() {
        let wrong = match held.damaged.first() {
            None => "the folder contains no results of this job".to_owned(),
            Some(path) => format!(
                "`{path}` is cut or was changed, and the folder contains no other result of this job"
            ),
        };
        let remedy = "name the records to be processed, or the folder of an earlier run with --out";
        return Err(Fault::new(&*shown, "days", wrong, remedy).into());
    }
    if held.others > 0 {
        work.findings.push(Finding::new(
            Severity::Info,
            "fleet-other-results",
            &shown,
            format!(
                "{} stored results belong to another job or version and were left out",
                held.others
            ),
            "delete them if they are no longer wanted",
        ));
    }
    work.findings.extend(held.damaged.iter().map(|path| {
        Finding::new(
            Severity::Error,
            "fleet-result-damaged",
            path,
            "this stored result is cut, or was changed after it was written: it is not used",
            "run the records again into this folder, then delete it if it still exists",
        )
    }));
    let missing = held
        .asked
        .iter()
        .filter_map(|a| a.find_missing_results(&held.files));
    work.findings.extend(missing);
    let n = held.files.len();
    Ok((held.files, n))
}

/// Returns the results of the requested files: stored results, and results that are computed now.
fn evaluate_files(
    work: &mut Work,
    kernel: &Kernel,
    kept: &KeptDays,
    form: &NameForm,
    spec: &FleetSpec,
) -> Result<(Vec<FileHead>, usize), Faults> {
    let mut paths: Vec<String> = spec.files.iter().map(|p| p.display().to_string()).collect();
    paths.sort();
    paths.dedup();
    let mine: Vec<&String> = paths
        .iter()
        .enumerate()
        .filter(|(i, _)| spec.shard.is_none_or(|s| s.holds(*i)))
        .map(|p| p.1)
        .collect();
    let asked = kept
        .put_asked(&paths, spec.shard.map_or(1, |s| s.of))
        .map_err(|e| not_kept(&spec.folder.display().to_string(), &e))?;
    let (source, progress) = (work.cx.files, work.cx.progress);
    progress.parts(mine.len());
    let evaluate = |path: &&String| {
        if progress.is_cancelled() {
            return Err(cancelled_fault());
        }
        let stated = spec.digests.get(*path);
        let stated = stated.and_then(|d| kept.head(path, d));
        let done = match stated.filter(|before| is_as_then(source, before)) {
            Some(before) => Ok((before, Came::Kept)),
            None => evaluate_file(kernel, kept, form, path, source),
        };
        progress.advance(1);
        done
    };
    // A record that is in memory as a whole is alone there. The threads share its pieces.
    let results: Vec<Result<(FileHead, Came), Fault>> = match kernel.holds_whole_records() {
        true => mine.iter().map(evaluate).collect(),
        false => mine.par_iter().map(evaluate).collect(),
    };
    work.go_on()?;
    let mut files = Vec::new();
    let (mut reused, mut replaced) = (0, Vec::new());
    for result in results {
        let (file, came) = result?;
        match came {
            Came::Kept => reused += 1,
            Came::Replacing => replaced.push(file.path.clone()),
            Came::New => {}
        }
        files.push(file);
    }
    work.findings.extend(report_replaced_records(&replaced));
    // A shard keeps the request, because other parts of the records are still missing.
    if spec.shard.is_none() && files.iter().all(|f| kept.holds(f)) {
        let _ = std::fs::remove_file(asked);
    }
    Ok((files, reused))
}

/// Returns whether the stamp of a file is unchanged since its result was computed. The file is not read. A file that is out of reach counts as
/// unchanged.
fn is_as_then(source: &dyn Files, before: &FileHead) -> bool {
    match source.stamp(Path::new(&before.path)) {
        Ok(now) => before.stamp == Some(now),
        Err(_) => true,
    }
}

/// Origin of a result: stored earlier, new, or new in place of the result of other bytes under the same path.
enum Came {
    Kept,
    New,
    Replacing,
}

/// Returns the finding that results were replaced: a record was written again, or a record of another folder has the same path.
fn report_replaced_records(paths: &[String]) -> Option<Finding> {
    let n = paths.len();
    (n > 0).then(|| {
        Finding::new(
            Severity::Info,
            "fleet-record-replaced",
            list_few(paths),
            format!("{n} records changed since an earlier run and were processed again"),
            "nothing, if they were written again; records of another folder need other paths",
        )
        .with_numbers(n as f64, 0.0)
    })
}

/// The result of one file, and how it came.
fn evaluate_file(
    kernel: &Kernel,
    kept: &KeptDays,
    form: &NameForm,
    path: &str,
    source: &dyn Files,
) -> Result<(FileHead, Came), Fault> {
    // The stamp is read before the file, so that a later change of the file also changes the stamp.
    let stamp = source.stamp(Path::new(path)).ok();
    let opened = source.open(Path::new(path));
    let named = form.read(path);
    let mut file = FileResult {
        path: path.to_owned(),
        sha256: String::new(),
        stamp,
        vehicle: named.as_ref().map_or(String::new(), |n| n.vehicle.clone()),
        day: named.as_ref().map_or(String::new(), |n| n.day.clone()),
        result: Err(String::new()),
    };
    let unread = |mut file: FileResult, e: &std::io::Error| {
        file.sha256 = String::new();
        file.result = Err(format!("it cannot be read: {e}"));
        Ok((file.into(), Came::New))
    };
    let opened = match opened {
        Ok(opened) => opened,
        Err(e) => return unread(file, &e),
    };
    let before = kept.latest_result(path);
    let (hash, result) = match (&named, &before) {
        (None, _) => {
            let wrong = "its path does not match the form of [fleet] file_name";
            (opened.sha256(), Some(Err(wrong.to_owned())))
        }
        (Some(_), Some(_)) => (opened.sha256(), None),
        // No result of this file is stored, so the record is evaluated while its digest is computed.
        (Some(_), None) => {
            let (hash, day) = rayon::join(
                || opened.sha256(),
                || day_of(kernel, &opened).map_err(reason),
            );
            (hash, Some(day))
        }
    };
    match hash {
        Ok(hash) => file.sha256 = hash,
        Err(e) => return unread(file, &e),
    }
    // A failed record is evaluated again, because this build may read more formats.
    let came = match before.filter(|_| named.is_some()) {
        Some(before) if before.sha256 != file.sha256 => Came::Replacing,
        Some(before) if before.result.is_ok() => return Ok((before, Came::Kept)),
        _ => Came::New,
    };
    file.result = result.unwrap_or_else(|| day_of(kernel, &opened).map_err(reason));
    if named.is_none() {
        return Ok((file.into(), Came::New));
    }
    // A file that changed while it was read, or that can't be read to its end, has no valid result: a later run tries again.
    if let Err(e) = opened.check() {
        return unread(file, &e);
    }
    kept.store_result(&file).map_err(|e| not_kept(path, &e))?;
    // The stored result is read back as a later run reads it. A merge of stored results then has the same bytes.
    Ok((
        kept.head(path, &file.sha256).unwrap_or_else(|| file.into()),
        came,
    ))
}

fn not_kept(path: &str, e: &std::io::Error) -> Fault {
    let wrong = format!("its result cannot be written ({e})");
    Fault::new(path, "output", wrong, "choose another folder with --out")
}

/// Returns why a record has no result, as text: every fault with its line, its field and its remedy.
fn reason(faults: Faults) -> String {
    let words = |f: Fault| {
        let line = f.line.map_or(String::new(), |l| format!("line {l}: "));
        format!("{line}{}: {}: {}", f.field, f.wrong, f.remedy)
    };
    let each: Vec<String> = faults.into_iter().map(words).collect();
    each.join("; ")
}

/// Computes the result of a record.
///
/// # Errors
/// The reason why the loads or their damage can't be computed.
pub fn day_of(kernel: &Kernel, opened: &OpenedFile) -> Result<Day, Faults> {
    let noise = kernel.errors.noise_variance(1.0).sqrt();
    let columns = (&*kernel.wanted_columns(), &*kernel.sensitivity.gauges);
    let record = FleetRecord::open(&kernel.job, columns, noise, opened)?;
    let day = kernel.day(record)?;
    let is_number = |l: &&day::LoadDay| {
        let sums = &l.tally.sums;
        let [a, b, c] = sums.damage;
        (a + b + c + sums.scatter).is_finite()
    };
    match day.loads.iter().find(|l| !is_number(l)) {
        None => Ok(day),
        Some(l) => {
            let wrong = "its damage exceeds the range of numbers";
            let remedy = "report it in a larger unit, or state a lower slope";
            Err(Fault::new("record", &*l.name, wrong, remedy).into())
        }
    }
}
