//! The checked, immutable model. `GridId`-like numbers (`id`) are the file's; `..Ix` are indices into our arrays.

use nastran::cards::{Dofs, ShellShape, SolidShape};
use nastran::place::Place;

/// A point or vector in the basic frame unless said otherwise.
pub type Vec3 = crate::linalg::Vector3<f64>;
/// Rows are the axes of a local frame in the basic frame: `local = R * basic`.
pub type Mat3 = crate::linalg::Matrix3<f64>;

macro_rules! index {
    ($($(#[$doc:meta])* $name:ident),+) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub u32);
        impl $name {
            /// As an array index.
            pub fn us(self) -> usize { self.0 as usize }
        }
    )+};
}
index!(
    /// Index into [`Model::grids`].
    GridIx,
    /// Index into [`Model::frames`]; 0 is the basic frame.
    FrameIx,
    /// Index into [`Model::shells`].
    ShellIx,
    /// Index into [`Model::beams`].
    BeamIx,
    /// Index into [`Model::shell_properties`].
    ShellPropertyIx,
    /// Index into [`Model::beam_properties`].
    BeamPropertyIx,
    /// Index into [`Model::materials`].
    MaterialIx
);

/// A structure as the deck means it.
#[derive(Clone, Debug, Default)]
pub struct Model {
    /// Grids by ascending id.
    pub grids: Vec<Grid>,
    /// Coordinate systems; the first is basic.
    pub frames: Vec<Frame>,
    /// Shells by ascending id.
    pub shells: Vec<Shell>,
    /// Shell properties by ascending id.
    pub shell_properties: Vec<ShellProperty>,
    /// CBAR and CBEAM by ascending id.
    pub beams: Vec<Beam>,
    /// Their properties.
    pub beam_properties: Vec<BeamProperty>,
    /// CROD, CTUBE, CONROD.
    pub rods: Vec<Rod>,
    /// CBUSH.
    pub bushes: Vec<Bush>,
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
    /// RBE1, RBE2, RBE3, RBAR.
    pub rigids: Vec<Rigid>,
    /// MPC sets.
    pub mpcs: Vec<MpcSet>,
    /// The set that holds under unit loads: [`nastran::bdf::CaseControl::mpc_of_structure`].
    pub mpc: Option<u32>,
    /// SPC sets, SPCADD resolved; enforced displacements included.
    pub spcs: Vec<SpcSet>,
    /// SUPORT and SUPORT1 (set id, `None` for SUPORT).
    pub suports: Vec<(Option<u32>, Vec<(GridIx, Dofs)>)>,
    /// Load sets by id, LOAD combinations resolved to weighted primitive loads.
    pub load_sets: Vec<LoadSet>,
    /// Temperature sets by id: default, grid values.
    pub temperatures: Vec<TemperatureSet>,
    /// Cards of the deck that change stiffness, mass, constraints or loads and have no place above: a solver must refuse them.
    pub uncarried: Vec<Uncarried>,
    /// Parameters that change what the model means.
    pub params: Params,
    /// Names of properties and components from comments: (`property id`, name).
    pub property_names: Vec<(u32, String)>,
}

/// What a point of the model is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointKind {
    /// GRID: a place and six dofs.
    Grid,
    /// SPOINT, or the end of a spring without a component: one dof and no place. It is carried as a grid at the origin of the basic
    /// frame whose dofs 2 to 6 are constrained, so that the whole path from cards to answer is that of grids.
    Scalar,
}

/// A grid, or a scalar point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Id in the file.
    pub id: u32,
    /// Which of the two.
    pub kind: PointKind,
    /// Location, basic frame.
    pub x: Vec3,
    /// Displacement coordinate system.
    pub cd: FrameIx,
    /// Permanent constraints.
    pub ps: Dofs,
    /// Where it stands.
    pub at: Place,
}

/// A coordinate system resolved to basic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Id in the file, 0 basic.
    pub id: u32,
    /// What its coordinates are.
    pub kind: nastran::cards::CoordKind,
    /// Origin, basic frame.
    pub origin: Vec3,
    /// Rows are its x, y, z axes in basic.
    pub axes: Mat3,
}

/// A shell element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shell {
    /// Element id.
    pub id: u32,
    /// Shape.
    pub shape: ShellShape,
    /// Grids, corners first; the first `n_grids` count, a missing mid-side grid repeats its corner.
    pub grids: [GridIx; 8],
    /// Property.
    pub property: ShellPropertyIx,
    /// Angle of the material x axis from side 1-2, radians, right-handed about the normal (MCID already projected).
    pub material_angle_rad: f64,
    /// Offset of the reference plane along the normal.
    pub zoffs: f64,
    /// Corner thicknesses (the property's where the card has none).
    pub thickness: [f64; 4],
    /// Where it stands.
    pub at: Place,
}

