//! What has to be added to the model for a named effect to be in it.

/// The addition, in words that a job or a deck can hold.
#[derive(Clone, Debug, PartialEq)]
pub enum Extension {
    /// A correction of one channel's reading.
    Channel {
        /// Effect id without place.
        id: &'static str,
        /// Gauge, or `a+b`.
        gauge: String,
        /// Size (microstrain, factor, degrees, mm).
        size: f64,
        /// Unit.
        unit: &'static str,
    },
    /// The stiffness of a zone or a joint times `1 + percent / 100`.
    Stiffness {
        /// Effect id without place.
        id: &'static str,
        /// Zone or joint.
        place: String,
        /// Percent.
        percent: f64,
    },
    /// A lumped mass.
    Mass {
        /// Place.
        place: String,
        /// Kilogram.
        kilogram: f64,
    },
    /// The payload's place.
    PayloadOffset {
        /// Metres forward or back, as the job's x counts.
        dx: f64,
        /// Metres to the left.
        dy: f64,
    },
    /// The payload's weight as a point load.
    PayloadWeight,
    /// All strain of the model times a factor.
    Scale(f64),
    /// Nothing can be added: no effect of the library.
    Nothing,
    /// Nuisance loads to be found in every run.
    NuisanceLoads {
        /// Effect id.
        id: &'static str,
        /// Names of the patterns, with their usual size.
        loads: Vec<(String, f64)>,
        /// Unit of the sizes.
        unit: &'static str,
    },
}
