//! A gauge as its user describes it, ids resolved.

use crate::fe::strain_tensor::Surface;
use crate::model::{BeamIx, Mat3, ShellIx, Vec3};

/// Wiring of the arms. `eps(d)` is the strain along direction `d`. The sum is divided by the bridge factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bridge {
    /// One grid: `eps`.
    Quarter,
    /// Two grids in adjacent arms: `eps(here) - eps(pair)`, pure bending doubled, axial strain and temperature cancelled.
    HalfBending,
    /// Four grids: `2 eps(here) - 2 eps(pair)`.
    FullBending,
    /// Two grids at +45 and -45 degrees from the axis in adjacent arms. They read `eps(+45) - eps(-45)`, the engineering shear strain in the frame of
    /// the axis. With a pair, the reading is the sum of both places (four grids).
    Shear,
}

impl Bridge {
    /// All wirings.
    pub const ALL: [Bridge; 4] = [
        Self::Quarter,
        Self::HalfBending,
        Self::FullBending,
        Self::Shear,
    ];

    /// Returns the name in files and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Quarter => "quarter",
            Self::HalfBending => "half-bending",
            Self::FullBending => "full-bending",
            Self::Shear => "shear",
        }
    }

    /// Returns the bridge of a name in files and reports.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|b| b.name() == name)
    }
}

/// Rosette of three grids at one place. The legs a, b, c give the whole strain in the surface.
///
/// # Example
/// Strain along an angle is `exx cos^2 + eyy sin^2 + gxy sin cos`, so the legs of a rectangular rosette give exx, gxy and eyy:
/// ```
/// use strainbridge::gauge::Rosette;
///
/// let [exx, eyy, gxy] = [400e-6, -100e-6, 300e-6];
/// let along = |angle: f64| {
///     let (s, c) = angle.sin_cos();
///     exx * c * c + eyy * s * s + gxy * s * c
/// };
/// let [a, b, c] = Rosette::Rectangular.legs().map(|(_, angle)| along(angle));
/// assert!((a - exx).abs() < 1e-15 && (c - eyy).abs() < 1e-15);
/// assert!((2.0 * b - a - c - gxy).abs() < 1e-15);
/// // The mean of a delta rosette is the mean of the principal strains.
/// let mean = Rosette::Delta.legs().map(|(_, angle)| along(angle)).iter().sum::<f64>() / 3.0;
/// assert!((mean - (exx + eyy) / 2.0).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rosette {
    /// Legs a, b, c at 0, 45, 90 degrees from the axis.
    Rectangular,
    /// Legs a, b, c at 0, 60, 120 degrees.
    Delta,
}

impl Rosette {
    /// Returns the leg names and angles, radians, right-handed about the element normal.
    pub fn legs(self) -> [(&'static str, f64); 3] {
        let step = match self {
            Self::Rectangular => 45_f64,
            Self::Delta => 60_f64,
        };
        [
            ("a", 0.0),
            ("b", step.to_radians()),
            ("c", (2.0 * step).to_radians()),
        ]
    }
}

/// Place of a gauge on the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GaugePlace {
    /// At the centre of a shell.
    Shell(ShellIx),
    /// Point of the shells' skins nearest to this one, basic frame.
    Nearest(Vec3),
    /// At recovery point 0 to 3 (C D E F) of a bar or beam, at a share of its length from end A. The gauge reads along the axis.
    Beam {
        /// Bar or beam.
        beam: BeamIx,
        /// 0 to 3.
        point: usize,
        /// x/xb.
        station: f64,
    },
}

/// Whether the result has strain at the corners of shells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum CornerRows {
    Present,
    Absent,
}

/// Place of the second pair of grids of a bridge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Shell of the pair. The pair is at the centre of the shell.
    pub shell: ShellIx,
    /// Side.
    pub surface: Surface,
    /// Rotation from the axes of the gauge's coordinate system at the first pair to its axes at this pair, basic frame. It is the identity except in
    /// cylindrical and spherical systems. The rotation transforms the axis of the first pair into the axis of this pair.
    pub turn: Mat3,
}

impl Pair {
    /// Returns a pair whose axis is parallel to the first pair's.
    pub fn with_parallel_axis(shell: ShellIx, surface: Surface) -> Self {
        Self {
            shell,
            surface,
            turn: Mat3::identity(),
        }
    }
}

/// A gauge.
#[derive(Clone, Debug, PartialEq)]
pub struct GaugeSpec {
    /// Name of the gauge. The channels of a rosette are `name.a`, `name.b`, `name.c`.
    pub name: String,
    /// Place of the gauge.
    pub place: GaugePlace,
    /// Side of the shell. `None` means top, or the nearer side for a point.
    pub surface: Option<Surface>,
    /// Direction that is projected onto the surface. `angle_rad` counts from it. `None` means the element x axis.
    pub direction: Option<Vec3>,
    /// Right-handed about the element normal, on both sides.
    pub angle_rad: f64,
    /// Wiring.
    pub bridge: Bridge,
    /// Number that divides the signed sum.
    pub bridge_factor: f64,
    /// Length of the grid along its axis. 0 means a point.
    pub grid_length: f64,
    /// Place of the second pair. `None` means the other side of the same shell for bending, and no second pair for shear.
    pub pair: Option<Pair>,
    /// Rosette, with three channels. `None` for a gauge with one channel.
    pub rosette: Option<Rosette>,
    /// Additional rotations of the legs a, b, c of a rosette, radians.
    pub leg_turns_rad: [f64; 3],
    /// Transverse sensitivity Kt, a fraction. The gauge factor of the maker corrects readings for a Poisson ratio of 0.285.
    pub transverse_sensitivity: f64,
}

impl GaugeSpec {
    /// Returns a quarter bridge on the top of a shell along its x axis.
    pub fn place_on_shell(name: impl Into<String>, shell: ShellIx) -> Self {
        Self {
            name: name.into(),
            place: GaugePlace::Shell(shell),
            surface: None,
            direction: None,
            angle_rad: 0.0,
            bridge: Bridge::Quarter,
            bridge_factor: 1.0,
            grid_length: 0.0,
            pair: None,
            rosette: None,
            leg_turns_rad: [0.0; 3],
            transverse_sensitivity: 0.0,
        }
    }
}
