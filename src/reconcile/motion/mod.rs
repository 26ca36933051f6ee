//! The acceleration path: a vehicle's equations of motion against a record.
//!
//! - [`frame`]: what is given; [`design`]: the equations as transforms within the band
//! - [`response`], [`noise`]: how sensor noise enters the equations
//! - [`change`], [`candidate`], [`effect`]: the library; [`fit`]: a set of effects fitted; [`scorer`]: its evidence
//! - [`unexplained_background`]: what nothing explains; [`gap`]: how much is left on other data; `examine`: the verdict
//! - [`sits`]: where, when and at which size a gap is largest; `next`: what to measure next
//! - [`simulation_gap`]: what was named, by simulation

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
pub mod judge;
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
mod zeros;

pub use examine::examine;
pub use frame::MotionFrame;
pub use outcome::{MotionEffect, MotionOutcome};
pub use simulation_gap::{SimulatedChannel, SimulatedGap, simulated_gap};
