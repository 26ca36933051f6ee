//! Channels of a vehicle record with the opposite sign, in another unit, or with exchanged names.
//!
//! Three kinds of evidence are used in this order. The first is gravity in the means of accelerometers. The second is motion that the equations of
//! the vehicle explain only with a corrected channel. The third is the masses from the equations.

use crate::estimate::median;
use crate::finding::{Finding, Severity, list_few};
use crate::units::{Quantity, STANDARD_GRAVITY_M_S2, find_unit, number};
use rayon::prelude::*;

mod gravity;
mod scale;
#[cfg(test)]
mod tests;

pub use gravity::{channels_by_gravity, faults_by_gravity, finding_by_weight, findings_by_gravity};
pub use scale::{MotionScale, finding_of_scale};

/// Thresholds of the search.
struct MotionRules {
    /// Relative distance between the mean of an accelerometer and gravity up to which it shows gravity: offsets of sensors are up to a tenth.
    gravity: f64,
    /// Unexplained share of the motion up to which the inputs are not tested. Models of real vehicles leave up to a tenth unexplained.
    unexplained: f64,
    /// Largest share of the unexplained squared motion that may remain after a correction. Dominant effects of `reconcile` have the same limit.
    left: f64,
    /// Ratio of unexplained shares up to which two corrections fit equally well. Noise floors differ by this ratio.
    alike: f64,
    /// Largest ratio of a channel's rms to the median of the other channels of its kind at which a unit is possible. Hubs move ten times as much as
    /// the body.
    apart: f64,
    /// Smallest and largest mass that one wheel of a vehicle carries, kg: from a light trailer to a mining truck.
    mass_kg: [f64; 2],
}

const RULES: MotionRules = MotionRules {
    gravity: 0.15,
    unexplained: 0.15,
    left: 0.1,
    alike: 1.5,
    apart: 30.0,
    mass_kg: [20.0, 120e3],
};

/// Quantity that a channel measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChannelKind {
    /// Vertical acceleration.
    Acceleration,
    /// Vertical force on a wheel.
    Force,
}

impl ChannelKind {
    /// Returns the units that records of this kind usually are in.
    fn usual_units(self) -> &'static [&'static str] {
        match self {
            Self::Acceleration => &["g", "m/s2", "mm/s2"],
            Self::Force => &["kN", "N", "kgf", "lbf"],
        }
    }

    /// Returns the size of a unit in SI; `None` if it is not a unit of this kind.
    pub fn unit_si(self, name: &str) -> Option<f64> {
        match (self, name) {
            // `g` is standard gravity here. As a unit of mass it is a gram.
            (Self::Acceleration, "g" | "G" | "g0" | "gn") => Some(STANDARD_GRAVITY_M_S2),
            (Self::Acceleration, _) => find_unit(Quantity::Acceleration, name).map(|u| u.si),
            (Self::Force, _) => find_unit(Quantity::Force, name).map(|u| u.si),
        }
    }

    fn plural_name(self) -> &'static str {
        match self {
            Self::Acceleration => "accelerations",
            Self::Force => "wheel forces",
        }
    }
}

/// A channel of a record, in the units of the caller.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionChannel<'a> {
    /// Name in the file.
    pub name: &'a str,
    /// Quantity that the channel measures.
    pub kind: ChannelKind,
    /// Whether the file states its unit.
    pub is_unit_stated: bool,
    /// Unit that the channel is read in: the stated unit, or the unit of the job.
    pub unit: String,
    /// Mean of the samples.
    pub mean: f64,
    /// Standard deviation of the samples.
    pub scatter: f64,
}

/// Channel that replaces another channel, with a factor on the samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelSource {
    /// Number of the channel whose samples are used.
    pub from: usize,
    /// Factor on the samples.
    pub factor: f64,
}

