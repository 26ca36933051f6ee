//! A recovered record against a record of loads: times are brought together, samples compared at the times of the recovered loads.

use super::curves::{RULES, SampledLoad, levels_of, spectra_of, without_alias};
use super::{Comparison, ComparisonShift, Differences, LoadLevels, POINTS, Pair};
use crate::estimate::NORMAL_95;
use crate::finding::{Finding, Severity};
use crate::host::fault::{Fault, Faults};
use crate::host::outcome::finite_or_none;
use crate::host::words::format_number;
use crate::host::work::Work;
use crate::job::{Compare, Job, TimeShift};
use crate::measured::recorded_loads::{LoadRecord, RecordedLoads, quantity_of, read_recorded};
use crate::measured::runs_file::read_runs;
use crate::recovery::Gain as Estimate;
use crate::series::record::Clock;
use crate::series::shift::{NoShift, SampledSignals, ShiftRules, estimate_shift};
use crate::workflow::recover::damage::{CycleCountInput, PIECE, damage_of_recorded};
use crate::workflow::recover::sink::RecordHead;
use crate::workflow::recover::task::Task;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// Blocks of a record whose scatter shows how many of its samples are independent.
const BLOCKS: usize = 20;

/// A sample with a missing reading, and the estimate from the other gauges.
pub type Gap = (usize, Option<Arc<Estimate>>);

/// Opens the record of loads that a job names for its strain record; `None` if it names no such record. The runs file of a job is read for its
/// faults.
///
/// # Errors
/// Files that can't be read; a `[compare]` that names runs.
pub fn record_of_job(
    work: &mut Work,
    task: &Task,
    names: &[String],
) -> Result<Option<LoadRecord>, Faults> {
    let job = task.job;
    if let Some(runs) = &job.runs {
        read_runs(&mut work.inputs, job, runs)?;
    }
    let Some(compare) = &job.compare else {
        return Ok(None);
    };
    match read_recorded(&mut work.inputs, job, compare, names)? {
        RecordedLoads::Record(record) => {
            work.findings.extend(record.findings.iter().cloned());
            Ok(Some(*record))
        }
        RecordedLoads::Runs(_) => Err(Fault::with_line(
            &*job.file,
            compare.line,
            "compare.file",
            "the recorded loads are of runs, and the strain file is a record",
            "name a record of loads (a column `time`, or a format of records), or runs of strain",
        )
        .into()),
    }
}

/// Loads of both records, report units.
struct LoadRecordPair<'a> {
    counting: CycleCountInput<'a>,
    gaps: &'a [Gap],
    recorded: LoadRecord,
    /// Column of each recorded load among the recovered ones.
    columns: Vec<usize>,
    /// Time of the first recorded sample by the clock of the strain record, the shift included, s.
    start_s: f64,
    /// Standard deviation of the noise of each recorded load.
    noise: Vec<f64>,
    /// Standard deviation of each recovered load without loads: of noise alone.
    quiet: Vec<f64>,
}

