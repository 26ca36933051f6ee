//! `[fleet]`: names of records, S-N line, what damage is held against.

use super::super::faults::Collector;
use super::super::raw_job::{RawFleet, RawMission};
use super::super::spanned_value::SpannedValue;
use super::super::types::*;
use std::collections::BTreeSet;

/// Largest rounding error of a share with three digits: three of .333 are thirds, six of .167 sixths. Rounding alone changes the
/// sum by at most this times the number of shares.
const ROUNDED: f64 = 0.0005;
/// Largest error of the sum of the shares, whatever their number. The shares are divided by their sum, so that a larger error would change the job's
/// shares.
const ROUNDED_IN_SUM: f64 = 0.01;

/// Keys of the section for comparing damage: they do not change the count of a record.
const OF_MERGE: [&str; 4] = ["reference", "target", "mission", "mission_hours"];
/// Keys that do not change the count of a record: the title, and sections that only other commands use.
const OF_OTHERS: [&str; 7] = [
    "title",
    "ballast",
    "compare",
    "reconcile",
    "respond",
    "section",
    "study",
];

/// Largest load range of a knee: no structure bears it in any unit, and its power of 20 is still finite.
const LARGEST_KNEE: f64 = 1e12;

pub(super) fn fleet(c: &mut Collector, raw: Option<&SpannedValue<RawFleet>>) -> Option<Fleet> {
    let section = raw?;
    let raw = section.value();
    c.require(
        &raw.file_name,
        section,
        "fleet.file_name",
        "file_name = \"{vehicle}_{day}.parquet\"",
    )?;
    let slope = c.number(
        &raw.slope_below_knee,
        "fleet.slope_below_knee",
        "a number from 1 to 40",
        |x| (1.0..=40.0).contains(&x),
    );
    if let (Some(slope), None) = (&raw.slope_below_knee, &raw.knee_range) {
        c.fault(
            slope,
            "fleet.slope_below_knee",
            "it applies below `knee_range`, and the job has no `knee_range`",
            "add `knee_range`, or delete this key",
        );
    }
    let hours = c.positive_number(&raw.mission_hours, "fleet.mission_hours");
    Some(Fleet {
        file_name: c.named_file(&raw.file_name, "fleet.file_name")?,
        knee_range: c.number(
            &raw.knee_range,
            "fleet.knee_range",
            "a number above 0 and at most 1e12",
            |x| x > 0.0 && x <= LARGEST_KNEE,
        ),
        slope_below_knee: slope.unwrap_or(f64::INFINITY),
        reference: reference(c, raw),
        target: target(c, raw),
        mission: mission(c, raw),
        mission_hours: hours.unwrap_or(1.0),
        of_records: of_records(c.text),
    })
}

/// The job, its keys in order, without comments, without what damage is held against and what no record is counted by.
fn of_records(text: &str) -> String {
    let Ok(mut job) = text.parse::<toml::Table>() else {
        return text.to_owned();
    };
    job.retain(|key, _| !OF_OTHERS.contains(&key));
    if let Some(toml::Value::Table(section)) = job.get_mut("fleet") {
        section.retain(|key, _| !OF_MERGE.contains(&key));
    }
    format!("{job:?}")
}

fn reference(c: &mut Collector, raw: &RawFleet) -> Option<ReferenceDay> {
    let section = raw.reference.as_ref()?;
    let example = "reference = { vehicle = \"T1\", day = \"2026-05-01\" }";
    let named = section.value();
    let vehicle = c.require(&named.vehicle, section, "fleet.reference.vehicle", example);
    let day = c.require(&named.day, section, "fleet.reference.day", example);
    Some(ReferenceDay {
        vehicle: vehicle?,
        day: day?,
        line: c.line(section),
    })
}

fn target(c: &mut Collector, raw: &RawFleet) -> Vec<TargetDamage> {
    let mut out = Vec::new();
    for (load, damage) in &raw.target {
        let value = *damage.value();
        if !(value.is_finite() && value > 0.0) {
            let wrong = format!("`{value}`, expected a number above 0");
            c.fault(damage, "fleet.target", wrong, "correct the number");
        }
        out.push(TargetDamage {
            load: load.value().clone(),
            damage: value,
            line: c.line(load),
        });
    }
    out
}

fn mission(c: &mut Collector, raw: &RawFleet) -> Vec<MissionKind> {
    let mut out: Vec<MissionKind> = Vec::new();
    let mut names = BTreeSet::new();
    for section in &raw.mission {
        let Some(k) = kind(c, section) else { continue };
        if !names.insert(k.name.clone()) {
            let wrong = format!("`{}` occurs twice", k.name);
            let remedy = "give every kind of days a separate name";
            c.fault(section, "fleet.mission.name", wrong, remedy);
        }
        out.push(k);
    }
    if out.len() == raw.mission.len()
        && let Some(first) = raw.mission.first()
    {
        let sum: f64 = out.iter().map(|k| k.share).sum();
        let rounding = (ROUNDED * out.len() as f64).min(ROUNDED_IN_SUM);
        // 1e-9 allows for rounding in the sum, if a share is off by exactly the limit (.4995 and .5).
        if (sum - 1.0).abs() > rounding + 1e-9 {
            let wrong = format!("the shares sum to {sum:.4}, expected 1");
            let remedy = "state the remaining share of the hours, or correct the shares";
            c.fault(first, "fleet.mission.share", wrong, remedy);
        }
        out.iter_mut().for_each(|k| k.share /= sum);
    }
    out
}

fn kind(c: &mut Collector, section: &SpannedValue<RawMission>) -> Option<MissionKind> {
    let raw = section.value();
    let name = c.require(&raw.name, section, "fleet.mission.name", "name = \"road\"");
    c.require(&raw.share, section, "fleet.mission.share", "share = 0.6");
    let share = c.number(
        &raw.share,
        "fleet.mission.share",
        "a number above 0, 1 at most",
        |x| x > 0.0 && x <= 1.0,
    );
    if raw.days.is_empty() && raw.vehicles.is_empty() {
        let wrong = "the entry names neither days nor vehicles";
        let remedy = "add `days = [\"2026-05-*\"]` or `vehicles = [\"T1\"]`";
        c.fault(section, "fleet.mission.days", wrong, remedy);
    }
    let texts = |list: &[SpannedValue<String>]| -> Vec<String> {
        list.iter().map(|t| t.value().clone()).collect()
    };
    Some(MissionKind {
        name: name?,
        share: share?,
        days: texts(&raw.days),
        vehicles: texts(&raw.vehicles),
        line: c.line(section),
    })
}
