//! The static strain path: frame, exact prediction, covariance, evidence.

mod adequacy;
mod bias;
mod covariance;
mod detect;
mod examine;
mod extended;
mod frame;
mod gap;
mod likelihood;
mod next;
mod remains;
mod size;
mod state;
mod tolerance;

pub use adequacy::{Adequacy, adequacy, deviate};
pub use covariance::{Selection, SizedAmplitudes, covariance, read_patterns};
pub use detect::DECISIVE;
pub use examine::examine;
pub use extended::{Correction, corrected_readings, extended_influence};
pub use frame::{
    GaugeFacts, MassSignature, N_PAYLOAD_COLUMNS, PayloadWeight, PlaneStrainRow, Scatter,
    StiffnessSignature, StrainFrame, WheelForces, Wiring,
};
pub use gap::{gap, held_out_residual, loads_before_after};
pub use likelihood::{Fit, Likelihood};
pub use state::{Part, StrainState, predict, read_all};
pub use tolerance::angle_scatter;
