//! The rows of the thesis (Stellenbosch 2020, chapters 3.5 and 6) on the truck of `models/`, as in the table of
//! `docs/reference/truck.md`.
//!
//! "Other model" means readings from the same truck with a mesh twice as fine in every direction. Its gauges have
//! position errors of millimetres, an angle error of a degree, 1 % of gain and 1 microstrain of noise.

#[allow(dead_code)]
#[path = "../../examples/truck/beam_frame.rs"]
mod beam_frame;
#[allow(dead_code)]
#[path = "../../examples/truck/deck.rs"]
mod deck;
#[allow(dead_code)]
#[path = "../../examples/truck/parameters.rs"]
mod parameters;
#[allow(dead_code)]
#[path = "../../examples/truck/running_gear.rs"]
mod running_gear;
#[allow(dead_code)]
#[path = "../../examples/truck/shell_frame.rs"]
mod shell_frame;

mod ballast;
#[path = "../drawn/mod.rs"]
mod drawn;
mod gauges;
mod model_bias;
mod nuisance;
mod other_model;
mod own_model;
mod payload;
mod plan_of_the_model;
mod program;
mod story;
mod world;
