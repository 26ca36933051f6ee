//! strainbridge turns a structure into its own load cell.
//!
//! Data flows one way, and so do imports (`tests/tidy.rs` checks it):
//!
//! | row | module | turns | into |
//! |---|---|---|---|
//! | 9 | [`cli`] | arguments and files (the only input and output) | exit code |
//! | 8 | [`report`] | plain results | text, json, csv, html |
//! | 7 | [`reconcile`] | measured and predicted channels, a library of effects | the effect that parts them, the gap before and after |
//! | 7 | [`calibrate`] | runs of known load, a prior S | S with its covariance |
//! | 6 | [`placement`], [`recovery`] | a [`sensitivity::Sensitivity`], strain | gauge layouts, [`estimate::LoadEstimate`]s |
//! | 5 | [`sensitivity`] | [`fe::Solution`]s and [`gauge::Gauge`]s | S in eps = S f |
//! | 4 | [`gauge`] | strain at a place | what that gauge reads |
//! | 3 | [`fe`] | [`model::Model`] and load cases, or result files | [`fe::Solution`] |
//! | 2 | [`model`] | a deck's cards | a checked, immutable [`model::Model`] |
//! | 1 | [`units`], [`linalg`], [`series`], [`estimate`], [`finding`] | no word of finite elements here | |
//! | 0 | crate `nastran` | bytes | cards and tables |
//!
//! Conventions, once and for all:
//! - strain is dimensionless inside (microstrain only in files and reports), tension positive; shear in an element frame is engineering
//!   shear, in a basic-frame tensor it is tensor shear;
//! - `bottom` is fibre distance Z1, `top` is Z2 of the element normal z = d13 x d24;
//! - angles are radians inside, right-handed about the element normal;
//! - model quantities are in the deck's own units; `units` converts at the door.
//!
//! The finite element layer never sees a gauge; a report never opens a file; numerics never print.
#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

pub mod app;
pub mod calibrate;
pub mod cli;
pub mod estimate;
pub mod fe;
pub mod finding;
pub mod gauge;
pub mod linalg;
pub mod model;
pub mod payload;
pub mod placement;
pub mod reconcile;
pub mod recovery;
pub mod report;
pub mod respond;
pub mod sensitivity;
pub mod series;
pub mod study;
pub mod units;
pub mod vehicle;
