//! Wrong inputs: readings and recorded loads with another sign, in another unit, or under each other's name. They are searched for before any
//! effect of a model is.

mod recorded_loads;
#[cfg(test)]
mod tests;

pub use recorded_loads::{
    RecordFault, RecordedRuns, faults_of_recorded_loads, findings_of_recorded_loads,
    recorded_mass_contradicted,
};
