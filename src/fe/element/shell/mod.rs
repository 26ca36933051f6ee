//! Three- and four-node shells.
//!
//! Bending and transverse shear: degenerated shell with nodal directors, mixed interpolation of the covariant shear strains
//! (MITC4: Dvorkin and Bathe 1984; MITC3+: Lee, Lee and Bathe 2014). Membrane: covariant strains of the mid-surface, with the
//! incompatible modes of Taylor, Beresford and Wilson 1976 (QM6) on quadrilaterals; CQUADR and CTRIAR have sides that bend with the
//! rotations about the normal instead (Allman 1984). Drilling: the rotation about the surface
//! normal is tied to the curl of the displacements about the same normal (Hughes and Brezzi 1989).

mod area;
mod expansion;
mod kinematics;
mod laminate;
mod law;
mod many;
mod normals;
mod of_model;
mod output_frame;
mod quad4;
mod tria3;

#[cfg(test)]
pub(crate) use area::corner_products;
pub(crate) use expansion::{Heat, in_axes_at};
pub(crate) use laminate::Lamination;
pub(crate) use law::ShellLaw;
pub(crate) use many::{linear_part, many_grids, over_face};
pub(crate) use normals::{CornerDirectors, shared_normals};
pub(crate) use of_model::{
    AnyShell, many_mass, material_angle, shell_heat, shell_mass, shell_matrices, shell_stiffness,
    shell_thermal_force, surfaces,
};
pub(crate) use output_frame::output_frame;
pub(crate) use quad4::quad4;
pub(crate) use tria3::tria3;

use crate::model::Vec3;

/// Everything a shell's stiffness and strain depend on.
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
    /// What is wanted.
    pub(crate) parts: Parts,
    /// What rotations about the normal do to the sides.
    pub(crate) sides: Sides,
    /// Temperatures, where forces of thermal strain are wanted.
    pub(crate) heat: Option<&'a Heat>,
}

/// What rotations about the normal do to the sides of a shell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sides {
    /// Nothing: they stay straight.
    Straight,
    /// They bend as a beam under its end rotations (Allman 1984; CQUADR and CTRIAR).
    Bending,
}

/// What is wanted of a shell: forming its stiffness is most of the work.
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
    /// Forces that hold the thermal strain back, sign reversed: the load it acts as.
    pub(crate) thermal: [f64; M],
}

/// Rows that turn an element's displacements into strain in its output frame: exx, eyy, gxy (engineering shear); strain at
/// height z above the reference plane is `membrane + z * curvature`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StrainRows<const M: usize> {
    pub(crate) membrane: [[f64; M]; 3],
    pub(crate) curvature: [[f64; M]; 3],
}

/// The shell can't be formed: corners coincide, lie on a line or make a re-entrant shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BadShape;

#[cfg(test)]
mod tests;
