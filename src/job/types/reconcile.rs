//! `[reconcile]` and `[[reconcile.effect]]`.

use super::named_file::NamedFile;
use crate::job::shapes::{Ids, PropertyIds};
use std::collections::BTreeMap;

/// Kind of measurement that `reconcile` compares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum ReconcilePath {
    Static,
    Dynamic,
}

/// `[reconcile]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Reconcile {
    /// Path of the comparison: strain of static runs, or motion.
    pub path: ReconcilePath,
    /// Zone to property ids.
    pub zones: BTreeMap<String, PropertyIds>,
    /// Place to grid id.
    pub places: BTreeMap<String, u32>,
    /// Apparent strain per degree by bridge name.
    pub thermal_microstrain_per_degc: BTreeMap<String, f64>,
    /// Temperature set of the deck with the pattern of `thermal_gradient`.
    pub temperature_set: Option<u32>,
    /// Effect ids; `None`: all.
    pub effects: Option<Vec<String>>,
    /// Bushes whose stiffness may be wrong. `None` means all bushes if there are few.
    pub joints: Option<Ids>,
    /// Causes measured in addition to the readings: name, and column of the runs file.
    pub causes: BTreeMap<String, String>,
    /// Gluing tolerance of angles, degrees, 1 sd.
    pub angle_tolerance_deg: Option<f64>,
    /// Gluing tolerance of places, mm, 1 sd.
    pub position_tolerance_mm: Option<f64>,
    /// Hypotheses of the user's own.
    pub described: Vec<DescribedEffect>,
    /// Line of the job.
    pub line: u32,
}

/// `[[reconcile.effect]]`: a hypothesis of the user's own.
#[derive(Clone, Debug, PartialEq)]
pub struct DescribedEffect {
    /// Id of the effect in results.
    pub id: String,
    /// Change of the model at size one.
    pub source: EffectSource,
    /// Standard deviation of the size of the effect before the measurement.
    pub prior: f64,
    /// Line of the job.
    pub line: u32,
}

/// Change of the model by a described effect of size one.
#[derive(Clone, Debug, PartialEq)]
pub enum EffectSource {
    /// A table of the change of S, with a row for each gauge and a column for each load.
    Signature(NamedFile),
    /// The thickness of a shell property times a factor.
    Thickness {
        /// Property id.
        property: u32,
        /// Factor.
        factor: f64,
    },
    /// The stiffness of a bush times a factor.
    Bush {
        /// Element id.
        element: u32,
        /// Factor.
        factor: f64,
    },
}
