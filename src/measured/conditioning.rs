//! `[conditioning]`: changes of the readings of a record before anything else.

use super::conditioning_step::ConditioningStep;
use super::faults::record_fault;
use super::record::Record;
use crate::estimate::median;
use crate::finding::{Finding, Severity, list_few};
use crate::host::fault::{Fault, Faults};
use crate::job::{Job, ReadingConditioning, TemperatureCompensation};
use crate::series::butterworth::{Passes, filter_without_phase};
use crate::series::detrend::{line, mean, rms};
use crate::series::quality::find_spikes;
use crate::units::MICROSTRAIN;
use rayon::prelude::*;
use std::ops::Range;

/// Samples that a stretch of zero needs: its noise is then below a tenth of the noise of a reading.
const LEAST_ZERO: usize = 100;

/// Readings of a record while they are conditioned.
struct Conditioner {
    /// Strain, a column each.
    readings: Vec<Vec<f64>>,
    names: Vec<String>,
    steps: Vec<ConditioningStep>,
}

impl Conditioner {
    /// Applies a change to every column; a column that does not change is not listed.
    fn apply(&mut self, step: &'static str, change: impl Fn(&mut [f64]) + Sync) {
        let of_column = |column: &mut Vec<f64>| -> (usize, f64) {
            let before = column.clone();
            change(column);
            let changes: Vec<f64> = (column.iter().zip(&before))
                .map(|(a, b)| a - b)
                .filter(|d| d.is_finite() && *d != 0.0)
                .collect();
            let share = changes.len() as f64 / before.len().max(1) as f64;
            (changes.len(), rms(&changes) * share.sqrt() / MICROSTRAIN)
        };
        let changed: Vec<(usize, f64)> = self.readings.par_iter_mut().map(of_column).collect();
        let listed = changed.into_iter().zip(&self.names);
        let listed = listed.filter(|((samples, _), _)| *samples > 0);
        self.steps
            .extend(listed.map(|((samples, rms), gauge)| ConditioningStep {
                step,
                gauge: gauge.clone(),
                samples,
                rms_microstrain: rms,
            }));
    }
}

/// Returns the record with the readings that the job's `[conditioning]` makes of it; `record` itself without the section.
///
/// # Errors
/// A temperature channel that the record lacks, a stretch of zero beyond the record, a zero file next to such a stretch, a corner above half of the
/// sample rate, or a record without uniform time steps.
pub(super) fn condition(job: &Job, record: Record) -> Result<Record, Faults> {
    let Some(asked) = &job.conditioning else {
        return Ok(record);
    };
    let fault = |key: &str, wrong: String, remedy: &str| {
        let field = format!("conditioning.{key}");
        Faults::from(Fault::with_line(
            &*job.file, asked.line, field, wrong, remedy,
        ))
    };
    let temperature = asked.temperature.as_ref().map(|t| t.channel.as_str());
    let record = record.with_all_uncorrected_strain(temperature);
    let (first_s, step_s) = record.first_and_step();
    let zero = match asked.zero_s {
        Some(times) => Some(
            zero_samples(job, &record, times)
                .map_err(|(wrong, remedy)| fault("zero_s", wrong, remedy))?,
        ),
        None => None,
    };
    for (key, corner) in [
        ("low_pass_hz", asked.low_pass_hz),
        ("high_pass_hz", asked.high_pass_hz),
    ] {
        if let Some(corner) = corner.filter(|f| !(f * step_s < 0.5)) {
            let wrong = format!(
                "{corner} Hz is not below half of the sample rate, {:.4} Hz",
                0.5 / step_s
            );
            return Err(fault(
                key,
                wrong,
                "state a lower frequency, or sample faster",
            ));
        }
    }
    let temperature = match &asked.temperature {
        Some(t) => Some((
            t,
            temperature_of(&record, t).map_err(|e| match e {
                Some(unreadable) => unreadable.into(),
                None => fault(
                    "temperature.channel",
                    format!("the record has no numeric channel `{}`", t.channel),
                    "name a column of the strain file",
                ),
            })?,
        )),
        None => None,
    };
    let mut work = Conditioner {
        readings: record.columns()?,
        names: record.names_read(),
        steps: Vec::new(),
    };
    let asked_of = (asked, zero.as_ref(), step_s);
    run_steps(
        &mut work,
        asked_of,
        temperature.as_ref().map(|(t, v)| (*t, &**v)),
    );
    record.with_conditioned_readings(work.readings, (first_s, step_s), work.steps)
}

