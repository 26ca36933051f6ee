//! Answer of `respond`.

use super::gauges::{Check, GaugeCheck};
use crate::estimate::NORMAL_95;
use crate::host::outcome::Answer;
use crate::host::words::count_of;
use crate::job::Job;
use crate::respond::{LoadState, Peak, ResponseRow};
use crate::strain_chain::JobSensitivity;
use crate::units::plus_minus;
use serde::Serialize;

/// Stress from loads.
#[derive(Serialize)]
pub struct StressResponse {
    /// Requested elements, or the elements with the highest stress, the highest first.
    pub elements: Vec<Element>,
    /// Elements with a higher stress than all elements that share a grid with them.
    pub hot_spots: Vec<Element>,
    /// Pseudo-damage of these elements over the history of loads, if the job states a slope.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub fatigue: Vec<ElementFatigue>,
    /// Number of load states.
    pub states: usize,
    /// Unit of the stresses.
    pub stress_unit: &'static str,
    /// Comparison of predicted with measured strain at the gauges.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub gauges: Vec<GaugeCheck>,
    /// All elements.
    #[serde(skip)]
    pub field: Field,
    /// The comparison at the gauges, state by state.
    #[serde(skip)]
    pub check: Check,
    /// S, gauges, model and strain fields.
    #[serde(skip)]
    pub prepared: JobSensitivity,
    /// The job.
    #[serde(skip)]
    pub job: Job,
}

impl Answer for StressResponse {
    const COMMAND: &'static str = "respond";
    const RESULT: &'static str = "The stresses";

    fn verdict(&self) -> String {
        let states = count_of(self.states, "load state");
        let Some(e) = self.elements.first() else {
            return format!("No element has a stress in {states}.");
        };
        let at =
            e.at.as_ref()
                .map_or_else(String::new, |at| format!(" at {at}"));
        format!(
            "Largest von Mises stress {} {}, element {} {}{at}, of {states}.",
            plus_minus(e.max_von_mises, e.half_width()),
            self.stress_unit,
            e.element,
            e.surface
        )
    }
}

/// Response of every element to every state, model units.
pub struct Field {
    /// Load-to-response matrix, row by row.
    pub rows: Vec<ResponseRow>,
    /// The largest von Mises stress of each row.
    pub peaks: Vec<Peak>,
    /// Requested rows, or the rows with the highest stress.
    pub order: Vec<usize>,
    /// Rows with a higher stress than all rows of elements that share a grid with them, the highest first.
    pub spots: Vec<usize>,
    /// States of the loads.
    pub states: Vec<LoadState>,
}

/// Pseudo-damage of an element, report unit of stress to the power of the slope.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ElementFatigue {
    /// Element id.
    pub element: u32,
    /// Side, or recovery point.
    pub surface: String,
    /// Damage on the plane where it is largest.
    pub damage: f64,
    /// Lower end of its 95 % interval.
    pub damage_low: f64,
    /// Upper end of this interval.
    pub damage_high: f64,
    /// Direction normal to that plane, from the x axis of the element.
    pub angle_deg: f64,
    /// Share of the life of the detail that the record uses; `None` without [respond] fatigue_class.
    pub life_share: Option<f64>,
    /// Lower end of its 95 % interval.
    pub life_share_low: Option<f64>,
    /// Upper end of this interval.
    pub life_share_high: Option<f64>,
}

/// The largest stress of an element.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Element {
    /// Element id.
    pub element: u32,
    /// Side of a shell, recovery point of a bar.
    pub surface: String,
    /// Largest von Mises stress over the states.
    pub max_von_mises: f64,
    /// State with this stress.
    pub at: Option<String>,
    /// Standard deviation of the largest von Mises stress, from the uncertainty of the loads.
    pub sigma: f64,
    /// Lower end of its 95 % interval.
    pub low: f64,
    /// Upper end of this interval.
    pub high: f64,
}

impl Element {
    /// Returns the half width of the 95 % interval.
    pub fn half_width(&self) -> f64 {
        NORMAL_95 * self.sigma
    }
}
