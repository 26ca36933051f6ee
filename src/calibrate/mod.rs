//! S from runs of known load, combined with the model's S if the job has a model.
//!
//! `eps_r = S f_r + e_r`, S unknown with a Gaussian prior: rows of the model with a stated relative error (`prior`), or almost no information.
//! `posterior` solves for all entries together, because the scatter of repeats (`scatter`) is correlated across gauges. `known` carries the
//! errors of the loads. `held_out` leaves out run by run and states how far intervals must be widened. `exchanged` finds two runs with each
//! other's label. `shift` computes the shift of each gauge, `cause` its cause by the `evidence` of its readings, `glued` its installed
//! position. `next` finds the load with the most information, `undetermined` the combinations that no run determines, `unknown` the directions
//! that runs with a known sum leave open. `lack_of_fit` tests terms beyond the straight line, `common_zero` models one of them, `check`
//! recovers check runs.

mod as_glued;
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

pub use as_glued::{GlueTolerance, calibrate_as_glued};
pub use check::{CheckedRun, recover_checks};
pub use dependence::{Dependence, depends_on};
pub use fit::calibrate;
pub use next::{NextRun, next_runs};
pub use types::*;
pub use unknown_directions::known_of;

#[cfg(test)]
mod tests;
