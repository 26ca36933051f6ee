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

/// MATT1: tables that give fields of a MAT1 at a temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matt1 {
    /// Id of the MAT1.
    pub id: u32,
    /// Table ids in the order of the fields of MAT1 behind its id: E, G, NU, RHO, A, TREF, GE, ST, SC, SS.
    pub tables: [Option<u32>; 10],
}

/// TABLEM1 to TABLEM4: a material property as a function of temperature.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialTable {
    /// Table id.
    pub id: u32,
    /// Form of the table (one of the four cards), with its parameters.
    pub form: MaterialTableForm,
    /// Keywords on the first line that request an interpolation other than straight lines between points; empty if the card has no keyword.
    pub options: String,
}

/// Value of a table at the temperature `x`, for a property whose value on the material card is `z`.
#[derive(Clone, Debug, PartialEq)]
pub enum MaterialTableForm {
    /// TABLEM1: `y(x)`.
    Replaces(Vec<(f64, f64)>),
    /// TABLEM2: `z y(x - x1)`.
    Shifted {
        /// X1.
        x1: f64,
        /// Points of `y`.
        points: Vec<(f64, f64)>,
    },
    /// TABLEM3: `z y((x - x1) / x2)`.
    Scaled {
        /// X1, X2.
        x: [f64; 2],
        /// Points of `y`.
        points: Vec<(f64, f64)>,
    },
    /// TABLEM4: `z sum of a_i ((x - x1) / x2)^i`, `x` kept within X3 and X4.
    Series {
        /// X1 to X4.
        x: [f64; 4],
        /// A0, A1 ..
        a: Vec<f64>,
    },
}
