//! Findings of single records, merged over all records of a vehicle with the same code and subject.

use super::day::FileHead;
use super::days::DayOrder;
use super::merge::Status;
use super::sample_tests::OF_SAMPLES;
use crate::finding::{Finding, list_few};
use crate::recovery::{ALARM, GAUGE_SUSPECT, UNEXPLAINED};
use statrs::distribution::{Binomial, DiscreteCDF};
use std::collections::{BTreeMap, BTreeSet};

/// Codes of findings that a correct record gets with a probability of at most [`ALARM`].
const BY_CHANCE: [&str; 2] = [GAUGE_SUSPECT, "residual-above-stated-errors"];
/// Codes of findings that a vehicle gets after a day at standstill, too. They are reported if more than half of its records have them.
const OF_STANDING: [&str; 3] = [
    "load-far-below-expected",
    "loads-not-determined",
    "readings-below-noise",
];
/// Codes of findings whose cause all vehicles share: logger, number of gauges, stated errors, sizes of loads.
const OF_ALL: [&str; 7] = [
    "gauge-without-strain",
    "load-beyond-expected",
    "no-redundancy",
    "record-gaps",
    "record-resampled",
    "residual-above-stated-errors",
    "samples-with-gaps",
];

/// Records with the same finding.
struct FindingGroup<'a> {
    n: usize,
    /// Whether at least one of the records certainly contains strain that the loads do not explain.
    certain: bool,
    /// Smallest probability, over these records, that a correct record has such a finding.
    chance: f64,
    day: &'a str,
    path: &'a str,
    first: &'a Finding,
    /// Vehicles of these records.
    vehicles: BTreeSet<&'a str>,
}

/// Returns one finding for all records with the same code and subject. Each vehicle has its own finding, unless all vehicles share the cause.
pub(super) fn of_records(files: &[FileHead], status: &[Status], days_in: DayOrder) -> Vec<Finding> {
    let mut records: BTreeMap<&str, usize> = BTreeMap::new();
    let mut grouped: BTreeMap<(&str, &str, &str), FindingGroup> = BTreeMap::new();
    for (file, status) in files.iter().zip(status) {
        let (Status::Done, Ok(day)) = (status, &file.result) else {
            continue;
        };
        let certain = day.findings.iter().any(|f| f.code == UNEXPLAINED);
        for vehicle in ["", file.vehicle.as_str()] {
            *records.entry(vehicle).or_insert(0) += 1;
        }
        // The histories of the gauges report dead gauges.
        for f in day.findings.iter().filter(|f| f.code != "gauge-silent") {
            let is_of = |list: &[&str]| list.contains(&f.code);
            let vehicle = if is_of(&OF_ALL) { "" } else { &file.vehicle };
            let subject = if is_of(&OF_SAMPLES) { "" } else { &f.subject };
            let alike = grouped
                .entry((f.code, vehicle, subject))
                .or_insert(FindingGroup {
                    n: 0,
                    certain: false,
                    chance: 1.0,
                    day: &file.day,
                    path: &file.path,
                    first: f,
                    vehicles: BTreeSet::new(),
                });
            alike.vehicles.insert(&file.vehicle);
            // For one vehicle, the example is the finding of its first day, on which the fault began.
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
            // A finding in the records of a single vehicle belongs to that vehicle.
            let vehicle = match alike.vehicles.first() {
                Some(one) if alike.vehicles.len() == 1 => one,
                _ => vehicle,
            };
            let [of, all] = [vehicle, ""].map(|v| records.get(v).copied().unwrap_or(0));
            is_reported(&alike, of, all)
                .then(|| combine_equal_findings(vehicle, subject, &alike, of))
        })
        .collect()
}

/// Returns whether a finding is reported. `alike.n` of `of` records have it, and the fleet has `all` records. A fleet of correct records gives an
/// alarm with the same probability as one correct record, for any number of vehicles.
fn is_reported(alike: &FindingGroup, of: usize, all: usize) -> bool {
    let is_of = |list: &[&str]| list.contains(&alike.first.code);
    if is_of(&BY_CHANCE) && !alike.certain {
        // A finding is reported if too many records have it, or if one record has it with a probability too small for the whole fleet.
        let groups = all as f64 / of.max(1) as f64;
        let many = by_chance(alike.n, of) * groups;
        let loudest = alike.chance * all as f64;
        return many.min(loudest) <= ALARM;
    }
    !is_of(&OF_STANDING) || 2 * alike.n > of
}

