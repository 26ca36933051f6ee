//! Faults of measured channels: the change of the readings by each fault, and the finding that reports it.

use crate::finding::{Finding, Severity};
use crate::linalg::Matrix;
use crate::units::{MICROSTRAIN, number};

/// One gauge by its number, or all gauges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channels {
    /// One gauge.
    One(usize),
    /// All gauges.
    All,
}

/// A fault of measured channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InputFault {
    /// Readings have the opposite sign.
    Sign(Channels),
    /// A gauge reads this multiple of the strain: its unit is another.
    Unit(usize, f64),
    /// A gauge reads this share of the strain.
    Gain(usize, f64),
    /// A gauge reads so much more than the strain in all runs.
    Offset(usize, f64),
    /// A gauge reads nothing.
    Dead(usize),
    /// A gauge gives one reading in all runs.
    Stuck(usize),
    /// Two gauges have each other's readings.
    Exchanged(usize, usize),
    /// Gauges are on the other surface than their table states.
    OtherSide(Channels),
    /// Angles of the table are in radians.
    Radians(Channels),
    /// A gauge contradicts the other gauges, and no other fault of this list explains it.
    Unlike(usize),
}

/// Readings by run and gauge (NaN if missing), and the rows of S for the comparison.
#[derive(Clone, Debug)]
pub struct Inputs {
    /// Strain by run and gauge.
    pub strain: Vec<Vec<f64>>,
    /// S, strain per unit of load, with a row for each gauge.
    pub rows: Matrix,
}

/// Rows of S for another installation of the gauges.
#[derive(Clone, Debug)]
pub struct AlternativeRows {
    /// [`InputFault::OtherSide`] or [`InputFault::Radians`] of a gauge.
    pub fault: fn(Channels) -> InputFault,
    /// S with every gauge in this installation.
    pub rows: Matrix,
    /// Whether this is possible for a gauge.
    pub applies: Vec<bool>,
}

impl AlternativeRows {
    /// Returns the rows of these gauges, in their order.
    pub fn of_gauges(&self, gauges: &[usize]) -> Self {
        let k = self.rows.ncols();
        Self {
            fault: self.fault,
            rows: Matrix::from_fn(gauges.len(), k, |i, l| self.rows[(gauges[i], l)]),
            applies: gauges.iter().map(|g| self.applies[*g]).collect(),
        }
    }
}

/// Remedy if all readings have the opposite sign.
pub const SIGN_OF_ALL: &str =
    "check the sign of the channels; if so, write a [[correction]] with sign = -1 for each gauge";

impl InputFault {
    /// Returns the gauges of the fault; an empty list for a fault of all gauges.
    pub fn gauges(&self) -> Vec<usize> {
        match *self {
            Self::Sign(c) | Self::OtherSide(c) | Self::Radians(c) => match c {
                Channels::One(g) => vec![g],
                Channels::All => Vec::new(),
            },
            Self::Unit(g, _) | Self::Gain(g, _) | Self::Offset(g, _) => vec![g],
            Self::Dead(g) | Self::Stuck(g) | Self::Unlike(g) => vec![g],
            Self::Exchanged(a, b) => vec![a, b],
        }
    }

    /// Returns whether the fault is that gauges are not installed as their table states.
    pub fn is_of_installation(&self) -> bool {
        matches!(self, Self::OtherSide(_) | Self::Radians(_))
    }

    /// Returns the inputs without the fault: corrected, or without the readings of a gauge that cannot be corrected.
    pub fn correct_inputs(&self, inputs: &Inputs, alternatives: &[AlternativeRows]) -> Inputs {
        let mut out = inputs.clone();
        let of = self.gauges();
        let of = |g: usize| of.is_empty() || of.contains(&g);
        match *self {
            Self::Exchanged(a, b) => out.strain.iter_mut().for_each(|run| run.swap(a, b)),
            Self::OtherSide(_) | Self::Radians(_) => {
                let rows = alternatives.iter().find(|a| {
                    std::mem::discriminant(&(a.fault)(Channels::All))
                        == std::mem::discriminant(self)
                });
                for g in (0..out.rows.nrows()).filter(|g| of(*g)) {
                    for l in 0..out.rows.ncols() {
                        out.rows[(g, l)] = rows.map_or(f64::NAN, |a| a.rows[(g, l)]);
                    }
                }
            }
            _ => {
                let change = |v: f64| match *self {
                    Self::Sign(_) => -v,
                    Self::Unit(_, factor) | Self::Gain(_, factor) => v / factor,
                    Self::Offset(_, offset) => v - offset,
                    _ => f64::NAN,
                };
                for run in &mut out.strain {
                    for (_, v) in run.iter_mut().enumerate().filter(|(g, _)| of(*g)) {
                        *v = change(*v);
                    }
                }
            }
        }
        out
    }

