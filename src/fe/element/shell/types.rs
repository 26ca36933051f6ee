//! Inputs and matrices of a shell element.

use crate::model::Vec3;

/// A linear form on the element's unknowns.
pub(super) type Row<const M: usize> = [f64; M];

/// Matrices of `stress = G strain` (engineering shear) in the output frame. They are multiplied by the thickness where they are used.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ShellLaw {
    /// Membrane; `None`: no membrane stiffness.
    pub(crate) membrane: Option<[[f64; 3]; 3]>,
    /// Bending, 12 I / t^3 included.
    pub(crate) bending: Option<[[f64; 3]; 3]>,
    /// Membrane-bending coupling (MID4).
    pub(crate) coupling: Option<[[f64; 3]; 3]>,
    /// Transverse shear, ts / t included.
    pub(crate) shear: Option<[[f64; 2]; 2]>,
}

/// Inputs of a shell's stiffness and strain.
#[derive(Clone, Debug)]
pub(crate) struct ShellInput<'a, const N: usize> {
    /// Corners, basic frame.
    pub(crate) x: [Vec3; N],
    /// Unit director at each corner.
    pub(crate) directors: [Vec3; N],
    /// Thickness at each corner.
    pub(crate) thickness: [f64; N],
    /// Material in the element's output frame.
    pub(crate) law: &'a ShellLaw,
    /// Offset of the reference plane along the element normal.
    pub(crate) zoffs: f64,
    /// K6ROT.
    pub(crate) k6rot: f64,
    /// Matrices to compute.
    pub(crate) parts: Parts,
    /// Displacement of the sides by rotations about the normal.
    pub(crate) sides: Sides,
    /// Temperatures, if forces of thermal strain are wanted.
    pub(crate) heat: Option<&'a Heat>,
}

/// Displacement of the sides of a shell by rotations about the normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sides {
    /// No displacement: they stay straight.
    Straight,
    /// They bend as a beam under its end rotations (Allman 1984; CQUADR and CTRIAR).
    Bending,
}

/// Matrices of a shell to compute. The stiffness takes most of the time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Parts {
    All,
    /// Strain rows and thermal forces; the stiffness stays zero.
    WithoutStiffness,
}

/// Stiffness and strain of a shell with `M` = 6 N unknowns, basic frame.
#[derive(Clone, Debug)]
pub(crate) struct ShellMatrices<const N: usize, const M: usize> {
    pub(crate) stiffness: [[f64; M]; M],
    pub(crate) centre: StrainRows<M>,
    pub(crate) corners: [StrainRows<M>; N],
    /// Loads equivalent to thermal strain: the forces that prevent thermal strain, with reversed sign.
    pub(crate) thermal: [f64; M],
}

/// Rows that transform an element's displacements to strain in its output frame: exx, eyy, gxy (engineering shear). Strain at height z above the
/// reference plane is `membrane + z * curvature`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StrainRows<const M: usize> {
    pub(crate) membrane: [[f64; M]; 3],
    pub(crate) curvature: [[f64; M]; 3],
}

/// The shell can't be formed: corners coincide, lie on a line or make a re-entrant shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BadShape;

/// Thermal strain of a shell in its output frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Expansion {
    /// Membrane force per length: of a unit rise of temperature, and of a unit gradient dT/dz.
    pub(crate) force: [[f64; 3]; 2],
    /// Moment per length (integral of z sigma) in the same two cases.
    pub(crate) moment: [[f64; 3]; 2],
    /// Free strain per unit rise at the surfaces Z1 and Z2: exx, eyy, gxy (engineering shear).
    pub(crate) surface: [[f64; 3]; 2],
    /// Reference temperature of thermal strain.
    pub(crate) tref: f64,
}

/// Thermal load of a shell in a load case.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Heat {
    pub(crate) expansion: Expansion,
    /// Temperature rise of the reference plane at the corners.
    pub(crate) rise: [f64; 4],
    /// dT/dz along the element normal.
    pub(crate) gradient: f64,
}
