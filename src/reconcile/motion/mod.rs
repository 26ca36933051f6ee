//! Reconciliation of a vehicle's equations of motion with an acceleration record.
//!
//! - [`frame`]: the inputs; [`design`]: the equations as transforms within the band
//! - [`response`], [`noise`]: how sensor noise enters the equations
//! - [`change`], [`candidate`], [`effect`]: the library; [`fit`]: the fit of a set of effects; [`scorer`]: the evidence of the set
//! - [`unexplained_background`]: the power that no effect explains; [`gap`]: the residual on other data; `examine`: the verdict
//! - [`sits`]: the equation, time and amplitude at which a gap is largest; `next`: the next measurement
//! - [`simulation_gap`]: the error of a simulation with the named effects

pub mod alias;
pub mod at_rest;
pub mod candidate;
pub mod change;
pub mod channel_check;
mod clock_rate;
pub mod columns;
pub mod corrections;
pub mod design;
pub mod detection_limits;
pub mod effect;
pub mod effect_units;
pub mod evidence;
pub mod examine;
pub mod fit;
pub mod floor;
pub mod frame;
pub mod gap;
pub mod gap_profile;
pub mod limits;
pub mod moments;
pub mod motion_fit;
mod next;
pub mod noise;
pub mod outcome;
pub mod part;
mod ranked_sets;
pub mod response;
pub mod scorer;
mod sentences;
pub mod simulation_gap;
pub mod sits;
mod sound;
pub mod unexplained_background;
mod unproven_effects;
pub mod verdict;
mod zeros;

pub use examine::examine;
pub use frame::MotionFrame;
pub use outcome::{MotionEffect, MotionOutcome};
pub use simulation_gap::{SimulatedChannel, SimulatedGap, simulated_gap};
