//! The static strain path: frame, exact prediction, covariance, evidence.

mod adequacy;
mod bias;
mod companions;
mod covariance;
mod detect;
mod evidence;
mod examine;
mod explanation;
mod extended;
mod frame;
mod gap;
mod judge;
mod learnt;
mod likelihood;
mod neighbours;
mod next;
mod no_drift;
mod nuisance;
mod optimum;
mod outlier;
mod own_covariance;
mod prediction;
mod proven;
mod recorded;
mod recovered;
mod remains;
mod resampled;
mod rivals;
mod scorer;
mod screen;
mod size;
mod sizes_found;
mod smooth;
mod standing;
mod state;
mod tolerance;
mod validation;

pub use adequacy::{Adequacy, adequacy, deviate};
pub use covariance::{Selection, covariance, read_patterns};
pub use examine::{examine, examine_with, outcome_of_wrong_inputs};
pub use extended::{corrected_readings, extended_state};
pub use frame::{
    GaugeFacts, MassSignature, N_PAYLOAD_COLUMNS, NuisanceLoad, PayloadWeight, PlaneStrainRow,
    Scatter, StiffnessOf, StiffnessSignature, StrainFrame, WheelForces, Wiring,
};
pub use gap::{FoundAnew, Judged, proof_residuals};
pub use likelihood::{Fit, Likelihood};
pub use nuisance::ground_patterns;
pub use prediction::{predict, read_all};
pub use recorded::gauges_installed_otherwise;
pub use recovered::loads_before_after;
pub use state::{Part, StrainState};
pub use tolerance::angle_scatter;
