//! The answer of `fleet`.

use super::damage_references::{DamageReferences, ReferenceAnswer};
use super::day::FileHead;
use super::days::DayOrder;
use super::gauge_history::{GainChange, GaugeHistory, moving_days};
use super::kernel::Kernel;
use super::merge::{RecordOf, SampleOf, Status, Vehicle, VehicleLoad};
use super::mission::{MissionAnswer, MissionSums};
use super::record_findings::of_records;
use crate::finding::{Finding, Severity, list_few};
use crate::host::outcome::Answer;
use crate::host::words::count_of;
use crate::job::{Fleet as FleetKeys, Job};
use crate::series::rainflow::{DamageInterval, Ratio};
use crate::units::number;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// A load of a vehicle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VehicleLoadAnswer {
    /// Name of the load.
    pub load: String,
    /// Unit of `max` and `min`. The unit of damage is a power of this unit.
    pub unit: String,
    /// Hours in which the load is known. Its damage covers these hours.
    pub hours: f64,
    /// Largest value, with its day.
    pub max: Option<f64>,
    /// Day of the largest value.
    pub max_day: String,
    /// Record and time of the largest value.
    pub max_at: Option<SampleOf>,
    /// Smallest value.
    pub min: Option<f64>,
    /// Day of the smallest value.
    pub min_day: String,
    /// Record and time of the smallest value.
    pub min_at: Option<SampleOf>,
    /// Number of cycles. Cycles of the residue count half.
    pub cycles: f64,
    /// Damage, with the bias of noise subtracted.
    pub damage: f64,
    /// Lower end of its 95 % interval.
    pub damage_low: f64,
    /// Upper end of this interval.
    pub damage_high: f64,
    /// Damage as counted.
    pub damage_counted: f64,
    /// Expected damage that noise added.
    pub noise_bias: f64,
    /// Standard deviation from the error of S, which is common to all days.
    pub sigma_s: f64,
    /// Standard deviation from the scatter of noise, which averages out.
    pub sigma_noise: f64,
    /// Standard deviation of the noise bias that was subtracted.
    pub sigma_bias: f64,
    /// Damage per hour, divided by the damage per hour of all vehicles together.
    pub relative: f64,
    /// Damage per hour, divided by the damage per hour of the reference day.
    pub to_reference: Option<Ratio>,
    /// Damage divided by the target damage.
    pub to_target: Option<Ratio>,
    /// Damage of each day separately.
    pub by_day: Vec<f64>,
    /// Share of the damage from days whose loads are not reliable.
    pub doubtful_share: f64,
    /// Width of a class.
    #[serde(skip)]
    pub width: f64,
    /// Number of cycles by range, in class widths.
    #[serde(skip)]
    pub range_pairs: Vec<(u32, f64)>,
    /// Cycles by class of both reversals.
    #[serde(skip)]
    pub from_to: Vec<(i32, i32, u64)>,
    /// Number of rises through the lower border of each class.
    #[serde(skip)]
    pub levels: Vec<(i32, u64)>,
}

/// A vehicle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VehicleAnswer {
    /// Name of the vehicle.
    pub name: String,
    /// Number of files that count.
    pub files: usize,
    /// Days of the vehicle, in order.
    pub days: Vec<String>,
    /// Records of these days, in order: the source of each day's numbers.
    pub records: Vec<RecordOf>,
    /// Duration of these days, hours.
    pub hours: f64,
    /// Loads, in the order of the job.
    pub loads: Vec<VehicleLoadAnswer>,
    /// Days with unreliable loads according to the findings of their records. Their damage is included in the sums.
    pub doubtful_days: Vec<String>,
    /// Gauges.
    pub gauges: Vec<GaugeHistory>,
    /// Whether a finding on the record of a day identifies a cause that makes gains and zeros of that day invalid, by day.
    #[serde(skip)]
    pub misread: Vec<bool>,
}

