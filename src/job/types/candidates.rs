//! `[candidates]`.

use super::gauge::JobGauge;
use super::named_file::NamedFile;
use super::region::Region;
use crate::fe::strain_tensor::Surface;
use crate::gauge::{Bridge, Rosette};
use crate::job::shapes::{Ids, PropertyIds};

/// Angles of candidates as the job states them: a step. [`crate::placement::candidates::Angles`] contains the angles themselves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AngleStep {
    /// Every so many degrees from the element x axis.
    Degrees(f64),
    /// Any angle.
    Continuous,
}

/// `[candidates]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidates {
    /// Property ids; `None`: all shells.
    pub properties: Option<PropertyIds>,
    /// Element ids; `None`: all.
    pub elements: Option<Ids>,
    /// Surfaces; default both.
    pub surfaces: Vec<Surface>,
    /// Angles; default 15 degrees.
    pub angles: AngleStep,
    /// Grid length of the gauges to be placed.
    pub grid_length: f64,
    /// Wirings to choose from. The default is quarter bridges only.
    pub bridges: Vec<Bridge>,
    /// Rosettes as additional candidates.
    pub rosette: Option<Rosette>,
    /// SETs of the deck's case control with the allowed elements. `None` means no such limit.
    pub sets: Option<Ids>,
    /// Properties left out.
    pub exclude_properties: Option<PropertyIds>,
    /// Elements left out.
    pub exclude_elements: Option<Ids>,
    /// Elements that must have a gauge each.
    pub wanted_elements: Option<Ids>,
    /// A TOML file with lists of properties and elements, or a table of named spots.
    pub file: Option<NamedFile>,
    /// Spots of the table. Gauges are chosen only from these spots. `None` if the file is not a table.
    pub spots: Option<Vec<NamedSpot>>,
    /// Boxes in which gauges may be placed. An empty list means everywhere.
    pub boxes: Vec<Region>,
    /// Boxes in which gauges may not be placed.
    pub exclude_boxes: Vec<Region>,
    /// Least distances, job units.
    pub clear: Clearances,
    /// Line of the job; 0 where the section is absent.
    pub line: u32,
}

/// A named place with a fixed direction, at which a gauge may be placed.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedSpot {
    /// Gauge as installed at the spot.
    pub gauge: JobGauge,
    /// Cost in the unit of `[placement] budget`; `None`: one for each channel.
    pub cost: Option<f64>,
}

impl Candidates {
    /// Returns whether the spots state costs.
    pub fn has_costs(&self) -> bool {
        self.spots.iter().flatten().any(|s| s.cost.is_some())
    }
}

/// `clear_of` of `[candidates]`: least distances, 0 by default.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Clearances {
    /// Least distance from free edges. It also applies to rims of holes if `holes` is not stated.
    pub edges: f64,
    /// Least distance from rims of holes.
    pub holes: Option<f64>,
    /// Least distance from edges where plates meet, such as welds.
    pub joints: f64,
    /// Least distance from grids at which loads act.
    pub loads: f64,
    /// Least distance from grids that rigid elements, RBE3 or bushes connect.
    pub attachments: f64,
}
