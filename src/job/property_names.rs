//! Properties that a job names as the deck does.

use super::shapes::PropertyIds;
use super::suggest;
use super::types::Job;
use crate::finding::list_few;
use crate::host::fault::{Fault, FaultList, Faults};

impl PropertyIds {
    /// Returns whether the list contains the id. Names have an effect only after [`Job::with_property_ids`] has replaced them.
    pub fn contains(&self, id: u32) -> bool {
        self.ids.contains(id)
    }

    /// Replaces names by the ids of `named`. Returns problem and remedy for each name that is unknown or that several properties have.
    fn take_names(&mut self, named: &[(u32, String)]) -> Vec<(String, String)> {
        let mut wrong = Vec::new();
        for name in std::mem::take(&mut self.names) {
            let exact: Vec<u32> = ids_called(named, |n| n == name);
            let alike = || ids_called(named, |n| n.eq_ignore_ascii_case(&name));
            let found = if exact.is_empty() { alike() } else { exact };
            match found.as_slice() {
                [id] => self.ids.0.push([*id; 2]),
                [] => wrong.push((
                    format!("the deck has no property `{name}`"),
                    unknown_remedy(&name, named),
                )),
                several => {
                    wrong.push((
                        format!("properties {} are all called `{name}`", list_few(several)),
                        "state the ids that are meant".to_owned(),
                    ));
                }
            }
        }
        wrong
    }
}

fn ids_called(named: &[(u32, String)], is_meant: impl Fn(&str) -> bool) -> Vec<u32> {
    let meant = named.iter().filter(|n| is_meant(&n.1));
    meant.map(|n| n.0).collect()
}

fn unknown_remedy(name: &str, named: &[(u32, String)]) -> String {
    match named.is_empty() {
        true => "state ids: the deck has no names of properties".to_owned(),
        false => suggest::remedy(name, named.iter().map(|n| n.1.as_str())),
    }
}

impl Job {
    /// Returns the job with ids instead of the names of properties. `named` contains the names in the deck.
    ///
    /// # Errors
    /// A fault for each name that no property or more than one property has.
    pub fn with_property_ids(&self, named: &[(u32, String)]) -> Result<Self, Faults> {
        let mut job = self.clone();
        let lines = [
            job.candidates.line,
            job.ballast.as_ref().map_or(0, |b| b.line),
            job.reconcile.as_ref().map_or(0, |r| r.line),
        ];
        let Self {
            candidates: c,
            ballast,
            reconcile,
            ..
        } = &mut job;
        let of_candidates = [
            ("candidates.properties", &mut c.properties),
            ("candidates.exclude_properties", &mut c.exclude_properties),
        ];
        let lists = of_candidates
            .into_iter()
            .filter_map(|(key, list)| Some((key, lines[0], list.as_mut()?)));
        let of_ballast = ballast.iter_mut().filter_map(|b| b.properties.as_mut());
        let of_ballast = of_ballast.map(|list| ("ballast.properties", lines[1], list));
        let zones = reconcile.iter_mut().flat_map(|r| r.zones.values_mut());
        let zones = zones.map(|list| ("reconcile.zones", lines[2], list));
        let mut faults = FaultList::new();
        for (key, line, list) in lists.chain(of_ballast).chain(zones) {
            let wrong = list.take_names(named);
            let fault = |(wrong, remedy)| Fault::with_line(&*self.file, line, key, wrong, remedy);
            faults.extend(wrong.into_iter().map(fault));
        }
        Faults::check(faults)?;
        Ok(job)
    }
}
