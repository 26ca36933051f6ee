//! Extensions of the model that include an identified effect.

/// Correction for a fault of one channel, for the present readings and all later ones.
#[derive(Clone, Debug, PartialEq)]
pub enum Correction {
    /// The channel reads with reversed sign.
    Sign,
    /// The channel reads the strain times this factor.
    Gain(f64),
    /// The channel reads too high by this offset, microstrain.
    Offset(f64),
    /// The channel and the channel of this name are exchanged.
    ExchangedWith(String),
    /// The gauge is rotated from its nominal angle by this much, degrees.
    AngleDeg(f64),
    /// The gauge is offset from its nominal position by this much along its axis, millimetres.
    PositionMm(f64),
    /// The channel can't be corrected: it is left out.
    Ignore,
}

/// Recorded quantity of a run that is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordedQuantity {
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

/// Extension in terms that a job or a deck can contain.
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
    /// Recorded value of a load divided by a factor, in every run.
    LoadScale {
        /// Load.
        load: String,
        /// Scale reading over true load.
        factor: f64,
    },
    /// Exchange of the recorded loads and payload between two runs.
    RunExchange {
        /// The runs.
        runs: [String; 2],
    },
    /// Error in one recorded quantity of a run.
    RunRecord {
        /// Run.
        run: String,
        /// Recorded quantity that is wrong.
        noted: RecordedQuantity,
        /// Amount by which the true value exceeds the recorded one.
        size: f64,
    },
    /// Nuisance loads to be found in every run.
    NuisanceLoads {
        /// Source of the patterns.
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
    /// Returns the extension that applies `correction` to every channel of `names`.
    pub fn channel(names: &[String], correction: Correction) -> Self {
        Self::Channels(
            names
                .iter()
                .map(|n| (n.clone(), correction.clone()))
                .collect(),
        )
    }
}