/// Compares a recovered record with the recorded loads; `clock` is the clock of the strain record.
///
/// # Errors
/// No time shift that brings both together; no sample in common.
pub fn record(
    work: &mut Work,
    job: &Job,
    (counting, gaps): (CycleCountInput, &[Gap]),
    (clock, mut recorded): (&Clock, LoadRecord),
) -> Result<Comparison, Faults> {
    let (head, compare) = (counting.head, job.compare.as_ref());
    let Some(compare) = compare.filter(|_| counting.samples.n_samples() > 0) else {
        return Ok(Comparison::default());
    };
    let (mut columns, mut noise) = (Vec::new(), Vec::new());
    for (load, samples) in recorded.loads.iter().zip(&mut recorded.samples) {
        let column = head.names.iter().position(|n| *n == load.name).unwrap_or(0);
        let si = quantity_of(job, &load.name).map_or(1.0, |q| job.units.si(q));
        let factor = head.units[column].factor / si;
        samples
            .iter_mut()
            .for_each(|v| *v = (f64::from(*v) * factor) as f32);
        columns.push(column);
        noise.push(load.noise_si * factor);
    }
    let start_s = recorded.clock.start_s + recorded.epoch_after(clock);
    let shift = shift_of(job, compare, counting, (&recorded, &columns, start_s))?;
    work.findings.extend(shift_found(&shift));
    let sigma = head.filter.sigma(&vec![0.0; head.n_loads()]);
    let both = LoadRecordPair {
        quiet: columns
            .iter()
            .map(|c| sigma[*c] * head.units[*c].factor)
            .collect(),
        start_s: start_s + shift.shift_s,
        counting,
        gaps,
        recorded,
        columns,
        noise,
    };
    let range = both.common_samples(head);
    if range.len() < 2 {
        return Err(both.nothing_common(job, compare).into());
    }
    let mut out = Comparison {
        shift: Some(shift),
        spectra: spectra_of(
            &both.sampled_loads(&range),
            1.0 / head.step_s,
            both.highest_hz(range.start),
        ),
        levels: both.levels(&range),
        ..Comparison::default()
    };
    for (i, (sums, curved)) in both.differences(&range).into_iter().enumerate() {
        let (sigma, deviations) = (sums.sigma(), sums.deviations(false));
        let column = both.columns[i];
        let Some(mut found) = sums.into_comparison(&head.names[column], &head.units[column].name)
        else {
            continue;
        };
        both.compare_damage(i, &range, &mut found);
        work.findings
            .extend(found.outside_intervals_finding(deviations));
        work.findings.extend(coarse_samples_finding(
            &both.recorded,
            &found.load,
            (curved, sigma),
        ));
        out.loads.push(found);
    }
    Ok(out)
}

