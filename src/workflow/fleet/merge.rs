//! Days of a vehicle, one after the other, as one.

use super::damage_references::Reference;
use super::day::{Day, FileHead, GaugeDay, LoadDay};
use super::days::DayOrder;
use super::gauge_history::is_misread;
use crate::series::rainflow::{DamageInterval, DamageParts, Ratio, Tally};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Status of a file in a merge.
#[derive(Clone, Debug, PartialEq)]
pub enum Status {
    /// The file counts.
    Done,
    /// The file can't be read, or its loads can't be recovered.
    Failed(String),
    /// Another file contains the same bytes.
    Copy(String),
    /// A file of another vehicle contains the same bytes.
    Foreign(String),
    /// Another file with other bytes is of the same day.
    Second(String),
}

impl Status {
    /// Returns the status as a word in `fleet.csv` and `result.json`.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Failed(_) => "failed",
            Self::Copy(_) | Self::Foreign(_) | Self::Second(_) => "copy",
        }
    }

    /// Reason of the status; empty for a complete result.
    pub fn message(&self) -> &str {
        match self {
            Self::Done => "",
            Self::Failed(m) | Self::Copy(m) | Self::Foreign(m) | Self::Second(m) => m,
        }
    }
}

/// Source of a number: a sample of a record.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SampleOf {
    /// The day.
    pub day: String,
    /// Path of the record.
    pub path: String,
    /// Digest of the bytes of the record.
    pub sha256: String,
    /// Seconds from the record's first sample.
    pub seconds: f64,
}

/// The record of a day.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecordOf {
    /// Path of the record.
    pub path: String,
    /// Digest of the bytes of the file.
    pub sha256: String,
    /// Hours of the file.
    pub hours: f64,
}

/// A load of a vehicle over all its days.
#[derive(Clone, Debug, PartialEq)]
pub struct VehicleLoad {
    /// Name of the load.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Hours of all days in which the load is known.
    pub hours: f64,
    /// Tally of all days.
    pub tally: Tally,
    /// Damage with its interval.
    pub damage: DamageInterval,
    /// Damage per hour divided by the damage per hour of the reference day.
    pub to_reference: Option<Ratio>,
    /// Samples with the largest and the smallest value.
    pub extremes: [Option<SampleOf>; 2],
    /// Damage of each day counted alone, in the order of the days.
    pub by_day: Vec<f64>,
    /// Relative decrease of the damage if days with unreliable loads are left out.
    pub doubtful_share: f64,
}

/// A vehicle.
#[derive(Clone, Debug, PartialEq)]
pub struct Vehicle {
    /// Name of the vehicle.
    pub name: String,
    /// Days, in order.
    pub days: Vec<String>,
    /// Records of the vehicles, in order.
    pub records: Vec<RecordOf>,
    /// Hours of all days.
    pub hours: f64,
    /// Loads, in the order of the job.
    pub loads: Vec<VehicleLoad>,
    /// Whether the loads of a day can't be relied on.
    pub doubtful: Vec<bool>,
    /// Whether the record of a day has a finding whose cause makes gains and zeros of that day invalid.
    pub misread: Vec<bool>,
    /// Readings of each gauge, with an entry for each day, in order.
    pub gauges: Vec<(String, Vec<GaugeDay>)>,
}

/// Returns the files that count, by vehicle and in the order of their days, and the status of every file in the given order.
///
/// The file with the first path counts if two files have the same day or the same bytes. The result does not depend on the order of `files`.
pub fn sort_files(
    files: &[FileHead],
    days_in: DayOrder,
) -> (BTreeMap<&str, Vec<&FileHead>>, Vec<Status>) {
    let mut order: Vec<usize> = (0..files.len()).collect();
    let key = |i: &usize| files.get(*i).map(|f| f.path.as_str()).unwrap_or_default();
    order.sort_by(|a, b| key(a).cmp(key(b)));
    let mut status = vec![Status::Done; files.len()];
    let mut days: BTreeMap<&str, Vec<&FileHead>> = BTreeMap::new();
    let mut seen_bytes: BTreeMap<&str, &FileHead> = BTreeMap::new();
    let mut seen_days: BTreeMap<(&str, &str), &str> = BTreeMap::new();
    for i in order {
        let (Some(file), Some(slot)) = (files.get(i), status.get_mut(i)) else {
            continue;
        };
        let same_day = seen_days.get(&(file.vehicle.as_str(), file.day.as_str()));
        match (&file.result, seen_bytes.get(file.sha256.as_str()), same_day) {
            (Err(why), ..) => *slot = Status::Failed(why.clone()),
            (Ok(_), Some(first), _) if first.vehicle == file.vehicle => {
                *slot = Status::Copy(format!("the same bytes as {}, which is used", first.path));
            }
            (Ok(_), Some(first), _) => {
                *slot = Status::Foreign(format!(
                    "the same bytes as {}, which is used for {}: the record of {} is missing, or this file belongs to another vehicle",
                    first.path, first.vehicle, file.vehicle
                ));
            }
            (Ok(_), None, Some(first)) => {
                *slot = Status::Second(format!(
                    "another file of {} on {}: {first} is used",
                    file.vehicle, file.day
                ));
            }
            (Ok(_), None, None) => {
                seen_bytes.insert(&file.sha256, file);
                seen_days.insert((&file.vehicle, &file.day), &file.path);
                days.entry(&file.vehicle).or_default().push(file);
            }
        }
    }
    for list in days.values_mut() {
        list.sort_by(|a, b| days_in.compare(&a.day, &b.day));
    }
    (days, status)
}

