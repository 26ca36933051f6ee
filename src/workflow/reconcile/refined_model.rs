//! The deck's model on a mesh half as wide, with the gauges on it.

use crate::gauge::{Gauge, on_refined};
use crate::model::{Model, RefinedModel};
use crate::strain_chain::refined_mesh;

/// The finer model with the gauges at their nominal positions, and turned by 45 and by 90 degrees.
pub(super) struct RefinedGaugeModel {
    pub(super) refined: RefinedModel,
    pub(super) laid: [Vec<Gauge>; 3],
}

impl RefinedGaugeModel {
    /// # Errors
    /// The reason why no finer mesh was made.
    pub(super) fn refine_model(model: &Model, laid: [&Vec<Gauge>; 3]) -> Result<Self, String> {
        let refined = refined_mesh(model, laid.first().map(|g| g.as_slice()))?;
        let lost = || "a gauge is not on the refined mesh".to_owned();
        let of = |k: usize| {
            let gauges = laid.get(k);
            gauges
                .and_then(|g| lay_on(g, model, &refined))
                .ok_or_else(lost)
        };
        let laid = [of(0)?, of(1)?, of(2)?];
        Ok(Self { refined, laid })
    }

    /// Places gauges of the deck's model on the finer model. `None` if a gauge is not on it.
    pub(super) fn lay(&self, gauges: &[Gauge], model: &Model) -> Option<Vec<Gauge>> {
        lay_on(gauges, model, &self.refined)
    }
}

fn lay_on(gauges: &[Gauge], model: &Model, refined: &RefinedModel) -> Option<Vec<Gauge>> {
    let gauges = gauges.iter();
    gauges.map(|g| on_refined(g, model, refined)).collect()
}
