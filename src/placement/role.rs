//! What a placed gauge is for.

use serde::Serialize;

/// What a gauge is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// Loads are estimated with it.
    Estimate,
    /// It is kept from estimating: the others predict it.
    Validation,
}

impl Role {
    /// The word of files and reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::Estimate => "estimate",
            Self::Validation => "validation",
        }
    }
}
