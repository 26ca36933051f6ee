//! Records: samples streamed through one estimate, pieces in parallel, a few pieces in memory at a time.

use super::active_gauges::{ActiveGaugeRecord, exclude_silent_gauges};
use super::answer::{AdditionalResults, Content, GaugeResidual, RecordLoad, RecoveredRecord};
use super::block::block;
use super::calibration_range;
use super::compare::{self, Gap};
use super::damage::{CycleCountInput, LoadDamage, about_damage, damage};
use super::dead_parts::{MaskedRecord, without_dead_parts};
use super::dynamic::remove_vibration;
use super::files;
use super::listed_loads::{ListedLoads, list_load_columns};
use super::motion::Motion;
use super::record_tests::{
    check_times, content, recover_quasi_static_samples, recover_tested_samples, spread,
};
use super::runs::find_identical_readings;
use super::sections;
use super::sink::{Block, RecordHead, RecordSink};
use super::task::Task;
use super::trace::Spans;
use super::validation::{self, Channels, ValidationSums};
use super::vertical_loads::VerticalLoads;
use crate::finding::Finding;
use crate::host::fault::{Fault, Faults};
use crate::host::outcome::finite_or_none;
use crate::host::work::Work;
use crate::job::LoadFile;
use crate::measured::record::Record;
use crate::measured::zero::no_zero_runs;
use crate::recovery::dynamic::ReadingCovariance;
use crate::recovery::history::Filter;
use crate::recovery::{Gain, Readings, Recovery, Sums, check_gaps, reading_plausibility};
use crate::sensitivity::Sensitivity;
use crate::units::MICROSTRAIN;
use rayon::prelude::*;
use std::sync::Arc;

/// Pieces in memory at a time.
const GROUP: usize = 8;

/// Recovers the loads of a record piece by piece, and passes each piece to `sink`.
///
/// # Errors
/// A record that can't be read, or an error of `sink`.
pub(super) fn record(
    work: &mut Work,
    task: &Task,
    record: &Record,
    sink: &mut dyn RecordSink,
) -> Result<(RecoveredRecord, AdditionalResults), Faults> {
    no_zero_runs(task.job, task.measured, &task.measured.strain.given)?;
    let mut channels = Channels::from_record(task, record);
    let ActiveGaugeRecord {
        record,
        sensitivity,
        zero,
    } = exclude_silent_gauges(work, task, record)?;
    let ListedLoads {
        names,
        units,
        sums: combinations,
    } = list_load_columns(task.job, &sensitivity)?;
    let MaskedRecord {
        record,
        readings,
        dead,
    } = without_dead_parts(work, task, record, &sensitivity, &zero)?;
    check_times(work, &record)?;
    work.findings
        .extend(find_identical_readings(&sensitivity, &readings));
    let clock = record.clock().clone();
    let recorded = compare::record_of_job(work, task, &names)?;
    let parts = sections::parts(task.job, &record, &clock)?;
    let quasi_static = remove_vibration(work, task, &record, &sensitivity)?;
    let (tested, errors, at_rest, motion, blank) = match quasi_static {
        Some((quasi_static, r)) => {
            let noise_factor = r.noise_factor(task.noise_factor);
            let readings = spread((noise_factor, r.apart), &quasi_static, &zero)?;
            let tested = recover_quasi_static_samples(task, &sensitivity, readings, &r.doubt);
            let errors = (noise_factor, Some(r.doubt));
            (tested, errors, Some(quasi_static), Some(r.motion), r.blank)
        }
        None => {
            let tested = recover_tested_samples(work, task, &sensitivity, readings);
            (tested, (task.noise_factor, None), None, None, 0)
        }
    };
    let filter = filter(
        work,
        (task, errors),
        tested,
        &sensitivity,
        zero,
        &combinations,
    )?;
    let first_mode = motion.as_ref().and_then(|m| m.modes_hz.first().copied());
    // The measured record still has content outside of the band.
    let content = content(work, task, (&record, first_mode), &filter, &names)?;
    let dropped = at_rest.as_ref().and_then(|_| channels.take());
    work.findings.extend(dropped.map(|c| c.not_compared()));
    let record = at_rest.unwrap_or(record);
    let (first_s, step_s) = record.first_and_step();
    let head = Arc::new(RecordHead {
        file: record.file().to_owned(),
        names,
        units,
        stretches: filter.stretches(&dead),
        filter,
        first_s,
        step_s,
        stride: task.job.recover.csv_every,
        turning_points: task.job.recover.turning_points,
        files: files::select_load_files(task.job, record.clock().samples)?,
        is_compared: recorded.is_some() || !parts.is_empty(),
    });
    sink.begin(&head)?;
    let RecordPassResults {
        sums,
        spans,
        compared,
        gaps,
    } = stream(work, (&record, channels.as_ref()), &head, sink)?;
    sink.end(sums.missing.samples())?;
    work.findings
        .extend(check_range_and_sign(task, &sensitivity, &head, &sums));
    let validation = match &channels {
        Some(c) => c.compare_gauges(&compared, head.filter.gain_of_all_gauges()),
        None => Vec::new(),
    };
    work.findings
        .extend(validation::report_contradictions(&validation));
    let slope = task.job.recover.slope;
    let mut beside = AdditionalResults {
        validation,
        ..AdditionalResults::default()
    };
    if head.is_compared {
        let samples = sink.samples()?;
        let counting = CycleCountInput {
            head: &head,
            samples: &*samples,
            slope,
        };
        if let Some(recorded) = recorded {
            let with = (&clock, recorded);
            beside.comparison = work.stage("compare", |w| {
                compare::record(w, task.job, (counting, &gaps), with)
            })?;
        }
        beside.sections = work.stage("sections", |_| sections::count_all(counting, &parts));
    }
    let damage = match head.files.contains(&LoadFile::Rainflow) {
        true => {
            work.findings.push(about_damage(slope));
            let samples = sink.samples()?;
            Some(work.stage("rainflow", |_| damage(&head, &sums, &*samples, slope)))
        }
        false => None,
    };
    about_files(work, task, &head, &sums, (&sensitivity, blank));
    let extras = (content, motion, damage);
    Ok((answer(sensitivity, head, sums, spans, extras), beside))
}

