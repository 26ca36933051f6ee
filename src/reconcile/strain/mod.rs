//! The static strain path: frame, exact prediction, covariance, evidence.

mod adequacy;
mod alternatives;
mod bias;
mod calibration_scatter;
mod companions;
mod covariance;
mod detect;
mod evidence;
mod examine;
mod explanation;
mod extended_strain_model;
mod frame;
mod gap;
mod input_fault_search;
mod likelihood;
mod neighbours;
mod next;
mod no_drift;
mod nuisance;
mod optimum;
mod outlier;
mod own_covariance;
mod prediction;
mod recovered_loads;
mod recurring_effects;
mod remains;
mod resampled_runs;
mod scorer;
mod screen;
mod size;
mod sizes_found;
mod smooth_alternative;
mod state;
mod tolerance;
mod unproven_effects;
mod validation;
mod verdict;

pub use adequacy::{Adequacy, adequacy, deviate};
pub use covariance::{Selection, covariance, read_patterns};
pub use examine::{examine, examine_with, outcome_of_wrong_inputs};
pub use extended_strain_model::{corrected_readings, extended_state};
pub use frame::{
    GaugeFacts, MassSignature, N_PAYLOAD_COLUMNS, NuisanceLoad, PayloadWeight, PlaneStrainRow,
    Scatter, StiffnessOf, StiffnessSignature, StrainFrame, WheelForces, Wiring,
};
pub use gap::{ReestimatedUnknowns, ValidationResiduals, proof_residuals};
pub use input_fault_search::gauges_installed_otherwise;
pub use likelihood::{Fit, Likelihood};
pub use nuisance::ground_patterns;
pub use prediction::{predict, read_all};
pub use recovered_loads::loads_before_after;
pub use state::{Part, StrainState};
pub use tolerance::angle_scatter;
