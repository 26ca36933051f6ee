//! The built-in solver against closed forms, published benchmarks and other solvers' results.

mod decks;
mod frame_units;
mod invariants;
mod macneal_harder;
mod mesh;
mod real_cases;
