//! Measured data: the one reader of readings, runs and records.
//!
//! [`strain_file`] runs and short records as a table, [`record`] a record of any length a piece at a time, [`means`] sums over a file,
//! [`gauge_columns`] columns and units by gauge, [`zero`] readings less their zero, [`reference`] the strain of the reference state,
//! [`runs_file`] what else was recorded in each run.

pub(in crate::app) mod columns;
pub mod gauge_columns;
pub mod means;
pub(in crate::app) mod record;
pub(in crate::app) mod reference;
pub mod runs_columns;
pub mod runs_file;
pub mod strain_file;
pub mod strain_table;
pub mod strain_text;
pub(in crate::app) mod zero;