/// Returns the probability that at least `n` of `of` correct records have a finding that each of them has with probability [`ALARM`].
fn by_chance(n: usize, of: usize) -> f64 {
    if of == 1 {
        return ALARM;
    }
    let binomial = Binomial::new(ALARM, of as u64);
    binomial.map_or(1.0, |b| b.sf(n.saturating_sub(1) as u64))
}

/// Returns the finding of records with the same code and subject, with their number and the first of them.
fn combine_equal_findings(
    vehicle: &str,
    subject: &str,
    alike: &FindingGroup,
    of: usize,
) -> Finding {
    let f = alike.first;
    let subject = [vehicle, subject].map(str::to_owned);
    let subject: Vec<String> = subject.into_iter().filter(|s| !s.is_empty()).collect();
    let samples = match OF_SAMPLES.contains(&f.code) {
        true => format!(" ({})", f.subject),
        false => String::new(),
    };
    let of_vehicles = match vehicle {
        "" => {
            let names: Vec<&str> = alike.vehicles.iter().copied().collect();
            format!(" ({})", list_few(&names))
        }
        _ => String::new(),
    };
    Finding {
        subject: subject.join(" "),
        message: format!(
            "{} of {of} records{of_vehicles}, the first {}{samples}: {}",
            alike.n, alike.path, f.message
        ),
        ..f.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::finding::Severity;

    fn is_group_reported(n: usize, certain: bool, chance: f64, [of, all]: [usize; 2]) -> bool {
        let first = Finding::new(Severity::Error, GAUGE_SUSPECT, "G", "", "");
        let alike = FindingGroup {
            n,
            certain,
            chance,
            day: "",
            path: "",
            first: &first,
            vehicles: BTreeSet::new(),
        };
        is_reported(&alike, of, all)
    }

    /// Correct records of a year give an alarm as rarely as one correct record. A wrong gauge is suspect in more of them.
    #[test]
    fn a_suspect_on_a_few_of_many_days_is_chance_and_on_more_is_told() {
        let told = |n, certain, chance, of| is_group_reported(n, certain, chance, [of, of]);
        assert!(told(1, false, 1.0, 1));
        // By chance, 1.8 of 365 records have such a finding.
        assert!(!told(4, false, 1.0, 365));
        assert!(told(10, false, 1.0, 365));
        assert!(told(1, true, 1.0, 365));
        // One day with a deviation of nearly ten sigmas, and one with less than four.
        assert!(told(1, false, 1e-20, 365));
        assert!(!told(1, false, 1e-4, 365));
    }

    /// Checks that correct records of all vehicles together cause an alarm with at most the probability for one correct record.
    #[test]
    fn a_fleet_of_right_vehicles_alarms_as_seldom_as_one() {
        for (vehicles, days) in [(1, 1), (1000, 1), (1000, 2), (1000, 20), (100, 365)] {
            let all = vehicles * days;
            let told = |n: &usize| is_group_reported(*n, false, 1.0, [days, all]);
            let chance = (1..=days).find(told).map_or(0.0, |n| {
                let binomial = Binomial::new(ALARM, days as u64).unwrap();
                binomial.sf(n as u64 - 1) * vehicles as f64
            });
            assert!(
                chance <= ALARM * (1.0 + 1e-9),
                "{vehicles} {days}: {chance}"
            );
            // A vehicle with a wrong gauge on most days is reported among a thousand vehicles.
            assert!(days < 20 || told(&days), "{vehicles} {days}");
        }
        // Among 20,000 records, one record with a probability of 3e-5 is no alarm, and one with 1e-8 is an alarm.
        assert!(!is_group_reported(1, false, 3e-5, [20, 20_000]));
        assert!(is_group_reported(1, false, 1e-8, [20, 20_000]));
    }
}
