//! Materials.

/// MAT1: isotropic. Of E, G and nu one may be blank.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Mat1 {
    pub id: u32,
    pub e: Option<f64>,
    pub g: Option<f64>,
    pub nu: Option<f64>,
    pub rho: f64,
    pub alpha: f64,
    pub tref: f64,
    pub ge: f64,
    /// Limits ST, SC, SS.
    pub limits: [Option<f64>; 3],
}

/// MAT2: two-dimensional anisotropic, stress = G strain with engineering shear.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Mat2 {
    pub id: u32,
    /// G11, G12, G13, G22, G23, G33.
    pub g: [f64; 6],
    pub rho: f64,
    pub alpha: [f64; 3],
    pub tref: f64,
    pub ge: f64,
}

/// MAT8: orthotropic shell material.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Mat8 {
    pub id: u32,
    pub e1: f64,
    pub e2: f64,
    pub nu12: f64,
    pub g12: f64,
    pub g1z: Option<f64>,
    pub g2z: Option<f64>,
    pub rho: f64,
    pub alpha: [f64; 2],
    pub tref: f64,
}

/// MAT9: anisotropic solid, upper triangle of G by rows.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Mat9 {
    pub id: u32,
    pub g: [f64; 21],
    pub rho: f64,
    pub alpha: [f64; 6],
    pub tref: f64,
    pub ge: f64,
}
