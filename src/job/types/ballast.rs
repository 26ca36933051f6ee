//! `[ballast]`.

use super::region::Region;
use crate::job::shapes::PropertyIds;

/// `[ballast]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Ballast {
    /// Number of masses. The default is 1.
    pub masses: usize,
    /// Region in which the masses may be.
    pub region: Option<Region>,
    /// Properties whose grids may carry the masses. `None` means all shells, or bars if there are no shells.
    pub properties: Option<PropertyIds>,
    /// Largest mass.
    pub max_mass: Option<f64>,
    /// Run whose reactions are used. The default is the first run.
    pub run: Option<String>,
    /// Gravity in m/s^2 for every unit system. The default is 9.80665.
    pub gravity_m_s2: f64,
    /// Line of the job.
    pub line: u32,
}
