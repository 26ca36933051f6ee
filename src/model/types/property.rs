//! Properties and materials of elements.

use super::index::MaterialIx;
use nastran::place::Place;

/// Property of a shell.
#[derive(Clone, Debug, PartialEq)]
pub struct ShellProperty {
    /// Property id.
    pub id: u32,
    /// Homogeneous or laminate.
    pub kind: ShellKind,
    /// Non-structural mass per area.
    pub nsm: f64,
    /// Stated fibre distances Z1 (bottom), Z2 (top) from the reference plane. `None` stands for half the local thickness ([`ShellProperty::fibres`]).
    pub z: [Option<f64>; 2],
    /// Place in the deck.
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

/// PBAR, PBARL, PBEAM, PBEAML: sections at least at A and B (x/xb 0 and 1).
#[derive(Clone, Debug, PartialEq)]
pub struct BeamProperty {
    /// Property id.
    pub id: u32,
    /// Material.
    pub material: MaterialIx,
    /// Sections with ascending x/xb. A uniform bar has two equal sections.
    pub sections: Vec<(f64, Section)>,
    /// Shear area factors K1, K2 (0: rigid in shear).
    pub k: [f64; 2],
    /// Section type of PBARL and PBEAML, empty for numbers.
    pub section_type: String,
    /// Centroid of a PBARL section, (y, z) from its shear centre. It is zero for other cards. The element axis of a CBAR passes through both points.
    pub bar_centroid: [f64; 2],
    /// Warping constant CW at A and B (integral omega^2 dA). Only elements with warping points use it.
    pub warping: [f64; 2],
    /// Place of the card in the deck.
    pub at: Place,
}

/// A cross-section.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Section {
    /// Area.
    pub area: f64,
    /// Moment of inertia for bending in plane 1 (x-y): integral y^2 dA.
    pub i1: f64,
    /// Moment of inertia for bending in plane 2 (x-z): integral z^2 dA.
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

/// Law of a material; matrices are stress = G strain with engineering shear.
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
