//! A gauge as a linear functional of a strain field.

use crate::fe::shell_frame::ShellPlace;
use crate::fe::strain_tensor::Surface;
use crate::fe::{CaseResult, PlaneStrain, StrainTerm};
use crate::model::{BeamIx, ShellIx, Vec3};

/// Place at which an arm takes its strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spot {
    /// A shell's surface, at its centre or a corner.
    Shell {
        /// Shell of the place.
        shell: ShellIx,
        /// Side.
        surface: Surface,
        /// Centre or corner.
        place: ShellPlace,
    },
    /// A recovery point of a bar or beam.
    Beam {
        /// Bar or beam of the place.
        beam: BeamIx,
        /// 0 to 3: C D E F.
        point: usize,
        /// x/xb.
        station: f64,
    },
    /// The neutral axis of a bar or beam, where bending strains nothing.
    BeamAxis {
        /// Bar or beam of the place.
        beam: BeamIx,
        /// x/xb.
        station: f64,
    },
}

/// `coefficient . (exx, eyy, gxy)` at a spot, in the output frame of that spot; an arm on a beam uses only the first component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arm {
    /// Place of the arm.
    pub spot: Spot,
    /// Weight and direction together: `w (cos^2 t, sin^2 t, sin t cos t)` for a plain grid.
    pub coefficient: [f64; 3],
}

/// A channel: the arms that it reads, and data for drawing and gluing sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Gauge {
    /// Channel name.
    pub name: String,
    /// Arms.
    pub arms: Vec<Arm>,
    /// Id of the element that carries the gauge.
    pub element: u32,
    /// Side of the shell. Gauges on beams have `Top`.
    pub surface: Surface,
    /// Basic frame, on the surface.
    pub position: Vec3,
    /// Unit vector of the axis, basic frame.
    pub direction: Vec3,
    /// Outward normal of the element (its z axis), basic frame.
    pub normal: Vec3,
    /// Angle of the axis from the element x axis, radians, in (-pi/2, pi/2].
    pub angle_rad: f64,
}

impl Gauge {
    /// Returns the unit vector out of the side of the gauge, basic frame.
    pub fn outward(&self) -> Vec3 {
        match self.surface {
            Surface::Top => self.normal,
            Surface::Bottom => -self.normal,
        }
    }
}

/// Returns the shell terms of the reading of a gauge, for [`crate::fe::Adjoint`]. Arms on bars contribute no terms.
pub fn strain_terms(gauge: &Gauge) -> Vec<StrainTerm> {
    let term = |arm: &Arm| match arm.spot {
        Spot::Shell {
            shell,
            surface,
            place,
        } => Some(StrainTerm {
            shell,
            surface,
            place,
            coefficient: arm.coefficient,
        }),
        Spot::Beam { .. } | Spot::BeamAxis { .. } => None,
    };
    gauge.arms.iter().filter_map(term).collect()
}

/// Returns the reading of a gauge in a load case, strain; `None` if the case has no strain at one of its spots.
pub fn gauge_reading(gauge: &Gauge, case: &CaseResult) -> Option<f64> {
    gauge.arms.iter().map(|arm| arm_reading(arm, case)).sum()
}

fn arm_reading(arm: &Arm, case: &CaseResult) -> Option<f64> {
    let [a, b, c] = arm.coefficient;
    match arm.spot {
        Spot::Shell {
            shell,
            surface,
            place,
        } => {
            let [x, y, g] = shell_strain(case, shell, surface, place)?;
            Some(a * x + b * y + c * g)
        }
        Spot::Beam {
            beam,
            point,
            station,
        } => {
            let (points, _) = case.beams.strain_at(beam, station)?;
            finite_or_none(a * points.get(point)?)
        }
        Spot::BeamAxis { beam, station } => {
            finite_or_none(a * case.beams.strain_at(beam, station)?.1)
        }
    }
}

fn finite_or_none(strain: f64) -> Option<f64> {
    strain.is_finite().then_some(strain)
}

/// Returns the strain of a shell at a place, output frame; `None` if the case has none.
pub fn shell_strain(
    case: &CaseResult,
    shell: ShellIx,
    surface: Surface,
    place: ShellPlace,
) -> Option<PlaneStrain> {
    let row = case.shells.elements.binary_search(&shell).ok()?;
    let strain = match place {
        ShellPlace::Centre => case.shells.centre.get(row)?[surface.ix()],
        ShellPlace::Corner(c) => case.shells.corners.get(row)?.get(c)?[surface.ix()],
    };
    strain.iter().all(|v| v.is_finite()).then_some(strain)
}
