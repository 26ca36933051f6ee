//! `fleet` as a user runs it.

mod command;
mod compared;
mod days;
#[path = "../drawn/mod.rs"]
mod drawn;
mod health;
mod program;
mod records;
