//! How channels of a record are taken: corrections, band, slow stretch; and what stops the acceleration path.

use super::adjustment::Adjustment;
use crate::series::SeriesError;
use crate::series::spectrum::Band;
use thiserror::Error;

/// What stops the acceleration path.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum VehicleError {
    /// The record itself.
    #[error(transparent)]
    Series(#[from] SeriesError),
    /// A body whose motion the sensors don't give.
    #[error("body `{body}` moves in {needed} ways, its accelerometers ({}) give {found}: add accelerometers at other places", .channels.join(", "))]
    Sensors {
        /// The body.
        body: String,
        /// Its motions.
        needed: usize,
        /// Motions that the sensors span.
        found: usize,
        /// Its channels.
        channels: Vec<String>,
    },
    /// No equation is left.
    #[error(
        "no equation of motion of model `{0}` holds measured quantities only: measure wheel forces, or accelerations of the body and its wheels"
    )]
    NoEquation(String),
    /// The record that judges, not the fitted one.
    #[error(transparent)]
    HeldOut(Box<VehicleError>),
    /// A known parameter that the model has not.
    #[error("`{name}` is declared known, but the model's parameters are {}", .present.join(", "))]
    Known {
        /// As written.
        name: String,
        /// Names of the model.
        present: Vec<String>,
    },
}

/// How channels are treated.
#[derive(Clone, Debug, PartialEq)]
pub struct Treatment {
    /// The band of every equation and channel.
    pub band: Band,
    /// Keep every n-th sample of the band-limited signals (a power of two); 0: as few as the band allows.
    pub keep_every: usize,
    /// Corrections of channels, none for most.
    pub adjust: Vec<Adjustment>,
    /// Slow stretch of links, where known: nonlinear terms then need no double integration below the band.
    pub slow: Vec<SlowStretch>,
    /// What is cut off either end, s; none: as little as the terms need.
    pub settle_s: Option<f64>,
}

impl Treatment {
    /// Plain treatment: one band, samples thinned as far as it allows.
    pub fn of(band: Band) -> Self {
        Self {
            band,
            keep_every: 0,
            adjust: vec![],
            slow: vec![],
            settle_s: None,
        }
    }
}

/// Stretch of a link as its own law gives it from the force through it, at every sample of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct SlowStretch {
    /// Index of the link.
    pub link: usize,
    /// Stretch, mean force taken as rest.
    pub stretch: Vec<f64>,
}
