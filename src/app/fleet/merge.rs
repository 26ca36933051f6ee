//! Days of a vehicle, one after the other, as one.

use super::day::{Day, FileHead, GaugeDay, LoadDay};
use super::name::by_day;
use crate::series::rainflow::{DamageInterval, Tally, damage_interval};
use std::collections::{BTreeMap, BTreeSet};

/// What became of a file.
#[derive(Clone, Debug, PartialEq)]
pub enum Status {
    /// It counts.
    Done,
    /// It can't be read, or loads can't be had of it.
    Failed(String),
    /// Another file is the same day, or holds the same bytes.
    Copy(String),
}

impl Status {
    /// The word of `fleet.csv` and `result.json`.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Failed(_) => "failed",
            Self::Copy(_) => "copy",
        }
    }

    /// Why, where there is a why.
    pub fn message(&self) -> &str {
        match self {
            Self::Done => "",
            Self::Failed(m) | Self::Copy(m) => m,
        }
    }
}

/// A load of a vehicle over all its days.
#[derive(Clone, Debug, PartialEq)]
pub struct VehicleLoad {
    /// Its name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// All days.
    pub tally: Tally,
    /// Damage with its interval.
    pub damage: DamageInterval,
    /// Day of the largest and of the smallest value.
    pub extreme_days: [String; 2],
    /// Damage of each day by itself, in their order.
    pub by_day: Vec<f64>,
}

/// A vehicle.
#[derive(Clone, Debug, PartialEq)]
pub struct Vehicle {
    /// Its name.
    pub name: String,
    /// Its days, in order.
    pub days: Vec<String>,
    /// Hours of all days.
    pub hours: f64,
    /// Loads, in the order of the job.
    pub loads: Vec<VehicleLoad>,
    /// Readings of each gauge, a day each, in order.
    pub gauges: Vec<(String, Vec<GaugeDay>)>,
}

/// Files that count, by vehicle and in the order of their days, and the status of every file in the order given.
///
/// Of two files for one day, or with the same bytes, that with the first path counts. What comes out does not depend on the order of
/// `files`.
pub fn sorted(files: &[FileHead]) -> (BTreeMap<&str, Vec<&FileHead>>, Vec<Status>) {
    let mut order: Vec<usize> = (0..files.len()).collect();
    let key = |i: &usize| files.get(*i).map(|f| f.path.as_str()).unwrap_or_default();
    order.sort_by(|a, b| key(a).cmp(key(b)));
    let mut status = vec![Status::Done; files.len()];
    let mut days: BTreeMap<&str, Vec<&FileHead>> = BTreeMap::new();
    let mut seen_bytes: BTreeMap<&str, &str> = BTreeMap::new();
    let mut seen_days: BTreeMap<(&str, &str), &str> = BTreeMap::new();
    for i in order {
        let (Some(file), Some(slot)) = (files.get(i), status.get_mut(i)) else {
            continue;
        };
        let same_day = seen_days.get(&(file.vehicle.as_str(), file.day.as_str()));
        match (&file.result, seen_bytes.get(file.sha256.as_str()), same_day) {
            (Err(why), ..) => *slot = Status::Failed(why.clone()),
            (Ok(_), Some(first), _) => {
                *slot = Status::Copy(format!("the same bytes as {first}, which counts"));
            }
            (Ok(_), None, Some(first)) => {
                *slot = Status::Copy(format!(
                    "another file of {} on {}: {first} counts",
                    file.vehicle, file.day
                ));
            }
            (Ok(_), None, None) => {
                seen_bytes.insert(&file.sha256, &file.path);
                seen_days.insert((&file.vehicle, &file.day), &file.path);
                days.entry(&file.vehicle).or_default().push(file);
            }
        }
    }
    for list in days.values_mut() {
        list.sort_by(|a, b| by_day(&a.day, &b.day).then(a.day.cmp(&b.day)));
    }
    (days, status)
}

/// The errors of all days together: where they differ (a gauge that died), by the share of damage that each day did.
fn errors(days: &[(&str, &LoadDay)], first: &LoadDay) -> LoadDay {
    let weight = |d: &LoadDay| d.tally.sums.damage.first().copied().unwrap_or(0.0);
    let total: f64 = days.iter().map(|(_, d)| weight(d)).sum();
    if !(total > 0.0) {
        return first.clone();
    }
    let mean = |of: &dyn Fn(&LoadDay) -> f64| -> f64 {
        days.iter().map(|(_, d)| weight(d) / total * of(d)).sum()
    };
    let entry = |i: usize| mean(&|d| d.scale.get(i).copied().unwrap_or(0.0));
    LoadDay {
        noise: mean(&|d| d.noise * d.noise).sqrt(),
        scale: (0..first.scale.len()).map(entry).collect(),
        ..first.clone()
    }
}

/// A vehicle from its days in order, each with its name.
pub fn vehicle(name: &str, list: &[(&str, Day)]) -> Vehicle {
    // Loads of the first day; a job that has changed has other results, so they are those of every day.
    let first = list
        .first()
        .map(|f| f.1.loads.as_slice())
        .unwrap_or_default();
    let mut loads = Vec::new();
    for (l, load) in first.iter().enumerate() {
        let of_load: Vec<_> = list
            .iter()
            .filter_map(|(f, d)| Some((*f, d.loads.get(l).filter(|x| x.name == load.name)?)))
            .collect();
        let tallies: Vec<&Tally> = of_load.iter().map(|d| &d.1.tally).collect();
        let Some(tally) = Tally::joined(&tallies) else {
            continue;
        };
        let of = |larger: bool| {
            let value = |t: &Tally| if larger { t.max } else { t.min }.map(|e| e.value);
            let found = of_load
                .iter()
                .filter_map(|(day, x)| Some((day, value(&x.tally)?)));
            let best = found.reduce(|a, b| {
                if (b.1 > a.1) == larger && b.1 != a.1 {
                    b
                } else {
                    a
                }
            });
            best.map_or(String::new(), |b| (*b.0).to_owned())
        };
        let damage_of = |t: &Tally, from: &LoadDay| damage_interval(t, &from.scale, from.noise);
        loads.push(VehicleLoad {
            name: load.name.clone(),
            unit: load.unit.clone(),
            damage: damage_of(&tally, &errors(&of_load, load)),
            tally,
            extreme_days: [of(true), of(false)],
            by_day: of_load
                .iter()
                .map(|(_, x)| damage_of(&x.tally, x).value)
                .collect(),
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
                found.cloned().unwrap_or_else(|| GaugeDay::silent(name))
            });
            (name.to_owned(), days.collect())
        })
        .collect();
    Vehicle {
        name: name.to_owned(),
        days: list.iter().map(|f| f.0.to_owned()).collect(),
        hours: list.iter().map(|f| f.1.hours).sum(),
        loads,
        gauges,
    }
}
