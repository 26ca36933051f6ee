//! `[[correction]]` applied to readings: a channel reads `sign gain strain + offset`.

use super::types::{Job, StrainCorrection};
use crate::finding::{Finding, Severity, few};

/// What turns the readings of a channel into strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Channel {
    /// Subtracted first, microstrain.
    pub offset: f64,
    /// What is left is divided by this.
    pub factor: f64,
    /// Its readings are taken for none.
    pub ignore: bool,
}

impl Channel {
    /// The reading put right, microstrain.
    pub fn put_right(self, reading: f64) -> f64 {
        if self.ignore {
            return f64::NAN;
        }
        (reading - self.offset) / self.factor
    }

    /// Whether nothing is to be put right.
    pub fn is_right(self) -> bool {
        self.offset == 0.0 && self.factor == 1.0 && !self.ignore
    }
}

/// What puts the readings of this gauge right.
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

/// The column that holds the readings of this gauge: another's, where the two are exchanged.
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

/// The columns that the readings of gauges are taken from: those of ignored ones are not asked for.
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

/// What a gauge is turned by beyond its stated angle, degrees.
pub fn turned_by(corrections: &[StrainCorrection], gauge: &str) -> f64 {
    let own = corrections.iter().filter(|c| c.gauge == gauge);
    own.filter_map(|c| c.angle_deg).sum()
}

/// A note that names the corrections; `None` without any.
pub fn noted(job: &Job) -> Option<Finding> {
    let names: Vec<&str> = job.corrections.iter().map(|c| c.gauge.as_str()).collect();
    (!names.is_empty()).then(|| {
        Finding::new(
            Severity::Info,
            "corrections-applied",
            few(&names),
            "readings and angles of these gauges are put right as [[correction]] says",
            "",
        )
    })
}