impl LoadRecordPair<'_> {
    fn recorded_samples(&self) -> SampledSignals<'_> {
        SampledSignals {
            start_s: self.start_s,
            rate_hz: self.recorded.clock.rate_hz,
            signals: &self.recorded.samples,
        }
    }

    /// Returns the recovered samples between the first and the last recorded sample.
    fn common_samples(&self, head: &RecordHead) -> Range<usize> {
        let n = self.counting.samples.n_samples();
        let last = self.recorded.clock.samples.saturating_sub(1) as f64;
        let end_s = self.start_s + last / self.recorded.clock.rate_hz;
        // Times are rounded. A sample that is a millionth of a step after the end counts as at the end.
        let place = |t: f64| (t - head.first_s) / head.step_s;
        let from = (place(self.start_s) - 1e-6).ceil().max(0.0) as usize;
        let to = ((place(end_s) + 1e-6).floor() + 1.0).max(0.0) as usize;
        from.min(n)..to.min(n).max(from.min(n))
    }

    /// Returns the highest frequency of the spectra. It is half of the sample rate if both records have samples at the same times. The curve between
    /// recorded samples loses 1 % of the density at an eighth of their rate, and 80 % at half of it. A faster recording passes a filter first, which
    /// loses less than 1 % up to half of its corner.
    fn highest_hz(&self, first: usize) -> f64 {
        let head = self.counting.head;
        let (own, theirs) = (1.0 / head.step_s, self.recorded.clock.rate_hz);
        let time = head.first_s + first as f64 * head.step_s;
        let place = (time - self.start_s) * theirs;
        let is_same_rate = (own / theirs - 1.0).abs() * self.recorded.clock.samples as f64 <= 1e-3;
        if is_same_rate && (place - place.round()).abs() <= 1e-3 {
            return 0.5 * own;
        }
        (theirs / 8.0).min(0.5 * RULES.low_pass * own)
    }

    fn nothing_common(&self, job: &Job, compare: &Compare) -> Fault {
        let head = self.counting.head;
        let end = |first: f64, n: usize, step: f64| first + n.saturating_sub(1) as f64 * step;
        let n = self.counting.samples.n_samples();
        let clock = &self.recorded.clock;
        let wrong = format!(
            "no time in common: the strain record covers {} to {} s, the recorded loads {} to {} s with this shift",
            format_number(head.first_s),
            format_number(end(head.first_s, n, head.step_s)),
            format_number(self.start_s),
            format_number(end(self.start_s, clock.samples, 1.0 / clock.rate_hz)),
        );
        let remedy = "state another number, or shift_s = \"estimate\"";
        Fault::with_line(&*job.file, compare.line, "compare.shift_s", wrong, remedy)
    }

    /// Returns, for each recorded load, sums of the differences, and the rms difference between curve and line through recorded samples.
    fn differences(&self, range: &Range<usize>) -> Vec<(Differences, f64)> {
        let pieces: Vec<usize> = range.clone().step_by(PIECE).collect();
        let of_pieces: Vec<Vec<(Differences, f64)>> = pieces
            .into_par_iter()
            .map(|from| self.of_piece(from..(from + PIECE).min(range.end), range))
            .collect();
        let nothing = || (Differences::of_blocks(BLOCKS), 0.0);
        let mut out: Vec<_> = self.columns.iter().map(|_| nothing()).collect();
        for piece in &of_pieces {
            for (sum, more) in out.iter_mut().zip(piece) {
                sum.0.merge(&more.0);
                sum.1 += more.1;
            }
        }
        for (sums, curved) in &mut out {
            *curved = (*curved / sums.n.max(1) as f64).sqrt();
        }
        out
    }

    fn of_piece(&self, piece: Range<usize>, range: &Range<usize>) -> Vec<(Differences, f64)> {
        let CycleCountInput { head, samples, .. } = self.counting;
        let k = head.n_loads();
        let all: Vec<usize> = (0..k).collect();
        let mut values = Vec::with_capacity(piece.len() * k);
        samples.read(piece.start, piece.end, &all, &mut values);
        let nothing = || (Differences::of_blocks(BLOCKS), 0.0);
        let mut out: Vec<_> = self.columns.iter().map(|_| nothing()).collect();
        let stride = range.len().div_ceil(POINTS).max(1);
        let sampled = self.recorded_samples();
        let wider = head.filter.coverage_factor() / NORMAL_95;
        for (at, row) in piece.zip(values.chunks_exact(k)) {
            let of_job: Vec<f64> = row
                .iter()
                .zip(&head.units)
                .map(|(v, u)| v / u.factor)
                .collect();
            let gap = self.gaps.binary_search_by_key(&at, |g| g.0).ok();
            let gain = match gap.and_then(|g| self.gaps.get(g)) {
                Some((_, gain)) => gain.as_deref(),
                None => head.estimate_at(at),
            };
            let sigma = head.filter.sigma_at(at, gain, &of_job);
            let time = head.first_s + at as f64 * head.step_s;
            let place = at - range.start;
            let block = place * BLOCKS / range.len();
            for (i, (column, (sums, curved))) in self.columns.iter().zip(&mut out).enumerate() {
                let Some(between) = sampled.value_at(i, time) else {
                    continue;
                };
                let (recorded, noise) = (between.value, between.noise * self.noise[i]);
                let recovered = row[*column];
                let wide = wider * sigma[*column] * head.units[*column].factor;
                if !(recovered.is_finite() && wide.is_finite()) {
                    continue;
                }
                let pair = Pair {
                    recovered,
                    recorded,
                    sigma: wide.hypot(noise),
                    own_sigma: (wider * self.quiet[i]).min(wide).hypot(noise),
                    factor: NORMAL_95,
                };
                sums.add(block, &pair);
                *curved += (recorded - between.line).powi(2);
                if place.is_multiple_of(stride) {
                    sums.points.push([recorded, recovered]);
                }
            }
        }
        out
    }

    /// Returns recovered and recorded loads at the times of the recovered loads.
    fn sampled_loads(&self, range: &Range<usize>) -> Vec<SampledLoad> {
        let head = self.counting.head;
        let recovered = recovered_columns(self.counting, &self.columns);
        let rates = 1.0 / (head.step_s * self.recorded.clock.rate_hz);
        let filtered = without_alias(&self.recorded.samples, rates);
        let sampled = SampledSignals {
            signals: filtered.as_ref().unwrap_or(&self.recorded.samples),
            ..self.recorded_samples()
        };
        let time = |at: usize| head.first_s + at as f64 * head.step_s;
        let load = |(i, recovered): (usize, Vec<f32>)| {
            let column = self.columns[i];
            let recorded = range.clone().map(|at| sampled.value_at(i, time(at)));
            SampledLoad {
                load: head.names[column].clone(),
                unit: head.units[column].name.clone(),
                recorded: recorded.map(|v| v.map_or(f64::NAN, |v| v.value)).collect(),
                recovered: recovered[range.clone()]
                    .iter()
                    .map(|v| f64::from(*v))
                    .collect(),
            }
        };
        recovered.into_iter().enumerate().map(load).collect()
    }

    /// Returns the level crossings of both loads between the same times, each from its own samples.
    fn levels(&self, range: &Range<usize>) -> Vec<LoadLevels> {
        let head = self.counting.head;
        let recovered = recovered_columns(self.counting, &self.columns);
        let of_load = |(i, recovered): (usize, Vec<f32>)| {
            let column = self.columns[i];
            let samples = recovered[range.clone()].iter().map(|v| f64::from(*v));
            // Only times count at which both are known.
            let step = head.step_s * self.recorded.clock.rate_hz;
            let is_known = |j: usize| {
                let place = range.start + (j as f64 / step).round() as usize;
                recovered.get(place).is_none_or(|v| v.is_finite())
            };
            let recorded = self.recorded_between(i, range).iter().enumerate();
            let recorded = recorded.map(|(j, v)| match is_known(j) {
                true => f64::from(*v),
                false => f64::NAN,
            });
            let name = (
                head.names[column].as_str(),
                head.units[column].name.as_str(),
            );
            levels_of(name, samples, recorded)
        };
        recovered
            .into_iter()
            .enumerate()
            .filter_map(of_load)
            .collect()
    }

    /// Returns the recorded samples of a load between the first and the last time of a range.
    fn recorded_between(&self, i: usize, range: &Range<usize>) -> &[f32] {
        let head = self.counting.head;
        let time = |at: usize| head.first_s + at as f64 * head.step_s;
        let place = |t: f64| (t - self.start_s) * self.recorded.clock.rate_hz;
        let from = (place(time(range.start)) - 1e-6).ceil().max(0.0) as usize;
        let to = (place(time(range.end - 1)) + 1e-6).floor().max(0.0) as usize;
        self.recorded.samples[i].get(from..=to).unwrap_or_default()
    }

    /// Returns the damage of recovered over recorded load between the same times, each from its own samples.
    fn compare_damage(&self, i: usize, range: &Range<usize>, found: &mut super::LoadComparison) {
        let samples = self.recorded_between(i, range);
        let values = samples.iter().map(|v| f64::from(*v));
        let slope = self.counting.slope;
        let recorded = damage_of_recorded(values, self.noise[i], slope);
        let recovered = self.counting.damage(self.columns[i], 0.0, range.clone());
        let Some(ratio) = finite_or_none(recovered.value / recorded.value).filter(|r| *r > 0.0)
        else {
            return;
        };
        // The relative errors of both damages are independent: their squares add up.
        let below = |low: f64, value: f64| (value / low).ln();
        let lower =
            below(recovered.low, recovered.value).hypot(below(recorded.value, recorded.high));
        let upper =
            below(recovered.value, recovered.high).hypot(below(recorded.low, recorded.value));
        found.damage_ratio = Some(ratio);
        found.damage_ratio_low = finite_or_none(ratio * (-lower).exp());
        found.damage_ratio_high = finite_or_none(ratio * upper.exp());
    }
}

