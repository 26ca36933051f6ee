//! A layout chosen, and its channels.

use crate::gauge::Gauge;
use crate::host::fault::Fault;
use crate::job::JobGauge;
use crate::placement::PlaceError;
use crate::placement::sites::Site;

/// A channel chosen.
pub(super) struct Channel {
    /// On the model.
    pub gauge: Gauge,
    /// Wiring, as a job names it.
    pub bridge: &'static str,
    /// Side of the shell; `None` on a bar.
    pub site: Option<Site>,
    /// Spot of the job's table, if the gauge is on a named spot.
    pub spot: Option<JobGauge>,
    /// Row over its standard deviation, columns in the candidates' order.
    pub row: Vec<f64>,
    /// Standard deviation of its reading, microstrain.
    pub sd: f64,
    /// Change of its reading with its angle, microstrain a radian, rms over the expected loads.
    pub turn: f64,
    /// The angle of its first grid.
    pub angle: f64,
    /// The refusal of a grid that does not fit on the part there; its strain is then that at its middle.
    pub misfit: Option<Fault>,
}

/// A layout chosen.
pub(super) struct ChosenLayout {
    pub channels: Vec<Channel>,
    pub log_det: f64,
    pub upper_bound: f64,
    pub efficiency_bound: f64,
    pub proved: bool,
    pub nodes: usize,
    /// Costs, if they were counted.
    pub cost: Option<f64>,
    /// Least condition number that the search found, if it was requested.
    pub least_condition: Option<f64>,
}

/// Reason of a refused choice.
pub(super) enum ChoiceRefusal {
    By(PlaceError),
    Job(Fault),
}
