//! Strain fields of load cases: one type, solved by us or read from a file.

use super::BeamField;
use crate::finding::Finding;
use crate::model::ShellIx;
use std::sync::Arc;

/// Results of one or several load cases on one model.
#[derive(Clone, Debug, Default)]
pub struct Solution {
    /// Results of each load case.
    pub cases: Vec<CaseResult>,
    /// Source of the results: name of the solver or of the file.
    pub source: String,
    /// Findings on the results.
    pub findings: Vec<Finding>,
}

/// Results of one load case.
#[derive(Clone, Debug, Default)]
pub struct CaseResult {
    /// Subcase id.
    pub subcase: u32,
    /// Label or subtitle, for reports.
    pub label: String,
    /// Shell strain.
    pub shells: ShellField,
    /// Bar and beam strain.
    pub beams: BeamField,
    /// Strain of solids. Only solved fields contain it.
    pub solids: SolidField,
    /// Displacements in the basic frame, transformed from the displacement frames of a file: translation and rotation by grid index. Empty if absent,
    /// NaN at a grid without displacements.
    pub displacement: Vec<[f64; 6]>,
}

/// In-plane strain at one fibre in the element's output frame: exx, eyy, gxy (engineering shear).
pub type PlaneStrain = [f64; 3];

/// Strain of shells at the surfaces Z1 and Z2, element output frame.
#[derive(Clone, Debug, Default)]
pub struct ShellField {
    /// Elements with strain, ascending. Load cases with equal elements share the list.
    pub elements: Arc<Vec<ShellIx>>,
    /// Strain at the centre of each element, bottom (Z1) and top (Z2).
    pub centre: Vec<[PlaneStrain; 2]>,
    /// Strain at each corner of each element (G1..G4; NaN for the fourth corner of a triangle). Empty if the result has no corner rows.
    pub corners: Vec<[[PlaneStrain; 2]; 4]>,
    /// Strain was computed from stress and the isotropic material.
    pub from_stress: bool,
}

/// Strain of solids: xx yy zz xy yz zx, engineering shear, in the basic frame or the material frame that PSOLID names.
#[derive(Clone, Debug, Default)]
pub struct SolidField {
    /// Indices into [`crate::model::Model::solids`], ascending.
    pub elements: Arc<Vec<usize>>,
    /// Strain at the centre of each element.
    pub centre: Vec<[f64; 6]>,
    /// Strain at each corner of each element. NaN beyond the corners of the element.
    pub corners: Vec<[[f64; 6]; 8]>,
}
