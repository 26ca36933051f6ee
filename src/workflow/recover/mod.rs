//! `recover`: loads from measured strain.
//!
//! `runs` recovers static states, one for each row. `record` recovers records of any length and format ([`crate::series::record`]) at constant
//! memory. It sends their loads to a [`RecordSink`] piece by piece.

mod active_gauges;
mod answer;
mod block;
mod by_load;
mod calibration_range;
mod compare;
mod content;
mod damage;
mod dead_parts;
mod dynamic;
mod files;
mod history;
mod input_check;
mod known_payload;
mod listed_loads;
mod motion;
mod record;
mod record_tests;
mod recorded_run_loads;
mod runs;
mod section_files;
mod section_rules;
mod sections;
mod sink;
mod task;
mod trace;
mod validation;
mod vertical_loads;
mod vibration_findings;

pub(crate) use calibration_range::record_beyond_calibration;

pub(super) use active_gauges::silent_throughout;
pub use answer::{
    Content, GaugeResidual, RecordLoad, RecoveredLoad, RecoveredLoads, RecoveredRecord,
    RecoveredRuns, RunFit, States,
};
pub use by_load::LoadSpan;
pub use compare::{
    Comparison, ComparisonShift, ComparisonSpectra, LoadComparison, LoadLevels, LoadSpectra,
};
pub use damage::LoadDamage;
pub(super) use dead_parts::silent_in_part;
pub(crate) use dynamic::VibrationModel;
pub use files::rpc_targets;
pub use history::{History, HistoryRow};
pub(super) use input_check::{check_inputs, gauges_of_file};
pub(super) use listed_loads::{ListedLoads, list_load_columns};
pub use motion::Motion;
pub use sections::{DutyLoad, SectionLoad, Sections};
use sink::Unheard;
pub use sink::{Block, RecordHead, RecordSink, Sample, Samples};
pub use trace::{Span, Spans};
pub use validation::ValidationGauge;
pub(crate) use vertical_loads::VerticalLoads;

use answer::AdditionalResults;

use crate::host::context::Context;
use crate::host::fault::{Fault, Faults};
use crate::host::outcome::{Outcome, StatedUnits};
use crate::host::work::Work;
use crate::job::{Job, Measured};
use crate::measured::conditioning::{report_conditioning, report_doubtful_drift};
use crate::measured::noise::prepare_with_noise;
use crate::measured::{self, MeasuredStrain};
use crate::recovery::{Readings, Recovery};
use crate::sensitivity::check_separability;
use crate::strain_chain::named_results::check_tables;
use crate::strain_chain::{Conditioning, JobSensitivity};

/// Recovers the loads of the runs or the record of a job with their intervals. Every sample of a record stays in memory
/// ([`RecoveredRecord::history`]); [`recover_into`] writes the samples to a sink instead.
///
/// # Errors
/// Returns every fault of the job and of the files that it names.
///
/// # Example
/// Gauges of known S read the strain of 2000 N and 1000 N, each with an error of one microstrain:
/// ```
/// use strainbridge::host::context::InMemory;
/// use strainbridge::{Context, Job, recover};
///
/// const JOB: &str = r#"
/// units = "m-kg-s"
/// load = [{ name = "left" }, { name = "right" }]
/// sensitivity = { file = "s.csv" } # microstrain per newton
/// measured = { strain = "strain.csv", noise_microstrain = 1.0 }
/// "#;
/// let files = InMemory::default()
///     .with_file("job.toml", JOB)
///     .with_file("s.csv", "gauge,left,right\nG1,0.10,0.02\nG2,0.02,0.10\nG3,0.05,0.05\n")
///     .with_file("strain.csv", "run,G1,G2,G3\nR1,221,139,151\n");
/// let found = recover(&Job::read("job.toml", &files)?, &Context::new(&files))?;
/// let runs = found.runs().unwrap();
/// for (load, truth) in runs.loads.iter().zip([2000.0, 1000.0]) {
///     assert!(load.low <= truth && truth <= load.high);
///     assert_eq!(load.unit, "N");
/// }
/// # Ok::<(), strainbridge::Faults>(())
/// ```
pub fn recover(job: &Job, cx: &Context) -> Result<Outcome<RecoveredLoads>, Faults> {
    let mut history = History::default();
    let mut outcome = recover_into(job, cx, &mut history)?;
    if let States::Record(record) = &mut outcome.answer.states {
        record.history = Some(history);
    }
    Ok(outcome)
}

