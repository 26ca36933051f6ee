//! The Python package: arrays and jobs of Python in, outcomes of the application out. Nothing is decided here.
//!
//! - [`array`]: numpy arrays as slices, without a copy
//! - [`command`]: every command that takes a job or files, by its name
//! - [`counting`]: rainflow cycles of a signal
//! - [`directions`]: strain of shells along any direction
//! - [`editing`]: cards of a deck changed by columns
//! - [`fault`]: faulty input as the exception `strainbridge.Faults`
//! - [`files`]: files on the disk, and files in memory
//! - [`job`]: a checked job
//! - [`outcome`]: outcome of any command
//! - [`placing`], [`recovering`]: layouts and loads of bare matrices
//! - [`plan`]: a plan of gauges in memory
//! - [`reading`]: decks and result files as arrays
//! - [`relaxing`]: weights instead of gauges, and the upper bound
//! - [`table`]: tables for readers of Arrow
//! - [`work`]: threads, the interpreter's lock, Ctrl-C, bugs
//! - [`writing`]: result files and meshes from arrays
//!
//! Users see the Python package with its documentation: `python/strainbridge`.

mod array;
mod command;
mod counting;
mod directions;
mod editing;
mod fault;
mod files;
mod job;
mod outcome;
mod placing;
mod plan;
mod reading;
mod recovering;
mod relaxing;
mod table;
mod work;
mod writing;

/// The engine, as `strainbridge` sees it.
#[pyo3::pymodule]
mod _strainbridge {
    #[pymodule_export]
    use crate::command::{ask, clean, commands, explain, made, schema};
    #[pymodule_export]
    use crate::counting::rainflow;
    #[pymodule_export]
    use crate::directions::strain_along;
    #[pymodule_export]
    use crate::job::{CheckedJob, job_to_json};
    #[pymodule_export]
    use crate::outcome::AnyOutcome;
    #[pymodule_export]
    use crate::placing::place_rows;
    #[pymodule_export]
    use crate::plan::KeptPlan;
    #[pymodule_export]
    use crate::reading::{ReadDeck, ReadResults, shell_strain};
    #[pymodule_export]
    use crate::recovering::recover_rows;
    #[pymodule_export]
    use crate::relaxing::relax;
    #[pymodule_export]
    use crate::table::Table;
    #[pymodule_export]
    use crate::work::fail;
    #[pymodule_export]
    use crate::writing::{op2_bytes, vtu_bytes};
}
