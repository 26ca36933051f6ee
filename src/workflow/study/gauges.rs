//! Gauges of the layouts of a study.

use crate::gauge::{Gauge, GaugeSpec};
use serde::Serialize;

/// The gauges of a layout.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LayoutGauges {
    /// Layout of the gauge.
    pub layout: String,
    /// Number of gauges.
    pub gauges: usize,
    /// Name and place of each gauge.
    pub chosen: Vec<LayoutGauge>,
}

/// A gauge of a layout.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LayoutGauge {
    /// Name.
    pub name: String,
    /// Place on the model. `None` if S is given.
    #[serde(flatten)]
    pub place: Option<LayoutPlace>,
}

/// Place of a gauge on the model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LayoutPlace {
    /// Element id.
    pub element: u32,
    /// `top` or `bottom`.
    pub surface: &'static str,
    /// Place on the surface, basic frame.
    pub position: [f64; 3],
    /// Unit vector of the axis, basic frame.
    pub direction: [f64; 3],
    /// Wiring.
    pub bridge: &'static str,
    /// Length over which strain is averaged.
    pub grid_length: f64,
}

impl LayoutGauge {
    /// Returns a gauge without a place.
    pub(super) fn without_place(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            place: None,
        }
    }

    /// Returns a gauge as laid onto the model.
    pub(super) fn from_gauge(gauge: &Gauge, spec: &GaugeSpec) -> Self {
        let place = LayoutPlace {
            element: gauge.element,
            surface: gauge.surface.word(),
            position: gauge.position.into(),
            direction: gauge.direction.into(),
            bridge: spec.bridge.name(),
            grid_length: spec.grid_length,
        };
        Self {
            name: gauge.name.clone(),
            place: Some(place),
        }
    }
}
