//! The built-in solver against closed forms, published benchmarks and other solvers' results.

#![allow(clippy::print_stderr, reason = "numbers for the tables in docs")]

mod coupled_mass;
mod decks;
mod frame_refined;
mod frame_units;
mod invariants;
mod laminates;
mod line_loads;
mod macneal_harder;
mod mesh;
mod modes;
mod plates;
mod quadratic_shells;
mod real_cases;
mod real_decks;
mod solids;
#[path = "../../nastran/tests/support/mod.rs"]
mod support;
mod supports;
mod thermal;
mod whole_decks;
mod written;
