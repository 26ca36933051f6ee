//! References for damage: a reference day, a target, a mission of several kinds of days.

use super::day::{Day, FileHead};
use super::mission::MissionSums;
use super::stored_results::KeptDays;
use crate::finding::{Finding, Severity};
use crate::host::fault::{Fault, Faults};
use crate::job::{Fleet as FleetKeys, ReferenceDay};
use crate::series::rainflow::{DamageParts, Ratio, SharedErrors};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// The day whose damage per hour is 1.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReferenceAnswer {
    /// Vehicle of the reference day.
    pub vehicle: String,
    /// The day.
    pub day: String,
    /// Path of the record.
    pub path: String,
    /// Digest of the bytes of the record.
    pub sha256: String,
    /// Hours of the record.
    pub hours: f64,
}

/// The reference, with its damage.
pub(super) struct Reference {
    pub answer: ReferenceAnswer,
    /// Damage of each load, with the hours in which the load is known.
    loads: BTreeMap<String, (DamageParts, f64)>,
    /// Gauges that read.
    gauges: BTreeSet<String>,
}

/// Gauges that read on a day.
fn gauges_with_readings(day: &Day) -> BTreeSet<String> {
    let read = day.gauges.iter().filter(|g| g.sd.is_finite());
    read.map(|g| g.name.clone()).collect()
}

impl Reference {
    /// Returns the reference, if it is among the files that count.
    pub fn among(
        wanted: &ReferenceDay,
        kept: &KeptDays,
        by_vehicle: &BTreeMap<&str, Vec<&FileHead>>,
    ) -> Option<Self> {
        let files = by_vehicle.get(wanted.vehicle.as_str())?;
        let file = files.iter().find(|f| f.day == wanted.day)?;
        let day = kept.day(file)?;
        let parts = day.loads.iter().map(|l| {
            let of_load = DamageParts::from_tally(&l.tally, &l.scale, l.noise);
            (l.name.clone(), (of_load, day.hours_of(l)))
        });
        Some(Self {
            loads: parts.collect(),
            gauges: gauges_with_readings(&day),
            answer: ReferenceAnswer {
                vehicle: file.vehicle.clone(),
                day: file.day.clone(),
                path: file.path.clone(),
                sha256: file.sha256.clone(),
                hours: day.hours,
            },
        })
    }

    /// Returns the damage per hour of a load of a vehicle, divided by the damage per hour of the reference. `days` are the days of the vehicle with
    /// their damage by this load. If the gauge sets of a day and of the reference day are not nested, the errors of S count as independent on this
    /// day.
    pub fn damage_ratio(
        &self,
        vehicle: &str,
        load: &str,
        damage: &DamageParts,
        hours: f64,
        days: &[(&Day, f64)],
    ) -> Option<Ratio> {
        let (own, own_hours) = self.loads.get(load)?;
        let (mut alike, mut all) = (0.0, 0.0);
        for (day, done) in days {
            let own = day.gauges.iter().filter(|g| g.sd.is_finite());
            let (n, shared) = own.fold((0, 0), |(n, shared), g| {
                (n + 1, shared + usize::from(self.gauges.contains(&g.name)))
            });
            let nested = shared == n || shared == self.gauges.len();
            all += done;
            alike += if nested { *done } else { 0.0 };
        }
        let shared = SharedErrors {
            scale: if all > 0.0 { alike / all } else { 1.0 },
            cycles: vehicle == self.answer.vehicle,
        };
        let ratio = damage.ratio_to(own, shared)?;
        Some(ratio.times(own_hours / hours))
    }
}

/// References of the job for comparisons of damage.
pub(super) struct DamageReferences {
    pub reference: Option<Reference>,
    pub mission: Option<MissionSums>,
}

impl DamageReferences {
    /// Finds the reference day and starts the mission without days.
    pub fn new(
        keys: &FleetKeys,
        kept: &KeptDays,
        by_vehicle: &BTreeMap<&str, Vec<&FileHead>>,
    ) -> Self {
        let wanted = keys.reference.as_ref();
        Self {
            reference: wanted.and_then(|r| Reference::among(r, kept, by_vehicle)),
            mission: MissionSums::from_keys(keys),
        }
    }

    /// Returns the findings on a reference day or a mission kind without a record.
    ///
    /// # Errors
    /// A fault for each of them if all existing records were merged (`is_all`).
    pub fn check(
        &self,
        file: &str,
        keys: &FleetKeys,
        is_all: bool,
    ) -> Result<Vec<Finding>, Faults> {
        let mut absent: Vec<(u32, &str, String)> = Vec::new();
        if let (Some(wanted), None) = (&keys.reference, &self.reference) {
            let what = format!("day {} of {}", wanted.day, wanted.vehicle);
            absent.push((wanted.line, "fleet.reference", what));
        }
        for kind in self.mission.iter().flat_map(MissionSums::without_records) {
            let what = format!("a day of the mission's kind `{}`", kind.name);
            absent.push((kind.line, "fleet.mission", what));
        }
        let remedy = "correct vehicle and day, or name the records too";
        let wrong = |what: &str| format!("no valid record is {what}");
        if is_all && !absent.is_empty() {
            let faults = absent.iter();
            let faults = faults
                .map(|(line, key, what)| Fault::with_line(file, *line, *key, wrong(what), remedy));
            return Err(Faults::or(
                faults.collect(),
                Fault::new(file, "fleet", "no record", remedy),
            ));
        }
        let finding = |(_, key, what): &(u32, &str, String)| {
            let message = format!(
                "{}: the columns that compare with it are blank",
                wrong(what)
            );
            Finding::new(Severity::Error, "fleet-days-absent", *key, message, remedy)
        };
        Ok(absent.iter().map(finding).collect())
    }
}

/// Checks that targets name loads of the job.
///
/// # Errors
/// A load that the job lacks.
pub(super) fn check_targets(file: &str, keys: &FleetKeys, loads: &[&str]) -> Result<(), Faults> {
    let unknown = keys
        .target
        .iter()
        .filter(|t| !loads.contains(&t.load.as_str()));
    let faults = unknown.map(|t| {
        let wrong = format!("the job has no load `{}`", t.load);
        let remedy = format!("write one of {}", loads.join(", "));
        Fault::with_line(file, t.line, "fleet.target", wrong, remedy)
    });
    Faults::check(faults.collect())
}
