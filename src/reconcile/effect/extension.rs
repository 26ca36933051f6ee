//! What has to be added to the model for a named effect to be in it.

/// What undoes a fault of one channel, on the readings at hand and on all to come.
#[derive(Clone, Debug, PartialEq)]
pub enum Correction {
    /// The channel reads with its sign turned.
    Sign,
    /// It reads this factor of the strain.
    Gain(f64),
    /// It reads this much too much, microstrain.
    Offset(f64),
    /// It carries the other channel's name, and the other one its own.
    ExchangedWith(String),
    /// The gauge is turned by this much, degrees.
    AngleDeg(f64),
    /// The gauge sits this far along its axis, millimetres.
    PositionMm(f64),
    /// Nothing can be made of it: it is left out.
    Ignore,
}

/// What was noted wrong of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Noted {
    /// One load, kN.
    Load(usize),
    /// All loads, by one factor.
    Loads,
    /// The payload's mass, kg.
    Mass,
}

/// Loads that a model leaves out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Nuisance {
    /// Side and longitudinal forces and moments at the wheels.
    SideLoads,
    /// An even temperature.
    UniformTemperature,
    /// A temperature that differs from place to place.
    TemperatureGradient,
    /// Wheel forces of ground that is not flat.
    Ground,
}

/// The addition, in words that a job or a deck can hold.
#[derive(Clone, Debug, PartialEq)]
pub enum Extension {
    /// Corrections of channels, one after the other.
    Channels(Vec<(String, Correction)>),
    /// The stiffness of a zone times `1 + percent / 100`.
    ZoneStiffness {
        /// Zone.
        place: String,
        /// Percent.
        percent: f64,
    },
    /// The stiffness of a joint times `exp(percent / 100)`.
    JointStiffness {
        /// Joint.
        place: String,
        /// Natural log times 100.
        percent: f64,
    },
    /// The stiffness of a small region times `exp(percent / 100)`.
    LocalStiffness {
        /// Element in its middle.
        place: String,
        /// Natural log times 100.
        percent: f64,
    },
    /// A change of the structure that the user described, times `size`.
    Described {
        /// Effect id.
        id: String,
        /// Size in its own unit.
        size: f64,
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
    /// The noted value of a load divided by a factor, in every run.
    LoadScale {
        /// Load.
        load: String,
        /// What the scale reads of the true load.
        factor: f64,
    },
    /// Two runs exchange what was noted of them.
    RunExchange {
        /// The runs.
        runs: [String; 2],
    },
    /// What was noted of one run is wrong.
    RunRecord {
        /// Run.
        run: String,
        /// What of it.
        noted: Noted,
        /// By how much the truth is above what was noted.
        size: f64,
    },
    /// Nuisance loads to be found in every run.
    NuisanceLoads {
        /// Where they come from.
        source: Nuisance,
        /// Names of the patterns, with their usual size.
        loads: Vec<(String, f64)>,
        /// Unit of the sizes.
        unit: &'static str,
    },
    /// Nothing can be added: no effect of the library.
    Nothing,
}

impl Extension {
    /// The same correction of every channel of `names`.
    pub fn channel(names: &[String], correction: Correction) -> Self {
        Self::Channels(
            names
                .iter()
                .map(|n| (n.clone(), correction.clone()))
                .collect(),
        )
    }
}
