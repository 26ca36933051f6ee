//! The model in three dimensions: its skin by property, strain of load cases as colour, gauges, loads as arrows.

mod coarse;
mod drawing;
mod outline;
mod paint;
mod skin;
mod solids;
mod types;

pub use drawing::{SceneView, scene_section};
pub use types::{Arrow, ArrowSet, Field, Mark, Scene, Twist};

#[cfg(test)]
mod tests;