/// Returns the shift that the job states, or the shift that is estimated from recovered and recorded loads. `start_s` is the time of the first
/// recorded sample without the shift.
fn shift_of(
    job: &Job,
    compare: &Compare,
    counting: CycleCountInput,
    (recorded, columns, start_s): (&LoadRecord, &[usize], f64),
) -> Result<ComparisonShift, Faults> {
    let mut out = ComparisonShift {
        file: recorded.file.clone(),
        shift_s: 0.0,
        half_width_s: None,
        correlation: None,
    };
    if let TimeShift::Stated(seconds) = compare.shift {
        out.shift_s = seconds;
        return Ok(out);
    }
    let head = counting.head;
    let recovered = recovered_columns(counting, columns);
    let fixed = SampledSignals {
        start_s: head.first_s,
        rate_hz: 1.0 / head.step_s,
        signals: &recovered,
    };
    let moving = SampledSignals {
        start_s,
        rate_hz: recorded.clock.rate_hz,
        signals: &recorded.samples,
    };
    let found = estimate_shift(fixed, moving, &ShiftRules::default());
    let found = found.map_err(|e| no_shift(job, compare, &recorded.file, e))?;
    out.shift_s = found.seconds;
    out.half_width_s = Some(found.half_width_s);
    out.correlation = Some(found.correlation);
    Ok(out)
}

