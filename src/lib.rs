//! strainbridge uses a structure as a load cell.
//!
//! Data flows one way, and so do imports (`tests/tidy/main.rs` checks it):
//!
//! | row | module | turns | into |
//! |---|---|---|---|
//! | 10 | [`cli`] | arguments | calls of row 8, exit codes |
//! | 9 | [`report`] | outcomes | html, pdf, csv, xlsx, vtu, op2 |
//! | 8 | [`workflow`] | a [`Job`] and a [`Context`] | an [`Outcome`]: one module a command |
//! | 7.8 | [`measured`] | files of readings, runs and records | readings by gauge, with units, times and zero |
//! | 7.7 | [`strain_chain`] | a job's deck, results, gauges | S with its uncertainty |
//! | 7.6 | [`mod@job`] | job.toml and the tables it names | a checked [`Job`], every fault with its line |
//! | 7.5 | [`host`] | paths | files, kept solutions, the output folder, progress |
//! | 7 | [`mod@reconcile`], [`mod@study`], [`mod@payload`], [`mod@calibrate`] | channels | ranked effects, studies, payload masses, a calibrated S |
//! | 6 | [`placement`], [`recovery`], [`mod@respond`], [`vehicle`] | S, strain, accelerations | layouts, loads, stress |
//! | 5 | [`mod@sensitivity`] | [`fe::Solution`]s and [`gauge::Gauge`]s | S in eps = S f |
//! | 4 | [`gauge`] | strain at a place | the reading of that gauge |
//! | 3 | [`fe`] | [`model::Model`] and load cases, or result files | [`fe::Solution`] |
//! | 2 | [`model`] | a deck's cards | a checked, immutable [`model::Model`] |
//! | 1 | [`series`], [`input_faults`], [`units`], [`estimate`], [`linalg`], [`finding`], [`stop`] | independent of finite elements | |
//! | 0 | crate `nastran` | bytes | cards and tables |
//!
//! Place gauges and recover loads with one job:
//!
//! ```
//! use strainbridge::{Context, Disk, Folder, Job, Severity};
//!
//! # // The carrier of `examples/frame` with a requested layout, in a temporary folder.
//! # let examples = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/frame");
//! # let folder = std::env::temp_dir().join(format!("strainbridge-lines-{}", std::process::id()));
//! # std::fs::create_dir_all(&folder)?;
//! # for name in ["frame.bdf", "gauges.csv", "strain.csv"] {
//! #     std::fs::copy(examples.join(name), folder.join(name))?;
//! # }
//! # let layout = "[candidates]\nproperties = [1, 2]\nangle_step_deg = 45\n[placement]\ngauges = 12\nspacing = 100.0\n\
//! #     angle_tolerance_deg = 1.0\nposition_tolerance = 2.0\n";
//! # let text = std::fs::read_to_string(examples.join("recover.toml"))?;
//! # std::fs::write(folder.join("truck.toml"), format!("{text}\n{layout}"))?;
//! # std::env::set_current_dir(&folder)?;
//! let job = Job::read("truck.toml", &Disk)?; // every fault with file:line
//! let cx = Context::new(&Disk).store(&Folder::from_job(&job));
//! let plan = strainbridge::place(&job, &cx)?;
//! for g in &plan.gauges {
//!     println!("{} {} {:.1} deg", g.name, g.element, g.angle_deg);
//! }
//! let loads = strainbridge::recover(&job, &cx)?; // runs, sigma, units, findings
//! assert!(loads.findings.worst_severity() < Some(Severity::Error));
//! # assert_eq!(plan.gauges.len(), 12);
//! # assert!(folder.join("truck.cache").is_dir(), "solutions are stored next to the job");
//! # std::env::set_current_dir(examples)?;
//! # std::fs::remove_dir_all(&folder)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Conventions:
//! - strain is dimensionless inside (microstrain only in files and reports), tension positive; shear in an element frame is engineering
//!   shear, in a basic-frame tensor it is tensor shear;
//! - `bottom` is fibre distance Z1, `top` is Z2 of the element normal z = d13 x d24;
//! - angles are radians inside, right-handed about the element normal;
//! - model quantities are in the deck's own units; `units` converts inputs and outputs.
//!
//! The finite element layer does not use gauges, reports do not open files, and numerics do not print.
#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

pub mod calibrate;
#[cfg(feature = "cli")]
pub mod cli;
pub mod estimate;
pub mod fe;
pub mod finding;
pub mod gauge;
pub mod host;
pub mod input_faults;
pub mod job;
pub mod linalg;
pub mod measured;
pub mod model;
#[cfg(feature = "open")]
pub mod open;
pub mod payload;
pub mod placement;
pub mod reconcile;
pub mod recovery;
#[cfg(feature = "report")]
pub mod report;
pub mod respond;
pub mod sensitivity;
pub mod series;
pub mod stop;
pub mod strain_chain;
pub mod study;
pub mod units;
pub mod vehicle;
pub mod workflow;

#[cfg(test)]
#[path = "../nastran/tests/support/mod.rs"]
mod support;

pub use finding::Severity;
pub use host::context::{Context, Disk};
pub use host::fault::{Fault, Faults};
pub use host::outcome::Outcome;
pub use host::store::Folder;
pub use job::Job;

pub use workflow::ballast::ballast;
pub use workflow::calibrate::calibrate;
pub use workflow::cases::cases;
pub use workflow::check::check;
pub use workflow::explain::{explain, explain_all};
pub use workflow::fleet::fleet;
pub use workflow::identify::identify;
pub use workflow::init::{init, init_for};
pub use workflow::modes::{modes, modes_of_deck};
pub use workflow::payload::payload;
pub use workflow::place::place;
pub use workflow::reconcile::reconcile;
pub use workflow::recover::recover;
pub use workflow::respond::respond;
pub use workflow::sensitivity::sensitivity;
pub use workflow::simulate::simulate;
pub use workflow::solve::{solve, solve_deck};
pub use workflow::strains::strains;
pub use workflow::study::study;
pub use workflow::verify::verify;
