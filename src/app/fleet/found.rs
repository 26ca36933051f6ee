//! Findings of single records, one for all records of a vehicle that say the same of the same subject.

use super::day::{DayFinding, FileHead};
use super::days::DayOrder;
use super::judged::OF_SAMPLES;
use super::merge::Status;
use crate::finding::explain::code;
use crate::finding::{Finding, Severity, few};
use crate::recovery::{ALARM, GAUGE_SUSPECT, UNEXPLAINED};
use statrs::distribution::{Binomial, DiscreteCDF};
use std::collections::{BTreeMap, BTreeSet};

/// Said of a right record with a chance of [`ALARM`], and less.
const BY_CHANCE: [&str; 2] = [GAUGE_SUSPECT, "residual-above-stated-errors"];
/// Said of a vehicle that stands still all day too: told where most of its records say so.
const OF_STANDING: [&str; 3] = [
    "load-far-below-expected",
    "loads-not-determined",
    "readings-below-noise",
];
/// Said of what all vehicles have in common: logger, number of gauges, stated errors, sizes of loads.
const OF_ALL: [&str; 7] = [
    "gauge-missing",
    "load-beyond-expected",
    "no-redundancy",
    "record-gaps",
    "record-resampled",
    "residual-above-stated-errors",
    "samples-with-gaps",
];

/// Records that say the same.
struct Alike<'a> {
    n: usize,
    /// Whether one of them holds strain that is beyond doubt not explained.
    certain: bool,
    /// The smallest chance that a right record says as much.
    chance: f64,
    day: &'a str,
    path: &'a str,
    first: &'a DayFinding,
    /// Vehicles whose records they are.
    vehicles: BTreeSet<&'a str>,
}

/// One finding for all records that say the same of the same subject; a vehicle each, but for what all have in common.
pub(super) fn of_records(files: &[FileHead], status: &[Status], days_in: DayOrder) -> Vec<Finding> {
    let mut records: BTreeMap<&str, usize> = BTreeMap::new();
    let mut grouped: BTreeMap<(&str, &str, &str), Alike> = BTreeMap::new();
    for (file, status) in files.iter().zip(status) {
        let (Status::Done, Ok(day)) = (status, &file.result) else {
            continue;
        };
        let certain = day.findings.iter().any(|f| f.code == UNEXPLAINED);
        for vehicle in ["", file.vehicle.as_str()] {
            *records.entry(vehicle).or_insert(0) += 1;
        }
        // The gauges' histories tell of dead ones.
        for f in day.findings.iter().filter(|f| f.code != "dead_channel") {
            let is_of = |list: &[&str]| list.contains(&f.code.as_str());
            let vehicle = if is_of(&OF_ALL) { "" } else { &file.vehicle };
            let subject = if is_of(&OF_SAMPLES) { "" } else { &f.subject };
            let alike = grouped.entry((&f.code, vehicle, subject)).or_insert(Alike {
                n: 0,
                certain: false,
                chance: 1.0,
                day: &file.day,
                path: &file.path,
                first: f,
                vehicles: BTreeSet::new(),
            });
            alike.vehicles.insert(&file.vehicle);
            // Of one vehicle the first is that of the first day, on which it began.
            if !vehicle.is_empty() && days_in.compare(&file.day, alike.day).is_lt() {
                (alike.day, alike.path, alike.first) = (&file.day, &file.path, f);
            }
            alike.n += 1;
            alike.chance = alike.chance.min(f.chance.unwrap_or(1.0));
            alike.certain |= certain;
        }
    }
    grouped
        .into_iter()
        .filter_map(|((_, vehicle, subject), alike)| {
            // What one vehicle alone has is that vehicle's.
            let vehicle = match alike.vehicles.first() {
                Some(one) if alike.vehicles.len() == 1 => one,
                _ => vehicle,
            };
            let of = records.get(vehicle).copied().unwrap_or(0);
            is_told(&alike, of).then(|| told(vehicle, subject, &alike, of))?
        })
        .collect()
}

/// Whether that many of `of` records say something of them.
fn is_told(alike: &Alike, of: usize) -> bool {
    let is_of = |list: &[&str]| list.contains(&alike.first.code.as_str());
    if is_of(&BY_CHANCE) && !alike.certain {
        // Many that say it, or one that says it louder than chance makes the loudest of all.
        let loudest = alike.chance * of as f64;
        return alike.n >= of || by_chance(alike.n, of) <= ALARM || loudest <= ALARM;
    }
    !is_of(&OF_STANDING) || 2 * alike.n > of
}

/// Chance that so many of `of` right records say what each says with a chance of [`ALARM`].
fn by_chance(n: usize, of: usize) -> f64 {
    let binomial = Binomial::new(ALARM, of as u64);
    binomial.map_or(1.0, |b| b.sf(n.saturating_sub(1) as u64))
}

/// `None` for a code that has no entry.
fn told(vehicle: &str, subject: &str, alike: &Alike, of: usize) -> Option<Finding> {
    let f = alike.first;
    let subject = [vehicle, subject].map(str::to_owned);
    let subject: Vec<String> = subject.into_iter().filter(|s| !s.is_empty()).collect();
    let samples = match OF_SAMPLES.contains(&f.code.as_str()) {
        true => format!(" ({})", f.subject),
        false => String::new(),
    };
    let of_vehicles = match vehicle {
        "" => {
            let names: Vec<&str> = alike.vehicles.iter().copied().collect();
            format!(" ({})", few(&names))
        }
        _ => String::new(),
    };
    Some(Finding {
        severity: Severity::named(&f.severity)?,
        code: code(&f.code)?.code,
        subject: subject.join(" "),
        message: format!(
            "{} of {of} records{of_vehicles}, the first {}{samples}: {}",
            alike.n, alike.path, f.message
        ),
        measured: f.measured,
        limit: f.limit,
        chance: f.chance,
        remedy: f.remedy.clone(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As many right records as a year has raise the alarm as seldom as one does; a gauge that is off shows in more of them.
    #[test]
    fn a_suspect_on_a_few_of_many_days_is_chance_and_on_more_is_told() {
        let first = DayFinding {
            severity: "error".into(),
            code: GAUGE_SUSPECT.into(),
            subject: "G".into(),
            message: String::new(),
            measured: None,
            limit: None,
            chance: None,
            remedy: String::new(),
        };
        let told = |n, certain, chance, of| {
            let alike = Alike {
                n,
                certain,
                chance,
                day: "",
                path: "",
                first: &first,
                vehicles: BTreeSet::new(),
            };
            is_told(&alike, of)
        };
        assert!(told(1, false, 1.0, 1));
        // 1.8 are expected of 365.
        assert!(!told(4, false, 1.0, 365));
        assert!(told(10, false, 1.0, 365));
        assert!(told(1, true, 1.0, 365));
        // One day on which it is off by ten sigmas, and one by less than four.
        assert!(told(1, false, 1e-20, 365));
        assert!(!told(1, false, 1e-4, 365));
    }
}
