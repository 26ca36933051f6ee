//! Content of a scene.

use crate::fe::CaseResult;
use crate::fe::strain_tensor::Surface;
use crate::gauge::Gauge;
use crate::job::{Candidates, Clearances, Ids, PropertyIds};
use crate::model::{Model, Vec3};

/// Model, gauges, strain fields and loads that are drawn together.
#[derive(Clone, Debug)]
pub struct Scene<'a> {
    /// Structure.
    pub model: &'a Model,
    /// Gauges.
    pub marks: Vec<Mark>,
    /// Strain fields to choose from.
    pub fields: Vec<Field<'a>>,
    /// Loads to choose from.
    pub arrows: Vec<ArrowSet>,
    /// Unit of length; empty if the deck states none.
    pub length: &'static str,
    /// Planning by pointing that the scene allows.
    pub pointing: PickTargets,
    /// Caption: what the scene shows, and what would be better or worse.
    pub caption: String,
}

/// Planning by pointing at a scene.
#[derive(Clone, Debug, PartialEq, Default)]
pub enum PickTargets {
    /// Nothing.
    #[default]
    Nothing,
    /// Installed positions of gauges.
    Gauges,
    /// Installed positions of gauges, and places for new gauges.
    Places(Places),
}

/// Places where gauges may go, before any pointing.
#[derive(Clone, Debug, PartialEq)]
pub struct Places {
    /// File of picked lists, as the job names it.
    pub file: String,
    /// Keys of `[candidates]` with the ids that the job states, from and to.
    pub lists: Vec<(&'static str, Vec<[u32; 2]>)>,
    /// Whether the job limits the places further: by sets, boxes, distances.
    pub also: bool,
}

impl Default for Places {
    /// Anywhere.
    fn default() -> Self {
        Self {
            file: "picked.toml".to_owned(),
            lists: Vec::new(),
            also: false,
        }
    }
}

impl Places {
    /// Returns the places that `[candidates]` of a job states.
    pub fn from_candidates(candidates: &Candidates) -> Self {
        let properties = |list: &Option<PropertyIds>| list.as_ref().map(|p| p.ids.clone());
        let lists = [
            ("properties", &properties(&candidates.properties)),
            ("elements", &candidates.elements),
            (
                "exclude_properties",
                &properties(&candidates.exclude_properties),
            ),
            ("exclude_elements", &candidates.exclude_elements),
            ("wanted_elements", &candidates.wanted_elements),
        ];
        let stated =
            |(key, ids): (&'static str, &Option<Ids>)| Some((key, ids.as_ref()?.0.clone()));
        let mut out = Self::default();
        if let Some(named) = candidates.file.as_ref().filter(|f| f.is_toml()) {
            out.file.clone_from(&named.given);
        }
        out.also = candidates.sets.is_some()
            || !candidates.boxes.is_empty()
            || !candidates.exclude_boxes.is_empty()
            || candidates.clear != Clearances::default();
        out.lists.extend(lists.into_iter().filter_map(stated));
        out
    }
}

/// A gauge.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Name.
    pub name: String,
    /// Place, basic frame.
    pub at: Vec3,
    /// Unit vectors along the axis of the gauge and out of its side, if known.
    pub axes: Option<[Vec3; 2]>,
    /// Side of the gauge, if known.
    pub surface: Option<Surface>,
    /// Further text shown when the gauge is picked.
    pub note: String,
    /// Gap at the mark, before and after, shown as the area of circles.
    pub gap: Option<[f64; 2]>,
}

impl Mark {
    /// A gauge laid onto the model.
    pub fn from_gauge(gauge: &Gauge, note: String) -> Self {
        Self {
            name: gauge.name.clone(),
            at: gauge.position,
            axes: Some([gauge.direction, gauge.outward()]),
            surface: Some(gauge.surface),
            note: format!(
                "element {} {}, {:.1}° from its x axis{}{note}",
                gauge.element,
                gauge.surface.word(),
                gauge.angle_rad.to_degrees(),
                if note.is_empty() { "" } else { ", " }
            ),
            gap: None,
        }
    }
}

/// Field that colours the model: `values * scale` in `unit`.
#[derive(Clone, Debug)]
pub struct Field<'a> {
    /// Name.
    pub name: String,
    /// Unit of the numbers shown.
    pub unit: String,
    /// Strain, or numbers by element.
    pub values: FieldValues<'a>,
    /// Factor from a value to the shown number.
    pub scale: f64,
}

/// Source of the values of a field.
#[derive(Clone, Debug)]
pub enum FieldValues<'a> {
    /// Load case, of which the field shows the largest principal strain by magnitude.
    Strain(&'a CaseResult),
    /// Magnitude of every shell at bottom and top, never negative; `NaN` without a value.
    Magnitudes(Vec<[f64; 2]>),
}

impl FieldValues<'_> {
    /// Returns whether the colour range is centred on 0. The colour range of magnitudes begins at 0.
    pub fn is_signed(&self) -> bool {
        matches!(self, Self::Strain(_))
    }
}

/// Kind of a load: force or moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Twist {
    /// Force.
    Force,
    /// Moment, right-hand rule.
    Moment,
}

/// Arrow for one load.
#[derive(Clone, Debug, PartialEq)]
pub struct Arrow {
    /// Place where the load acts, basic frame.
    pub at: Vec3,
    /// Unit vector of the load.
    pub along: Vec3,
    /// Kind of the load.
    pub twist: Twist,
    /// Size with sign. Lengths of arrows are comparable within a kind.
    pub value: f64,
    /// Text of the load's label.
    pub label: String,
}

/// Loads that act together: a run, or the unit loads.
#[derive(Clone, Debug, PartialEq)]
pub struct ArrowSet {
    /// Name.
    pub name: String,
    /// Loads.
    pub arrows: Vec<Arrow>,
}