    /// Returns the code of its finding.
    fn code(&self) -> &'static str {
        match self {
            Self::Sign(_) => "input-sign-reversed",
            Self::Unit(..) => "input-unit",
            Self::Exchanged(..) => "inputs-exchanged",
            Self::OtherSide(_) => "gauge-other-side",
            Self::Radians(_) => "gauge-angle-in-radians",
            Self::Dead(_) => "gauge-dead",
            Self::Stuck(_) => "gauge-silent",
            Self::Gain(..) | Self::Offset(..) | Self::Unlike(_) => "gauge-suspect",
        }
    }

    /// Returns the subject of the fault: the names of its gauges, or `all`.
    fn subject(&self, names: &[String]) -> String {
        let list: Vec<&str> = (self.gauges().iter())
            .filter_map(|g| Some(names.get(*g)?.as_str()))
            .collect();
        match list.is_empty() {
            true => "all".to_owned(),
            false => list.join(", "),
        }
    }

    /// Returns a clause that describes the fault.
    pub fn clause(&self, names: &[String]) -> String {
        let name = |g: usize| names.get(g).map_or("", String::as_str);
        match *self {
            Self::Sign(Channels::One(g)) => format!("gauge `{}` has reversed sign", name(g)),
            Self::Sign(Channels::All) => "all readings have reversed sign".to_owned(),
            Self::Unit(g, factor) => format!(
                "gauge `{}` reads {} times the strain, as with another unit",
                name(g),
                number(factor)
            ),
            Self::Gain(g, gain) => format!(
                "gauge `{}` reads {} of the strain that the others predict",
                name(g),
                number(gain)
            ),
            Self::Offset(g, offset) => format!(
                "gauge `{}` is offset by {} microstrain in all runs",
                name(g),
                number(offset / MICROSTRAIN)
            ),
            Self::Dead(g) => format!("gauge `{}` has no signal", name(g)),
            Self::Stuck(g) => format!("gauge `{}` has a constant reading in all runs", name(g)),
            Self::Exchanged(a, b) => {
                format!(
                    "gauges `{}` and `{}` have each other's readings",
                    name(a),
                    name(b)
                )
            }
            Self::OtherSide(Channels::One(g)) => format!(
                "gauge `{}` is on the opposite surface to its table",
                name(g)
            ),
            Self::OtherSide(Channels::All) => {
                "all gauges are on the opposite surface to their table".to_owned()
            }
            Self::Radians(Channels::One(g)) => {
                format!("the stated angle of gauge `{}` is in radians", name(g))
            }
            Self::Radians(Channels::All) => {
                "the stated angles of all gauges are in radians".to_owned()
            }
            Self::Unlike(g) => format!("gauge `{}` contradicts the others", name(g)),
        }
    }

    /// Returns the remedy: the line of the job, if one corrects the fault.
    fn remedy(&self, names: &[String]) -> String {
        let line = |g: usize, value: String| {
            let name = names.get(g).map_or("", String::as_str);
            format!("[[correction]] gauge = \"{name}\", {value}")
        };
        match *self {
            Self::Sign(Channels::One(g)) => format!(
                "check the wiring; if so, state it: {}",
                line(g, "sign = -1".to_owned())
            ),
            Self::Sign(Channels::All) => SIGN_OF_ALL.to_owned(),
            Self::Unit(g, factor) => format!(
                "check the unit of the channel; if so, state it: {}",
                line(g, format!("gain = {}", number(factor)))
            ),
            Self::Gain(g, gain) => format!(
                "check gauge factor, bridge factor, position and direction; state a known gain: {}, or exclude the gauge: ignore = true",
                line(g, format!("gain = {}", number(gain)))
            ),
            Self::Offset(g, offset) => format!(
                "check the zero of the gauge; state a known offset: {}, or exclude the gauge: ignore = true",
                line(
                    g,
                    format!("offset_microstrain = {}", number(offset / MICROSTRAIN))
                )
            ),
            Self::Dead(g) | Self::Stuck(g) => format!(
                "check wiring and channel, or exclude the gauge: {}",
                line(g, "ignore = true".to_owned())
            ),
            Self::Exchanged(a, b) => {
                let other = names.get(b).map_or("", String::as_str);
                let line = line(a, format!("exchanged_with = \"{other}\""));
                format!("check columns and plugs; if so, state it: {line}")
            }
            Self::OtherSide(_) => {
                "correct `surface` in the table of gauges (top is Z2, bottom Z1 of the element)"
                    .to_owned()
            }
            Self::Radians(_) => "state `angle_deg` in degrees".to_owned(),
            Self::Unlike(g) => format!(
                "check its position, direction, bridge factor and wiring, or exclude it: {}",
                line(g, "ignore = true".to_owned())
            ),
        }
    }
}

