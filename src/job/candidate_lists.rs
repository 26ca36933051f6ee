//! The file of `[candidates]`: lists of properties and elements that were picked elsewhere, such as in a report. It may also state the number of
//! gauges and the gauges that stay.

use super::faults::Collector;
use super::parse::parse_job;
use super::resolve::{candidates_of, placement_of};
use super::types::{Candidates, Ids, Job, NamedFile, PropertyIds};
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::files::Inputs;

/// Keys of `[placement]` that the file may state. They replace the values of the job.
const OF_PLACEMENT: [&str; 2] = ["gauges", "keep"];

/// A list of `[candidates]`.
pub(super) enum List<'a> {
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

    /// Deletes the list.
    pub(super) fn clear(self) {
        match self {
            Self::Elements(list) => *list = None,
            Self::Properties(list) => *list = None,
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

pub(super) fn lists(c: &mut Candidates) -> [(&'static str, List<'_>); 5] {
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

/// Keys of a picked file that are not among its lists: they would not count.
fn report_unused_keys(file: &str, text: &str, candidates: &mut Candidates) -> FaultList {
    let known = lists(candidates).map(|l| l.0);
    let table: toml::Table = text.parse().unwrap_or_default();
    let unused = |section: &str, known: &[&str]| -> Vec<String> {
        let below = table.get(section).and_then(toml::Value::as_table);
        let keys = below.into_iter().flat_map(toml::Table::keys);
        let keys = keys.filter(|k| !known.contains(&k.as_str()));
        keys.map(|k| format!("{section}.{k}")).collect()
    };
    let sections = table
        .keys()
        .filter(|k| *k != "candidates" && *k != "placement");
    let remedy = format!(
        "keep {} and [placement] {} here, and all other keys in the job",
        known.join(", "),
        OF_PLACEMENT.join(", ")
    );
    sections
        .cloned()
        .chain(unused("candidates", &known))
        .chain(unused("placement", &OF_PLACEMENT))
        .map(|k| {
            let wrong = "this key is not used in a file of picked lists";
            Fault::new(file, k, wrong, &*remedy)
        })
        .collect()
}

/// Adds the lists of a picked file to the lists of a job, and its faults to the list. The number of gauges and the gauges that stay of the file
/// replace the values of the job.
pub(super) fn merge_candidates(
    job: &mut Job,
    named: &NamedFile,
    text: &str,
    faults: &mut FaultList,
) {
    let file = &*named.given;
    let (raw, found) = parse_job(file, text);
    let broken = !found.is_empty();
    faults.extend(found);
    if raw.candidates.is_none() && raw.placement.is_none() {
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
    }
    faults.extend(report_unused_keys(file, text, &mut job.candidates));
    let mut c = Collector::new(file, text, faults);
    if let Some(section) = &raw.placement {
        let picked = placement_of(&mut c, section);
        if section.value().gauges.is_some() {
            job.placement.gauges = picked.gauges;
        }
        if section.value().keep.is_some() {
            job.placement.keep = picked.keep;
        }
    }
    let Some(section) = &raw.candidates else {
        return;
    };
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
