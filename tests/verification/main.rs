//! Compares the built-in solver with closed forms, published benchmarks and results of other solvers.

#![allow(clippy::print_stderr, reason = "numbers for the tables in docs")]

mod accelerations;
mod adjoint;
mod balance;
mod connector_faults;
mod connectors;
mod coupled_mass;
mod decks;
#[path = "../drawn/mod.rs"]
mod drawn;
mod frame_calibrated;
mod frame_refined;
mod frame_units;
mod hot_materials;
mod invariants;
mod laminates;
mod line_loads;
mod macneal_harder;
mod masses;
mod mesh;
mod modes;
mod plates;
mod pressures;
mod quadratic_shells;
mod real_cases;
mod real_deck_limits;
mod real_decks;
mod sections;
mod small_decks;
mod solids;
mod springs_in_series;
#[path = "../../nastran/tests/support/mod.rs"]
mod support;
mod supports;
mod thermal;
mod ties;
mod variants;
mod warping;
mod whole_decks;
mod written;
