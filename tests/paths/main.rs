//! Runs the program from files to results.

mod cases;
mod combinations;
mod command;
mod deck_rules;
mod first_hour;
mod frame;
mod gauges;
mod job_and_deck;
mod misread;
mod named_properties;
mod names;
mod op2_mesh;
mod placement;
mod sides;
mod sites;
mod spots;
#[path = "../../nastran/tests/support/mod.rs"]
mod support;
mod thickness;
mod wing;
