//! Wrong inputs. Readings, recorded loads and vehicle records may have another sign, another unit or exchanged names. Gauges may be dead, or
//! installed otherwise than stated. These faults are searched for before any effect of a model.
//!
//! [`search_faults`] undoes each [`InputFault`] in turn and asks a [`Misfit`] how well the other readings agree. A type with readings and a measure
//! of their errors implements `Misfit`. [`faults_of_recorded_loads`] compares recorded loads with the readings, [`fault_of_motion`] tests the
//! channels of a vehicle.

mod fault;
pub mod identical_columns;
mod known_loads;
mod motion;
pub(crate) mod recorded_loads;
mod search;
#[cfg(test)]
mod tests;

pub use fault::{
    AlternativeRows, Channels, DetectedFault, FaultTreatment, InputFault, Inputs, SIGN_OF_ALL,
    not_explained_by,
};
pub use known_loads::KnownLoads;
pub use motion::{
    ChannelKind, ChannelSource, ExplainedFault, MotionChannel, MotionFault, MotionRecord,
    MotionScale, channels_by_gravity, fault_of_motion, faults_by_gravity, finding_by_weight,
    finding_of_motion, finding_of_scale, findings_by_gravity, shows,
};
pub use recorded_loads::{
    RecordFault, RecordedRuns, faults_of_recorded_loads, findings_of_recorded_loads,
    recorded_mass_contradicted,
};
pub use search::{InputFit, Misfit, Rules, search_faults};
