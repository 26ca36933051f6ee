//! `[payload]`.

use super::region::Region;
use crate::payload::Place;

/// `[payload]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Payload {
    /// Grid where the payload acts.
    pub grid: Option<u32>,
    /// Whether the place of the payload is known or to be determined. The default is known.
    pub position: Place,
    /// Gravity in m/s^2 for every unit system. The default is 9.80665.
    pub gravity_m_s2: f64,
    /// Whether the payload's weight acts in the analyst's model.
    pub weight_in_model: bool,
    /// Region in which the payload may be.
    pub region: Option<Region>,
    /// Whether strain is used. By default strain and wheel forces are used if present.
    pub use_strain: bool,
    /// Whether reactions are used.
    pub use_reactions: bool,
    /// Run without payload. Its wheel forces are subtracted. Without a zero file, its strain is also subtracted.
    pub unloaded: Option<String>,
    /// Nominal position along x, job units.
    pub nominal_x: Option<f64>,
    /// Nominal position along y, job units.
    pub nominal_y: Option<f64>,
    /// Line of the job.
    pub line: u32,
}
