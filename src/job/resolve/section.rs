//! `[[section]]`.

use super::super::faults::Collector;
use super::super::raw_job::RawSection;
use super::super::spanned_value::SpannedValue;
use super::super::types::*;
use std::collections::BTreeSet;

pub(super) fn sections(c: &mut Collector, raw: &[SpannedValue<RawSection>]) -> Vec<RecordSection> {
    let mut out: Vec<RecordSection> = Vec::new();
    let mut names = BTreeSet::new();
    for item in raw {
        let Some(section) = section(c, item) else {
            continue;
        };
        if !names.insert(section.name.clone()) {
            let wrong = format!("two sections are called `{}`", section.name);
            c.fault(
                item,
                "section.name",
                wrong,
                "give every section a separate name",
            );
        }
        let times = |s: &RecordSection| match s.extent {
            SectionExtent::Times(times) => Some(times),
            SectionExtent::File(_) | SectionExtent::Within(_) => None,
        };
        if let Some([from, to]) = times(&section) {
            let overlaps = |s: &&RecordSection| times(s).is_some_and(|[a, b]| from < b && a < to);
            if let Some(other) = out.iter().find(overlaps) {
                let wrong = format!(
                    "it overlaps section `{}`: the duty cycle would count these samples twice",
                    other.name
                );
                let remedy = "let each section end where the next one begins";
                c.fault(item, "section.start_s", wrong, remedy);
            }
        }
        out.push(section);
    }
    out
}

fn section(c: &mut Collector, item: &SpannedValue<RawSection>) -> Option<RecordSection> {
    const TIMES: &str = "start_s = 0.0 and end_s = 60.0";
    let raw = item.value();
    let name = c.require(&raw.name, item, "section.name", "name = \"gravel\"");
    let repeats = c.number(&raw.repeats, "section.repeats", "0 or more", |x| x >= 0.0);
    let number = |c: &mut Collector, value, key| c.number(value, key, "a time in s", |_| true);
    let start = number(c, &raw.start_s, "section.start_s");
    let end = number(c, &raw.end_s, "section.end_s");
    let least = c.at_least_zero(&raw.at_least_s, "section.at_least_s");
    if let (Some(at), true) = (&raw.at_least_s, raw.within.is_empty()) {
        let wrong = "a shortest stretch needs ranges of channels";
        let remedy = "state within = { speed = [5.0, inf] }, or delete this key";
        c.fault(at, "section.at_least_s", wrong, remedy);
        return None;
    }
    if !raw.within.is_empty() {
        if raw.file.is_some() || raw.start_s.is_some() || raw.end_s.is_some() {
            let wrong = "the section has ranges of channels together with a file or times";
            let remedy = format!("state `within`, `file`, or {TIMES}");
            c.fault(item, "section.within", wrong, remedy);
            return None;
        }
        return Some(RecordSection {
            name: name?,
            extent: SectionExtent::Within(SectionRule {
                ranges: ranges(c, raw)?,
                at_least_s: least.unwrap_or(0.0),
            }),
            repeats: repeats.unwrap_or(1.0),
            line: c.line(item),
        });
    }
    let extent = match (&raw.file, &raw.start_s, &raw.end_s) {
        (Some(file), None, None) => SectionExtent::File(c.named_at(file, "section.file")),
        (None, Some(_), Some(at)) => {
            let (start, end) = (start?, end?);
            if end <= start {
                let wrong =
                    format!("the section is empty: it ends at {end} s and begins at {start} s");
                c.fault(at, "section.end_s", wrong, "write an end after the start");
                return None;
            }
            SectionExtent::Times([start, end])
        }
        (Some(file), _, _) => {
            let wrong = "the section has both a file and times";
            let remedy = format!("state `file`, or {TIMES}");
            c.fault(file, "section.file", wrong, remedy);
            return None;
        }
        (None, _, _) => {
            let wrong = "the section has no samples";
            c.fault(
                item,
                "section.start_s",
                wrong,
                format!("state {TIMES}, `file`, or within = {{ speed = [5.0, inf] }}"),
            );
            return None;
        }
    };
    Some(RecordSection {
        name: name?,
        extent,
        repeats: repeats.unwrap_or(1.0),
        line: c.line(item),
    })
}

/// Ranges of the channels of a rule; `None` and a fault for a range without a limit or without a value.
fn ranges(c: &mut Collector, raw: &RawSection) -> Option<Vec<(String, [f64; 2])>> {
    let mut out = Vec::new();
    for (channel, [low, high]) in &raw.within {
        let limited = low.is_finite() || high.is_finite();
        if !(low < high && limited) {
            let key = format!("section.within.{}", channel.value());
            let wrong = format!("[{low}, {high}] is not a range");
            let remedy =
                "write [low, high] in the unit of the channel, such as [5.0, 20.0] or [5.0, inf]";
            c.fault(channel, &key, wrong, remedy);
            return None;
        }
        out.push((channel.value().clone(), [*low, *high]));
    }
    Some(out)
}
