//! The size and place of one load that is not measured directly: a payload, or the masses that a model lacks.

mod robust;
#[cfg(test)]
mod tests;

pub use robust::{
    GaugeEstimates, GaugeVerdict, RobustPayload, RobustSpec, RunPayload, robust_payload,
};
