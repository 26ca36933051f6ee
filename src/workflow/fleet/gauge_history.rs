//! A gauge of a vehicle over its days: parts in which it was dead, and changes of its gain.

use super::day::GaugeDay;
use crate::estimate::median;
use crate::finding::{Finding, Severity};
use serde::Serialize;

/// Factor on the reading of its typical day below which a gauge counts as dead on a day.
const DEAD: f64 = 0.01;
/// Factor on the readings of their typical days that most gauges exceed on a day when the vehicle moves. On other days a small reading is no sign of
/// a fault.
const MOVES: f64 = 0.1;
/// Smallest relative change of a gain that counts. Glue, wires and amplifiers of a sound gauge cause much less. A gauge with less than this share of
/// the reading predicted from the other gauges gives no signal.
const OFF: f64 = 0.1;
/// Codes of findings that identify the cause in a record. Gains and zeros of that day are then invalid.
const CAUSES: [&str; 3] = ["inputs-exchanged", "input-sign-reversed", "gauge-dead"];

/// History of a gauge of a vehicle over its days.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GaugeHistory {
    /// Name of the gauge.
    pub name: String,
    /// Days on which the gauge is dead (no readings) or stuck (constant), all day or for a part of it.
    pub dead_days: Vec<String>,
    /// Parts of days in which the gauge is dead or stuck.
    pub dead_parts: Vec<DeadPart>,
    /// Mean reading of each day, microstrain.
    pub mean: Vec<Option<f64>>,
    /// Standard deviation of the readings on each day, microstrain.
    #[serde(skip)]
    pub sd: Vec<Option<f64>>,
    /// Noise of each day, microstrain.
    pub noise: Vec<Option<f64>>,
    /// Gain relative to the prediction from the other gauges, on each day.
    pub gain: Vec<Option<f64>>,
    /// Mean reading minus the prediction from the other gauges, on each day, microstrain.
    pub offset: Vec<Option<f64>>,
    /// Leverage of the gauge on its own prediction, on each day.
    #[serde(skip)]
    pub leverage: Vec<f64>,
}

/// A part of a day on which a gauge was dead.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DeadPart {
    /// The day.
    pub day: String,
    /// Begin of the part, in hours from the record's first sample.
    pub from: f64,
    /// End of the part, in hours from the record's first sample.
    pub to: f64,
}

/// A lasting change of the gain from one day on.
pub(super) struct GainChange {
    /// Number of the first day.
    pub from: usize,
    /// Absolute value of the natural log of the new gain divided by the old gain.
    pub size: f64,
    pub finding: Finding,
}

/// Returns the typical reading of a gauge: the median of its standard deviations over the days with readings.
fn typical_reading(days: &[GaugeDay]) -> f64 {
    let sds = days.iter().map(|d| d.sd).filter(|s| s.is_finite());
    median(sds.collect()).unwrap_or(0.0)
}

/// Returns for each day whether the vehicle moves, according to the gauges with readings.
pub(super) fn moving_days(gauges: &[(String, Vec<GaugeDay>)], n_days: usize) -> Vec<bool> {
    let typical: Vec<f64> = gauges.iter().map(|g| typical_reading(&g.1)).collect();
    let moves = |day: usize| {
        let of = gauges.iter().zip(&typical).filter(|g| *g.1 > 0.0);
        let shares = of.filter_map(|((_, days), typical)| Some(days.get(day)?.sd / typical));
        let shares = shares.filter(|s| s.is_finite()).collect();
        median(shares).is_none_or(|share| share > MOVES)
    };
    (0..n_days).map(moves).collect()
}

