//! What a link between two bodies does: force as a sum of terms, each a coefficient times a function of stretch and its rate.

/// What a coefficient is measured in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// kg or t.
    Mass,
    /// Mass times length.
    FirstMoment,
    /// Mass times length squared.
    Inertia,
    /// Force per length.
    Stiffness,
    /// Force per length squared.
    Stiffness2,
    /// Force per length cubed.
    Stiffness3,
    /// Force times time per length.
    Damping,
    /// Force.
    Force,
}

/// Names of the job's units, such as kg, m, N.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitNames {
    /// Mass.
    pub mass: String,
    /// Length.
    pub length: String,
    /// Force.
    pub force: String,
}

impl UnitNames {
    /// kg, m, N.
    pub fn si() -> Self {
        Self {
            mass: "kg".into(),
            length: "m".into(),
            force: "N".into(),
        }
    }

    /// The unit of a quantity, in words.
    pub fn of(&self, quantity: Quantity) -> String {
        let Self {
            mass: m,
            length: l,
            force: f,
        } = self;
        match quantity {
            Quantity::Mass => m.clone(),
            Quantity::FirstMoment => format!("{m} {l}"),
            Quantity::Inertia => format!("{m} {l}2"),
            Quantity::Stiffness => format!("{f}/{l}"),
            Quantity::Stiffness2 => format!("{f}/{l}2"),
            Quantity::Stiffness3 => format!("{f}/{l}3"),
            Quantity::Damping => format!("{f} s/{l}"),
            Quantity::Force => f.clone(),
        }
    }
}

/// Which direction of stretch an end stop acts in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Both.
    Both,
    /// Body and wheel approach.
    Compression,
    /// Body and wheel part.
    Rebound,
}

/// One term of a link force; d is the stretch (body less wheel), v its rate, d = 0 at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Term {
    /// k d.
    Stiffness,
    /// c v.
    Damping,
    /// k2 d^2.
    Quadratic,
    /// k3 d^3.
    Cubic,
    /// kp d |d|: a leaf spring that stiffens as leaves close.
    Progressive,
    /// fc tanh(v / velocity): friction between leaves, smoothed below `velocity`.
    Friction {
        /// Rate at which friction has developed to 76 %; 0 means 2 % of the record's rms rate.
        velocity: f64,
    },
    /// kb (|d| - gap) beyond the gap.
    BumpStop {
        /// Free travel; 0 means to be found.
        gap: f64,
        /// Where it acts.
        side: Side,
    },
    /// ca |v|: a damper with different rates c + ca in rebound (v > 0) and c - ca in compression.
    TwoRate,
}

impl Term {
    /// Prefix of the coefficient's name.
    pub fn symbol(&self) -> &'static str {
        match self {
            Self::Stiffness => "k",
            Self::Damping => "c",
            Self::Quadratic => "k2",
            Self::Cubic => "k3",
            Self::Progressive => "kp",
            Self::Friction { .. } => "fc",
            Self::BumpStop { .. } => "kb",
            Self::TwoRate => "ca",
        }
    }

    /// The term of a name in a job: a coefficient's prefix or an effect id; automatic where it has a constant of its own.
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "k" | "stiffness" => Self::Stiffness,
            "c" | "viscous_damper" | "damping" => Self::Damping,
            "k2" | "quadratic_stiffness" => Self::Quadratic,
            "k3" | "cubic_stiffness" => Self::Cubic,
            "kp" | "progressive_leaf" => Self::Progressive,
            "fc" | "Fc" | "coulomb_friction" => Self::Friction { velocity: 0.0 },
            "kb" | "bump_stop" => Self::BumpStop {
                gap: 0.0,
                side: Side::Both,
            },
            "ca" | "asymmetric_damper" => Self::TwoRate,
            _ => return None,
        })
    }

    /// What its coefficient is measured in.
    pub fn quantity(&self) -> Quantity {
        match self {
            Self::Stiffness | Self::BumpStop { .. } => Quantity::Stiffness,
            Self::Damping | Self::TwoRate => Quantity::Damping,
            Self::Quadratic | Self::Progressive => Quantity::Stiffness2,
            Self::Cubic => Quantity::Stiffness3,
            Self::Friction { .. } => Quantity::Force,
        }
    }

    /// Whether a negative coefficient is against nature.
    pub fn is_positive(&self) -> bool {
        matches!(
            self,
            Self::Stiffness | Self::Damping | Self::Friction { .. } | Self::BumpStop { .. }
        )
    }

    /// Whether the term is proportional to the stretch or its rate.
    pub fn is_linear(&self) -> bool {
        matches!(self, Self::Stiffness | Self::Damping)
    }

    /// Force for a coefficient of one.
    pub fn basis(&self, d: f64, v: f64) -> f64 {
        match *self {
            Self::Stiffness => d,
            Self::Damping => v,
            Self::Quadratic => d * d,
            Self::Cubic => d * d * d,
            Self::Progressive => d * d.abs(),
            Self::Friction { velocity } => (v / velocity).tanh(),
            Self::BumpStop { gap, side } => match side {
                Side::Rebound => (d - gap).max(0.0),
                Side::Compression => (d + gap).min(0.0),
                Side::Both => (d - gap).max(0.0) + (d + gap).min(0.0),
            },
            Self::TwoRate => v.abs(),
        }
    }
}
