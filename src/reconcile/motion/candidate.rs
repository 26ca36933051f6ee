//! An effect that may be there: its name, its forms.

use super::change::Change;

/// A candidate of the library.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Id with place, such as `accel_gain:a_body`.
    pub id: String,
    /// Place alone.
    pub place: Option<String>,
    /// Forms it may take; the data choose.
    pub shapes: Vec<Change>,
    /// Log prior odds against a plain effect.
    pub handicap: f64,
    /// What its parameters must be.
    pub sign: Sign,
}

/// What nature asks of an effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// Nothing.
    Any,
    /// The first is positive.
    Positive,
}

impl Candidate {
    /// An effect at a place.
    pub fn of(family: &str, place: Option<&str>, shapes: Vec<Change>) -> Self {
        Self {
            id: place.map_or_else(|| family.to_owned(), |p| format!("{family}:{p}")),
            place: place.map(str::to_owned),
            shapes,
            handicap: 0.0,
            sign: Sign::Any,
        }
    }

    /// The same, its first parameter positive.
    pub fn positive(mut self) -> Self {
        self.sign = Sign::Positive;
        self
    }

    /// The same, less likely beforehand.
    pub fn handicapped(mut self, by: f64) -> Self {
        self.handicap = by;
        self
    }

    /// Id without place.
    pub fn family(&self) -> &str {
        self.id.split(':').next().unwrap_or("")
    }

    /// Whether a channel is at fault, not the vehicle.
    pub fn is_channel(&self) -> bool {
        let own = |s: &Change| s.channel().is_some() || matches!(s, Change::Swap { .. });
        self.shapes.first().is_some_and(own)
    }

    /// The link whose spring it bends: force over stretch that is no straight line.
    pub fn bends_spring(&self) -> Option<usize> {
        match self.shapes.first()? {
            Change::Terms { link, terms } if terms.iter().all(|t| t.bends_spring()) => Some(*link),
            _ => None,
        }
    }

    /// Whether it may be so large that nothing of a record is explained without it, and more may be found beside it.
    pub fn overturns(&self) -> bool {
        matches!(
            self.shapes.first(),
            Some(Change::Step(_) | Change::Clock { .. })
        )
    }

    /// Whether it changes everything at once, beyond what a linear look ahead can see.
    pub fn is_upheaval(&self) -> bool {
        matches!(
            self.shapes.first(),
            Some(Change::Swap { .. } | Change::Flip { .. })
        )
    }
}