/// Reads the recovered loads of these columns into memory, report units.
fn recovered_columns(counting: CycleCountInput, columns: &[usize]) -> Vec<Vec<f32>> {
    let n = counting.samples.n_samples();
    let mut out = vec![Vec::with_capacity(n); columns.len()];
    let mut values = Vec::new();
    for from in (0..n).step_by(PIECE) {
        values.clear();
        counting
            .samples
            .read(from, (from + PIECE).min(n), columns, &mut values);
        for row in values.chunks_exact(columns.len().max(1)) {
            out.iter_mut().zip(row).for_each(|(c, v)| c.push(*v as f32));
        }
    }
    out
}

fn no_shift(job: &Job, compare: &Compare, file: &str, e: NoShift) -> Fault {
    let (wrong, remedy) = match e {
        NoShift::Constant => (
            format!(
                "no load changes both in the strain record and in `{file}`: their time shift can't be estimated"
            ),
            "state it as a number of seconds: shift_s = 0.0",
        ),
        NoShift::Unlike(best) => (
            format!(
                "recovered loads and the loads of `{file}` do not agree at any time shift: the largest mean correlation coefficient is {best:.2}"
            ),
            "compare columns, signs and the times of both files, or state the shift as a number of seconds: shift_s = 0.0",
        ),
        NoShift::Ambiguous([first, second]) => (
            format!(
                "the loads of `{file}` agree with the recovered loads at a time shift of {} s and equally at {} s: they are periodic",
                format_number(first),
                format_number(second)
            ),
            "state the shift as a number of seconds",
        ),
    };
    Fault::with_line(&*job.file, compare.line, "compare.shift_s", wrong, remedy)
}

fn shift_found(shift: &ComparisonShift) -> Option<Finding> {
    let half = shift.half_width_s?;
    Some(Finding::new(
        Severity::Info,
        "time-shift-estimated",
        &*shift.file,
        format!(
            "recorded loads are compared {:.5} ± {:.5} s after the times of their file, which gives the best agreement with the recovered \
             loads; mean correlation coefficient {:.3}",
            shift.shift_s,
            half,
            shift.correlation.unwrap_or(f64::NAN)
        ),
        "state the shift in the job if it is known from the loggers: [compare] shift_s",
    ))
}

/// Returns the warning on a load with a low recording rate: the values between samples are less certain than the recovered load.
fn coarse_samples_finding(
    recorded: &LoadRecord,
    load: &str,
    (curved, sigma): (f64, f64),
) -> Option<Finding> {
    (curved > sigma).then(|| {
        Finding::new(
            Severity::Warning,
            "recorded-samples-coarse",
            format!("load `{load}`"),
            format!(
                "`{}` has {} samples per second. The interpolation error of the load is {} rms, more than the standard deviation {} of the \
                 recovered load: differences and damage include it",
                recorded.file,
                format_number(recorded.clock.rate_hz),
                format_number(curved),
                format_number(sigma)
            ),
            "export the recorded loads at a higher rate",
        )
        .with_numbers(curved, sigma)
    })
}
