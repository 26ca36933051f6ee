//! Force law of a link between two bodies: a sum of terms, each a coefficient times a function of stretch and its rate.

use crate::units::{Quantity as Dimension, UnitSystem};

/// Physical quantity of a coefficient.
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
    /// Force times time squared per length squared.
    Damping2,
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
    /// Returns the names of a system of units.
    pub fn from_system(system: UnitSystem) -> Self {
        let name = |d: Dimension| system.unit(d).name.to_owned();
        Self {
            mass: name(Dimension::Mass),
            length: name(Dimension::Length),
            force: name(Dimension::Force),
        }
    }

    /// Returns the unit of a speed.
    pub fn speed(&self) -> String {
        format!("{}/s", self.length)
    }

    /// Returns the name of the unit of a quantity.
    pub fn unit_name(&self, quantity: Quantity) -> String {
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
            Quantity::Damping2 => format!("{f} s2/{l}2"),
            Quantity::Force => f.clone(),
        }
    }
}

/// Direction of stretch in which an end stop acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Both sides.
    Both,
    /// Body and wheel approach.
    Compression,
    /// Body and wheel part.
    Rebound,
}

impl Side {
    /// Returns the name in a job.
    pub fn word(self) -> &'static str {
        match self {
            Self::Both => "both",
            Self::Compression => "compression",
            Self::Rebound => "rebound",
        }
    }

    /// Parses the name in a job.
    pub fn from_name(word: &str) -> Option<Self> {
        [Self::Both, Self::Compression, Self::Rebound]
            .into_iter()
            .find(|s| s.word() == word)
    }
}

/// One term of a link force. d is the stretch (body minus wheel), v its rate. At rest d is 0.
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
        /// Side on which the term acts.
        side: Side,
    },
    /// b d'': a mass that only relative acceleration moves, as in axles and bodies that turn. Not simulated.
    Inertance,
    /// ca |v|: a damper with different rates c + ca in rebound (v > 0) and c - ca in compression.
    TwoRate,
    /// c2 v |v|: a damper whose force grows with the square of the rate.
    QuadraticDamping,
    /// -kz d within the gap, -kz gap beyond: free play that takes kz of the link's stiffness.
    DeadZone {
        /// Free travel to either side.
        gap: f64,
    },
    /// dk d times the share of a change that is done: a spring that changes during a record.
    StiffnessChange {
        /// When the change begins, s of the record's time.
        at_s: f64,
        /// Duration of the change, s. 0 means at once.
        over_s: f64,
    },
}