/// What a shell is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct ShellProperty {
    /// Property id.
    pub id: u32,
    /// Homogeneous or laminate.
    pub kind: ShellKind,
    /// Non-structural mass per area.
    pub nsm: f64,
    /// Fibre distances Z1 (bottom), Z2 (top), from the reference plane.
    pub z: [f64; 2],
    /// Where it stands.
    pub at: Place,
}

/// PSHELL or PCOMP.
#[derive(Clone, Debug, PartialEq)]
pub enum ShellKind {
    /// PSHELL.
    Homogeneous {
        /// Default thickness.
        t: f64,
        /// Membrane; `None`: no membrane stiffness.
        membrane: Option<MaterialIx>,
        /// Bending; `None`: no bending stiffness.
        bending: Option<MaterialIx>,
        /// MID2 is -1: plane strain.
        plane_strain: bool,
        /// Transverse shear; `None`: rigid in shear.
        shear: Option<MaterialIx>,
        /// Membrane-bending coupling.
        coupling: Option<MaterialIx>,
        /// 12 I / t^3.
        bending_ratio: f64,
        /// ts / t.
        shear_ratio: f64,
    },
    /// PCOMP: plies from the bottom up, symmetric ones written out.
    Laminate {
        /// Distance of the bottom surface from the reference plane.
        z0: f64,
        /// Plies.
        plies: Vec<ModelPly>,
        /// LAM as written.
        lam: String,
        /// TREF: where thermal strain counts from; `None`: TREF of the plies' materials.
        tref: Option<f64>,
    },
}

/// A ply.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct ModelPly {
    pub material: MaterialIx,
    pub t: f64,
    pub theta_rad: f64,
}

/// CBAR or CBEAM.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Element id.
    pub id: u32,
    /// A CBEAM.
    pub is_beam: bool,
    /// Ends A, B.
    pub grids: [GridIx; 2],
    /// Property.
    pub property: BeamPropertyIx,
    /// Offsets of the ends from their grids, basic frame.
    pub offsets: [Vec3; 2],
    /// Element axes, rows x (A to B, offsets included), y (in the plane of the orientation vector), z, basic frame.
    pub axes: Mat3,
    /// Released dofs at A, B, element frame.
    pub pins: [Dofs; 2],
    /// Where it stands.
    pub at: Place,
}

/// PBAR, PBARL, PBEAM, PBEAML: sections at least at A and B (x/xb 0 and 1).
#[derive(Clone, Debug, PartialEq)]
pub struct BeamProperty {
    /// Property id.
    pub id: u32,
    /// Material.
    pub material: MaterialIx,
    /// Sections, x/xb ascending; a uniform bar has two equal ones.
    pub sections: Vec<(f64, Section)>,
    /// Shear area factors K1, K2 (0: rigid in shear).
    pub k: [f64; 2],
    /// Section type of PBARL and PBEAML, empty for numbers.
    pub section_type: String,
    /// Where it stands.
    pub at: Place,
}

/// A cross-section.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Section {
    /// Area.
    pub area: f64,
    /// For bending in plane 1 (x-y): integral y^2 dA.
    pub i1: f64,
    /// For bending in plane 2 (x-z): integral z^2 dA.
    pub i2: f64,
    /// Product integral y z dA.
    pub i12: f64,
    /// Torsion constant.
    pub j: f64,
    /// Non-structural mass per length.
    pub nsm: f64,
    /// Recovery points C D E F, (y, z) from the shear centre line.
    pub recovery: [[f64; 2]; 4],
    /// Neutral axis, (y, z) from the shear centre line.
    pub neutral: [f64; 2],
    /// Centre of non-structural mass, (y, z).
    pub nsm_centre: [f64; 2],
    /// Non-structural moment of inertia per length.
    pub nsi: f64,
}

/// CROD, CTUBE, CONROD.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Rod {
    pub id: u32,
    pub card: RodCard,
    pub grids: [GridIx; 2],
    pub material: MaterialIx,
    pub area: f64,
    pub torsion: f64,
    /// Torsional stress coefficient.
    pub c: f64,
    pub nsm: f64,
    pub at: Place,
}

/// Which card a rod came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum RodCard {
    Crod,
    Ctube,
    Conrod,
}

