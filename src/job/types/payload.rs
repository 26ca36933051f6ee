//! `[payload]`.

use super::region::Region;
use crate::payload::Place;

/// `[payload]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Payload {
    /// Grid where it acts.
    pub grid: Option<u32>,
    /// Whether its place is known or asked for; default known.
    pub position: Place,
    /// Gravity, m/s^2 whatever the unit system; default 9.80665.
    pub gravity_m_s2: f64,
    /// The payload's weight acts in the analyst's model.
    pub weight_in_model: bool,
    /// Region in which the payload may be.
    pub region: Option<Region>,
    /// Use strain; default both where present.
    pub use_strain: bool,
    /// Use reactions.
    pub use_reactions: bool,
    /// Run without payload: its wheel forces (and its strain, without a zero file) are subtracted.
    pub unloaded: Option<String>,
    /// Nominal position, job units.
    pub nominal_x: Option<f64>,
    /// Likewise across.
    pub nominal_y: Option<f64>,
    /// Line of the job.
    pub line: u32,
}
