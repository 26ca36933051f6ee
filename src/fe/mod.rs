//! From a model and loads, or from a result file, to strain fields.

mod adjoint;
mod applied_loads;
mod assembly;
mod autospc;
mod beam_field;
mod beam_strain;
mod combination;
mod constraint;
pub mod deck_result_consistency;
mod element;
mod error;
pub mod floor;
mod formulation;
mod free_motions;
pub mod from_results;
mod grid_frames;
mod ground;
mod hanging_points;
mod held_dependents;
mod lanczos;
mod line_load;
mod load;
mod load_case;
mod load_checks;
mod mass;
mod modal_loads;
mod modes;
mod negative;
mod options;
mod ply_strain;
mod prepared_model;
mod reaction_balance;
mod reactions;
mod reading_changes;
mod relief;
mod report;
mod rigid_motion;
mod scalar_points;
mod shape_checks;
pub mod shell_frame;
mod shell_strain;
mod solid_fields;
mod solution;
mod solve;
mod strain_of_cases;
pub mod strain_rows;
pub mod strain_tensor;
mod support;
mod system;
mod temperature;
mod thermal_force;
mod unsupported_cards;
mod variants;
mod weight;
mod what_hangs;

pub use adjoint::{Adjoint, StrainTerm};
pub use beam_field::BeamField;
pub use combination::{combine_balances, combine_reactions, combine_results};
pub(crate) use element::beam::section_at;
pub use error::{FeError, FreeDof, Refusal};
pub use free_motions::determinate_dofs;
pub use held_dependents::held_dependents;
pub use load_case::{LoadCase, Relief, UnitLoad};
pub use mass::MassProperties;
pub use modal_loads::modal_loads;
pub use modes::{ModalSolution, Mode, solve_modes};
pub use options::{Corners, HeatedStrain, SolveOptions};
pub use ply_strain::ply_strains;
pub use reactions::{Reaction, Reactions};
pub use reading_changes::reading_changes;
pub use relief::Balance;
pub use report::{DisplacementSolution, SolveReport};
pub use shape_checks::check_shapes;
pub use solution::*;
pub use solve::{
    Triplets, factor_on_paper, solution_of, solve_cases, solve_displacements, solve_unit_loads,
    solve_unit_loads_on, supported_stiffness,
};
pub use support::{
    Support, SupportChoice, SupportError, contradictions, relief_finding, suport_without_inrel,
    support_of,
};
pub(crate) use temperature::is_heated;
pub use unsupported_cards::refuse;
pub(crate) use unsupported_cards::unsupported_cards;
pub use variants::solve_variants;
pub(crate) use weight::mass_moved;