impl Term {
    /// Returns the prefix of the coefficient's name.
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
            Self::Inertance => "b",
            Self::QuadraticDamping => "c2",
            Self::DeadZone { .. } => "kz",
            Self::StiffnessChange { .. } => "dk",
        }
    }

    /// Returns the term of a name in a job: a coefficient's prefix or an effect id. A constant may follow in brackets: `coulomb_friction(0.006)`
    /// (velocity), `bump_stop(0.03 compression)` (gap, side); without brackets, the program determines the constant. `dead_zone(0.004)` (gap) and
    /// `stiffness_drift(0 64)` (begin and length in s) require a constant.
    pub fn from_name(name: &str) -> Option<Self> {
        if let Some((plain, rest)) = name.split_once('(') {
            let inside = rest.strip_suffix(')')?;
            if plain == "stiffness_drift" {
                let (at, over) = inside.split_once(' ')?;
                let numbers = (at.parse::<f64>().ok()?, over.parse::<f64>().ok()?);
                let (at_s, over_s) = Some(numbers).filter(|n| n.0.is_finite() && n.1 >= 0.0)?;
                return Some(Self::StiffnessChange { at_s, over_s });
            }
            let (number, word) = inside.split_once(' ').unwrap_or((inside, "both"));
            let constant = number.parse::<f64>().ok().filter(|v| *v > 0.0)?;
            if plain == "dead_zone" {
                return Some(Self::DeadZone { gap: constant });
            }
            return match Self::from_name(plain)? {
                Self::Friction { .. } => Some(Self::Friction { velocity: constant }),
                Self::BumpStop { .. } => Some(Self::BumpStop {
                    gap: constant,
                    side: Side::from_name(word)?,
                }),
                _ => None,
            };
        }
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
            "c2" | "quadratic_damping" => Self::QuadraticDamping,
            "b" | "inertance" => Self::Inertance,
            _ => return None,
        })
    }

    /// Returns the term with its constant in the form of a job, which [`Term::from_name`] reads.
    pub fn text(&self) -> String {
        match self {
            Self::Friction { velocity } if *velocity > 0.0 => {
                format!("coulomb_friction({velocity:.5e})")
            }
            Self::BumpStop { gap, side } if *gap > 0.0 => {
                format!("bump_stop({gap:.6e} {})", side.word())
            }
            Self::Friction { .. } => "coulomb_friction".into(),
            Self::BumpStop { .. } => "bump_stop".into(),
            Self::Stiffness => "stiffness".into(),
            Self::Damping => "viscous_damper".into(),
            Self::Quadratic => "quadratic_stiffness".into(),
            Self::Cubic => "cubic_stiffness".into(),
            Self::Progressive => "progressive_leaf".into(),
            Self::TwoRate => "asymmetric_damper".into(),
            Self::Inertance => "inertance".into(),
            Self::QuadraticDamping => "quadratic_damping".into(),
            Self::DeadZone { gap } => format!("dead_zone({gap:.6e})"),
            Self::StiffnessChange { at_s, over_s } => {
                format!("stiffness_drift({at_s:.6} {over_s:.6})")
            }
        }
    }

    /// Returns the physical quantity of the coefficient.
    pub fn quantity(&self) -> Quantity {
        match self {
            Self::Stiffness
            | Self::BumpStop { .. }
            | Self::DeadZone { .. }
            | Self::StiffnessChange { .. } => Quantity::Stiffness,
            Self::QuadraticDamping => Quantity::Damping2,
            Self::Damping | Self::TwoRate => Quantity::Damping,
            Self::Quadratic | Self::Progressive => Quantity::Stiffness2,
            Self::Cubic => Quantity::Stiffness3,
            Self::Friction { .. } => Quantity::Force,
            Self::Inertance => Quantity::Mass,
        }
    }

    /// Returns whether a negative coefficient is physically impossible.
    pub fn is_positive(&self) -> bool {
        matches!(
            self,
            Self::Stiffness | Self::Damping | Self::Friction { .. } | Self::BumpStop { .. }
        )
    }

    /// Returns whether the term is proportional to the stretch, its rate or its acceleration.
    pub fn is_linear(&self) -> bool {
        matches!(self, Self::Stiffness | Self::Damping | Self::Inertance)
    }

    /// Returns whether the term is a nonlinear function of the stretch alone.
    pub fn bends_spring(&self) -> bool {
        match self {
            Self::Quadratic
            | Self::Cubic
            | Self::Progressive
            | Self::BumpStop { .. }
            | Self::DeadZone { .. } => true,
            Self::Stiffness
            | Self::Damping
            | Self::Friction { .. }
            | Self::Inertance
            | Self::TwoRate
            | Self::QuadraticDamping
            | Self::StiffnessChange { .. } => false,
        }
    }

    /// Returns the force for a coefficient of one; 0 for inertance, which does not depend on stretch and rate.
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
            Self::Inertance => 0.0,
            Self::QuadraticDamping => v * v.abs(),
            Self::DeadZone { gap } => -d.clamp(-gap, gap),
            Self::StiffnessChange { .. } => d,
        }
    }

    /// Returns the basis function at a time of the record, s. For a term that changes with time, it includes the share at this time.
    pub fn basis_at(&self, d: f64, v: f64, t_s: f64) -> f64 {
        match *self {
            Self::StiffnessChange { at_s, over_s } => d * share_done(at_s, over_s, t_s),
            _ => self.basis(d, v),
        }
    }

    /// Returns whether the term changes with time.
    pub fn is_of_time(&self) -> bool {
        matches!(self, Self::StiffnessChange { .. })
    }
}

/// Returns the completed share (0 to 1) of a linear change at time `t_s`. The change begins at `at_s` and lasts `over_s`, all in seconds.
pub fn share_done(at_s: f64, over_s: f64, t_s: f64) -> f64 {
    if over_s > 0.0 {
        ((t_s - at_s) / over_s).clamp(0.0, 1.0)
    } else {
        f64::from(u8::from(t_s >= at_s))
    }
}
