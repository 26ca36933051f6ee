//! Wrong inputs: readings, recorded loads and vehicle records with another sign, in another unit, or under each other's name. They are searched for
//! before any effect of a model is.

mod motion;
mod recorded_loads;
#[cfg(test)]
mod tests;

pub use motion::{
    ChannelKind, ChannelSource, ExplainedFault, MotionChannel, MotionFault, MotionRecord,
    MotionScale, channels_by_gravity, fault_of_motion, faults_by_gravity, finding_of_motion,
    finding_of_scale, findings_by_gravity,
};
pub use recorded_loads::{
    RecordFault, RecordedRuns, faults_of_recorded_loads, findings_of_recorded_loads,
    recorded_mass_contradicted,
};
