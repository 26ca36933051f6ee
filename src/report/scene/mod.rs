//! The model in three dimensions: its skin by property, strain of load cases as colour, gauges, loads as arrows.

mod drawing;
mod mesh_coarsening;
mod of_job;
mod outline;
mod pack;
mod paint;
mod part;
mod planning_tools;
mod skin;
mod solids;
mod still_picture;
mod types;
mod view;

pub use drawing::scene_section;
pub use of_job::{
    LoadRange, fields_of, mark_of_gap, placed_mark, run_arrows, scene_of, scene_of_job,
    scene_of_loads, scene_of_model, scene_of_solution,
};
pub(in crate::report) use still_picture::draw_still as still_of;
pub use types::{Arrow, ArrowSet, Field, FieldValues, Mark, PickTargets, Places, Scene, Twist};
pub use view::SceneView;

#[cfg(test)]
mod tests;