/// Result of one record file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FileAnswer {
    /// Path as given.
    pub path: String,
    /// Digest of its bytes.
    pub sha256: String,
    /// The vehicle.
    pub vehicle: String,
    /// The day.
    pub day: String,
    /// `done`, `failed` or `copy`.
    pub status: &'static str,
    /// Reason, if the record does not count.
    pub message: String,
    /// Hours of it.
    pub hours: Option<f64>,
    /// Samples per second.
    pub rate_hz: Option<f64>,
    /// Samples missing in gaps.
    pub missing: Option<usize>,
    /// Findings of the record.
    pub findings: Vec<Finding>,
}

impl FileAnswer {
    /// Returns whether the file counts although its loads are unreliable.
    pub fn is_doubtful(&self) -> bool {
        let is_error = |f: &Finding| f.severity == Severity::Error;
        self.status == Status::Done.word() && self.findings.iter().any(is_error)
    }

    /// Returns the reason why the file does not count, or else the codes of its findings.
    pub fn words(&self) -> String {
        let codes: BTreeSet<&str> = self.findings.iter().map(|f| f.code).collect();
        match self.message.is_empty() {
            true => codes.into_iter().collect::<Vec<_>>().join(", "),
            false => self.message.clone(),
        }
    }
}

/// The answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fleet {
    /// Title of the job.
    #[serde(skip)]
    pub title: String,
    /// Slope of the S-N line.
    pub slope: f64,
    /// Vehicles by name.
    pub vehicles: Vec<VehicleAnswer>,
    /// The reference day, whose damage per hour is 1, if the job names a day that exists.
    pub reference: Option<ReferenceAnswer>,
    /// Damage of the mission that the job mixes.
    pub mission: Option<MissionAnswer>,
    /// Files by path.
    pub files: Vec<FileAnswer>,
}

impl Answer for Fleet {
    const COMMAND: &'static str = "fleet";
    const RESULT: &'static str = "The loads and damage of the fleet";

    fn verdict(&self) -> String {
        let count = |status: &str| self.files.iter().filter(|f| f.status == status).count();
        let hours: f64 = self.vehicles.iter().map(|v| v.hours).sum();
        format!(
            "{} of {} used, {} failed: {} h of {}.",
            count("done"),
            count_of(self.files.len(), "file"),
            count("failed"),
            number(hours),
            count_of(self.vehicles.len(), "vehicle")
        )
    }
}

impl VehicleAnswer {
    /// Returns the answer of a vehicle without its comparison with other vehicles; [`VehicleAnswer::compare`] adds that.
    pub(super) fn from_vehicle(v: Vehicle, keys: &FleetKeys) -> Self {
        let moves = moving_days(&v.gauges, v.days.len());
        Self {
            files: v.days.len(),
            hours: v.hours,
            gauges: v
                .gauges
                .iter()
                .map(|(name, days)| GaugeHistory::from_days(name, days, &v.days, &moves))
                .collect(),
            loads: v
                .loads
                .into_iter()
                .map(|l| VehicleLoadAnswer::from_load(l, keys))
                .collect(),
            doubtful_days: v
                .days
                .iter()
                .zip(&v.doubtful)
                .filter(|d| *d.1)
                .map(|d| d.0.clone())
                .collect(),
            misread: v.misread,
            records: v.records,
            name: v.name,
            days: v.days,
        }
    }

    /// Returns the findings on gains that change from some day on. A changed gain of one gauge also changes the predictions for other gauges. Of the
    /// gauges that change on one day, only the one with the largest change is reported.
    pub(super) fn gain_changes(&self) -> impl Iterator<Item = Finding> {
        let mut largest: BTreeMap<usize, GainChange> = BTreeMap::new();
        for g in &self.gauges {
            let Some(change) = g.gain_change(&self.name, &self.days, &self.misread) else {
                continue;
            };
            let known = largest.get(&change.from);
            if known.is_none_or(|k| change.size > k.size) {
                largest.insert(change.from, change);
            }
        }
        largest.into_values().map(|c| c.finding)
    }

