//! S from runs of known load, combined with the model's S if the job has a model.
//!
//! `eps_r = S f_r + e_r`. S is unknown with a Gaussian prior: rows of the model with a stated relative error (`prior`), or almost no information.
//! `posterior` solves for all entries together, because the scatter of repeats (`scatter`) is correlated across gauges. `load_correction` corrects
//! uncertain known loads. `held_out` leaves out each run in turn and states how far intervals must be widened. `label_exchange` finds two runs with
//! exchanged labels.
//!
//! `shift` computes the shift of each gauge. `cause` finds its cause by the `evidence` of its readings, and `installed_position` estimates its
//! position. `next` finds the load with the most information. `undetermined_combinations` finds the combinations that no run determines.
//! `unknown_directions` finds the directions that runs with a known sum leave open. `lack_of_fit` tests terms beyond the straight line, `common_zero`
//! models one of them, and `check` recovers check runs.

mod cause;
mod check;
mod common_zero;
mod dependence;
mod evidence;
mod excluded_runs;
mod fit;
mod given_others;
mod held_out;
mod identical_columns;
mod installed_gauges;
mod installed_position;
mod known_load_faults;
mod label_exchange;
mod lack_of_fit;
mod load_correction;
mod loading;
mod model_error;
mod next;
mod overfit;
mod posterior;
mod prior;
mod range;
mod runs;
mod scatter;
mod shift;
mod start;
mod state;
mod terms_held_out;
mod types;
mod undetermined_combinations;
mod unknown_directions;

pub use check::{CheckedRun, recover_checks};
pub use dependence::{Dependence, depends_on};
pub use fit::calibrate;
pub use installed_gauges::{GlueTolerance, calibrate_installed_gauges};
pub use next::{NextRun, next_runs};
pub use types::*;
pub use unknown_directions::known_of;

#[cfg(test)]
mod tests;
