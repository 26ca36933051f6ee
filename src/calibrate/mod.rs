//! S learnt from runs of known load, fused with the model's S where there is one.
//!
//! `eps_r = S f_r + e_r`, S unknown with a Gaussian prior: rows of the model with a stated relative error ([`prior`]), or next to nothing.
//! [`posterior`] solves for all entries together, because the scatter of repeats ([`scatter`]) goes across gauges; [`known`] carries the
//! errors of the loads themselves; [`held_out`] leaves out run by run and states how far intervals must be widened; [`exchanged`] finds two
//! runs with each other's label; [`shift`] says how
//! each gauge moved, [`cause`] what that looks like by the [`evidence`] of its readings, [`glued`] where it sits, [`next`] which load would
//! tell most, [`undetermined`] what no run has shown, [`unknown`] what runs weighed by a sum leave open. [`lack_of_fit`]
//! tests terms beyond the straight line, [`common_zero`] models one of them, [`check`] recovers check runs.

mod as_glued;
mod cause;
mod check;
mod common_zero;
mod dependence;
mod evidence;
mod exchanged;
mod excluded;
mod fit;
mod given_others;
mod glued;
mod held_out;
mod identical;
mod known;
mod lack_of_fit;
mod loading;
mod model_error;
mod next;
mod overfit;
mod posterior;
mod prior;
mod range;
mod recorded;
mod runs;
mod scatter;
mod shift;
mod start;
mod state;
mod terms_held_out;
mod types;
mod undetermined;
mod unknown;

pub use as_glued::{GlueTolerance, calibrate_as_glued};
pub use check::{CheckedRun, recover_checks};
pub use dependence::{Dependence, depends_on};
pub use fit::calibrate;
pub use next::{NextRun, next_runs};
pub use types::*;
pub use unknown::known_of;

#[cfg(test)]
mod tests;