/// Recovers loads like [`recover`], and writes the samples of a record to `sink` piece by piece. Runs do not use `sink`.
///
/// # Errors
/// Returns every fault of the job and of the files that it names, or the faults of `sink`.
pub fn recover_into(
    job: &Job,
    cx: &Context,
    sink: &mut dyn RecordSink,
) -> Result<Outcome<RecoveredLoads>, Faults> {
    let mut work = Work::of_job(cx, job);
    let measured = task::measured_of(job)?;
    job.without_validation_gauges()?;
    check_tables(&work, job)?;
    let mut prepared = prepare_with_noise(&mut work, job)?;
    let (states, beside) = recover_measured_loads(&mut work, (job, measured), &prepared, sink)?;
    prepared.retain(&task::validation_rows(job, &prepared.sensitivity).1);
    let answer = RecoveredLoads {
        reading_conditioning: beside.reading_conditioning,
        validation: beside.validation,
        comparison: beside.comparison,
        sections: Sections::from_loads(job, beside.sections),
        conditioning: Conditioning::from_sensitivity(&prepared.sensitivity),
        states,
        mesh_error: prepared.mesh_error.clone(),
        prepared,
        job: job.clone(),
    };
    Ok(work.finish(
        StatedUnits::from_units(job.units, &job.report_units),
        answer,
    ))
}

/// Recovers the loads from the measured strain. The loads of a record go to `sink`.
///
/// # Errors
/// Readings that can't be read, and the errors of `sink`.
fn recover_measured_loads(
    work: &mut Work,
    (job, measured): (&Job, &Measured),
    prepared: &JobSensitivity,
    sink: &mut dyn RecordSink,
) -> Result<(States, AdditionalResults), Faults> {
    let (_, estimating) = task::validation_rows(job, &prepared.sensitivity);
    let s = prepared.sensitivity.of_gauges(&estimating);
    work.findings
        .extend(check_separability(&s.without_prior_loads()));
    let task = task::task_of(work, job, measured, prepared)?;
    work.findings.extend(task::changes(measured));
    let strain = open_strain(work, job, measured)?;
    Ok(match strain {
        MeasuredStrain::Record(record) => {
            let steps = record.conditioning_steps().to_vec();
            work.findings.extend(report_conditioning(&steps));
            let noise = task.errors.noise_variance(1.0).sqrt();
            work.findings.extend(report_doubtful_drift(&steps, noise));
            let (record, mut beside) =
                work.stage("stream", |w| record::record(w, &task, &record, sink))?;
            beside.reading_conditioning = steps;
            let of_files = section_files::count_files(work, &task)?;
            beside.sections.extend(of_files);
            (States::Record(Box::new(record)), beside)
        }
        MeasuredStrain::Runs(_) if job.recover.turning_points.is_some() => {
            return Err(Faults::from(Fault::new(
                &*job.file,
                "recover.turning_points",
                "the readings are runs, which are not consecutive in time and have no turning points",
                "name a record in [measured] strain, or delete turning_points",
            )));
        }
        MeasuredStrain::Runs(table) => {
            let unused = job
                .dynamic
                .as_ref()
                .map(|_| vibration_findings::without_record());
            work.findings.extend(unused);
            let (runs, beside) = runs::runs(work, &task, &table)?;
            (States::Runs(Box::new(runs)), beside)
        }
    })
}

/// Opens the strain file of a job.
fn open_strain(work: &mut Work, job: &Job, measured: &Measured) -> Result<MeasuredStrain, Faults> {
    work.stage("read strain", |w| {
        measured::open(&mut w.inputs, job, measured, &measured.strain)
    })
}

/// Recovers the loads only for the findings, as `check` needs them.
///
/// # Errors
/// The errors of [`recover_into`].
pub(super) fn recover_for_findings(
    work: &mut Work,
    job: &Job,
    measured: &Measured,
    prepared: &JobSensitivity,
) -> Result<(), Faults> {
    recover_measured_loads(work, (job, measured), prepared, &mut Unheard).map(|_| ())
}

/// Returns readings and recovered loads of the job's static runs, for commands that use both.
///
/// # Errors
/// Unreadable tables; a record, which [`recover_into`] streams.
pub(super) fn recovered_runs(
    work: &mut Work,
    job: &Job,
    measured: &Measured,
    prepared: &JobSensitivity,
) -> Result<(Vec<Readings>, Recovery), Faults> {
    let task = task::task_of(work, job, measured, prepared)?;
    let table = open_strain(work, job, measured)?.into_runs()?;
    let solved = runs::solve(work, &task, &table)?;
    Ok((solved.readings, solved.recovery))
}
