//! Wrong inputs: readings and recorded loads with another sign, in another unit, or under each other's name, gauges that are dead or installed
//! otherwise than stated. They are searched for before any effect of a model is.
//!
//! [`search_faults`] undoes each [`InputFault`] in turn and asks a [`Misfit`] how well the rest agrees; whoever has readings and a measure of their
//! errors implements one. [`faults_of_recorded_loads`] compares recorded loads with the readings.

mod fault;
mod known_loads;
mod recorded_loads;
mod search;
#[cfg(test)]
mod tests;

pub use fault::{AlternativeRows, Channels, Found, Handling, InputFault, Inputs, not_explained_by};
pub use known_loads::KnownLoads;
pub use recorded_loads::{
    RecordFault, RecordedRuns, faults_of_recorded_loads, findings_of_recorded_loads,
    recorded_mass_contradicted,
};
pub use search::{Fitted, Misfit, Rules, search_faults};
