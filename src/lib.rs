//! strainbridge turns a structure into its own load cell.
//!
//! Data flows one way, and so do imports (`tests/tidy.rs` checks it):
//!
//! | row | module | turns | into |
//! |---|---|---|---|
//! | 10 | [`cli`] | arguments | calls of row 8, exit codes |
//! | 9 | [`report`] | outcomes | html, pdf, csv, xlsx, vtu, op2 |
//! | 8 | [`app`] | a [`Job`] and a [`Context`] | an [`Outcome`] |
//! | 7 | [`mod@reconcile`], [`mod@study`], [`mod@payload`], [`mod@calibrate`] | measured and predicted channels | ranked effects, studies, weighings, a learnt S |
//! | 6 | [`placement`], [`recovery`], [`mod@respond`], [`vehicle`] | S, strain, accelerations | layouts, loads, stress |
//! | 5 | [`mod@sensitivity`] | [`fe::Solution`]s and [`gauge::Gauge`]s | S in eps = S f |
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
#[cfg(feature = "cli")]
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
#[cfg(feature = "report")]
pub mod report;
pub mod respond;
pub mod sensitivity;
pub mod series;
pub mod study;
pub mod units;
pub mod vehicle;

#[cfg(test)]
#[path = "../nastran/tests/support/mod.rs"]
mod support;

pub use app::context::{Context, Disk};
pub use app::fault::{Fault, Faults};
pub use app::job::Job;
pub use app::outcome::Outcome;
pub use finding::Severity;

pub use app::ballast::ballast;
pub use app::calibrate::calibrate;
pub use app::cases::cases;
pub use app::check::check;
pub use app::explain::{explain, explain_all};
pub use app::fleet::fleet;
pub use app::identify::identify;
pub use app::init::{init, init_for};
pub use app::modes::{modes, modes_of_deck};
pub use app::payload::payload;
pub use app::place::place;
pub use app::reconcile::reconcile;
pub use app::recover::recover;
pub use app::respond::respond;
pub use app::sensitivity::sensitivity;
pub use app::solve::{solve, solve_deck};
pub use app::strains::strains;
pub use app::study::study;
