//! Loads of a record by section, and the duty cycle that the sections make.

use super::damage::{CycleCountInput, PIECE};
use super::section_rules::{NoSamples, stretches_within};
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::words::format_number;
use crate::job::{Job, RecordSection, SectionExtent};
use crate::measured::record::Record;
use crate::series::record::Clock;
use rayon::prelude::*;
use serde::Serialize;
use std::ops::Range;

/// Sections of a record.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sections {
    /// Loads of each section.
    pub sections: Vec<SectionLoad>,
    /// Sum over the sections for each load, each section counted as often as it occurs.
    pub duty_cycle: Vec<DutyLoad>,
}

/// A load in a section, report units.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SectionLoad {
    /// Section.
    pub section: String,
    /// Load or combination.
    pub load: String,
    /// Report unit.
    pub unit: String,
    /// Stretches of the record; more than one where a rule selects them.
    pub stretches: usize,
    /// Number of samples of the section times the time step.
    pub seconds: f64,
    /// Number of occurrences of the section in the duty cycle.
    pub repeats: f64,
    /// Smallest sample.
    pub min: f64,
    /// Mean.
    pub mean: f64,
    /// Largest sample.
    pub max: f64,
    /// Pseudo-damage of the section once, the sum over its stretches.
    pub damage: f64,
    /// Lower end of its 95 % interval.
    pub damage_low: f64,
    /// Upper end of this interval.
    pub damage_high: f64,
}

/// A load over the duty cycle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DutyLoad {
    /// Load or combination.
    pub load: String,
    /// Report unit.
    pub unit: String,
    /// Duration of the duty cycle, s.
    pub seconds: f64,
    /// Sum of repeats times damage of a section.
    pub damage: f64,
    /// Lower end of its 95 % interval.
    pub damage_low: f64,
    /// Upper end of this interval.
    pub damage_high: f64,
}

/// The samples of a section of the strain record: one stretch or more, ascending.
pub(super) struct Part<'a> {
    pub section: &'a RecordSection,
    pub stretches: Vec<Range<usize>>,
}

/// Refuses sections without a record.
///
/// # Errors
/// A fault at the first section.
pub(super) fn without_record(job: &Job) -> Result<(), Faults> {
    let Some(first) = job.sections.first() else {
        return Ok(());
    };
    let wrong = "sections are stretches of a record, and the strain file has runs";
    let remedy = "delete the sections, or name a record: a column `time`, or a format of records";
    Err(Fault::with_line(&*job.file, first.line, "section", wrong, remedy).into())
}

/// Returns the sections of a job that are parts of its strain record, with their samples.
///
/// # Errors
/// A fault for each section that is beyond the record, has no sample, names a channel that the record lacks, or overlaps another section.
pub(super) fn parts<'a>(
    job: &'a Job,
    record: &Record,
    clock: &Clock,
) -> Result<Vec<Part<'a>>, Faults> {
    let mut faults = FaultList::new();
    let mut out: Vec<Part> = Vec::new();
    for section in &job.sections {
        let stretches = match &section.extent {
            SectionExtent::File(_) => continue,
            SectionExtent::Times(times) => samples_between(*times, clock).map(|r| vec![r]),
            SectionExtent::Within(rule) => stretches_within(rule, record, clock)?,
        };
        let stretches = stretches.map_err(|(field, wrong, remedy)| {
            let wrong = format!("section `{}`: {wrong}", section.name);
            let line = section.line;
            faults.push(Fault::with_line(&*job.file, line, field, wrong, remedy));
        });
        let Ok(stretches) = stretches else { continue };
        let part = Part { section, stretches };
        faults.extend(
            out.iter()
                .find_map(|other| overlap(job, other, &part, clock)),
        );
        out.push(part);
    }
    Faults::check(faults)?;
    Ok(out)
}

/// Samples from one time until before another, s.
fn samples_between([from, to]: [f64; 2], clock: &Clock) -> Result<Range<usize>, NoSamples> {
    let step = 1.0 / clock.rate_hz;
    let end_s = clock.start_s + clock.samples as f64 * step;
    // Stated times are rounded. A time up to a millionth of a step after a sample selects this sample.
    let place = |t: f64| (((t - clock.start_s) / step - 1e-6).ceil()).max(0.0) as usize;
    let range = place(from)..place(to).min(clock.samples);
    if from < clock.start_s - 1e-6 * step || to > end_s + 1e-6 * step {
        let [from, to, start, end] = [from, to, clock.start_s, end_s].map(format_number);
        let wrong =
            format!("{from} to {to} s is beyond the record, which covers {start} to {end} s");
        let remedy = "correct the times, in s of the record's own clock";
        return Err(("section.end_s", wrong, remedy));
    }
    if range.is_empty() {
        let wrong = "no sample of the record is between its times".to_owned();
        return Err(("section.start_s", wrong, "correct its times"));
    }
    Ok(range)
}