/// Runs the steps in their order.
fn run_steps(
    work: &mut Conditioner,
    (asked, zero, step_s): (&ReadingConditioning, Option<&Range<usize>>, f64),
    temperature: Option<(&TemperatureCompensation, &[f64])>,
) {
    if asked.spikes {
        work.apply("spikes", |x| {
            for i in find_spikes(x).0 {
                x[i] = 0.5 * (x[i - 1] + x[i + 1]);
            }
        });
    }
    if let Some((compensation, measured)) = temperature {
        let reference = match zero {
            Some(zero) => mean(&measured[zero.clone()]),
            None => measured
                .iter()
                .copied()
                .find(|t| t.is_finite())
                .unwrap_or(0.0),
        };
        let factor = compensation.microstrain_per_deg_c * MICROSTRAIN;
        work.apply("temperature", |x| {
            let both = x.iter_mut().zip(measured);
            both.for_each(|(x, t)| *x -= factor * (t - reference));
        });
    }
    if asked.linear_drift {
        let at = zero.map_or(0.0, |z| 0.5 * (z.start + z.end) as f64);
        work.apply("drift", |x| {
            let slope = slope_of(x);
            let all = x.iter_mut().enumerate();
            all.for_each(|(i, v)| *v -= slope * (i as f64 - at));
        });
    }
    if let Some(zero) = zero {
        work.apply("zero", |x| {
            let read: Vec<f64> = x[zero.clone()]
                .iter()
                .copied()
                .filter(|v| v.is_finite())
                .collect();
            let offset = if read.is_empty() {
                f64::NAN
            } else {
                mean(&read)
            };
            x.iter_mut().for_each(|v| *v -= offset);
        });
    }
    let filters = [
        ("low_pass", Passes::Low, asked.low_pass_hz),
        ("high_pass", Passes::High, asked.high_pass_hz),
    ];
    for (step, passes, corner) in filters {
        if let Some(corner) = corner {
            work.apply(step, |x| filter_without_phase(x, passes, corner * step_s));
        }
    }
}

/// Returns the slope of the least squares line per sample; missing samples count as the median.
fn slope_of(x: &[f64]) -> f64 {
    if x.iter().all(|v| v.is_finite()) {
        return line(x).1;
    }
    let read: Vec<f64> = x.iter().copied().filter(|v| v.is_finite()).collect();
    let middle = median(read).unwrap_or(0.0);
    let filled: Vec<f64> = x
        .iter()
        .map(|v| if v.is_finite() { *v } else { middle })
        .collect();
    line(&filled).1
}

/// Returns the samples of the stretch of zero.
fn zero_samples(
    job: &Job,
    record: &Record,
    [from, to]: [f64; 2],
) -> Result<Range<usize>, (String, &'static str)> {
    if job.measured.as_ref().is_some_and(|m| m.zero.is_some()) {
        let wrong = "[measured] states a zero file too: only one of them can be zero".to_owned();
        return Err((wrong, "delete `zero_s`, or `zero` in [measured]"));
    }
    let (samples, (first_s, step_s)) = (record.clock().samples, record.first_and_step());
    let last_s = first_s + step_s * samples.saturating_sub(1) as f64;
    if from < first_s - 0.5 * step_s || to > last_s + 0.5 * step_s {
        let wrong = format!("[{from}, {to}] s is beyond the record, {first_s:.4} to {last_s:.4} s");
        return Err((wrong, "state times of the record"));
    }
    let at = |t: f64| ((t - first_s) / step_s).round().max(0.0) as usize;
    let range = at(from)..(at(to) + 1).min(samples);
    if range.len() < LEAST_ZERO {
        let wrong = format!(
            "[{from}, {to}] s contains {} samples, and a zero needs {LEAST_ZERO}",
            range.len()
        );
        return Err((wrong, "state a longer stretch without loads"));
    }
    Ok(range)
}

/// Returns the temperature of every sample; missing ones have the last value before. `Err(None)` without such a channel.
fn temperature_of(
    record: &Record,
    compensation: &TemperatureCompensation,
) -> Result<Vec<f64>, Option<Fault>> {
    let read = record.raw_column(&compensation.channel).ok_or(None)?;
    let mut values = read.map_err(|e| Some(record_fault(record.file(), &e)))?;
    let first = values.iter().copied().find(|v| v.is_finite()).ok_or(None)?;
    let mut last = first;
    for v in &mut values {
        if v.is_finite() {
            last = *v;
        } else {
            *v = last;
        }
    }
    Ok(values)
}

/// Refuses runs of a job with `[conditioning]`.
///
/// # Errors
/// One fault if the job has the section.
pub(super) fn refuse_runs(job: &Job, file: &str) -> Result<(), Faults> {
    let Some(asked) = &job.conditioning else {
        return Ok(());
    };
    let wrong =
        format!("`{file}` contains runs, and [conditioning] acts on the samples of a record");
    let remedy = "name a record as [measured] strain, or delete [conditioning]";
    Err(Fault::with_line(&*job.file, asked.line, "conditioning", wrong, remedy).into())
}

/// Returns a note on the steps that changed readings; `None` without any.
pub fn report_conditioning(steps: &[ConditioningStep]) -> Option<Finding> {
    let mut names: Vec<&str> = steps.iter().map(|s| s.step).collect();
    names.dedup();
    let largest = steps
        .iter()
        .max_by(|a, b| a.rms_microstrain.total_cmp(&b.rms_microstrain))?;
    let spikes: usize = steps
        .iter()
        .filter(|s| s.step == "spikes")
        .map(|s| s.samples)
        .sum();
    let spikes = match spikes {
        0 => String::new(),
        n => format!("{n} spikes are replaced; "),
    };
    let message = format!(
        "[conditioning] changed the readings in these steps: {}; {spikes}the largest change is {:.4} microstrain rms, by `{}` at gauge {}",
        names.join(", "),
        largest.rms_microstrain,
        largest.step,
        largest.gauge
    );
    let gauges: Vec<&str> = (steps.iter())
        .filter(|s| s.step == largest.step)
        .map(|s| s.gauge.as_str())
        .collect();
    Some(Finding::new(
        Severity::Info,
        "corrections-applied",
        list_few(&gauges),
        message,
        "",
    ))
}