/// A fault that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct DetectedFault {
    /// The fault.
    pub fault: InputFault,
    /// Share of the reduced sum of squares that remains after correction of the fault.
    pub share: f64,
    /// Limit of `share`, or of `sigmas`.
    pub limit: f64,
    /// Number of sigmas by which the gauge contradicts the other gauges, if errors come from scatter. It is a root mean square over the runs.
    pub sigmas: Option<f64>,
    /// Size of the gauge's readings, and size of their prediction from the other gauges, strain.
    pub sizes: [f64; 2],
    /// Largest shift of a load, divided by the half width of its interval. `None` if loads are known.
    pub moves: Option<f64>,
    /// Whether the fault is found only after correction of the other faults.
    pub together: bool,
    /// Faults that explain the readings equally well.
    pub alternatives: Vec<InputFault>,
}

/// Treatment of the gauges of a fault by the command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultTreatment {
    /// The result uses the readings as they are.
    AsMeasured,
    /// The readings of these gauges are left out.
    LeftOut,
}

impl DetectedFault {
    /// Returns the finding on a fault of gauges with these names. It is an error if the result includes the fault and changes by more than its
    /// interval, or by an unknown amount.
    pub fn finding(&self, names: &[String], handling: FaultTreatment) -> Finding {
        let left_out = handling == FaultTreatment::LeftOut && !self.fault.gauges().is_empty();
        let severity = match self.moves {
            _ if left_out => Severity::Warning,
            Some(ratio) if ratio <= 1.0 => Severity::Warning,
            _ => Severity::Error,
        };
        let mut message = self.fault.clause(names);
        if let (InputFault::Dead(_) | InputFault::Stuck(_), [reads, expected]) =
            (self.fault, self.sizes)
        {
            message += &format!(
                " ({} microstrain), and {} microstrain is predicted from the other gauges",
                number(reads / MICROSTRAIN),
                number(expected / MICROSTRAIN)
            );
        }
        let how = match (self.fault, self.together) {
            (InputFault::Dead(_) | InputFault::Stuck(_) | InputFault::Unlike(_), false) => {
                "without it"
            }
            (_, false) => "with this corrected",
            (_, true) => "with all identified faults corrected",
        };
        message += &format!(
            ": {how}, the residual sum of squares falls to {} % of its value",
            number(100.0 * self.share)
        );
        if let Some(sigmas) = self.sigmas {
            message += &format!(" ({} sigma)", number(sigmas));
        }
        if let Some(ratio) = self.moves.filter(|r| *r > 1.0 && !left_out) {
            message += &format!(
                "; the fault changes a load by {} times the half width of its interval",
                number(ratio)
            );
        }
        if left_out {
            message += ". The gauge is excluded here";
        }
        if !self.alternatives.is_empty() {
            let each = self.alternatives.iter().map(|a| a.clause(names));
            message += &format!(
                ". Alternative explanations: {}",
                each.collect::<Vec<_>>().join("; ")
            );
        }
        Finding::new(
            severity,
            self.fault.code(),
            self.fault.subject(names),
            message,
            self.fault.remedy(names),
        )
        .with_numbers(self.share, self.limit)
    }
}

/// Returns the findings on recorded loads that findings on gauges do not explain. The list is empty if all gauges are installed otherwise than
/// stated, because recorded loads with the opposite sign give the same residual.
pub fn not_explained_by(of_gauges: &[Finding], of_records: Vec<Finding>) -> Vec<Finding> {
    let installed = ["gauge-other-side", "gauge-angle-in-radians"];
    let all = |f: &Finding| f.subject == "all" && installed.contains(&f.code);
    match of_gauges.iter().any(all) {
        true => Vec::new(),
        false => of_records,
    }
}
