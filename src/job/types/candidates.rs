//! `[candidates]`.

use super::gauge::JobGauge;
use super::named_file::NamedFile;
use super::region::Region;
use crate::fe::strain_tensor::Surface;
use crate::gauge::{Bridge, Rosette};
use crate::job::shapes::{Ids, PropertyIds};

/// The angles of candidates as a job states them: a step, not the angles themselves ([`crate::placement::candidates::Angles`]).
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
    /// Wirings to choose from; default quarter bridges alone.
    pub bridges: Vec<Bridge>,
    /// Rosettes too.
    pub rosette: Option<Rosette>,
    /// SETs of the deck's case control that name the elements; `None`: not limited so.
    pub sets: Option<Ids>,
    /// Properties left out.
    pub exclude_properties: Option<PropertyIds>,
    /// Elements left out.
    pub exclude_elements: Option<Ids>,
    /// Elements of which each gets a gauge.
    pub wanted_elements: Option<Ids>,
    /// A TOML file with lists of properties and elements, or a table of named spots.
    pub file: Option<NamedFile>,
    /// The spots of that table: gauges are chosen from these alone. `None`: the file is not a table.
    pub spots: Option<Vec<NamedSpot>>,
    /// Boxes in which gauges may sit; empty: anywhere.
    pub boxes: Vec<Region>,
    /// Boxes in which they may not.
    pub exclude_boxes: Vec<Region>,
    /// Least distances, job units.
    pub clear: Clearances,
    /// Line of the job; 0 where the section is absent.
    pub line: u32,
}

/// A named place with a fixed direction that a gauge may be chosen for.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedSpot {
    /// The gauge as it would be installed there.
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

/// `clear_of` of `[candidates]`: least distances, 0 where not stated.
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