/// Returns the findings on loads beyond the range of a calibrated S and on vertical loads that all pull. It tests the smallest and largest loads.
fn check_range_and_sign(
    task: &Task,
    sensitivity: &Sensitivity,
    head: &RecordHead,
    sums: &Sums,
) -> Vec<Finding> {
    let ends: Vec<f64> = (sums.min.iter().zip(&sums.max))
        .map(|(a, b)| a.abs().max(b.abs()))
        .collect();
    let sigma = head.filter.sigma(&ends);
    let factor = head.filter.coverage_factor();
    let halves: Vec<f64> = sigma.iter().map(|s| factor * s).collect();
    let high: Vec<f64> = sums.max.iter().zip(&halves).map(|(m, h)| m + h).collect();
    let vertical = VerticalLoads::of_job(task.job);
    let reversed = vertical.check_sign("in the whole record", &high, &head.units);
    let mut found = calibration_range::record_beyond_calibration(
        &calibration_range::with_range(task.job, sensitivity, &head.units),
        (&head.file, sums.missing.samples()),
        (&sums.min, &sums.max, &halves),
    );
    found.extend(reversed);
    found
}

/// Adds the findings on files and on gaps; `blank` samples are blank for the filter of `[dynamic]` alone, which its own finding states.
fn about_files(
    work: &mut Work,
    task: &Task,
    head: &RecordHead,
    sums: &Sums,
    (sensitivity, blank): (&Sensitivity, usize),
) {
    work.findings.extend(files::findings(task.job, head, sums));
    let gaps = check_gaps(&head.file, sensitivity, &sums.missing);
    let by_filter = sums.missing.gaps == blank as u64;
    let stated = |f: &Finding| !(by_filter && f.code == "samples-with-gaps");
    work.findings.extend(gaps.into_iter().filter(stated));
}

