//! `[ballast]`.

use super::region::Region;
use crate::job::shapes::PropertyIds;

/// `[ballast]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Ballast {
    /// How many masses; default 1.
    pub masses: usize,
    /// Region in which the masses may be.
    pub region: Option<Region>,
    /// Properties whose grids may carry them; `None`: all shells (bars where there are none).
    pub properties: Option<PropertyIds>,
    /// The largest one.
    pub max_mass: Option<f64>,
    /// Run whose reactions count; default the first.
    pub run: Option<String>,
    /// Gravity, m/s^2 whatever the unit system; default 9.80665.
    pub gravity_m_s2: f64,
    /// Line of the job.
    pub line: u32,
}
