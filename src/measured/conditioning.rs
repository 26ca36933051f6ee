//! `[conditioning]`: changes of the readings of a record before anything else.

use super::conditioning_step::ConditioningStep;
use super::faults::record_fault;
use super::record::{MOST_NUMBERS, Record};
use crate::estimate::NORMAL_95;
use crate::finding::{Finding, Severity, list_few};
use crate::host::fault::{Fault, Faults};
use crate::job::{Job, ReadingConditioning, Reference, TemperatureCompensation};
use crate::recovery::dead_gauges::shortest_part;
use crate::series::butterworth::{Passes, filter_without_phase};
use crate::series::detrend::{finite_mean, line, mean, rms};
use crate::series::quality::find_spikes;
use crate::units::{MICROSTRAIN, number};
use rayon::prelude::*;
use std::ops::Range;

/// Independent readings that a stretch of zero needs: the error of the mean is then below a tenth of the noise of a reading.
const LEAST_ZERO: usize = 100;

/// Readings of a record while they are conditioned.
struct Conditioner {
    /// Strain, a column each.
    readings: Vec<Vec<f64>>,
    names: Vec<String>,
    steps: Vec<ConditioningStep>,
}

impl Conditioner {
    /// Blanks long stretches in which one gauge reads a constant value while most of the others vary: the gauge or its wire is dead there. A filter
    /// or a subtracted temperature would hide it. A gauge that is constant throughout is left to the search for gauges without a signal.
    fn blank_constant_stretches(&mut self) {
        let samples = self.readings.first().map_or(0, Vec::len);
        let least = shortest_part(samples);
        let mut dead: Vec<(usize, Range<usize>)> = Vec::new();
        for (g, column) in self.readings.iter().enumerate() {
            let mut first = 0;
            for stretch in column.chunk_by(|a, b| a == b) {
                let span = first..first + stretch.len();
                first = span.end;
                if span.len() < least || span.len() == samples {
                    continue;
                }
                let others = self.readings.iter().enumerate().filter(|(o, _)| *o != g);
                let varies = |x: &[f64]| x.windows(2).any(|w| w[0] != w[1]);
                let varying = others.filter(|(_, x)| varies(&x[span.clone()])).count();
                if 2 * varying > self.readings.len() - 1 {
                    dead.push((g, span));
                }
            }
        }
        for (g, span) in dead {
            let column = &mut self.readings[g];
            let value = column[span.start] / MICROSTRAIN;
            column[span.clone()].fill(f64::NAN);
            self.steps.push(ConditioningStep {
                step: "constant",
                gauge: self.names[g].clone(),
                samples: span.len(),
                rms_microstrain: value.abs() * (span.len() as f64 / samples as f64).sqrt(),
                error_microstrain: None,
            });
        }
    }

    /// Applies a change to every column; a column that does not change is not listed.
    fn apply(&mut self, step: &'static str, change: impl Fn(&mut [f64]) + Sync) {
        let of_column = |column: &mut Vec<f64>| -> (usize, f64) {
            let before = column.clone();
            // A gauge with one constant value has no signal: the search for such gauges must still find it.
            let mut read = before.iter().filter(|v| v.is_finite());
            let first = read.next();
            if step != "zero" && read.all(|v| Some(v) == first) {
                return (0, 0.0);
            }
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
                error_microstrain: None,
            }));
    }
}

/// Returns the record with the columns `wanted` conditioned as `[conditioning]` of the job states. Without this section, the result is `record`
/// itself. `[[correction]]` is applied first, and not again afterwards.
///
/// # Errors
/// - The record lacks the temperature channel, or this channel is a gauge.
/// - A stretch of zero is beyond the record or has too few readings, or the job states two zeros.
/// - A corner frequency is above half of the sample rate.
/// - The record is too long.
pub(crate) fn condition(job: &Job, record: Record, wanted: &[String]) -> Result<Record, Faults> {
    let Some(asked) = &job.conditioning else {
        return Ok(record);
    };
    let fault = |key: &str, (wrong, remedy): (String, &str)| {
        let field = format!("conditioning.{key}");
        let field = field.trim_end_matches('.');
        Faults::from(Fault::with_line(
            &*job.file, asked.line, field, wrong, remedy,
        ))
    };
    check_zeros(job)?;
    let temperature = match &asked.temperature {
        Some(t) => {
            let measured = temperature_of(&record, t, wanted);
            let field = "temperature.channel";
            Some((
                t,
                measured.map_err(|e| e.unwrap_or_else(|wrong| fault(field, wrong)))?,
            ))
        }
        None => None,
    };
    let record = record.with_wanted_strain(job, wanted);
    let (first_s, step_s) = record.first_and_step();
    let samples = record.clock().samples;
    if samples.saturating_mul(record.n_columns()) > MOST_NUMBERS {
        let wrong = format!("the record has {samples} samples, which must be held in memory");
        return Err(fault(
            "",
            (
                wrong,
                "cut the record into parts of at most 100 million readings",
            ),
        ));
    }
    for (key, corner) in [
        ("low_pass_hz", asked.low_pass_hz),
        ("high_pass_hz", asked.high_pass_hz),
    ] {
        if let Some(corner) = corner.filter(|f| f * step_s * (samples as f64) < 1.0) {
            let wrong = format!("the record is shorter than one period of {corner} Hz");
            return Err(fault(key, (wrong, "state a higher frequency")));
        }
        if let Some(corner) = corner.filter(|f| !(f * step_s < 0.5)) {
            let wrong = format!(
                "{corner} Hz is not below half of the sample rate, {:.4} Hz",
                0.5 / step_s
            );
            return Err(fault(
                key,
                (wrong, "state a lower frequency, or sample faster"),
            ));
        }
    }
    let mut work = Conditioner {
        readings: record.columns()?,
        names: record.names_read(),
        steps: Vec::new(),
    };
    work.blank_constant_stretches();
    let zero = match asked.zero_s {
        Some(times) => {
            let zero = zero_samples(&record, times, asked.low_pass_hz, &work);
            Some(zero.map_err(|wrong| fault("zero_s", wrong))?)
        }
        None => None,
    };
    let asked_of = (asked, zero.as_ref(), step_s);
    run_steps(
        &mut work,
        asked_of,
        temperature.as_ref().map(|(t, v)| (*t, &**v)),
    );
    let channel = asked.temperature.as_ref().map(|t| t.channel.as_str());
    record.with_conditioned_readings(work.readings, (first_s, step_s), (work.steps, channel))
}

