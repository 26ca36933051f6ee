//! Materials.

use super::fields::Fields;
use crate::cards::{Mat1, Mat2, Mat8, Mat9};

/// Reads MAT1: `mid e g nu rho a tref ge st sc ss mcsid`.
pub(super) fn mat1(f: &mut Fields<'_>) -> Option<Mat1> {
    Some(Mat1 {
        id: f.id()?,
        e: f.blank_or_real()?,
        g: f.blank_or_real()?,
        nu: f.blank_or_real()?,
        rho: f.read_real()?,
        alpha: f.read_real()?,
        tref: f.read_real()?,
        ge: f.read_real()?,
        limits: [limit(f)?, limit(f)?, limit(f)?],
    })
}

/// Reads MAT2: `mid g11 g12 g13 g22 g23 g33 rho a1 a2 a3 tref ge st sc ss mcsid`, 17 words; 23 with six damping terms.
pub(super) fn mat2(f: &mut Fields<'_>) -> Option<Mat2> {
    Some(Mat2 {
        id: f.id()?,
        g: f.reals()?,
        rho: f.read_real()?,
        alpha: f.reals()?,
        tref: f.read_real()?,
        ge: f.read_real()?,
    })
}

/// Reads MAT8: `mid e1 e2 nu12 g12 g1z g2z rho a1 a2 tref` and strengths.
pub(super) fn mat8(f: &mut Fields<'_>) -> Option<Mat8> {
    Some(Mat8 {
        id: f.id()?,
        e1: f.read_real()?,
        e2: f.read_real()?,
        nu12: f.read_real()?,
        g12: f.read_real()?,
        g1z: limit(f)?,
        g2z: limit(f)?,
        rho: f.read_real()?,
        alpha: f.reals()?,
        tref: f.read_real()?,
    })
}

/// Reads MAT9: `mid g1..g21 rho a1..a6 tref ge`, 35 words; 56 with 21 damping terms.
pub(super) fn mat9(f: &mut Fields<'_>) -> Option<Mat9> {
    Some(Mat9 {
        id: f.id()?,
        g: f.reals()?,
        rho: f.read_real()?,
        alpha: f.reals()?,
        tref: f.read_real()?,
        ge: f.read_real()?,
    })
}

/// Reads a real; 0 means blank.
fn limit(f: &mut Fields<'_>) -> Option<Option<f64>> {
    Some(f.blank_or_real()?.filter(|x| *x != 0.0))
}
