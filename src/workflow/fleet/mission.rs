//! Damage of a mission from kinds of days and their shares: an extrapolation from the days that were measured.

use super::day::{Day, FileHead};
use crate::host::fault::{Fault, Faults};
use crate::job::{Fleet as FleetKeys, MissionKind};
use crate::series::rainflow::{DamageInterval, DamageParts, Law};
use serde::Serialize;

/// A load of the mission.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MissionLoad {
    /// Name of the load.
    pub load: String,
    /// Unit of the load. The unit of damage is a power of this unit.
    pub unit: String,
    /// Damage of the mission.
    pub damage: f64,
    /// Lower end of the 95 % interval from errors of measurement.
    pub damage_low: f64,
    /// Upper end of this interval.
    pub damage_high: f64,
    /// Standard deviation from the error of S, which is common to all days.
    pub sigma_s: f64,
    /// Standard deviation from the scatter of noise.
    pub sigma_noise: f64,
    /// Standard deviation of the noise bias that was subtracted.
    pub sigma_bias: f64,
    /// Standard deviation from the scatter between days of one kind, which is not part of the interval; `None` if a kind has one day.
    pub sigma_days: Option<f64>,
    /// Damage per hour of each kind.
    pub by_kind: Vec<f64>,
    /// Upper bound of the damage of cycles that close between days, which `damage` leaves out.
    pub between_days_at_most: f64,
}

/// Days of one kind in the mission, with their share and their records.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KindAnswer {
    /// Name of the kind of days.
    pub name: String,
    /// Share of the hours.
    pub share: f64,
    /// Number of records of this kind.
    pub files: usize,
    /// Hours of these records.
    pub hours: f64,
}

/// The mission.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MissionAnswer {
    /// Statement that the result is an extrapolation, with its basis.
    pub statement: String,
    /// Hours of the mission.
    pub hours: f64,
    /// Kinds of days, as stated in the job.
    pub kinds: Vec<KindAnswer>,
    /// Loads, in the order of the job.
    pub loads: Vec<MissionLoad>,
}

/// Sums over the days of a kind.
struct KindSums {
    key: MissionKind,
    files: usize,
    hours: f64,
    loads: Vec<LoadSums>,
}

/// Sums over the days of a kind for one load.
struct LoadSums {
    name: String,
    unit: String,
    damage: DamageParts,
    /// Sum of the hours in which the load is known, and sum of their squares.
    hours: [f64; 2],
    /// Sum of the squared damages of the days, and sum of the products of damage and hours.
    squares: [f64; 2],
    /// Smallest and largest value.
    ends: [f64; 2],
    law: Law,
}

/// Sums over the days of every kind.
pub(super) struct MissionSums {
    hours: f64,
    kinds: Vec<KindSums>,
}

/// Whether a name has the form of a pattern, in which `*` is any text.
fn matches(pattern: &str, name: &str) -> bool {
    let Some((first, rest)) = pattern.split_once('*') else {
        return pattern == name;
    };
    let Some(left) = name.strip_prefix(first) else {
        return false;
    };
    let ends = left.char_indices().map(|c| c.0).chain([left.len()]);
    ends.filter_map(|i| left.get(i..))
        .any(|end| matches(rest, end))
}

impl KindSums {
    fn holds(&self, file: &FileHead) -> bool {
        let any = |list: &[String], name: &str| {
            list.is_empty() || list.iter().any(|pattern| matches(pattern, name))
        };
        any(&self.key.days, &file.day) && any(&self.key.vehicles, &file.vehicle)
    }

    fn add(&mut self, day: &Day) {
        self.files += 1;
        self.hours += day.hours;
        for load in &day.loads {
            let parts = DamageParts::from_tally(&load.tally, &load.scale, load.noise);
            let known = day.hours_of(load);
            let hours = [known, known * known];
            let squares = [parts.value * parts.value, parts.value * known];
            let ends = [load.tally.min, load.tally.max].map(|e| e.map_or(f64::NAN, |e| e.value));
            match self.loads.iter_mut().find(|l| l.name == load.name) {
                Some(l) => {
                    l.damage.add(1.0, &parts);
                    l.squares.iter_mut().zip(squares).for_each(|(a, b)| *a += b);
                    l.hours.iter_mut().zip(hours).for_each(|(a, b)| *a += b);
                    l.ends = merge_spans(l.ends, ends);
                }
                None => self.loads.push(LoadSums {
                    name: load.name.clone(),
                    unit: load.unit.clone(),
                    damage: parts,
                    hours,
                    squares,
                    ends,
                    law: load.tally.law,
                }),
            }
        }
    }

    /// Variance of the damage an hour of a load by the scatter between days: of `n` days with damage d and hours h, `r = sum d / sum h`,
    /// `n / (n - 1) sum (d - r h)^2 / (sum h)^2`. `None` for one day.
    ///
    /// # Reference
    /// W.G. Cochran, Sampling Techniques, 3rd ed. (1977), eq. 6.9.
    fn between_days(&self, l: &LoadSums) -> Option<f64> {
        let n = self.files as f64;
        let ([hours, squared_hours], [squares, products]) = (l.hours, l.squares);
        let rate = l.damage.value / hours;
        let sum = squares - 2.0 * rate * products + rate * rate * squared_hours;
        (self.files > 1).then(|| n / (n - 1.0) * sum.max(0.0) / (hours * hours))
    }
}

