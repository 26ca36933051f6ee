//! Treatment of the channels of a record: corrections, band, slow stretch; and the errors of the acceleration path.

use super::adjustment::Adjustment;
use crate::series::SeriesError;
use crate::series::spectrum::Band;
use std::fmt;

/// Errors that stop the acceleration path.
#[derive(Clone, Debug, PartialEq)]
pub enum VehicleError {
    /// The record itself.
    Series(SeriesError),
    /// A body whose motion the sensors do not determine.
    Sensors {
        /// The body.
        body: String,
        /// Number of motions of the body.
        needed: usize,
        /// Motions that the sensors span.
        found: usize,
        /// Channels of the body.
        channels: Vec<String>,
    },
    /// No equation remains.
    NoEquation(String),
    /// An error of the hold-out record, not of the fitted one.
    HeldOut(Box<VehicleError>),
    /// A known parameter that the model does not have.
    Known {
        /// Name in the job.
        name: String,
        /// Names of the model.
        present: Vec<String>,
    },
    /// Limits without a physically possible value.
    Bounds {
        /// The parameter.
        name: String,
        /// Upper limit of the parameter.
        high: f64,
    },
}

impl VehicleError {
    /// Returns the message and the remedy.
    pub fn parts(&self) -> (String, String) {
        let (wrong, remedy) = match self {
            Self::Series(e) => return e.parts(),
            Self::HeldOut(e) => return e.parts(),
            Self::Sensors {
                body,
                needed,
                found,
                channels,
            } => (
                format!(
                    "body `{body}` has {needed} degrees of freedom, its accelerometers ({}) determine {found}",
                    channels.join(", ")
                ),
                "add accelerometers at other places",
            ),
            Self::NoEquation(model) => (
                format!(
                    "every equation of motion of model `{model}` contains a quantity that is not measured"
                ),
                "measure wheel forces, or accelerations of the body and its wheels",
            ),
            Self::Bounds { name, high } => {
                return (
                    format!("`{name}` cannot be negative, and its upper limit is {high}"),
                    "write [low, high] with a high above 0, or leave the parameter free".to_owned(),
                );
            }
            Self::Known { name, present } => (
                format!(
                    "`{name}` is declared known, but the model's parameters are {}",
                    present.join(", ")
                ),
                "write one of these names, or delete it",
            ),
        };
        (wrong, remedy.to_owned())
    }
}

impl fmt::Display for VehicleError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (wrong, remedy) = self.parts();
        write!(f, "{wrong}: {remedy}")
    }
}

impl std::error::Error for VehicleError {}

impl From<SeriesError> for VehicleError {
    fn from(e: SeriesError) -> Self {
        Self::Series(e)
    }
}

/// Treatment of channels.
#[derive(Clone, Debug, PartialEq)]
pub struct Treatment {
    /// The band of every equation and channel.
    pub band: Band,
    /// Every n-th sample of the band-limited signals is kept, with this n (a power of two). 0 means as few samples as the band allows.
    pub keep_every: usize,
    /// Corrections of channels. Most channels have none.
    pub adjust: Vec<Adjustment>,
    /// Slow stretch of links, if known: nonlinear terms then need no double integration below the band.
    pub slow: Vec<SlowStretch>,
    /// Time that is cut off at both ends, s. `None` means as little as the terms need.
    pub settle_s: Option<f64>,
}

impl Treatment {
    /// Returns the plain treatment: one band, and samples thinned as far as the band allows.
    pub fn from_band(band: Band) -> Self {
        Self {
            band,
            keep_every: 0,
            adjust: vec![],
            slow: vec![],
            settle_s: None,
        }
    }
}

/// Stretch of a link, computed from the force through the link and its law, at every sample of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct SlowStretch {
    /// Index of the link.
    pub link: usize,
    /// Stretch of the link. The mean force defines the rest position.
    pub stretch: Vec<f64>,
}
