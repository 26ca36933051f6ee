//! The application: a [`job::Job`] and a [`context::Context`] in, an [`outcome::Outcome`] out; one module a workflow.
//!
//! What they share: [`work`] (files read, findings, seconds of a question on its way), [`files`] (reading), [`store`] (kept solutions),
//! [`fault`] (bad input), [`job`] (job.toml and the tables it names), [`strain`] (the one chain from job to S).

pub mod ballast;
pub mod calibrate;
pub mod cases;
pub mod check;
mod combined_subcases;
pub mod context;
pub mod deck;
pub mod explain;
pub mod fault;
pub mod file_read;
pub mod files;
pub mod fleet;
pub mod half_written;
pub mod identify;
pub mod init;
pub mod job;
mod job_deck;
mod manifest;
pub mod measured;
pub mod modes;
mod named_results;
mod not_solved;
pub mod outcome;
pub mod output;
pub mod payload;
pub mod place;
pub mod reconcile;
pub mod recover;
pub mod respond;
pub mod sensitivity;
mod sheet;
pub mod solve;
mod solved;
pub mod store;
pub mod strain;
pub mod strains;
pub mod study;
pub mod vehicle;
pub mod verify;
mod what_is;
mod wheels;
mod whole_file;
pub mod words;
pub mod work;
