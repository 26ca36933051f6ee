//! Vehicles as rigid bodies on springs: parameters and wheel loads from accelerations.
//!
//! - [`layout`]: bodies, accelerometers, wheels and links of a vehicle; [`term`]: terms of a link force; [`preset`]: vehicles that a job can name
//! - [`motion`]: measured channels made comparable; [`equations`]: the equations of motion, linear in the parameters
//! - [`fit`]: weighted least squares with bounds; [`interval`]: covariance under coloured residuals
//! - [`identify`]: the whole identification, with messages on [`identifiability`], [`checks`] and [`wrong_inputs`]
//! - [`loads`]: wheel forces; [`chassis`]: chassis forces
//! - [`stretch`]: slow stretch from force, for frequencies at which integration drifts
//! - [`simulate`]: simulation in time; [`refine`]: nonlinear parameters by simulation error
//! - [`response`]: response of a vehicle with known parameters to a record; [`tyre`]: tyres on a road

pub mod adequacy;
pub mod adjustment;
mod body_motion;
pub mod chassis;
pub mod checks;
pub mod equations;
pub mod fit;
pub mod identifiability;
pub mod identification;
pub mod identify;
pub mod interval;
mod known_body;
pub mod layout;
mod limiter;
mod link_motion;
pub mod loads;
pub mod misfit;
pub mod motion;
mod part_answer;
mod part_problem;
pub mod preset;
pub mod refine;
pub mod response;
pub mod simulate;
pub mod stretch;
pub mod term;
pub mod treatment;
pub mod tyre;
pub mod wrong_inputs;

#[cfg(test)]
mod tests;
