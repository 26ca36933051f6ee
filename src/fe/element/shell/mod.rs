//! Three- and four-node shells.
//!
//! Bending and transverse shear use a degenerated shell with nodal directors. The covariant shear strains are interpolated separately (mixed
//! interpolation). The sources are Dvorkin and Bathe 1984 (MITC4) and Lee, Lee and Bathe 2014 (MITC3+). The membrane uses covariant strains of the
//! mid-surface. Quadrilaterals add the incompatible modes of Taylor, Beresford and Wilson 1976 (QM6). CQUADR and CTRIAR instead have sides that bend
//! with the rotations about the normal (Allman 1984). Drilling ties the rotation about the surface normal to the curl of the displacements about the
//! same normal (Hughes and Brezzi 1989).

mod area;
mod expansion;
mod kinematics;
mod laminate;
mod law;
mod many;
mod normals;
mod of_model;
mod output_frame;
mod plane_stress;
mod products;
mod quad4;
mod tria3;
mod types;

#[cfg(test)]
pub(crate) use area::corner_products;
pub(crate) use expansion::in_axes_at;
pub(crate) use laminate::Lamination;
pub(crate) use many::{linear_part, many_grids, over_face};
pub(crate) use normals::{CornerDirectors, normals_beyond, shared_normals};
pub(crate) use of_model::{
    AnyShell, many_mass, material_angle, shell_heat, shell_mass, shell_matrices, shell_stiffness,
    shell_thermal_force, surfaces,
};
pub(crate) use output_frame::output_frame;
#[cfg(test)]
pub(crate) use quad4::quad4;
#[cfg(test)]
pub(crate) use tria3::tria3;
pub(crate) use types::{Parts, StrainRows};
#[cfg(test)]
#[cfg(test)]
pub(crate) use types::{ShellInput, ShellLaw, Sides};

#[cfg(test)]
mod tests;
