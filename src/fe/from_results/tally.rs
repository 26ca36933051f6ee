//! Counts irregularities of result files, so that each kind makes one finding.

use crate::finding::{Finding, LISTED, Severity};
use std::collections::BTreeMap;

/// Kinds of irregularities.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Irregularity {
    /// Corner rows of a grid that is no corner of the element.
    ForeignCorner,
    /// Fibre rows at other distances than the deck's Z1, Z2.
    OtherFibres,
    /// Strain taken from stress.
    ShellFromStress,
    BeamFromStress,
    /// Stress that could not be converted: the material is not isotropic.
    NotIsotropic,
    /// Shell rows that do not come in pairs.
    Unpaired,
    /// Ply results without element strain.
    PliesOnly,
    /// Shell rows of an element type with another number of corners than the element of the deck.
    OtherType,
}

/// Counts by kind with the first ids and the largest number.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally(BTreeMap<Irregularity, Entry>);

#[derive(Clone, Debug, Default)]
struct Entry {
    ids: Vec<u32>,
    count: usize,
    measured: Option<(f64, f64)>,
}

impl Tally {
    pub(super) fn add(&mut self, met: Irregularity, id: u32) {
        let entry = self.0.entry(met).or_default();
        entry.count += 1;
        if entry.ids.len() < LISTED && !entry.ids.contains(&id) {
            entry.ids.push(id);
        }
    }

    /// Counts an irregularity with a measured and an expected number. Of all irregularities of a kind, the largest difference is kept.
    pub(super) fn add_measured(&mut self, met: Irregularity, id: u32, measured: f64, wanted: f64) {
        self.add(met, id);
        if let Some(entry) = self.0.get_mut(&met) {
            let worse = entry
                .measured
                .is_none_or(|(m, w)| (measured - wanted).abs() > (m - w).abs());
            if worse {
                entry.measured = Some((measured, wanted));
            }
        }
    }

    pub(super) fn merge(&mut self, other: Tally) {
        for (met, theirs) in other.0 {
            let ours = self.0.entry(met).or_default();
            // Subcases usually contain the same elements, so the largest count is kept and not the sum.
            ours.count = ours.count.max(theirs.count);
            for id in theirs.ids {
                if ours.ids.len() < LISTED && !ours.ids.contains(&id) {
                    ours.ids.push(id);
                }
            }
            ours.measured = ours.measured.or(theirs.measured);
        }
    }

    /// Returns one finding for each kind of irregularity in the file `name`.
    pub(super) fn findings(&self, name: &str) -> Vec<Finding> {
        self.0
            .iter()
            .map(|(&met, entry)| finding(met, entry, name))
            .collect()
    }
}

/// Returns the finding on results whose elements have another type than in the deck.
pub fn other_element_types(findings: &[Finding]) -> Option<&Finding> {
    let mut findings = findings.iter();
    findings.find(|f| f.code == "element-not-in-deck" && f.severity == Severity::Error)
}

fn finding(met: Irregularity, entry: &Entry, name: &str) -> Finding {
    let n = entry.count;
    let mut ids = entry
        .ids
        .iter()
        .map(u32::to_string)
        .collect::<Vec<_>>()
        .join(", ");
    if n > entry.ids.len() && entry.ids.len() >= LISTED {
        ids += ", ..";
    }
    use Severity::{Error, Info, Warning};
    let (severity, code, message, remedy) = match met {
        Irregularity::ForeignCorner => (
            Warning,
            "corner-not-of-element",
            format!(
                "{n} corner rows name a grid that is no corner of their element in the deck: elements {ids}"
            ),
            "give the deck of this run: its connectivity differs",
        ),
        Irregularity::OtherFibres => (
            Warning,
            "fibre-distance-differs",
            format!(
                "{n} shells have strain at other fibre distances than Z1 and Z2 of the deck; they are used unchanged: elements {ids}"
            ),
            "give the deck of this run: thickness or Z1, Z2 differ",
        ),
        Irregularity::ShellFromStress => (
            Info,
            "strain-from-stress",
            format!(
                "no shell strain in the file: strain of {n} shells comes from stress and the isotropic material, without thermal strain"
            ),
            "request STRAIN(FIBER) output",
        ),
        Irregularity::BeamFromStress => (
            Info,
            "bar-strain-from-stress",
            format!(
                "no bar strain in the file: strain of {n} bars comes from stress divided by E, without thermal strain"
            ),
            "request STRAIN output",
        ),
        Irregularity::NotIsotropic => (
            Warning,
            "stress-not-converted",
            format!(
                "{n} elements have stress only and no isotropic material; they were left out: {ids}"
            ),
            "request STRAIN(FIBER) output",
        ),
        Irregularity::Unpaired => (
            Warning,
            "shell-rows-unpaired",
            format!("{n} shell rows have no second fibre and were left out: elements {ids}"),
            "export the results again",
        ),
        Irregularity::OtherType => (
            Error,
            "element-not-in-deck",
            format!(
                "results of another element type than in the deck (three corners instead of four, or four instead of three); elements ({n}): {ids}"
            ),
            "give the deck of this run: its elements differ",
        ),
        Irregularity::PliesOnly => (
            Info,
            "plies-only",
            format!(
                "{n} laminates have ply results only, no strain at their surfaces: elements {ids}"
            ),
            "request homogeneous strain output of laminates (LAM, or PARAM,NOCOMPS,0 or -1)",
        ),
    };
    let finding = Finding::new(severity, code, name, message, remedy);
    match entry.measured {
        Some((measured, wanted)) => finding.with_numbers(measured, wanted),
        None => finding,
    }
}
