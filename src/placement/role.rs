//! Purpose of a placed gauge.

use serde::Serialize;

/// Purpose of a gauge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// The gauge is used to estimate loads.
    Estimate,
    /// The gauge is excluded from the estimate; the other gauges predict its reading.
    Validation,
}

impl Role {
    /// Returns the name of the role in files and reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::Estimate => "estimate",
            Self::Validation => "validation",
        }
    }
}
