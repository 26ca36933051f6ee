//! A layout chosen, and its channels.

use crate::gauge::Gauge;
use crate::host::fault::Fault;
use crate::job::JobGauge;
use crate::placement::PlaceError;
use crate::placement::sites::Site;

/// A chosen channel.
pub(super) struct Channel {
    /// Gauge on the model.
    pub gauge: Gauge,
    /// Wiring, as a job names it.
    pub bridge: &'static str,
    /// Site on a side of a shell. `None` on a bar.
    pub site: Option<Site>,
    /// Spot of the job's table, if the gauge is on a named spot.
    pub spot: Option<JobGauge>,
    /// Row divided by its standard deviation, with columns in the order of the candidates.
    pub row: Vec<f64>,
    /// Standard deviation of the reading, microstrain.
    pub sd: f64,
    /// Change of the reading with the angle, microstrain per radian, rms over the expected loads.
    pub turn: f64,
    /// Angle of the first grid.
    pub angle: f64,
    /// Refusal of a grid that does not fit on the part. The strain is then the strain at the middle of the grid.
    pub misfit: Option<Fault>,
}

/// A chosen layout.
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