/// A record of motion with the misfit of its vehicle.
pub struct MotionRecord<'a> {
    /// Channels that the equations use.
    pub channels: Vec<MotionChannel<'a>>,
    /// Acceleration of gravity in the unit of the samples.
    pub gravity: f64,
    /// Function that returns the share of the motion that the vehicle does not explain (0 to 1), with a source for each channel. Parameters keep
    /// their natural signs. `None` if there is nothing to compare.
    pub unexplained: Box<dyn Fn(&[ChannelSource]) -> Option<f64> + Sync + 'a>,
}

/// A fault of channels.
#[derive(Clone, Debug, PartialEq)]
pub enum MotionFault {
    /// Channels with the opposite sign.
    Sign(Vec<usize>),
    /// Channels in another unit than the one that they are read in: its name, and the factor on their samples.
    Unit(Vec<usize>, &'static str, f64),
    /// Two channels under each other's name.
    Exchanged([usize; 2]),
}

/// A fault that explains the motion.
#[derive(Clone, Debug, PartialEq)]
pub struct ExplainedFault {
    /// The fault.
    pub fault: MotionFault,
    /// Unexplained share of the motion as recorded.
    pub before: f64,
    /// Unexplained share of the motion with the fault corrected.
    pub after: f64,
    /// Other faults that explain the record equally well.
    pub alternatives: Vec<MotionFault>,
}

impl MotionFault {
    /// Corrects the sources of channels.
    fn correct(&self, sources: &mut [ChannelSource]) {
        match self {
            Self::Sign(list) => list.iter().for_each(|c| sources[*c].factor *= -1.0),
            Self::Unit(list, _, factor) => {
                list.iter().for_each(|c| sources[*c].factor *= factor);
            }
            Self::Exchanged([a, b]) => sources.swap(*a, *b),
        }
    }

    fn code(&self) -> &'static str {
        match self {
            Self::Sign(_) => "input-sign-reversed",
            Self::Unit(..) => "input-unit",
            Self::Exchanged(_) => "inputs-exchanged",
        }
    }

    fn channels(&self) -> &[usize] {
        match self {
            Self::Sign(list) | Self::Unit(list, ..) => list,
            Self::Exchanged(pair) => pair,
        }
    }

    /// Returns the subject of its finding: `all` for all channels of a kind.
    fn subject(&self, channels: &[MotionChannel]) -> String {
        let own = self.channels();
        match (self, kind_of_all(own, channels)) {
            (Self::Exchanged(_), _) | (_, None) => list_few(&names(own, channels)),
            _ => "all".to_owned(),
        }
    }

    /// Describes it: "`f_wheel` has reversed sign".
    fn describe(&self, channels: &[MotionChannel]) -> String {
        let own = self.channels();
        let quoted: Vec<String> = names(own, channels)
            .iter()
            .map(|n| format!("`{n}`"))
            .collect();
        let (who, many) = match kind_of_all(own, channels) {
            Some(kind) => (format!("all {}", kind.plural_name()), true),
            None => (list_few(&quoted), own.len() > 1),
        };
        match self {
            Self::Sign(_) => {
                format!("{who} {} reversed sign", if many { "have" } else { "has" })
            }
            Self::Unit(_, unit, _) => {
                let read = own.first().map_or("", |c| channels[*c].unit.as_str());
                format!(
                    "{who} {} in {unit} and {} read as {read}",
                    if many { "are" } else { "is" },
                    if many { "are" } else { "is" }
                )
            }
            Self::Exchanged(_) => format!("{} are exchanged", quoted.join(" and ")),
        }
    }

    /// Returns the remedy.
    fn remedy(&self, channels: &[MotionChannel]) -> String {
        let own = names(self.channels(), channels);
        let first = own.first().copied().unwrap_or_default();
        match self {
            Self::Sign(_) => format!(
                "Correct the sign in the file, or state it in the job: corrections = {{ {} }} in [vehicle].",
                own.iter()
                    .map(|n| format!("{n} = {{ gain = -1.0 }}"))
                    .collect::<Vec<_>>()
                    .join(", ")
            ),
            Self::Unit(_, unit, _) => {
                format!("State the unit after the name of the channel: `{first} [{unit}]`.")
            }
            Self::Exchanged(_) => {
                let second = own.get(1).copied().unwrap_or_default();
                format!(
                    "Exchange the names in the file, or state them in the job: columns = {{ {first} = \"{second}\", {second} = \"{first}\" }} in \
                     [vehicle]."
                )
            }
        }
    }
}

