//! `[[gauge]]`, or a row of a gauge file.

use crate::fe::strain_tensor::Surface;
use crate::gauge::{Bridge, Rosette};
use crate::placement::Role;

/// Place of a gauge as the user states it: ids and axes of the deck, or no place. [`crate::gauge::GaugePlace`] is the corresponding place on a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StatedPlace {
    /// At the centre of an element.
    Element(u32),
    /// At a point in the axes of `cid`: the nearest surface is taken.
    Position([f64; 3], u32),
    /// At a bar or beam: recovery point 0 to 3 (C D E F) at a share of the length from end A.
    BeamPoint {
        /// Element id.
        element: u32,
        /// 0 to 3: C D E F.
        point: u8,
        /// x/xb.
        station: f64,
    },
    /// Not stated: enough for a job whose S is given.
    Unstated,
}

/// A gauge.
#[derive(Clone, Debug, PartialEq)]
pub struct JobGauge {
    /// Name: the column of the strain file.
    pub name: String,
    /// Stated place of the gauge.
    pub place: StatedPlace,
    /// Location in job units, if stated in addition to the element. It is compared with the element, and selects the surface if none is stated.
    pub position: Option<[f64; 3]>,
    /// Surface.
    pub surface: Surface,
    /// Whether the job states the surface. Otherwise the surface is `top`, or the surface nearest to the stated point.
    pub surface_stated: bool,
    /// Direction to be projected onto the surface, in the basic frame or the frame of `cid`. `None` means the element x axis.
    pub direction: Option<[f64; 3]>,
    /// Coordinate system of the direction.
    pub cid: u32,
    /// Angle from that direction, degrees, right-handed about the element normal.
    pub angle_deg: f64,
    /// Wiring.
    pub bridge: Bridge,
    /// Number that divides the sum of signed arm strains.
    pub bridge_factor: f64,
    /// Length over which strain is averaged. 0 means the strain at the point.
    pub grid_length: f64,
    /// Element and surface of the other pair. Without a surface, it is on the side that faces away from the first pair.
    pub pair: Option<(u32, Option<Surface>)>,
    /// Rosette with three legs. `None` for a single grid.
    pub rosette: Option<Rosette>,
    /// Transverse sensitivity Kt, a fraction.
    pub transverse_sensitivity: f64,
    /// Whether loads are estimated from the gauge.
    pub role: Role,
    /// Free columns of the table, such as `member`.
    pub member: String,
    /// File that states the gauge.
    pub file: String,
    /// Line of this file.
    pub line: u32,
}
