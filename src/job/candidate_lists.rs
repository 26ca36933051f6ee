//! The file of `[candidates]`: lists of properties and elements that were picked elsewhere, such as in a report.

use super::faults::Collector;
use super::parse::parse_job;
use super::resolve::candidates_of;
use super::types::{Candidates, Ids, Job, NamedFile, PropertyIds};
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::files::Inputs;

/// A list of `[candidates]`.
enum List<'a> {
    Elements(&'a mut Option<Ids>),
    Properties(&'a mut Option<PropertyIds>),
}

impl List<'_> {
    fn is_stated(&self) -> bool {
        match self {
            Self::Elements(list) => list.is_some(),
            Self::Properties(list) => list.is_some(),
        }
    }

    /// Takes what `other`, the same list of another file, states.
    fn take(self, other: Self) {
        match (self, other) {
            (Self::Elements(own), Self::Elements(other)) => *own = other.take(),
            (Self::Properties(own), Self::Properties(other)) => *own = other.take(),
            _ => {}
        }
    }
}

fn lists(c: &mut Candidates) -> [(&'static str, List<'_>); 5] {
    use List::{Elements, Properties};
    [
        ("properties", Properties(&mut c.properties)),
        ("elements", Elements(&mut c.elements)),
        ("exclude_properties", Properties(&mut c.exclude_properties)),
        ("exclude_elements", Elements(&mut c.exclude_elements)),
        ("wanted_elements", Elements(&mut c.wanted_elements)),
    ]
}

/// Adds the lists of the file that `[candidates] file` names to the lists of the job, and its faults to the list.
pub(super) fn read_picked(inputs: &mut Inputs, job: &mut Job, faults: &mut FaultList) {
    let Some(named) = job.candidates.file.clone().filter(NamedFile::is_toml) else {
        return;
    };
    match inputs.read_named_text(job, &named) {
        Ok(text) => merge_candidates(job, &named, &text, faults),
        Err(f) => faults.extend(Faults::from(f).into_list()),
    }
}

/// Keys of a picked file that are none of its lists: they would not count.
fn report_unused_keys(file: &str, text: &str, candidates: &mut Candidates) -> FaultList {
    let known = lists(candidates).map(|l| l.0);
    let table: toml::Table = text.parse().unwrap_or_default();
    let below = table.get("candidates").and_then(toml::Value::as_table);
    let sections = table.keys().filter(|k| *k != "candidates").cloned();
    let keys = below.into_iter().flat_map(toml::Table::keys);
    let keys = keys.filter(|k| !known.contains(&k.as_str()));
    let remedy = format!(
        "keep {} here, and all other keys in the job",
        known.join(", ")
    );
    sections
        .chain(keys.map(|k| format!("candidates.{k}")))
        .map(|k| {
            Fault::new(
                file,
                k,
                "this key is not used in a file of picked lists",
                &*remedy,
            )
        })
        .collect()
}

fn merge_candidates(job: &mut Job, named: &NamedFile, text: &str, faults: &mut FaultList) {
    let file = &*named.given;
    let (raw, found) = parse_job(file, text);
    let broken = !found.is_empty();
    faults.extend(found);
    let Some(section) = &raw.candidates else {
        if !broken {
            faults.push(Fault::with_line(
                file,
                1,
                "candidates",
                "the file has no [candidates]",
                "write `[candidates]` above its lists",
            ));
        }
        return;
    };
    faults.extend(report_unused_keys(file, text, &mut job.candidates));
    let mut c = Collector::new(file, text, faults);
    let mut picked = candidates_of(&mut c, section);
    for ((name, own), (_, other)) in lists(&mut job.candidates)
        .into_iter()
        .zip(lists(&mut picked))
    {
        if own.is_stated() && other.is_stated() {
            let wrong = format!("`{name}` is in the job too");
            c.fault(
                section,
                &format!("candidates.{name}"),
                wrong,
                "state it in one of the two",
            );
        }
        if !own.is_stated() {
            own.take(other);
        }
    }
}