impl GaugeHistory {
    /// Returns the history of gauge `name` over the days with these names. `moves`: whether the vehicle moved on each day.
    pub(super) fn from_days(
        name: &str,
        days: &[GaugeDay],
        names: &[String],
        moves: &[bool],
    ) -> Self {
        let typical = typical_reading(days);
        let finite = |x: f64| x.is_finite().then_some(x);
        let is_dead = |(d, moves): (&GaugeDay, &bool)| {
            // If spikes dominate the typical day, a gauge that follows the other gauges is not dead.
            let follows = d.gain.abs() > OFF;
            let quiet = *moves && d.sd <= DEAD * typical && !follows;
            !d.sd.is_finite() || quiet || !d.dead.is_empty()
        };
        let dead: Vec<bool> = days.iter().zip(moves).map(is_dead).collect();
        let parts = days.iter().zip(names).flat_map(|(d, day)| {
            let part = |[from, to]: &[f64; 2]| DeadPart {
                day: day.clone(),
                from: *from,
                to: *to,
            };
            d.dead.iter().map(part)
        });
        Self {
            name: name.to_owned(),
            dead_days: names
                .iter()
                .zip(&dead)
                .filter(|(_, dead)| **dead)
                .map(|(n, _)| n.clone())
                .collect(),
            dead_parts: parts.collect(),
            mean: days.iter().map(|d| finite(d.mean)).collect(),
            sd: days.iter().map(|d| finite(d.sd)).collect(),
            noise: days.iter().map(|d| finite(d.noise)).collect(),
            gain: days.iter().map(|d| finite(d.gain)).collect(),
            offset: days.iter().map(|d| finite(d.offset)).collect(),
            leverage: days.iter().map(|d| d.leverage).collect(),
        }
    }

    /// Returns the hour from which the gauge was dead on a day; `None` if it was dead all day, or not at all.
    pub fn dead_from(&self, day: &str) -> Option<f64> {
        let part = self.dead_parts.iter().find(|p| p.day == day);
        part.map(|p| p.from)
    }

    /// Returns the finding that the gauge was dead on some of `of` days.
    pub(super) fn dead_days_finding(&self, vehicle: &str, of: usize) -> Option<Finding> {
        let first = self.dead_days.first()?;
        let n = self.dead_days.len();
        let from = match self.dead_from(first) {
            Some(hour) => format!(" from hour {hour:.3} of its record on"),
            None => String::new(),
        };
        let message = format!(
            "it has no readings, or a constant reading, on {n} of {of} days, the first {first}{from}"
        );
        let remedy = "repair it; while it was dead, the loads come from the other gauges if these determine them";
        let subject = format!("{vehicle} {}", self.name);
        let found = Finding::new(Severity::Warning, "gauge-silent", subject, message, remedy);
        Some(found.with_numbers(n as f64, 0.0))
    }

    /// Returns the lasting change of the gain from one day on, if it is large. Days in `misread` are left out: another finding identifies their
    /// cause.
    pub(super) fn gain_change(
        &self,
        vehicle: &str,
        days: &[String],
        misread: &[bool],
    ) -> Option<GainChange> {
        let known: Vec<(usize, f64)> = self
            .gain
            .iter()
            .enumerate()
            .filter(|(i, _)| misread.get(*i) != Some(&true))
            .filter_map(|(i, x)| Some((i, (*x)?)))
            .collect();
        let median = |list: &[(usize, f64)]| median(list.iter().map(|x| x.1).collect());
        // The cut is at the day with the smallest sum of deviations from the medians before and after. The jump of the medians alone is equal for all
        // cuts with most days on the correct side. At least two days are on each side, so that one odd day is not a change.
        let left = |list: &[(usize, f64)]| -> f64 {
            let middle = median(list).unwrap_or(0.0);
            list.iter().map(|x| (x.1 - middle).abs()).sum()
        };
        let cut = (2..known.len().saturating_sub(1)).min_by(|a, b| {
            let left_by = |c: usize| {
                let (before, after) = known.split_at(c);
                left(before) + left(after)
            };
            left_by(*a).total_cmp(&left_by(*b))
        })?;
        let (before, after) = known.split_at(cut);
        let (was, is) = (median(before)?, median(after)?);
        let half = 0.5 * (is - was).abs();
        let apart = after.iter().all(|x| (x.1 - was).abs() > half)
            && before.iter().all(|x| (x.1 - is).abs() > half);
        let from = after.first()?.0;
        let day = days.get(from)?;
        (apart && (is - was).abs() > OFF).then(|| GainChange {
            from,
            size: (is.abs().max(OFF) / was.abs().max(OFF)).ln().abs(),
            finding: Finding::new(
                Severity::Warning,
                "gauge_gain",
                format!("{vehicle} {}", self.name),
                format!("its gain relative to the other gauges is {was:.2} before {day} and {is:.2} from that day on"),
                "check its lead wires, amplifier and bond",
            )
            .with_numbers(is - was, OFF),
        })
    }
}

/// Returns whether a finding of a record identifies a cause that makes gains and zeros of its day invalid.
pub(super) fn is_misread(findings: &[Finding]) -> bool {
    findings.iter().any(|f| CAUSES.contains(&f.code))
}
