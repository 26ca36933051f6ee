//! The Python package: arrays and jobs of Python in, outcomes of the application out. Nothing is decided here.
//!
//! - [`array`]: numpy arrays as slices, without a copy
//! - [`command`]: every command that asks a job or files, by its name
//! - [`counting`]: rainflow cycles of a signal
//! - [`fault`]: bad input as the exception `strainbridge.Faults`
//! - [`files`]: files on the disk, and some held in memory
//! - [`job`]: a checked job
//! - [`outcome`]: an outcome, whatever the command
//! - [`placing`], [`recovering`]: layouts and loads of bare matrices
//! - [`reading`]: decks and result files as arrays
//! - [`work`]: threads, the interpreter's lock, Ctrl-C, bugs
//!
//! What users see, with its documentation, is Python: `python/strainbridge`.

mod array;
mod command;
mod counting;
mod fault;
mod files;
mod job;
mod outcome;
mod placing;
mod reading;
mod recovering;
mod work;

/// The engine, as `strainbridge` sees it.
#[pyo3::pymodule]
mod _strainbridge {
    #[pymodule_export]
    use crate::command::{ask, commands, schema};
    #[pymodule_export]
    use crate::counting::rainflow;
    #[pymodule_export]
    use crate::job::{CheckedJob, job_to_json};
    #[pymodule_export]
    use crate::outcome::Told;
    #[pymodule_export]
    use crate::placing::place_rows;
    #[pymodule_export]
    use crate::reading::{ReadDeck, ReadResults, shell_strain};
    #[pymodule_export]
    use crate::recovering::recover_rows;
    #[pymodule_export]
    use crate::work::fail;
}
