//! Days whose readings and noise are larger or smaller than on the other days of the fleet by the factor of another unit.

use super::outcome::VehicleAnswer;
use crate::estimate::median;
use crate::finding::{Finding, Severity, list_few};
use crate::recovery::ErrorModel;
use crate::units::MICROSTRAIN;
use std::collections::BTreeMap;

/// Smallest factor that indicates another unit. The use of a vehicle changes the scatter of its readings as much, but not their noise, which comes
/// from the electronics.
pub(super) const TIMES: f64 = 100.0;
/// Largest ratio between the changes of noise and scatter, in either direction.
const SAME_CHANGE_RATIO: f64 = 5.0;
/// Share of the stated noise below which no reading's noise falls.
const OF_STATED: f64 = 0.3;

/// Scatter and noise of a gauge on a day.
type Sizes = [Option<f64>; 2];

/// Returns one finding for each vehicle with such days. Loads of these days are wrong by the factor, and damage by its power.
pub(super) fn in_other_units(vehicles: &[VehicleAnswer], errors: &ErrorModel) -> Vec<Finding> {
    let mut all: BTreeMap<&str, [Vec<f64>; 2]> = BTreeMap::new();
    for g in vehicles.iter().flat_map(|v| &v.gauges) {
        let lists = all.entry(&g.name).or_default();
        for (list, values) in lists.iter_mut().zip([&g.sd, &g.noise]) {
            list.extend(values.iter().flatten().filter(|v| **v > 0.0));
        }
    }
    let typical: BTreeMap<&str, Sizes> = all.into_iter().map(|(g, l)| (g, l.map(median))).collect();
    let of_vehicle = |v: &VehicleAnswer| {
        let days: Vec<(&String, f64)> = v
            .days
            .iter()
            .enumerate()
            .filter_map(|(i, day)| Some((day, factor(v, i, &typical, errors)?)))
            .collect();
        let (first, times) = days.first()?;
        let (times, word) = match *times {
            t if t < 1.0 => (1.0 / t, "smaller"),
            t => (t, "larger"),
        };
        let names: Vec<&String> = days.iter().map(|d| d.0).collect();
        let message = format!(
            "on {} of {} days ({}) readings and noise are {times:.0} times {word} than on the other days of the fleet, from {first} on. They are in another unit. Do not use the damage of these days",
            days.len(),
            v.days.len(),
            list_few(&names),
        );
        let remedy = "state the unit in the columns of these records ([um/m], [mm/m], [m/m]), or correct them with [[correction]]";
        let found = Finding::new(Severity::Error, "fleet-day-unit", &v.name, message, remedy);
        Some(found.with_numbers(times, TIMES))
    };
    vehicles.iter().filter_map(of_vehicle).collect()
}

/// Returns the ratio of the readings of a day to typical readings, if it indicates another unit.
fn factor(
    v: &VehicleAnswer,
    day: usize,
    typical: &BTreeMap<&str, Sizes>,
    errors: &ErrorModel,
) -> Option<f64> {
    let share = |which: usize| {
        let of = v.gauges.iter().filter_map(|g| {
            let own = [&g.sd, &g.noise].get(which)?.get(day).copied()??;
            let typical = (*typical.get(&*g.name)?.get(which)?)?;
            (own > 0.0).then_some(own / typical)
        });
        median(of.collect())
    };
    let (scatter, noise) = (share(0)?, share(1)?);
    let apart = (scatter / noise).ln().abs() < SAME_CHANGE_RATIO.ln();
    let far = (scatter > TIMES && noise > TIMES) || (scatter * TIMES < 1.0 && noise * TIMES < 1.0);
    let stated = errors.noise / MICROSTRAIN * OF_STATED;
    let quiet = median(v.gauges.iter().filter_map(|g| *g.noise.get(day)?).collect())?;
    (apart && far && (scatter > 1.0 || quiet < stated)).then_some(scatter)
}
