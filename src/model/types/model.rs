//! The model as a whole.

use super::constraint::{MpcSet, RigidElement, SpcSet};
use super::index::GridIx;
use super::joint::Joint;
use super::load::{LoadSet, TemperatureSet};
use super::mesh::{
    Beam, Bush, Frame, Grid, GridNormal, PointMass, Rod, ScalarMass, ShearPanel, Shell, Solid,
    Spring,
};
use super::params::Params;
use super::property::{BeamProperty, Material, ShellProperty, SolidProperty};
use super::unsupported_card::UnsupportedCard;
use nastran::cards::Dofs;

/// A structure as described by the deck.
#[derive(Clone, Debug, Default)]
pub struct Model {
    /// Grids by ascending id.
    pub grids: Vec<Grid>,
    /// Coordinate systems. The first one is the basic system.
    pub frames: Vec<Frame>,
    /// Shells by ascending id.
    pub shells: Vec<Shell>,
    /// Shell properties by ascending id. An element that needs a separate property (for its temperature or NSM of ELEMENT) has a copy with the id of
    /// the original. Copies follow after all other properties. Beam properties, solid properties and materials have copies in the same way.
    pub shell_properties: Vec<ShellProperty>,
    /// CBAR and CBEAM by ascending id.
    pub beams: Vec<Beam>,
    /// Properties of beams.
    pub beam_properties: Vec<BeamProperty>,
    /// CROD, CTUBE, CONROD.
    pub rods: Vec<Rod>,
    /// CBUSH.
    pub bushes: Vec<Bush>,
    /// CWELD, CFAST, CGAP, ascending id.
    pub joints: Vec<Joint>,
    /// CELAS1, CELAS2.
    pub springs: Vec<Spring>,
    /// CHEXA, CPENTA, CTETRA.
    pub solids: Vec<Solid>,
    /// Solid properties, ascending id.
    pub solid_properties: Vec<SolidProperty>,
    /// CSHEAR.
    pub shear_panels: Vec<ShearPanel>,
    /// Materials by ascending id.
    pub materials: Vec<Material>,
    /// CONM1, CONM2.
    pub masses: Vec<PointMass>,
    /// CMASS1 to CMASS4, ascending id.
    pub scalar_masses: Vec<ScalarMass>,
    /// SNORM, ascending grid.
    pub normals: Vec<GridNormal>,
    /// RBE1, RBE2, RBE3, RBAR and RSPLINE, and further equations: of rigid components of bushes, and of grids that pierce the patch of a connector.
    pub rigids: Vec<RigidElement>,
    /// MPC sets.
    pub mpcs: Vec<MpcSet>,
    /// MPC set that is active under unit loads: [`nastran::bdf::CaseControl::mpc_of_structure`].
    pub mpc: Option<u32>,
    /// SPC sets that the subcases of the deck's case control select, ascending, each once. Empty for a model without a deck.
    pub selected_spcs: Vec<u32>,
    /// SPC sets. SPCADD is resolved, and enforced displacements are included.
    pub spcs: Vec<SpcSet>,
    /// SUPORT and SUPORT1 (set id, `None` for SUPORT).
    pub suports: Vec<(Option<u32>, Vec<(GridIx, Dofs)>)>,
    /// Load sets by id, LOAD combinations resolved to weighted primitive loads.
    pub load_sets: Vec<LoadSet>,
    /// Temperature sets by id: default, grid values.
    pub temperatures: Vec<TemperatureSet>,
    /// Temperature set for materials with MATT1. With `None` these materials have the values of MAT1.
    pub material_temperature: Option<u32>,
    /// Unsupported cards of the deck that change stiffness, mass, constraints or loads. A solver must refuse them.
    pub unsupported_cards: Vec<UnsupportedCard>,
    /// Parameters that affect the model, its solution or its output.
    pub params: Params,
    /// Names of properties and components from comments: (`property id`, name).
    pub property_names: Vec<(u32, String)>,
}
