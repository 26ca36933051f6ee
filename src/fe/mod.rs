//! From a model and loads, or from a result file, to strain fields.

mod assembly;
mod autospc;
mod beam_strain;
pub mod belongs;
mod constraint;
mod element;
mod error;
pub mod floor;
pub mod from_results;
mod grid_frames;
mod line_load;
mod load;
mod mass;
mod modes;
mod ply_strain;
mod relief;
mod rigid_motion;
pub mod shell_frame;
mod shell_strain;
mod solid_fields;
mod solution;
mod solve;
pub mod strain_rows;
pub mod strain_tensor;
mod system;
mod temperature;
mod unsupported;

pub use error::{FeError, FreeDof, Refusal};
pub use mass::{MassProperties, mass_properties};
pub use modes::{Mode, free_modes};
pub use ply_strain::ply_strains;
pub use relief::Balance;
pub use shell_strain::Corners;
pub use solution::*;
pub use solve::{
    HeatedStrain, LoadCase, Relief, SolveOptions, SolveReport, Solved, Triplets, loads_of_subcase,
    relief_of, solution_of, solve_cases, solve_displacements, solve_unit_loads,
    supported_stiffness, unit_cases,
};
