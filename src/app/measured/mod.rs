//! Measured data: the one reader of readings, runs and records.
//!
//! [`open`] tells runs from records and opens them: [`strain_file`] runs and short records as a table, [`record`] a record of any length a
//! piece at a time. [`means`] sums over a file, [`gauge_columns`] columns and units by gauge, [`zero`] readings less their zero, [`reference`]
//! the strain of the reference state, [`runs_file`] what else was recorded in each run.

pub(in crate::app) mod columns;
pub(in crate::app) mod faults;
pub mod gauge_columns;
pub mod means;
mod open;
pub(in crate::app) mod record;
pub(in crate::app) mod reference;
pub mod runs_columns;
pub mod runs_file;
pub mod strain_file;
pub mod strain_table;
pub mod strain_text;
pub(in crate::app) mod zero;

pub(in crate::app) use open::{MeasuredStrain, open};
