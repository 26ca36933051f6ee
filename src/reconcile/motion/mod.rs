//! The acceleration path: a vehicle's equations of motion against a record.
//!
//! - [`frame`]: what is given; [`design`]: the equations as transforms within the band
//! - [`response`], [`noise`], [`gls`]: how sensor noise enters, and least squares that respects it
//! - [`change`], [`candidate`], [`effect`]: the library; [`fit`]: a set of effects fitted; [`scorer`]: its evidence
//! - [`backdrop`]: what nothing explains; [`gap`]: how much is left on other data; [`examine`]: the verdict; [`simulated`]: what was named, by simulation

pub mod backdrop;
pub mod candidate;
pub mod change;
pub mod channel_check;
pub mod course;
pub mod design;
pub mod effect;
pub mod examine;
pub mod fit;
pub mod frame;
pub mod gap;
pub mod gls;
pub mod noise;
pub mod outcome;
pub mod response;
pub mod scorer;
pub mod simulated;

pub use examine::examine;
pub use frame::MotionFrame;
pub use outcome::{MotionEffect, MotionOutcome};
pub use simulated::{SimulatedChannel, SimulatedGap, simulated_gap};