fn names<'a>(list: &[usize], channels: &[MotionChannel<'a>]) -> Vec<&'a str> {
    list.iter()
        .filter_map(|c| channels.get(*c))
        .map(|c| c.name)
        .collect()
}

/// Returns the kind of channel if `list` contains all channels of this kind and there are several.
fn kind_of_all(list: &[usize], channels: &[MotionChannel]) -> Option<ChannelKind> {
    let kind = channels.get(*list.first()?)?.kind;
    let all = of_kind(channels, kind);
    (all.len() > 1 && list == all).then_some(kind)
}

fn of_kind(channels: &[MotionChannel], kind: ChannelKind) -> Vec<usize> {
    (0..channels.len())
        .filter(|c| channels[*c].kind == kind)
        .collect()
}

/// Returns the units that a channel may have instead of its stated unit, with the factors on its samples.
fn other_units(c: &MotionChannel) -> Vec<(&'static str, f64)> {
    let si = |name: &str| c.kind.unit_si(name).unwrap_or(f64::NAN);
    let each = c.kind.usual_units().iter();
    each.map(|name| (*name, si(name) / si(&c.unit)))
        .filter(|(_, factor)| (factor - 1.0).abs() > RULES.gravity)
        .collect()
}

/// Returns the fault that explains the motion, with the alternative faults that fit equally well. `None` if the vehicle explains the motion as
/// recorded, or if no single fault explains it. Faults that gravity shows are corrected first.
pub fn fault_of_motion(record: &MotionRecord) -> Option<ExplainedFault> {
    let channels = &record.channels;
    let mut recorded: Vec<ChannelSource> = (0..channels.len())
        .map(|from| ChannelSource { from, factor: 1.0 })
        .collect();
    for fault in faults_by_gravity(channels, record.gravity) {
        fault.correct(&mut recorded);
    }
    let before = (record.unexplained)(&recorded)?;
    if before < RULES.unexplained {
        return None;
    }
    let try_all = |faults: Vec<MotionFault>| -> Vec<(MotionFault, f64, i32)> {
        let each = faults.into_par_iter().filter_map(|fault| {
            let mut sources = recorded.clone();
            fault.correct(&mut sources);
            let after = (record.unexplained)(&sources)?;
            let enough = after * after <= RULES.left * before * before;
            enough.then(|| (fault, after, agreement(record, &sources)))
        });
        each.collect()
    };
    let mut tried = try_all(reversed_and_exchanged(channels));
    tried.extend(try_all(units_of_all(channels)));
    if tried.is_empty() {
        tried = try_all(units_of_one(channels));
    }
    let least = tried.iter().map(|t| t.1).fold(f64::INFINITY, f64::min);
    let mut alike: Vec<_> = tried
        .into_iter()
        .filter(|t| t.1 <= RULES.alike * least)
        .collect();
    let most = alike.iter().map(|t| t.2).max()?;
    alike.retain(|t| t.2 == most);
    let mut alike = alike.into_iter();
    let (fault, after, _) = alike.next()?;
    Some(ExplainedFault {
        fault,
        before,
        after,
        alternatives: alike.map(|t| t.0).collect(),
    })
}

fn kinds_of(channels: &[MotionChannel]) -> [Vec<usize>; 2] {
    [ChannelKind::Force, ChannelKind::Acceleration].map(|k| of_kind(channels, k))
}