    /// Sets the damage per hour of each vehicle relative to the damage per hour of all vehicles, by load.
    pub(super) fn compare(all: &mut [Self]) {
        let mut sums: BTreeMap<String, [f64; 2]> = BTreeMap::new();
        for l in all.iter().flat_map(|v| &v.loads) {
            let [damage, hours] = sums.entry(l.load.clone()).or_default();
            *damage += l.damage;
            *hours += l.hours;
        }
        for v in all {
            for l in &mut v.loads {
                let of_all = sums.get(&l.load).map_or(f64::NAN, |[d, hours]| d / hours);
                l.relative = l.damage / l.hours / of_all;
            }
        }
    }
}

impl VehicleLoadAnswer {
    fn from_load(l: VehicleLoad, keys: &FleetKeys) -> Self {
        let DamageInterval {
            value,
            low,
            high,
            counted,
            noise_bias,
            sigma_s,
            sigma_noise,
            sigma_bias,
        } = l.damage;
        let [max_at, min_at] = l.extremes;
        let day = |at: &Option<SampleOf>| at.as_ref().map_or(String::new(), |s| s.day.clone());
        let target = keys.target.iter().find(|t| t.load == l.name);
        Self {
            max: l.tally.max.map(|e| e.value),
            max_day: day(&max_at),
            max_at,
            min: l.tally.min.map(|e| e.value),
            min_day: day(&min_at),
            min_at,
            cycles: l.tally.n_cycles(),
            damage: value,
            damage_low: low,
            damage_high: high,
            damage_counted: counted,
            noise_bias,
            sigma_s,
            sigma_noise,
            sigma_bias,
            relative: f64::NAN,
            to_reference: l.to_reference,
            to_target: target.map(|t| Ratio { value, low, high }.times(1.0 / t.damage)),
            by_day: l.by_day,
            doubtful_share: l.doubtful_share,
            width: l.tally.width,
            range_pairs: l.tally.range_pairs(),
            from_to: l.tally.cycles,
            levels: l.tally.levels,
            load: l.name,
            hours: l.hours,
            unit: l.unit,
        }
    }
}

impl Fleet {
    /// Returns every load of every vehicle.
    pub fn rows(&self) -> impl Iterator<Item = (&VehicleAnswer, &VehicleLoadAnswer)> {
        let vehicles = self.vehicles.iter();
        vehicles.flat_map(|v| v.loads.iter().map(move |l| (v, l)))
    }

    /// Returns the answer of merged vehicles.
    pub(super) fn from_vehicles(
        job: &Job,
        kernel: &Kernel,
        vehicles: Vec<VehicleAnswer>,
        files: &[FileHead],
        status: &[Status],
        compared: DamageReferences,
    ) -> Self {
        let mut listed: Vec<FileAnswer> = files
            .iter()
            .zip(status)
            .map(|(f, s)| {
                let day = f.result.as_ref().ok();
                FileAnswer {
                    path: f.path.clone(),
                    sha256: f.sha256.clone(),
                    vehicle: f.vehicle.clone(),
                    day: f.day.clone(),
                    status: s.word(),
                    message: s.message().to_owned(),
                    hours: day.map(|d| d.hours),
                    rate_hz: day.map(|d| d.rate_hz),
                    missing: day.map(|d| d.missing),
                    findings: day.map_or_else(Vec::new, |d| d.findings.clone()),
                }
            })
            .collect();
        listed.sort_by(|a, b| a.path.cmp(&b.path));
        Self {
            title: job.title.clone(),
            slope: kernel.law.slope,
            vehicles,
            reference: compared.reference.map(|r| r.answer),
            mission: compared.mission.as_ref().and_then(MissionSums::answer),
            files: listed,
        }
    }