/// CBUSH.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bush {
    /// Element id.
    pub id: u32,
    /// Ends; B is `None` when grounded.
    pub grids: (GridIx, Option<GridIx>),
    /// Element axes, basic frame.
    pub axes: Mat3,
    /// Location of the spring, basic frame.
    pub location: Vec3,
    /// Stiffness by component.
    pub k: [f64; 6],
    /// Stress and strain recovery coefficients SA, ST, EA, ET.
    pub recovery: [f64; 4],
    /// Where it stands.
    pub at: Place,
}

/// CELAS1, CELAS2.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Spring {
    pub id: u32,
    pub k: f64,
    pub stress_coefficient: f64,
    /// Grid and dof (0-based, displacement frame of the grid); `None` ground.
    pub ends: [Option<(GridIx, u8)>; 2],
    pub at: Place,
}

/// A solid element.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Solid {
    pub id: u32,
    pub shape: SolidShape,
    /// Corners first; `None`: no mid-side grid.
    pub grids: [Option<GridIx>; 20],
    /// Index into [`Model::solid_properties`].
    pub property: u32,
    pub at: Place,
}

/// PSOLID.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct SolidProperty {
    pub id: u32,
    pub material: MaterialIx,
    pub cordm: Option<i32>,
    pub options: [Option<String>; 4],
    pub at: Place,
}

/// CSHEAR with its PSHEAR.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct ShearPanel {
    pub id: u32,
    pub grids: [GridIx; 4],
    pub material: MaterialIx,
    pub t: f64,
    pub nsm: f64,
    pub f1: f64,
    pub f2: f64,
    pub at: Place,
}

/// A material.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Material {
    pub id: u32,
    pub kind: MaterialKind,
    /// Density, before WTMASS.
    pub rho: f64,
    pub tref: f64,
    pub at: Place,
}

/// Its law; matrices are stress = G strain with engineering shear.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub enum MaterialKind {
    /// MAT1.
    Isotropic { e: f64, g: f64, nu: f64, alpha: f64 },
    /// MAT2: G11 G12 G13 G22 G23 G33.
    Anisotropic2d { g: [f64; 6], alpha: [f64; 3] },
    /// MAT8; transverse shear moduli of 0 mean rigid.
    Orthotropic {
        e1: f64,
        e2: f64,
        nu12: f64,
        g12: f64,
        g1z: f64,
        g2z: f64,
        alpha: [f64; 2],
    },
    /// MAT9: upper triangle by rows.
    Anisotropic3d { g: [f64; 21], alpha: [f64; 6] },
}

/// A concentrated mass: 6 x 6 about its grid, basic frame, before WTMASS.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointMass {
    /// Element id.
    pub id: u32,
    /// Grid.
    pub grid: GridIx,
    /// Mass matrix in the basic frame, referred to the grid.
    pub matrix: crate::linalg::Matrix6<f64>,
    /// Offset of the centre of gravity from the grid, basic frame (0 for CONM1).
    pub offset: Vec3,
    /// Where it stands.
    pub at: Place,
}

/// A rigid element; dofs are in the displacement frames of their grids.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Rigid {
    pub id: u32,
    pub kind: RigidKind,
    pub at: Place,
}

/// Which rigid element.
#[derive(Clone, Debug, PartialEq)]
pub enum RigidKind {
    /// RBE2, RBAR and RBE1: dependent dofs follow the rigid motion given by the independent ones.
    Body {
        /// Independent dofs, six in all.
        independent: Vec<(GridIx, Dofs)>,
        /// Dependent dofs.
        dependent: Vec<(GridIx, Dofs)>,
        /// Thermal expansion coefficient.
        alpha: f64,
    },
    /// RBE3.
    Mean {
        /// Reference grid.
        reference: GridIx,
        /// REFC.
        refc: Dofs,
        /// Weight, dofs, grid.
        arms: Vec<(f64, Dofs, GridIx)>,
        /// UM: dofs made dependent instead of REFC; empty: REFC is dependent.
        um: Vec<(GridIx, Dofs)>,
    },
}

/// The equations of one MPC set id (MPCADD resolved): terms grid, dof (0-based), coefficient; the first is dependent.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct MpcSet {
    pub sid: u32,
    pub equations: Vec<(Vec<(GridIx, u8, f64)>, Place)>,
}

/// The constraints of one SPC set id (SPCADD resolved): grid, dofs, enforced value.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct SpcSet {
    pub sid: u32,
    pub terms: Vec<(GridIx, Dofs, f64)>,
}

/// One load set: weighted primitive loads.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct LoadSet {
    pub sid: u32,
    pub loads: Vec<(f64, Load)>,
}