/// Reads the whole record without S, and returns the names of the active gauges and readings of samples spread over the record.
///
/// # Errors
/// A record that can't be read.
pub(super) fn sample_readings(
    work: &mut Work,
    task: &Task,
    record: &Record,
) -> Result<(Sensitivity, Vec<Readings>), Faults> {
    no_zero_runs(task.job, task.measured, &task.measured.strain.given)?;
    let ActiveGaugeRecord {
        record,
        sensitivity,
        zero,
    } = exclude_silent_gauges(work, task, record)?;
    let (all, unloaded): (Vec<usize>, _) = (
        (0..sensitivity.gauges.len()).collect(),
        vec![0.0; sensitivity.loads.len()],
    );
    let gain = Gain::new(
        &sensitivity,
        &all,
        task.errors,
        task.noise_factor,
        &unloaded,
    );
    if gain.is_none() && !unloaded.is_empty() {
        return Err(sensitivity_fault(task).into());
    }
    check_times(work, &record)?;
    let living = without_dead_parts(work, task, record, &sensitivity, &zero)?;
    let (record, readings) = (living.record, living.readings);
    let mut impossible = 0;
    in_groups(work, &record, &mut |group| {
        let pieces = group.par_iter();
        impossible += pieces
            .map(|&i| record.count_impossible_readings(i, &zero))
            .sum::<Result<u64, Fault>>()?;
        Ok(())
    })?;
    if impossible > 0 {
        let found = reading_plausibility::impossible_in_record(record.file(), impossible);
        work.findings.push(found);
    }
    Ok((sensitivity, readings))
}

/// Returns the filter that estimates every sample. Its typical loads and the widening of its intervals come from samples spread over the record.
fn filter(
    work: &mut Work,
    (task, (noise_factor, doubt)): (&Task, (f64, Option<ReadingCovariance>)),
    tested: Recovery,
    s: &Sensitivity,
    zero: Vec<f64>,
    combinations: &[Vec<(usize, f64)>],
) -> Result<Filter, Faults> {
    work.findings.extend(tested.findings.iter().cloned());
    let s = &tested.s(s);
    let filter = Filter::new(
        s,
        zero,
        task.errors,
        noise_factor,
        &tested.typical,
        tested.widening,
    );
    let mut filter = filter.ok_or_else(|| sensitivity_fault(task))?;
    if let Some(doubt) = doubt {
        filter.add_reading_covariance(Arc::new(doubt));
    }
    filter.combine(combinations);
    Ok(filter)
}

/// The fault of an S that no estimate can be formed of.
fn sensitivity_fault(task: &Task) -> Fault {
    let file = match (&task.job.sensitivity, &task.job.model) {
        (Some(given), _) => &*given.file.given,
        (None, Some(model)) => &*model.deck.given,
        (None, None) => &*task.job.file,
    };
    Fault::new(
        file,
        "sensitivity",
        "S contains numbers that are not finite, or too large to compute with",
        "check the table of S, or the results of the unit loads",
    )
}

/// Results of one pass over the record.
struct RecordPassResults {
    sums: Sums,
    spans: Spans,
    compared: ValidationSums,
    /// Samples in which a gauge gives nothing, with the estimate from the other gauges, if loads are compared.
    gaps: Vec<Gap>,
}