/// Checks that a job with `[conditioning]` has one zero.
///
/// # Errors
/// Steps that remove static strain in a job that subtracts a zero or adds a reference state itself.
pub(crate) fn check_zeros(job: &Job) -> Result<(), Faults> {
    let Some(asked) = &job.conditioning else {
        return Ok(());
    };
    refuse_two_zeros(job, asked).map_err(|(key, (wrong, remedy))| {
        let field = format!("conditioning.{key}");
        Fault::with_line(&*job.file, asked.line, field, wrong, remedy).into()
    })
}

/// Refuses steps that remove static strain in a job that subtracts a zero or adds a reference state itself.
fn refuse_two_zeros(
    job: &Job,
    asked: &ReadingConditioning,
) -> Result<(), (&'static str, (String, &'static str))> {
    let measured = job.measured.as_ref();
    let has_zero = measured.is_some_and(|m| m.zero.is_some());
    let has_reference = measured.is_some_and(|m| m.reference != Reference::None);
    let common = job.sensitivity.as_ref();
    let has_common = common.is_some_and(|s| s.common_zero.is_some());
    let remedy = "delete one of them";
    if has_zero && asked.zero_s.is_some() {
        let wrong = "[measured] states a zero file too: only one of them can be zero";
        return Err(("zero_s", (wrong.to_owned(), remedy)));
    }
    if has_zero && asked.temperature.is_some() {
        let wrong = "the temperature of the zero file in [measured] is not known";
        let remedy = "state `zero_s` instead of the zero file, or compensate the readings before";
        return Err(("temperature", (wrong.to_owned(), remedy)));
    }
    if asked.high_pass_hz.is_some() && (has_zero || has_reference || has_common) {
        let wrong = "the filter removes static strain, and the job subtracts a zero or adds a reference state";
        return Err(("high_pass_hz", (wrong.to_owned(), remedy)));
    }
    Ok(())
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
            None => measured.first().copied().unwrap_or(0.0),
        };
        let factor = compensation.microstrain_per_deg_c * MICROSTRAIN;
        work.apply("temperature", |x| {
            let both = x.iter_mut().zip(measured);
            both.for_each(|(x, t)| *x -= factor * (t - reference));
        });
    }
    if asked.linear_drift {
        let at = zero.map_or(0.0, |z| 0.5 * (z.start + z.end) as f64);
        let errors = work.readings.par_iter().map(|x| line_error(x, at));
        let errors: Vec<f64> = errors.collect();
        work.apply("drift", |x| {
            let slope = line(x).1;
            let all = x.iter_mut().enumerate();
            all.for_each(|(i, v)| *v -= slope * (i as f64 - at));
        });
        for (name, error) in work.names.iter().zip(errors) {
            let mut of_gauge = work.steps.iter_mut();
            let step = of_gauge.find(|s| s.step == "drift" && s.gauge == *name);
            step.into_iter()
                .for_each(|s| s.error_microstrain = Some(error / MICROSTRAIN));
        }
    }
    if let Some(zero) = zero {
        work.apply("zero", |x| {
            // Only a gauge without any reading in the record can lack readings in the time span: other gauges were refused before.
            let offset = finite_mean(&x[zero.clone()]);
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

/// Returns the largest change of the least squares line if up to a fifth of the record is omitted at either end. The line is zero at `at`, and the
/// change is that at the sample farthest from `at`. A line that loads tilt depends on where the record begins and ends.
fn line_error(x: &[f64], at: f64) -> f64 {
    let n = x.len();
    let farthest = at.max(n as f64 - 1.0 - at);
    let whole = line(x).1;
    let shorter = (1..=8).flat_map(|k| {
        let cut = n * k / 40;
        [&x[cut..], &x[..n - cut]]
    });
    let change = |part: &[f64]| (line(part).1 - whole).abs() * farthest;
    shorter.map(change).fold(0.0, f64::max)
}

/// Returns the samples of the stretch of zero.
fn zero_samples(
    record: &Record,
    [from, to]: [f64; 2],
    low_pass_hz: Option<f64>,
    work: &Conditioner,
) -> Result<Range<usize>, (String, &'static str)> {
    let (samples, (first_s, step_s)) = (record.clock().samples, record.first_and_step());
    let last_s = first_s + step_s * samples.saturating_sub(1) as f64;
    if from < first_s - 0.5 * step_s || to > last_s + 0.5 * step_s {
        let wrong = format!("[{from}, {to}] s is beyond the record, {first_s:.4} to {last_s:.4} s");
        return Err((wrong, "state times of the record"));
    }
    let at = |t: f64| ((t - first_s) / step_s).round().max(0.0) as usize;
    let range = at(from)..(at(to) + 1).min(samples);
    // Noise below a corner is independent in steps of half its period.
    let independent = low_pass_hz.map_or(1.0, |f| (2.0 * f * step_s).min(1.0));
    let least = (LEAST_ZERO as f64 / independent).ceil() as usize;
    let filtered = low_pass_hz.map_or("", |_| " with this `low_pass_hz`");
    for (name, column) in work.names.iter().zip(&work.readings) {
        let read = column[range.clone()].iter().filter(|v| v.is_finite());
        let n = read.count();
        // A gauge without any reading is reported elsewhere.
        if n < least && column.iter().any(|v| v.is_finite()) {
            let wrong = format!(
                "[{from}, {to}] s contains {n} readings of gauge {name}, and a zero needs {least}{filtered}"
            );
            return Err((
                wrong,
                "state a longer stretch without loads, or [[correction]] ignore = true for this gauge",
            ));
        }
    }
    Ok(range)
}

/// Returns the temperature of every sample in degrees Celsius or Kelvin; missing ones have the last value before.
fn temperature_of(
    record: &Record,
    compensation: &TemperatureCompensation,
    wanted: &[String],
) -> Result<Vec<f64>, Result<Faults, (String, &'static str)>> {
    let channel = &compensation.channel;
    let wrong = |wrong: String, remedy: &'static str| Err(Err((wrong, remedy)));
    if wanted.contains(channel) {
        let wrong_name = format!("`{channel}` is a gauge of the job");
        return wrong(wrong_name, "name the column of the temperature");
    }
    let (Some(unit), Some(read)) = (record.unit_of(channel), record.raw_column(channel)) else {
        return wrong(
            format!(
                "the record has no numeric channel `{channel}` that is sampled with the gauges"
            ),
            "name a column of the strain file",
        );
    };
    let known = ["", "degc", "\u{b0}c", "deg c", "deg_c", "celsius", "c", "k"];
    if !known.contains(&unit.to_lowercase().as_str()) {
        return wrong(
            format!("the unit of channel `{channel}` is `{unit}`"),
            "export the temperature in degC",
        );
    }
    let mut values = read.map_err(|e| Ok(record_fault(record.file(), &e).into()))?;
    let Some(first) = values.iter().copied().find(|v| v.is_finite()) else {
        return wrong(
            format!("channel `{channel}` has no number"),
            "name a column with temperatures",
        );
    };
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

/// Returns the warning that loads tilt the line of drift of some gauges by more than the 95 % interval of a reading with `noise`, strain.
pub fn report_doubtful_drift(steps: &[ConditioningStep], noise: f64) -> Option<Finding> {
    let limit = NORMAL_95 * noise / MICROSTRAIN;
    let error = |s: &ConditioningStep| s.error_microstrain.filter(|e| *e > limit);
    let tilted: Vec<&ConditioningStep> = steps.iter().filter(|s| error(s).is_some()).collect();
    let largest = tilted.iter().filter_map(|s| error(s)).fold(0.0, f64::max);
    let gauges: Vec<&str> = tilted.iter().map(|s| s.gauge.as_str()).collect();
    (!gauges.is_empty()).then(|| {
        Finding::new(
            Severity::Warning,
            "corrections-applied",
            list_few(&gauges),
            format!(
                "the subtracted drift changes by up to {} microstrain with the begin and the end of the record, limit {}: loads tilt the line. \
                 The intervals do not contain this error",
                number(largest),
                number(limit)
            ),
            "record the unloaded structure again at the end, or state `drift = \"none\"`",
        )
        .with_numbers(largest, limit)
    })
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
        "[conditioning] changed the readings in these steps: {}; {spikes}the largest change is {} microstrain rms, by `{}` at gauge {}",
        names.join(", "),
        number(largest.rms_microstrain),
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