/// One temperature set (TEMP, TEMPD): what TEMPERATURE(LOAD) selects.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct TemperatureSet {
    pub sid: u32,
    /// TEMPD: temperature of grids that `grids` leaves out.
    pub default: Option<f64>,
    pub grids: Vec<(GridIx, f64)>,
    /// Temperatures of single elements by id (TEMPP1, TEMPRB): they go before those of their grids.
    pub elements: std::collections::HashMap<u32, ElementTemperature>,
    /// Cards of this set that ask for more than is carried.
    pub unsupported: Vec<(String, Place)>,
    pub at: Place,
}

impl TemperatureSet {
    /// Temperature of each of the `n` grids of the model.
    pub fn by_grid(&self, n: usize) -> Vec<f64> {
        let mut all = vec![self.default.unwrap_or(0.0); n];
        for (g, t) in &self.grids {
            if let Some(slot) = all.get_mut(g.us()) {
                *slot = *t;
            }
        }
        all
    }
}

/// Temperature of an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ElementTemperature {
    /// TEMPP1: of the reference plane, and dT/dz along the element normal.
    Plate {
        /// TBAR.
        mean: f64,
        /// TPRIME.
        gradient: f64,
    },
    /// TEMPRB: mean of the section at A and B; gradients along element y and z at A and B.
    Line {
        /// TA, TB.
        ends: [f64; 2],
        /// Along y: at A, B; along z: at A, B.
        gradient: [[f64; 2]; 2],
    },
}

/// A card that the model does not carry.
#[derive(Clone, Debug, PartialEq)]
pub struct Uncarried {
    /// Its name.
    pub card: String,
    /// Its element id or set id.
    pub id: Option<u32>,
    /// Where it stands.
    pub at: Place,
}

/// A primitive load, vectors in the basic frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Load {
    /// Force at a grid.
    Force(GridIx, Vec3),
    /// Moment at a grid.
    Moment(GridIx, Vec3),
    /// Pressure on shells along their normal (corner values).
    ShellPressure {
        /// Which shells.
        shells: Vec<ShellIx>,
        /// Pressure at the corners.
        pressure: [f64; 4],
        /// Direction instead of the normal, unit vector.
        direction: Option<Vec3>,
    },
    /// Pressure on a face given by grids (PLOAD, PLOAD4 on solids), right-hand rule of the order; the fourth may be missing.
    FacePressure {
        /// Corners.
        grids: [Option<GridIx>; 4],
        /// Pressure at them.
        pressure: [f64; 4],
        /// Direction instead of the normal.
        direction: Option<Vec3>,
    },
    /// Acceleration field of GRAV.
    Gravity(Vec3),
    /// Centrifugal forces of RFORCE.
    Spin {
        /// A point on the axis.
        centre: Vec3,
        /// Angular velocity, radians per unit of time.
        omega: Vec3,
    },
    /// Force or moment along a CBAR or CBEAM (PLOAD1).
    Line {
        /// Which one.
        beam: BeamIx,
        /// Share of the length, offsets included, where it begins and ends; equal: concentrated there.
        span: [f64; 2],
        /// Per length at both ends of the span, the concentrated one first; element axes.
        force: [Vec3; 2],
        /// Likewise.
        moment: [Vec3; 2],
    },
    /// SPCD: another enforced displacement of dofs that an SPC set holds, displacement frame.
    Enforced {
        /// Grid.
        grid: GridIx,
        /// Its dofs.
        dofs: Dofs,
        /// Displacement or rotation.
        value: f64,
    },
    /// A load that the solver does not carry yet: the card's name and place, so that it can be refused by name.
    Unsupported(String, Place),
}

/// Parameters that change what the model means, with the deck's value or the default.
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// WTMASS, default 1.
    pub wtmass: f64,
    /// GRDPNT, `None` where absent.
    pub grdpnt: Option<u32>,
    /// INREL, default 0.
    pub inrel: i32,
    /// K6ROT, default 100.
    pub k6rot: f64,
    /// SNORM in radians, default 20 degrees.
    pub snorm_rad: f64,
    /// AUTOSPC, default yes.
    pub autospc: bool,
    /// COUPMASS > 0.
    pub coupmass: bool,
    /// POST.
    pub post: Option<i64>,
    /// OMID yes: element output in the material frame.
    pub omid: bool,
    /// UNITSYS as written.
    pub unitsys: Option<String>,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            wtmass: 1.0,
            grdpnt: None,
            inrel: 0,
            k6rot: 100.0,
            snorm_rad: 20_f64.to_radians(),
            autospc: true,
            coupmass: false,
            post: None,
            omid: false,
            unitsys: None,
        }
    }
}
