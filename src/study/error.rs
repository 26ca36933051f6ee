//! Kinds of error.

/// Kind of error of each gauge. Every trial draws a new error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// Reading times 1 + e, e uniform in +-size.
    RelativeUniform,
    /// Reading times 1 + e, e normal, sd size.
    RelativeNormal,
    /// Reading plus e microstrain, uniform in +-size.
    AbsoluteUniform,
    /// Reading plus e microstrain, normal, sd size.
    AbsoluteNormal,
    /// Installed position off along both surface directions: normal, sd size, job length.
    Position,
    /// Installed angle off: normal, sd size degrees.
    Angle,
    /// Gauge or bridge factor: reading times 1 + e, e normal, sd size.
    Factor,
}

impl ErrorKind {
    /// All kinds of errors.
    pub const ALL: [Self; 7] = [
        Self::RelativeUniform,
        Self::RelativeNormal,
        Self::AbsoluteUniform,
        Self::AbsoluteNormal,
        Self::Position,
        Self::Angle,
        Self::Factor,
    ];

    /// Returns whether the size of the error is a fraction of the reading.
    pub fn is_relative(self) -> bool {
        matches!(
            self,
            Self::RelativeUniform | Self::RelativeNormal | Self::Factor
        )
    }

    /// Returns the name in a job.
    pub fn word(self) -> &'static str {
        match self {
            Self::RelativeUniform => "relative-uniform",
            Self::RelativeNormal => "relative-normal",
            Self::AbsoluteUniform => "absolute-uniform",
            Self::AbsoluteNormal => "absolute-normal",
            Self::Position => "position",
            Self::Angle => "angle",
            Self::Factor => "factor",
        }
    }

    /// Parses the kind of error from a job. `relative`, `absolute`, `uniform` and `normal` alone are short forms of relative-uniform, absolute-normal
    /// and so on.
    pub fn from_word(word: &str) -> Option<Self> {
        match word {
            "relative" | "uniform" => Some(Self::RelativeUniform),
            "absolute" | "noise" => Some(Self::AbsoluteNormal),
            "normal" => Some(Self::RelativeNormal),
            "gain" | "gauge-factor" => Some(Self::Factor),
            _ => Self::ALL.into_iter().find(|k| k.word() == word),
        }
    }
}

/// A kind and its size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StudyError {
    /// Kind.
    pub kind: ErrorKind,
    /// Size: a fraction, microstrain, job length or degrees.
    pub size: f64,
}
