//! The commands: a [`Job`](crate::job::Job) or files and a [`Context`](crate::host::context::Context) in, an
//! [`Outcome`](crate::host::outcome::Outcome) out; one module a command.
//!
//! Each reads its input through [`job`](crate::job), [`measured`](crate::measured) and [`strain_chain`](crate::strain_chain), computes with
//! the rooms below, and collects findings on its way.

pub mod ballast;
pub mod calibrate;
pub mod cases;
pub mod check;
pub mod explain;
pub mod fleet;
pub mod identify;
pub mod init;
pub mod modes;
pub mod payload;
pub mod place;
pub mod reconcile;
pub mod recover;
pub mod respond;
pub mod sensitivity;
pub mod simulate;
pub mod solve;
pub mod strains;
pub mod study;
pub mod vehicle;
pub mod verify;