/// Returns every sign, the signs of all channels of a kind, and the pairs of a kind.
fn reversed_and_exchanged(channels: &[MotionChannel]) -> Vec<MotionFault> {
    let kinds = kinds_of(channels);
    let groups = || kinds.iter().filter(|k| k.len() > 1);
    let mut out: Vec<MotionFault> = Vec::new();
    out.extend(kinds.iter().flatten().map(|c| MotionFault::Sign(vec![*c])));
    out.extend(groups().map(|k| MotionFault::Sign(k.clone())));
    for list in groups() {
        for (i, a) in list.iter().enumerate() {
            let later = list.iter().skip(i + 1);
            out.extend(later.map(|b| MotionFault::Exchanged([*a, *b])));
        }
    }
    out
}

/// Returns the other units of all channels of a kind that are read in one unit.
fn units_of_all(channels: &[MotionChannel]) -> Vec<MotionFault> {
    let kinds = kinds_of(channels);
    let each = kinds.iter().flat_map(|list| {
        let first = list.first().map(|c| &channels[*c]);
        let is_one = |first: &&MotionChannel| list.iter().all(|c| channels[*c].unit == first.unit);
        let units = first.filter(is_one).map(other_units).unwrap_or_default();
        let unit = |(name, f)| MotionFault::Unit(list.clone(), name, f);
        units.into_iter().map(unit).collect::<Vec<_>>()
    });
    each.collect()
}

/// Returns the other units of one of several channels that are possible by the size of its samples.
fn units_of_one(channels: &[MotionChannel]) -> Vec<MotionFault> {
    let mut out: Vec<MotionFault> = Vec::new();
    for list in kinds_of(channels).iter().filter(|k| k.len() > 1) {
        for &c in list {
            let others = list.iter().filter(|o| **o != c);
            let middle = median(others.map(|o| channels[*o].scatter).collect()).unwrap_or(0.0);
            let possible = |(_, f): &(&str, f64)| {
                let ratio = f * channels[c].scatter / middle;
                (1.0 / RULES.apart..RULES.apart).contains(&ratio)
            };
            let units = other_units(&channels[c]).into_iter().filter(possible);
            out.extend(units.map(|(name, f)| MotionFault::Unit(vec![c], name, f)));
        }
    }
    out
}

/// Returns whether a mean is the static value: gravity of an accelerometer, or the weight of wheel forces.
pub fn shows(mean: f64, gravity: f64) -> bool {
    (mean / gravity - 1.0).abs() < RULES.gravity
}

/// Returns how many means agree with gravity and with wheels that press on the road, less those that contradict.
fn agreement(record: &MotionRecord, sources: &[ChannelSource]) -> i32 {
    let each = record.channels.iter().zip(sources).map(|(c, s)| {
        let from = &record.channels[s.from];
        let (mean, scatter) = (s.factor * from.mean, from.scatter * s.factor.abs());
        let [with, against] = match c.kind {
            ChannelKind::Acceleration => {
                [shows(mean, record.gravity), shows(-mean, record.gravity)]
            }
            ChannelKind::Force => [mean > scatter, -mean > scatter],
        };
        i32::from(with) - i32::from(against)
    });
    each.sum()
}

/// Returns the finding on [`fault_of_motion`], an error.
pub fn finding_of_motion(record: &MotionRecord) -> Option<Finding> {
    let found = fault_of_motion(record)?;
    let percent = |share: f64| number(100.0 * share);
    let others: Vec<String> = found
        .alternatives
        .iter()
        .map(|f| f.describe(&record.channels))
        .collect();
    let others = match others.is_empty() {
        true => String::new(),
        false => format!(
            " The record fits equally well if {}.",
            others.join(", or if ")
        ),
    };
    let message = format!(
        "{}: the model leaves {} % of the motion unexplained as recorded, and {} % with the correction.{others}",
        found.fault.describe(&record.channels),
        percent(found.before),
        percent(found.after)
    );
    let subject = found.fault.subject(&record.channels);
    let remedy = found.fault.remedy(&record.channels);
    let code = found.fault.code();
    Some(
        Finding::new(Severity::Error, code, subject, message, remedy)
            .with_numbers(found.before, RULES.unexplained),
    )
}