/// Returns the errors of all days together. If they differ (a gauge that failed), the days are weighted by their share of damage.
fn errors(days: &[(&FileHead, &Day, &LoadDay)], first: &LoadDay) -> LoadDay {
    let weight = |d: &LoadDay| d.tally.sums.damage.first().copied().unwrap_or(0.0);
    let total: f64 = days.iter().map(|(.., d)| weight(d)).sum();
    if !(total > 0.0) {
        return first.clone();
    }
    let mean = |of: &dyn Fn(&LoadDay) -> f64| -> f64 {
        days.iter().map(|(.., d)| weight(d) / total * of(d)).sum()
    };
    let entry = |i: usize| mean(&|d| d.scale.get(i).copied().unwrap_or(0.0));
    LoadDay {
        noise: mean(&|d| d.noise * d.noise).sqrt(),
        scale: (0..first.scale.len()).map(entry).collect(),
        ..first.clone()
    }
}

/// Returns the relative decrease of the damage without some days. Such days may close no cycle alone and still widen the cycles of other days.
fn share_without(all: f64, without: f64) -> f64 {
    match all > 0.0 {
        true => (1.0 - without / all).clamp(0.0, 1.0),
        false => 0.0,
    }
}

/// Returns the sample with the largest (smallest) value of a load; of equal values the first.
fn extreme(days: &[(&FileHead, &Day, &LoadDay)], larger: bool) -> Option<SampleOf> {
    let of = |t: &Tally| if larger { t.max } else { t.min };
    let found = days
        .iter()
        .filter_map(|(file, day, load)| Some((file, day, of(&load.tally)?)));
    let best = found.reduce(|a, b| {
        let (x, y) = (a.2.value, b.2.value);
        if (y > x) == larger && y != x { b } else { a }
    });
    best.map(|(file, day, e)| SampleOf {
        day: file.day.clone(),
        path: file.path.clone(),
        sha256: file.sha256.clone(),
        seconds: e.at as f64 / day.rate_hz,
    })
}

/// Returns a vehicle from its days in order, each with its file.
pub(super) fn vehicle(
    name: &str,
    list: &[(&FileHead, Day)],
    reference: Option<&Reference>,
) -> Vehicle {
    // All days have the loads of the first day, because the results of a changed job are stored separately.
    let first = list
        .first()
        .map(|f| f.1.loads.as_slice())
        .unwrap_or_default();
    let hours: f64 = list.iter().map(|f| f.1.hours).sum();
    let mut loads = Vec::new();
    for (l, load) in first.iter().enumerate() {
        let of_load: Vec<(&FileHead, &Day, &LoadDay)> = list
            .iter()
            .filter_map(|(f, d)| {
                let of_day = d.loads.get(l).filter(|x| x.name == load.name)?;
                Some((*f, d, of_day))
            })
            .collect();
        let tallies: Vec<&Tally> = of_load.iter().map(|d| &d.2.tally).collect();
        let Some(tally) = Tally::join_parts(&tallies) else {
            continue;
        };
        let damage_of =
            |t: &Tally, from: &LoadDay| DamageParts::from_tally(t, &from.scale, from.noise);
        let by_day: Vec<f64> = of_load
            .iter()
            .map(|(.., x)| damage_of(&x.tally, x).interval().value)
            .collect();
        let all = damage_of(&tally, &errors(&of_load, load));
        let hours: f64 = of_load.iter().map(|d| d.1.hours_of(d.2)).sum();
        let relied: Vec<_> = of_load
            .iter()
            .filter(|d| !d.1.is_doubtful())
            .copied()
            .collect();
        let without = match relied.len() == of_load.len() {
            true => all.interval().value,
            false => {
                let tallies: Vec<&Tally> = relied.iter().map(|d| &d.2.tally).collect();
                Tally::join_parts(&tallies).map_or(0.0, |tally| {
                    damage_of(&tally, &errors(&relied, load)).interval().value
                })
            }
        };
        let done: Vec<(&Day, f64)> = of_load.iter().map(|d| d.1).zip(by_day.clone()).collect();
        loads.push(VehicleLoad {
            name: load.name.clone(),
            unit: load.unit.clone(),
            hours,
            doubtful_share: share_without(all.interval().value, without),
            damage: all.interval(),
            to_reference: reference
                .and_then(|r| r.damage_ratio(name, &load.name, &all, hours, &done)),
            tally,
            extremes: [true, false].map(|larger| extreme(&of_load, larger)),
            by_day,
        });
    }
    let names: BTreeSet<&str> = list
        .iter()
        .flat_map(|(_, d)| d.gauges.iter().map(|g| g.name.as_str()))
        .collect();
    let gauges = names
        .into_iter()
        .map(|name| {
            let days = list.iter().map(|(_, d)| {
                let found = d.gauges.iter().find(|g| g.name == name);
                found
                    .cloned()
                    .unwrap_or_else(|| GaugeDay::without_readings(name))
            });
            (name.to_owned(), days.collect())
        })
        .collect();
    let record = |(file, day): &(&FileHead, Day)| RecordOf {
        path: file.path.clone(),
        sha256: file.sha256.clone(),
        hours: day.hours,
    };
    Vehicle {
        name: name.to_owned(),
        days: list.iter().map(|f| f.0.day.clone()).collect(),
        records: list.iter().map(record).collect(),
        doubtful: list.iter().map(|f| f.1.is_doubtful()).collect(),
        misread: list.iter().map(|f| is_misread(&f.1.findings)).collect(),
        hours,
        loads,
        gauges,
    }
}