/// Recovers the record piece by piece, in parallel, and passes the loads to `sink`. Returns the sums over the record.
///
/// # Errors
/// The first piece that can't be read, the errors of `sink`, or one fault if the work is stopped.
fn stream(
    work: &Work,
    (record, channels): (&Record, Option<&Channels>),
    head: &RecordHead,
    sink: &mut dyn RecordSink,
) -> Result<RecordPassResults, Faults> {
    let filter = &head.filter;
    let mut compared = ValidationSums::default();
    let mut gaps = Vec::new();
    let mut sums = Sums::new(filter.n_gauges(), filter.n_loads());
    let mut spans = Spans::new(filter.n_loads());
    let mut first = 0;
    in_groups(work, record, &mut |group| {
        let one = |&i: &usize| -> Result<(Block, Sums, ValidationSums), Fault> {
            let (block, sums) = block(record, filter, i)?;
            let compared = match channels {
                Some(c) => c.compare(i, &block.loads.values, filter.n_loads())?,
                None => ValidationSums::default(),
            };
            Ok((block, sums, compared))
        };
        let done: Result<Vec<_>, Fault> = group.par_iter().map(one).collect();
        let mut blocks = Vec::with_capacity(group.len());
        for (mut block, of_block, of_channels) in done? {
            sums.merge(&of_block);
            compared.merge(&of_channels);
            spans.add(&block);
            block.first = first;
            if head.is_compared {
                let of_block = block.loads.gaps.iter();
                gaps.extend(of_block.map(|(i, gain)| (first + i, gain.clone())));
            }
            first += block.times.len();
            blocks.push(block);
        }
        Ok(sink.take(blocks)?)
    })?;
    Ok(RecordPassResults {
        sums,
        spans,
        compared,
        gaps,
    })
}

/// Passes the pieces of a record to `take` group by group, and reports the progress, until the work is stopped.
///
/// # Errors
/// An error of `take`; one fault if the work is stopped.
fn in_groups(
    work: &Work,
    record: &Record,
    take: &mut dyn FnMut(&[usize]) -> Result<(), Faults>,
) -> Result<(), Faults> {
    let progress = work.cx.progress;
    progress.parts(record.n_pieces());
    let pieces: Vec<usize> = (0..record.n_pieces()).collect();
    for group in pieces.chunks(GROUP) {
        work.go_on()?;
        take(group)?;
        progress.advance(group.len());
    }
    Ok(())
}

/// Returns the answer in report units.
fn answer(
    sensitivity: Sensitivity,
    head: Arc<RecordHead>,
    sums: Sums,
    spans: Spans,
    (content, motion, damage): (Option<Content>, Option<Motion>, Option<Vec<LoadDamage>>),
) -> RecoveredRecord {
    let known: Vec<f64> = (0..head.n_loads())
        .map(|l| sums.known_samples(l) as f64)
        .collect();
    let rms: Vec<f64> = sums
        .sum_of_squares
        .iter()
        .zip(&known)
        .map(|(q, n)| (q / n.max(1.0)).sqrt())
        .collect();
    let sigma = head.filter.sigma(&rms);
    let loads = head.units.iter().enumerate().map(|(l, u)| RecordLoad {
        run: head.file.clone(),
        name: head.names[l].clone(),
        value: sums.sum[l] / known[l] * u.factor,
        sigma: sigma[l] * u.factor,
        unit: u.name.clone(),
        min: sums.min[l] * u.factor,
        max: sums.max[l] * u.factor,
        rms: rms[l] * u.factor,
    });
    let (n, whole) = (sensitivity.gauges.len(), head.filter.gain_of_all_gauges());
    let dof = n.saturating_sub(whole.rank).max(1) as f64;
    let free: f64 = (0..n).map(|g| sums.read(g) as f64 * dof / n as f64).sum();
    let residual = (sums.residual.iter().sum::<f64>() / free.max(1.0)).sqrt();
    let gauges = sensitivity.gauges.iter().enumerate();
    let gauges = gauges.map(|(g, name)| GaugeResidual {
        name: name.clone(),
        residual_rms_microstrain: (sums.residual[g] / sums.read(g).max(1) as f64).sqrt()
            / MICROSTRAIN,
        leverage: whole.leverage[g],
    });
    let [from, to] = spans.time();
    let samples = sums.missing.samples();
    RecoveredRecord {
        loads: loads.collect(),
        residual_rms_microstrain: residual / MICROSTRAIN,
        gauges: gauges.collect(),
        samples,
        gaps: sums.missing.gaps,
        duration_s: to - from,
        csv_every: head.stride,
        sample_rate_hz: finite_or_none(samples.saturating_sub(1) as f64 / (to - from)),
        content,
        motion,
        damage,
        sensitivity,
        head,
        sums,
        spans,
        history: None,
    }
}