/// Returns the fault of a section that contains samples of an earlier section.
fn overlap(job: &Job, first: &Part, second: &Part, clock: &Clock) -> Option<Fault> {
    // Both lists ascend.
    let (mut ours, mut theirs) = (first.stretches.iter().peekable(), second.stretches.iter());
    let mut other = theirs.next();
    let at = loop {
        let (a, b) = (*ours.peek()?, other?);
        let from = a.start.max(b.start);
        if from < a.end.min(b.end) {
            break from;
        }
        if a.end <= b.end {
            ours.next();
        } else {
            other = theirs.next();
        }
    };
    let wrong = format!(
        "section `{}` overlaps section `{}` at {} s: the duty cycle would count these samples twice",
        second.section.name,
        first.section.name,
        format_number(clock.time_s(at))
    );
    let remedy = "change the times or ranges so that no sample is in two sections";
    let line = second.section.line;
    Some(Fault::with_line(&*job.file, line, "section", wrong, remedy))
}

/// Returns the statistics and damage of every load in every section of the record.
pub(super) fn count_all(counting: CycleCountInput, parts: &[Part]) -> Vec<SectionLoad> {
    let counted = parts.iter();
    counted
        .flat_map(|p| count(counting, p.section, &p.stretches))
        .collect()
}

/// Returns the statistics and damage of every load in some samples of a record.
pub(super) fn count(
    counting: CycleCountInput,
    section: &RecordSection,
    stretches: &[Range<usize>],
) -> Vec<SectionLoad> {
    let head = counting.head;
    let one = |l: usize| {
        let (mut n, mut sum) = (0.0, 0.0);
        let [mut min, mut max] = [f64::INFINITY, f64::NEG_INFINITY];
        let mut values = Vec::with_capacity(PIECE);
        let [mut value, mut low, mut high] = [0.0; 3];
        for range in stretches {
            for from in range.clone().step_by(PIECE) {
                values.clear();
                let to = (from + PIECE).min(range.end);
                counting.samples.read(from, to, &[l], &mut values);
                for v in values.iter().filter(|v| v.is_finite()) {
                    n += 1.0;
                    sum += v;
                    (min, max) = (min.min(*v), max.max(*v));
                }
            }
            // Errors of the model are common to all stretches, so the ends of the intervals are added.
            let damage = counting.damage(l, 0.0, range.clone());
            value += damage.value;
            low += damage.low;
            high += damage.high;
        }
        let known = |v: f64| if n > 0.0 { v } else { f64::NAN };
        let samples: usize = stretches.iter().map(Range::len).sum();
        SectionLoad {
            section: section.name.clone(),
            load: head.names[l].clone(),
            unit: head.units[l].name.clone(),
            stretches: stretches.len(),
            seconds: samples as f64 * head.step_s,
            repeats: section.repeats,
            min: known(min),
            mean: known(sum / n),
            max: known(max),
            damage: known(value),
            damage_low: known(low),
            damage_high: known(high),
        }
    };
    (0..head.n_loads()).into_par_iter().map(one).collect()
}

impl Sections {
    /// Returns the sections in the order of the job, with their duty cycle. `None` without sections.
    pub(super) fn from_loads(job: &Job, counted: Vec<SectionLoad>) -> Option<Self> {
        let place = |s: &SectionLoad| job.sections.iter().position(|j| j.name == s.section);
        let mut sections = counted;
        sections.sort_by_key(place);
        let mut duty_cycle: Vec<DutyLoad> = Vec::new();
        for s in &sections {
            let at = duty_cycle.iter().position(|d| d.load == s.load);
            let at = at.unwrap_or_else(|| {
                duty_cycle.push(DutyLoad {
                    load: s.load.clone(),
                    unit: s.unit.clone(),
                    seconds: 0.0,
                    damage: 0.0,
                    damage_low: 0.0,
                    damage_high: 0.0,
                });
                duty_cycle.len() - 1
            });
            let sum = &mut duty_cycle[at];
            sum.seconds += s.repeats * s.seconds;
            sum.damage += s.repeats * s.damage;
            // Errors of the model are common to all sections, so the ends of the intervals are added.
            sum.damage_low += s.repeats * s.damage_low;
            sum.damage_high += s.repeats * s.damage_high;
        }
        (!sections.is_empty()).then_some(Self {
            sections,
            duty_cycle,
        })
    }
}
