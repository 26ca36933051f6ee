//! Limits of the differences from MSC and NX on the decks of `real_decks`: name of the row, limit of the median, limit
//! of the 95 % quantile.
//!
//! Each limit is slightly above the measured value, so that a loss of accuracy fails the test.

/// Name, median, 95 % quantile.
pub type Limits = &'static [(&'static str, f64, f64)];

/// Wing box of laminates.
///
/// The elements of this deck are next to shear panels, which changes their strain. The median therefore tests the formula of each
/// element on the displacements of MSC.
pub const WING_BOX: Limits = &[
    ("displacement", 1e-3, 0.01),
    ("CBAR strain from their displacements", 1e-12, 1e-12),
    ("CQUAD4 strain", 0.05, 0.3),
    ("CQUAD4 strain from their displacements", 3e-3, 0.12),
    ("CROD axial stress", 0.015, 0.1),
    ("CTRIA3 strain", 0.07, 0.5),
    ("CTRIA3 strain from their displacements", 6e-3, 0.05),
];

/// Column with one element per wall.
///
/// The formulations of wedge and tetrahedron differ by their full amount. Strain on the displacements of NX agrees
/// within rounding.
pub const SHELL_BAR: Limits = &[
    ("displacement", 3e-3, 0.015),
    ("CBAR strain", 3e-4, 3e-4),
    ("CBAR strain from their displacements", 1e-12, 1e-12),
    ("CBEAM strain", 4e-3, 4e-3),
    ("CBEAM strain from their displacements", 1e-6, 1e-6),
    ("CROD axial strain", 4e-4, 4e-4),
    ("CROD axial stress", 4e-4, 4e-4),
    ("CQUAD4 strain", 0.05, 0.05),
    ("CQUAD4 strain from their displacements", 1e-6, 1e-6),
    ("CTRIA3 strain", 0.07, 0.07),
    ("CTRIA3 strain from their displacements", 1e-6, 1e-6),
    ("CHEXA stress", 0.06, 0.06),
    ("CHEXA strain", 0.11, 0.11),
    ("CPENTA stress", 0.04, 0.04),
    ("CPENTA strain", 0.07, 0.07),
    ("CTETRA stress", 0.06, 0.06),
    ("CTETRA strain", 0.11, 0.11),
    ("ply strain", 0.015, 0.025),
];

/// The same column with more kinds of element, NX and MSC.
pub const NEARLY_EVERY: Limits = &[
    ("displacement", 0.015, 0.035),
    ("CQUAD4 strain", 0.08, 0.08),
    ("CQUAD4 strain from their displacements", 1e-6, 1e-6),
    ("CTRIA3 strain", 0.06, 0.06),
    ("CTRIA3 strain from their displacements", 1e-6, 1e-6),
    ("CHEXA stress", 0.06, 0.06),
    ("CHEXA strain", 0.11, 0.11),
    ("CPENTA stress", 0.04, 0.04),
    ("CPENTA strain", 0.07, 0.07),
    ("CTETRA stress", 0.06, 0.06),
    ("CTETRA strain", 0.11, 0.11),
    ("ply strain", 0.05, 0.45),
];

/// Plate that partly consists of plies.
pub const PLIES: Limits = &[
    ("displacement", 2.5e-3, 5e-3),
    ("CQUAD4 strain", 6e-3, 0.025),
    ("CQUAD4 strain from their displacements", 2e-3, 6e-3),
];

/// Single elements, one per model.
pub const SINGLE: Limits = &[
    ("CHEXA strain", 1e-7, 1e-7),
    ("CHEXA stress", 1e-9, 1e-9),
    ("CTETRA strain", 1e-6, 1e-6),
    ("CTETRA stress", 1e-6, 1e-6),
    ("CTRIAR strain", 1e-6, 1e-6),
    ("CPENTA strain", 0.02, 0.02),
    ("CPENTA stress", 0.04, 0.04),
    ("CTRIA6 strain", 0.17, 0.17),
];

/// Beam of bricks with rigid ends.
pub const RIGID_ENDS: Limits = &[
    ("displacement", 1e-5, 3e-4),
    ("CBAR strain", 1e-4, 1e-4),
    ("CBAR strain from their displacements", 1e-6, 1e-6),
    ("CHEXA stress", 5e-4, 1.5e-3),
];

/// Beam of bricks on a bush.
///
/// The bricks have E h = 3.6e9 N/m and rotate with an arm of half a metre about a spring of 0.15 N m. The ratio is 6e9.
/// The rounding of double precision (1.1e-16) therefore changes the motion by 7e-7.
pub const BUSH: Limits = &[("displacement", 1e-6, 3e-6), ("CHEXA stress", 4e-3, 0.01)];
