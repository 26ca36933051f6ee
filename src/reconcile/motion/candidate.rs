//! An effect that may be there: its name, its forms.

use super::change::Change;

/// A candidate of the library.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Id with place, such as `accel_gain:a_body`.
    pub id: String,
    /// Place without the id.
    pub place: Option<String>,
    /// Possible forms; the data determine which one applies.
    pub shapes: Vec<Change>,
    /// Logarithm of the prior odds of a plain effect to this candidate. It is subtracted from the evidence of the candidate.
    pub handicap: f64,
    /// Sign that the first parameter must have.
    pub sign: Sign,
}

/// Physical limit on the sign of an effect's first parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// Either sign.
    Any,
    /// Positive.
    Positive,
}

impl Candidate {
    /// Returns the candidate for an effect at a place.
    pub fn new(family: &str, place: Option<&str>, shapes: Vec<Change>) -> Self {
        Self {
            id: place.map_or_else(|| family.to_owned(), |p| format!("{family}:{p}")),
            place: place.map(str::to_owned),
            shapes,
            handicap: 0.0,
            sign: Sign::Any,
        }
    }

    /// Returns the candidate with its first parameter limited to positive values.
    pub fn with_positive_parameter(mut self) -> Self {
        self.sign = Sign::Positive;
        self
    }

    /// Returns the candidate with the log prior odds `by` against it.
    pub fn with_handicap(mut self, by: f64) -> Self {
        self.handicap = by;
        self
    }

    /// Returns the id without the place.
    pub fn family(&self) -> &str {
        self.id.split(':').next().unwrap_or("")
    }

    /// Returns whether the fault is in a channel and not in the vehicle.
    pub fn is_channel(&self) -> bool {
        let own = |s: &Change| s.channel().is_some() || matches!(s, Change::Swap { .. });
        self.shapes.first().is_some_and(own)
    }

    /// Returns the link whose spring becomes nonlinear by the effect. Its force is then not proportional to its stretch.
    pub fn bends_spring(&self) -> Option<usize> {
        match self.shapes.first()? {
            Change::Terms { link, terms } if terms.iter().all(|t| t.bends_spring()) => Some(*link),
            _ => None,
        }
    }

    /// Returns whether the effect can be so large that no other effect explains the record alone. Other effects may be present in addition.
    pub fn overturns(&self) -> bool {
        matches!(
            self.shapes.first(),
            Some(Change::Step(_) | Change::Clock { .. })
        )
    }

    /// Returns whether the effect changes everything at once, too much for a linear prediction of its gain.
    pub fn is_dominant_fault(&self) -> bool {
        matches!(
            self.shapes.first(),
            Some(Change::Swap { .. } | Change::Flip { .. })
        )
    }
}
