//! Measured data: the one reader of readings, runs and records.
//!
//! [`open`] tells runs from records and opens them: [`strain_file`] runs and short records as a table, [`record`] a record of any length a
//! piece at a time. [`means`] sums over a file, [`gauge_columns`] columns and units by gauge, [`zero`] readings less their zero, [`reference`]
//! the strain of the reference state, [`runs_file`] what else was recorded in each run, [`recorded_loads`] loads of another instrument.

pub(crate) mod columns;
pub(crate) mod common_zero;
pub(crate) mod faults;
pub mod gauge_columns;
pub mod means;
pub mod noise;
mod open;
pub(crate) mod record;
pub(crate) mod recorded_loads;
pub(crate) mod reference;
pub mod runs_columns;
pub mod runs_file;
pub mod strain_file;
pub mod strain_table;
pub mod strain_text;
pub(crate) mod wheels;
pub(crate) mod zero;

#[cfg(test)]
mod tests;

pub(crate) use open::{MeasuredStrain, open};