    /// Returns the findings of the fleet: files that don't count, dead gauges, findings of single records.
    pub(super) fn findings(
        &self,
        files: &[FileHead],
        status: &[Status],
        days_in: DayOrder,
    ) -> Vec<Finding> {
        let mut out = Vec::new();
        for (file, status) in files.iter().zip(status) {
            let (severity, code, remedy) = match status {
                Status::Done => continue,
                Status::Failed(_) => (
                    Severity::Error,
                    "fleet-file-failed",
                    "repair the file, or leave it out",
                ),
                Status::Copy(_) => (
                    Severity::Warning,
                    "fleet-second-copy",
                    "keep one file for each day",
                ),
                Status::Foreign(_) => (
                    Severity::Error,
                    "fleet-copy-of-another",
                    "correct the vehicle in the name of one of them, or leave one out",
                ),
                // The hours and damage of this file were requested, and are missing.
                Status::Second(_) => (
                    Severity::Error,
                    "fleet-day-twice",
                    "keep one file for each day; if both are valid, let {day} in [fleet] file_name contain the part that differs",
                ),
            };
            out.push(Finding::new(
                severity,
                code,
                &file.path,
                status.message(),
                remedy,
            ));
        }
        out.extend(of_records(files, status, days_in));
        for v in &self.vehicles {
            let dead = v.gauges.iter();
            out.extend(dead.filter_map(|g| g.dead_days_finding(&v.name, v.days.len())));
            out.extend(v.gain_changes());
            out.extend(report_unreliable_damage(v));
            out.extend(v.loads.iter().filter_map(|l| known_in_part(v, l)));
            out.extend(v.loads.iter().filter_map(|l| mostly_noise(&v.name, l)));
        }
        out
    }
}

/// Returns the finding that noise causes most of the counted damage.
fn mostly_noise(vehicle: &str, l: &VehicleLoadAnswer) -> Option<Finding> {
    /// Limit of the noise bias, as a share of the counted damage.
    const MOST: f64 = 0.5;
    let share = l.noise_bias / l.damage_counted;
    (share > MOST).then(|| {
        let message = format!(
            "noise causes {:.0} % of the counted damage. The noise damage is estimated with added noise and subtracted; the interval of \
             the remaining damage includes its uncertainty",
            100.0 * share
        );
        let remedy = "filter the record below the noise, or place gauges with a higher sensitivity to this load";
        let subject = format!("{vehicle} {}", l.load);
        Finding::new(Severity::Warning, "damage-of-noise", subject, message, remedy)
            .with_numbers(share, MOST)
    })
}

/// Returns the finding that a load is known for less time than other loads; its damage covers fewer hours.
fn known_in_part(v: &VehicleAnswer, l: &VehicleLoadAnswer) -> Option<Finding> {
    /// Limit of the missing hours, as a share of all hours. The corresponding difference in damage is small against the differences between days.
    const MISSING: f64 = 0.05;
    let missing = 1.0 - l.hours / v.hours;
    (missing > MISSING).then(|| {
        let message = format!(
            "the gauges determine it in {:.4} of {:.4} hours only, and its damage is the damage of these hours",
            l.hours, v.hours
        );
        let remedy = "repair the gauges that are missing on some days, or add gauges; until then compare its damage per hour";
        let subject = format!("{} {}", v.name, l.load);
        let found = Finding::new(Severity::Warning, "load-known-in-part", subject, message, remedy);
        found.with_numbers(missing, MISSING)
    })
}

/// Returns the finding with the share of a vehicle's damage that comes from days with unreliable loads.
fn report_unreliable_damage(v: &VehicleAnswer) -> Option<Finding> {
    let first = v.doubtful_days.first()?;
    let share = |l: &VehicleLoadAnswer| format!("{} {:.1} %", l.load, 100.0 * l.doubtful_share);
    let shares: Vec<String> = v.loads.iter().map(share).collect();
    let most = v.loads.iter().map(|l| l.doubtful_share).fold(0.0, f64::max);
    let message = format!(
        "on {} of {} days (the first {first}) the loads do not explain the strain, and the damage of these days is in the sums. Share by \
         load: {}. The intervals of the sums do not include this error",
        v.doubtful_days.len(),
        v.days.len(),
        list_few(&shares)
    );
    let remedy = "correct the causes in the findings of these records, or leave the records out";
    let found = Finding::new(Severity::Error, "damage-in-doubt", &v.name, message, remedy);
    Some(found.with_numbers(most, 0.0))
}
