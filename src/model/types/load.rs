//! Load sets and temperature sets.

use super::index::{BeamIx, FrameIx, GridIx, ShellIx, Vec3};
use nastran::cards::Dofs;
use nastran::place::Place;

/// One load set: weighted primitive loads.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct LoadSet {
    pub sid: u32,
    pub loads: Vec<(f64, Load)>,
}

/// One temperature set (TEMP, TEMPD), which TEMPERATURE(LOAD) selects.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct TemperatureSet {
    pub sid: u32,
    /// TEMPD: temperature of grids that `grids` leaves out.
    pub default: Option<f64>,
    pub grids: Vec<(GridIx, f64)>,
    /// Temperatures of single elements by id (TEMPP1, TEMPRB): they take precedence over the temperatures of their grids.
    pub elements: std::collections::HashMap<u32, ElementTemperature>,
    /// Cards of this set that are not fully supported.
    pub unsupported: Vec<(String, Place)>,
    pub at: Place,
}

impl TemperatureSet {
    /// Returns the temperature of each of the `n` grids of the model.
    pub fn by_grid(&self, n: usize) -> Vec<f64> {
        let mut all = vec![self.default.unwrap_or(0.0); n];
        for (g, t) in &self.grids {
            if let Some(slot) = all.get_mut(g.us()) {
                *slot = *t;
            }
        }
        all
    }
}

/// Temperature of an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ElementTemperature {
    /// TEMPP1: of the reference plane, and dT/dz along the element normal.
    Plate {
        /// TBAR.
        mean: f64,
        /// TPRIME.
        gradient: f64,
    },
    /// TEMPRB: mean of the section at A and B; gradients along element y and z at A and B.
    Line {
        /// TA, TB.
        ends: [f64; 2],
        /// Along y: at A, B; along z: at A, B.
        gradient: [[f64; 2]; 2],
    },
}

/// A direction in a coordinate system. In a cylindrical or spherical system it depends on the place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction {
    /// The system.
    pub frame: FrameIx,
    /// Components, of any length.
    pub components: [f64; 3],
}

/// A primitive load, vectors in the basic frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Load {
    /// Force at a grid.
    Force(GridIx, Vec3),
    /// Moment at a grid.
    Moment(GridIx, Vec3),
    /// Pressure on shells along their normal (corner values).
    ShellPressure {
        /// Shells with this load.
        shells: Vec<ShellIx>,
        /// Pressure at the corners.
        pressure: [f64; 4],
        /// Direction instead of the normal.
        direction: Option<Direction>,
    },
    /// Pressure on a face given by grids (PLOAD, PLOAD4 on solids), right-hand rule of the order; the fourth may be missing.
    FacePressure {
        /// Corners.
        grids: [Option<GridIx>; 4],
        /// Pressure at the corners.
        pressure: [f64; 4],
        /// Direction instead of the normal.
        direction: Option<Direction>,
    },
    /// Acceleration field of GRAV.
    Gravity(Vec3),
    /// Acceleration of single grids (ACCEL1), or of all by their location (ACCEL).
    Acceleration {
        /// The acceleration that the factors multiply.
        a: Vec3,
        /// Grids and their factors.
        grids: Vec<(GridIx, f64)>,
    },
    /// Centrifugal forces of RFORCE and RFORCE1.
    Spin {
        /// A point on the axis.
        centre: Vec3,
        /// Angular velocity, radians per unit of time.
        omega: Vec3,
    },
    /// Force or moment along a CBAR or CBEAM (PLOAD1).
    Line {
        /// Element with this load.
        beam: BeamIx,
        /// Share of the length, offsets included, where it begins and ends; equal: concentrated there.
        span: [f64; 2],
        /// Per length at both ends of the span, the concentrated one first; element axes.
        force: [Vec3; 2],
        /// Likewise.
        moment: [Vec3; 2],
    },
    /// SPCD: another enforced displacement of dofs that an SPC set holds, displacement frame.
    Enforced {
        /// Grid.
        grid: GridIx,
        /// Degrees of freedom that are moved.
        dofs: Dofs,
        /// Displacement or rotation.
        value: f64,
    },
    /// A load that the solver does not carry yet: the card's name and place, so that it can be refused by name.
    Unsupported(String, Place),
}