impl MissionSums {
    /// Returns the sums of a mission without days; `None` if the job has no mission.
    pub fn from_keys(keys: &FleetKeys) -> Option<Self> {
        let kinds = keys.mission.iter().map(|key| KindSums {
            key: key.clone(),
            files: 0,
            hours: 0.0,
            loads: Vec::new(),
        });
        (!keys.mission.is_empty()).then(|| Self {
            hours: keys.mission_hours,
            kinds: kinds.collect(),
        })
    }

    /// Adds a day to its kind of days.
    ///
    /// # Errors
    /// A fault if the day belongs to two kinds of days.
    pub fn add(&mut self, job: &str, file: &FileHead, day: &Day) -> Result<(), Faults> {
        let mut kinds = self.kinds.iter_mut().filter(|k| k.holds(file));
        let Some(first) = kinds.next() else {
            return Ok(());
        };
        if let Some(second) = kinds.next() {
            let wrong = format!(
                "day {} of {} belongs to the kinds `{}` and `{}`",
                file.day, file.vehicle, first.key.name, second.key.name
            );
            let remedy = "assign every day to one kind";
            let line = second.key.line;
            return Err(Fault::with_line(job, line, "fleet.mission", wrong, remedy).into());
        }
        first.add(day);
        Ok(())
    }

    /// Returns the kinds without a record.
    pub fn without_records(&self) -> impl Iterator<Item = &MissionKind> {
        let none = self.kinds.iter().filter(|k| k.files == 0);
        none.map(|k| &k.key)
    }

    /// Returns the damage of the mission, `hours * sum of share_i damage_i / hours_i`. `None` if a kind has no record.
    pub fn answer(&self) -> Option<MissionAnswer> {
        let first = self.kinds.first()?;
        if self.kinds.iter().any(|k| !(k.hours > 0.0)) {
            return None;
        }
        let load = |of_first: &LoadSums| {
            let (mut all, mut between) = (DamageParts::default(), Some(0.0));
            let (mut by_kind, mut days, mut ends) = (Vec::new(), 0.0, [f64::NAN; 2]);
            for k in &self.kinds {
                let l = k.loads.iter().find(|l| l.name == of_first.name)?;
                let [hours, _] = l.hours;
                if !(hours > 0.0) {
                    return None;
                }
                let weight = self.hours * k.key.share / hours;
                all.add(weight, &l.damage);
                days += self.hours * k.key.share / k.hours * k.files as f64;
                ends = merge_spans(ends, l.ends);
                by_kind.push(l.damage.value.max(0.0) / hours);
                let of_kind = k.between_days(l);
                let times = (self.hours * k.key.share).powi(2);
                between = between.zip(of_kind).map(|(a, b)| a + times * b);
            }
            let DamageInterval {
                value,
                low,
                high,
                sigma_s,
                sigma_noise,
                sigma_bias,
                ..
            } = all.interval();
            Some(MissionLoad {
                load: of_first.name.clone(),
                unit: of_first.unit.clone(),
                damage: value,
                damage_low: low,
                damage_high: high,
                sigma_s,
                sigma_noise,
                sigma_bias,
                sigma_days: between.map(f64::sqrt),
                by_kind,
                between_days_at_most: between_days_at_most(of_first.law, ends, days),
            })
        };
        let kinds: Vec<KindAnswer> = self
            .kinds
            .iter()
            .map(|k| KindAnswer {
                name: k.key.name.clone(),
                share: k.key.share,
                files: k.files,
                hours: k.hours,
            })
            .collect();
        let measured: f64 = kinds.iter().map(|k| k.hours).sum();
        Some(MissionAnswer {
            statement: format!(
                "An extrapolation: {} hours from {measured:.2} measured hours, on the assumption that all hours of a kind are alike. \
                 Cycles that close between days are left out; between_days_at_most is an upper bound of their damage.",
                self.hours
            ),
            hours: self.hours,
            loads: first.loads.iter().filter_map(load).collect(),
            kinds,
        })
    }
}

/// Both spans together, the numbers of either that are none left out.
fn merge_spans(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// Returns the upper bound of the damage that cycles closing between days add to the sum of the damages of single days. The bound adds half a cycle
/// at each border of two days. Its range is from the smallest to the largest value of all days, by the straight line of the law.
///
/// The count of a history at levels u < v is half the number of its passages from u to v and back. The damage `sum of d(range)` is the integral of
/// that count with the weight `d''(v - u)`. At the border of two days there is at most one passage more than in both days. There is no passage if a
/// level is beyond the extremes. This adds `d(max - min) / 2`. With a knee, at which d is not convex, the bound is an estimate.
///
/// # Reference
/// I. Rychlik, Note on cycle counts in irregular loads, Fatigue Fract. Eng. Mater. Struct. 16 (1993) 377: passages of intervals.
fn between_days_at_most(law: Law, ends: [f64; 2], days: f64) -> f64 {
    let range = ends[1] - ends[0];
    let of_one = 0.5 * Law::from_slope(law.slope).damage(range);
    if range > 0.0 { days * of_one } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_star_is_any_text() {
        for (pattern, name) in [
            ("2026-05-01", "2026-05-01"),
            ("2026-*", "2026-05-01"),
            ("*", ""),
            ("*road*", "a road b"),
            ("a*b*b", "a b b"),
        ] {
            assert!(matches(pattern, name), "{pattern} {name}");
        }
        for (pattern, name) in [("2026", "2026-05"), ("*road", "roads"), ("a*b", "b a")] {
            assert!(!matches(pattern, name), "{pattern} {name}");
        }
    }
}
