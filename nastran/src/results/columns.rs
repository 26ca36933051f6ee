//! Column names of [`Rows`](super::Rows), one list for each kind of row.

/// Columns of displacements, forces and moments at grids, and of bushes.
pub const NODAL: &[&str] = &["t1", "t2", "t3", "r1", "r2", "r3"];
/// Shell strain, one row for each fibre; `gxy` is engineering shear.
pub const SHELL_STRAIN: &[&str] = &["fiber", "exx", "eyy", "gxy", "angle", "emax", "emin", "vm"];
/// Shell stress, one row for each fibre.
pub const SHELL_STRESS: &[&str] = &["fiber", "oxx", "oyy", "txy", "angle", "omax", "omin", "vm"];
/// Ply strain or stress in ply axes, one row for each ply.
pub const PLY: &[&str] = &[
    "s11", "s22", "s12", "s1z", "s2z", "angle", "smax", "smin", "vm",
];
/// CBAR: recovery points C D E F at both ends.
pub const BAR: &[&str] = &[
    "s1a", "s2a", "s3a", "s4a", "axial", "smaxa", "smina", "mst", "s1b", "s2b", "s3b", "s4b",
    "smaxb", "sminb", "msc",
];
/// CBAR with stations, one row for each station.
pub const BAR_STATION: &[&str] = &[
    "x_xb", "s1", "s2", "s3", "s4", "axial", "smax", "smin", "ms",
];
/// CBEAM, one row for each station.
pub const BEAM: &[&str] = &[
    "x_xb", "sxc", "sxd", "sxe", "sxf", "smax", "smin", "mst", "msc",
];
/// CROD, CTUBE, CONROD.
pub const ROD: &[&str] = &["axial", "msa", "torsion", "mst"];
/// CELAS1 to CELAS4.
pub const SPRING: &[&str] = &["value"];
/// CSHEAR.
pub const SHEAR_PANEL: &[&str] = &["max", "average", "margin"];
/// CTETRA, CPENTA, CHEXA, one row for each location; shear strain is engineering shear.
pub const SOLID: &[&str] = &[
    "xx", "yy", "zz", "xy", "yz", "zx", "max", "mid", "min", "vm",
];
/// Forces and moments of a shell per length: membrane, bending, transverse shear.
pub const SHELL_FORCE: &[&str] = &["fx", "fy", "fxy", "mx", "my", "mxy", "qx", "qy"];
/// CBAR forces: bending in planes 1 and 2 at both ends.
pub const BAR_FORCE: &[&str] = &[
    "m1a", "m2a", "m1b", "m2b", "shear1", "shear2", "axial", "torque",
];
/// CBAR forces with stations, one row for each station.
pub const BAR_STATION_FORCE: &[&str] = &["x_xb", "m1", "m2", "shear1", "shear2", "axial", "torque"];
/// CBEAM forces, one row for each station.
pub const BEAM_FORCE: &[&str] = &[
    "x_xb",
    "m1",
    "m2",
    "shear1",
    "shear2",
    "axial",
    "torque",
    "warping_torque",
];
/// CROD, CTUBE, CONROD forces.
pub const ROD_FORCE: &[&str] = &["axial", "torque"];
