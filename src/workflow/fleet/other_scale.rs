//! Days on which the noise of all gauges differs from the vehicle's other days by the same factor. A bridge factor, a gain or a range changed for all
//! channels, so the readings are wrong by the same factor.

use super::other_unit;
use super::outcome::VehicleAnswer;
use crate::estimate::median;
use crate::finding::{Finding, Severity, list_few};
use crate::recovery::ErrorModel;
use crate::units::MICROSTRAIN;

/// Smallest factor that is reported. Of the factors that are mixed up (quarter, half and full bridge, Poisson's 1 + nu, steps of gain) the smallest
/// is 1.3. Temperature changes the noise of amplifiers by some per cent.
const FROM: f64 = 1.25;
/// Largest ratio of a gauge's factor to the median factor: second differences of a thousand readings determine white noise to 3 %.
const COMMON_FACTOR_RATIO: f64 = 1.06;
/// Smallest share of the gauges with the common factor. Other gauges may be dead or exchanged on that day.
const SHARE: f64 = 0.75;
/// Smallest number of gauges with the common factor. Fewer gauges agree by chance.
const GAUGES: usize = 4;
/// Smallest number of days with noise, the day with another scale included.
const DAYS: usize = 4;
/// Largest ratio of the usual noise to the stated noise, or of the stated to the usual noise. Larger noise is vibration, which rough roads raise in
/// all gauges.
const OF_STATED: f64 = 1.5;
/// Largest ratio between the changes of scatter and noise on a day. The manoeuvres of a vehicle change its scatter.
const DRIVEN: f64 = 2.0;

/// Returns the natural log of each number over its median, by gauge and day. Returns `None` for a missing number.
fn logs<'a>(of: impl Iterator<Item = &'a Vec<Option<f64>>>) -> Vec<Vec<Option<f64>>> {
    let of_gauge = |days: &Vec<Option<f64>>| {
        let usual = median(days.iter().flatten().copied().collect());
        let log = |v: &Option<f64>| Some((v.filter(|v| *v > 0.0)? / usual?).ln());
        days.iter().map(log).collect()
    };
    of.map(of_gauge).collect()
}

/// Returns the factor of a day's noise, if nearly all gauges have the same factor.
fn common_factor(logs: &[Vec<Option<f64>>], day: usize) -> Option<f64> {
    let known: Vec<f64> = logs.iter().filter_map(|g| *g.get(day)?).collect();
    let middle = median(known.clone())?;
    let alike = |v: &&f64| (**v - middle).abs() < COMMON_FACTOR_RATIO.ln();
    let n = known.iter().filter(alike).count();
    (n >= GAUGES && n as f64 >= SHARE * logs.len() as f64).then_some(middle)
}

/// Returns one finding for each vehicle with such days.
pub(super) fn in_other_scale(v: &VehicleAnswer, errors: &ErrorModel) -> Option<Finding> {
    let stated = errors.noise / MICROSTRAIN;
    let usual = v
        .gauges
        .iter()
        .filter_map(|g| median(g.noise.iter().flatten().copied().collect()));
    let usual = median(usual.collect())?;
    if !(usual < OF_STATED * stated && stated < OF_STATED * usual) {
        return None;
    }
    let noise = logs(v.gauges.iter().map(|g| &g.noise));
    let scatter = logs(v.gauges.iter().map(|g| &g.sd));
    let factors: Vec<Option<f64>> = (0..v.days.len())
        .map(|day| common_factor(&noise, day))
        .collect();
    // On most days the noise must have its usual size.
    let quiet = factors
        .iter()
        .flatten()
        .filter(|f| f.abs() < COMMON_FACTOR_RATIO.ln())
        .count();
    if quiet < DAYS - 1 || 2 * quiet < v.days.len() {
        return None;
    }
    let odd = |(day, factor): (usize, &Option<f64>)| {
        // A larger factor means another unit, which has its own finding.
        let factor = factor.filter(|f| f.abs() > FROM.ln() && f.abs() < other_unit::TIMES.ln())?;
        let own = median(scatter.iter().filter_map(|g| *g.get(day)?).collect())?;
        ((own - factor).abs() < DRIVEN.ln()).then_some((v.days.get(day)?, factor.exp()))
    };
    let days: Vec<(&String, f64)> = factors.iter().enumerate().filter_map(odd).collect();
    let (first, times) = days.first()?;
    let names: Vec<&String> = days.iter().map(|d| d.0).collect();
    Some(
        Finding::new(
            Severity::Warning,
            "fleet-day-scale",
            &v.name,
            format!(
                "on {} of {} days ({}) the noise of nearly all gauges is multiplied by one factor, {times:.2} on {first}. Noise comes from \
                 the electronics. The readings of these days may therefore be {times:.2} times too large, and damage grows with the power \
                 of the slope",
                days.len(),
                v.days.len(),
                list_few(&names),
            ),
            "check the bridge factor, the gain and the filter of the logger; correct the records with [[correction]], or leave them out",
        )
        .with_numbers(*times, FROM),
    )
}
