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
            SectionExtent::File(_) => None,
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
                format!("state {TIMES}, or `file`"),
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
