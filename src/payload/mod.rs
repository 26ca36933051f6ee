//! The size and place of one load that is not measured directly: a payload, or the masses that a model lacks.

mod ballast;
mod by_calibration;
mod carrier;
mod evidence;
mod locate;
mod misfit;
mod one_run;
mod robust;
#[cfg(test)]
mod tests;
mod weigh;

pub use ballast::{BallastFit, BallastMass, BallastSpec, size_ballast};
pub use carrier::{Carriers, spread};
pub use evidence::{PayloadModel, PayloadRun, Place, Refusal, Support, WeighSpec, WeighedRun};
pub use misfit::{faults_of_gauges, payload_rows};
pub use robust::{
    GaugeEstimates, GaugeVerdict, RobustPayload, RobustSpec, RunPayload, robust_payload,
};
pub use weigh::{Weighing, weigh};
