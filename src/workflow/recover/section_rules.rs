//! Sections by a rule on channels of the strain record: a threshold of speed, or a box of positions.

use crate::host::fault::Faults;
use crate::host::words::format_number;
use crate::job::SectionRule;
use crate::job::suggest::find_closest_name;
use crate::measured::faults::record_fault;
use crate::measured::record::Record;
use crate::series::record::Clock;
use std::ops::Range;

/// Field, message and remedy of a section that selects no samples.
pub(super) type NoSamples = (&'static str, String, &'static str);

/// Returns the stretches of a record in which every channel of a rule is within its range. A missing sample of a channel is outside.
///
/// # Errors
/// Outer: a channel that can't be decoded. Inner: a channel that the record lacks; a rule that no stretch fulfils.
pub(super) fn stretches_within(
    rule: &SectionRule,
    record: &Record,
    clock: &Clock,
) -> Result<Result<Vec<Range<usize>>, NoSamples>, Faults> {
    const FIELD: &str = "section.within";
    let mut inside = vec![true; clock.samples];
    let mut seen = Vec::new();
    for (channel, [low, high]) in &rule.ranges {
        let Some(values) = record.raw_column(channel) else {
            let names = record.names.iter().map(String::as_str);
            let close = find_closest_name(channel, names);
            let hint = close.map_or_else(String::new, |c| format!("; did you mean `{c}`?"));
            let wrong = format!(
                "the record has no numeric channel `{channel}` that is sampled with the gauges{hint}"
            );
            return Ok(Err((FIELD, wrong, "name a column of the strain file")));
        };
        let values = values.map_err(|e| record_fault(record.file(), &e))?;
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for (at, value) in inside.iter_mut().zip(&values) {
            *at &= (*low..=*high).contains(value);
            (least, most) = (least.min(*value), most.max(*value));
        }
        inside.truncate(values.len());
        seen.push(match least <= most {
            true => {
                let [least, most] = [least, most].map(format_number);
                format!("`{channel}` covers {least} to {most}")
            }
            false => format!("`{channel}` has no number"),
        });
    }
    // Durations are rounded. A stretch that is a millionth of a step too short counts.
    let shortest = (rule.at_least_s * clock.rate_hz - 1e-6).ceil().max(1.0) as usize;
    let stretches = runs_of(&inside, shortest);
    if stretches.is_empty() {
        let longest = runs_of(&inside, 1).iter().map(Range::len).max();
        let longest = longest.unwrap_or(0) as f64 / clock.rate_hz;
        let wrong = format!(
            "no stretch of {} s or more fulfils its ranges, the longest has {} s; {}",
            format_number(rule.at_least_s),
            format_number(longest),
            seen.join(", ")
        );
        return Ok(Err((FIELD, wrong, "correct ranges and `at_least_s`")));
    }
    Ok(Ok(stretches))
}

/// Runs of true values of at least `shortest` samples.
fn runs_of(inside: &[bool], shortest: usize) -> Vec<Range<usize>> {
    let mut out = Vec::new();
    let mut start = None;
    for (i, is_in) in inside.iter().chain(std::iter::once(&false)).enumerate() {
        match (start, is_in) {
            (None, true) => start = Some(i),
            (Some(from), false) => {
                if i - from >= shortest {
                    out.push(from..i);
                }
                start = None;
            }
            _ => {}
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_the_least_length_are_kept_up_to_both_ends() {
        let inside = [true, true, false, true, false, true, true, true];
        assert_eq!(runs_of(&inside, 1), [0..2, 3..4, 5..8]);
        assert_eq!(runs_of(&inside, 2), [0..2, 5..8]);
        assert!(runs_of(&inside, 4).is_empty());
    }
}
