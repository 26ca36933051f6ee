//! Model of a deck: ids resolved, coordinates in the basic frame, defaults applied, faults listed.
//!
//! [`Model::from_cards`] builds it, with one file for each kind of card. [`ModelFault`] describes a fault; [`Model::weight`] computes the mass.

mod beam;
mod beam_property;
mod build;
mod case_params;
mod connector;
mod constraint;
mod duplicates;
mod elements;
mod face;
mod fault;
mod fibre;
mod frame;
mod grids;
mod isotropic;
mod line;
mod load;
mod load_sum;
mod mass;
mod material;
mod material_at;
mod model_parameters;
mod nonstructural;
mod normals;
mod not_carried;
mod own_property;
mod params;
mod point_mass;
mod property_names;
mod refine;
mod rigid;
mod rigid_bush;
mod scalar_mass;
mod section;
mod set_sum;
mod shape_functions;
mod shell;
mod solid;
mod spline;
mod table;
mod temperature_gaps;
mod types;
mod unsupported_cards;

#[cfg(test)]
mod tests;

pub(crate) use elements::ElementRef;
#[cfg(feature = "report")]
pub(crate) use face::faces as solid_faces;
pub use fault::*;
pub use fibre::Fibres;
pub use mass::Weight;
pub use refine::RefinedModel;
pub(crate) use shape_functions::{face_edges, face_functions, solid_edges, solid_functions};
pub use types::*;
