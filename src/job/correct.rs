//! `[[correction]]` applied to readings: a channel reads `sign gain strain + offset`.

use super::readings::readings_of;
use super::suggest;
use super::types::{Job, StrainCorrection};
use crate::finding::{Finding, Severity, list_few};
use crate::host::fault::{Fault, FaultList, Faults};

/// Correction that converts the readings of a channel to strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Channel {
    /// Offset that is subtracted first, microstrain.
    pub offset: f64,
    /// Divisor of the reading after subtraction of the offset.
    pub factor: f64,
    /// Whether the readings of the channel are ignored.
    pub ignore: bool,
}

impl Channel {
    /// Returns the correction that changes no reading: offset 0, factor 1.
    pub fn without_correction() -> Self {
        Self {
            offset: 0.0,
            factor: 1.0,
            ignore: false,
        }
    }

    /// Returns the corrected reading, microstrain; NaN for an ignored channel.
    pub fn put_right(self, reading: f64) -> f64 {
        if self.ignore {
            return f64::NAN;
        }
        (reading - self.offset) / self.factor
    }

    /// Returns whether the channel needs no correction.
    pub fn is_right(self) -> bool {
        self.offset == 0.0 && self.factor == 1.0 && !self.ignore
    }
}

/// Returns the correction of the readings of this gauge.
pub fn channel_of(corrections: &[StrainCorrection], gauge: &str) -> Channel {
    let own = corrections.iter().filter(|c| c.gauge == gauge);
    own.fold(
        Channel {
            offset: 0.0,
            factor: 1.0,
            ignore: false,
        },
        |a, c| Channel {
            offset: a.offset + c.offset_microstrain,
            factor: a.factor * c.sign * c.gain,
            ignore: a.ignore || c.ignore,
        },
    )
}

/// Returns the column that contains the readings of this gauge. It is the column of the other gauge if two gauges are exchanged.
pub fn column_of<'a>(corrections: &'a [StrainCorrection], gauge: &'a str) -> &'a str {
    corrections
        .iter()
        .find_map(|c| match &c.exchanged_with {
            Some(other) if c.gauge == gauge => Some(other.as_str()),
            Some(other) if other == gauge => Some(c.gauge.as_str()),
            _ => None,
        })
        .unwrap_or(gauge)
}

/// Returns the columns that contain the readings of gauges. Columns of ignored gauges are not needed.
pub fn columns_wanted<'a>(
    corrections: &[StrainCorrection],
    gauges: impl IntoIterator<Item = &'a String>,
) -> Vec<String> {
    gauges
        .into_iter()
        .filter(|g| !channel_of(corrections, g).ignore)
        .map(|g| column_of(corrections, g).to_owned())
        .collect()
}

/// Returns the rotation of a gauge from its stated angle, degrees.
pub fn turned_by(corrections: &[StrainCorrection], gauge: &str) -> f64 {
    let own = corrections.iter().filter(|c| c.gauge == gauge);
    own.filter_map(|c| c.angle_deg).sum()
}

/// Adds corrections of the legs to the corrections of rosettes, because the legs are the channels with readings. The angle rotates the whole rosette
/// and is not repeated.
pub(super) fn correct_legs(job: &mut Job, faults: &mut FaultList) {
    let legs_of = |name: &str| {
        let rosette = job.gauges.iter().find(|g| g.name == name)?;
        Some(readings_of(rosette)).filter(|_| rosette.rosette.is_some())
    };
    let mut of_legs = Vec::new();
    for c in &job.corrections {
        let other = c.exchanged_with.as_deref();
        let (own, others) = (legs_of(&c.gauge), other.map(legs_of));
        // A given S may have one row for a rosette, which is then one channel.
        if others.is_some_and(|o| o.is_some() != own.is_some()) && job.sensitivity.is_none() {
            faults.push(Fault::with_line(
                &*job.file,
                c.line,
                "correction.exchanged_with",
                format!(
                    "of `{}` and `{}` one is a rosette with three channels, the other one channel",
                    c.gauge,
                    other.unwrap_or_default()
                ),
                "name a leg of the rosette, such as `R1.a`",
            ));
        }
        let others = other.and_then(legs_of).unwrap_or_default();
        for (i, leg) in own.into_iter().flatten().enumerate() {
            of_legs.push(StrainCorrection {
                gauge: leg,
                exchanged_with: others.get(i).cloned(),
                angle_deg: None,
                of_rosette: true,
                ..c.clone()
            });
        }
    }
    job.corrections.extend(of_legs);
}

/// Refuses corrections of channels that are not among `known`, in a job that does not list its gauges; `place` is where these channels are.
///
/// # Errors
/// A fault for each of these corrections.
pub fn check_channels(job: &Job, known: &[String], place: &str) -> Result<(), Faults> {
    let mut faults = FaultList::new();
    for c in job.corrections.iter().filter(|_| job.gauges.is_empty()) {
        let named = std::iter::once(&c.gauge).chain(&c.exchanged_with);
        for name in named.filter(|n| !known.contains(n)) {
            faults.push(Fault::with_line(
                &*job.file,
                c.line,
                "correction.gauge",
                format!("{place} has no channel `{name}`"),
                suggest::remedy(name, known.iter().map(String::as_str)),
            ));
        }
    }
    Faults::check(faults)
}

/// Returns a note that names the corrections of the job; `None` without any.
pub fn report_corrections(job: &Job) -> Option<Finding> {
    let stated = job.corrections.iter().filter(|c| !c.of_rosette);
    let names: Vec<&str> = stated.map(|c| c.gauge.as_str()).collect();
    (!names.is_empty()).then(|| {
        Finding::new(
            Severity::Info,
            "corrections-applied",
            list_few(&names),
            "readings and angles of these gauges are corrected as [[correction]] states",
            "",
        )
    })
}
