//! Measured data: the only reader of readings, runs and records.
//!
//! `open` distinguishes runs and records and opens them. [`strain_file`] reads runs and short records as a table; `record` reads a record of any
//! length a piece at a time. [`means`] sums over a file, [`gauge_columns`] assigns columns and units to gauges, and `zero` subtracts the zero.
//! `reference` computes the strain of the reference state. [`runs_file`] reads further data recorded in each run, and `recorded_loads` reads loads of
//! another instrument.

pub(crate) mod columns;
pub(crate) mod common_zero;
pub mod conditioning;
pub mod conditioning_step;
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
