//! The deck's model on a mesh half as wide, with the gauges on it.

use crate::gauge::{Gauge, on_refined};
use crate::model::{Model, RefinedModel};
use crate::strain_chain::refined_mesh;

/// The finer model with the gauges as drawn, turned by 45 and by 90 degrees.
pub(super) struct Finer {
    pub(super) refined: RefinedModel,
    pub(super) laid: [Vec<Gauge>; 3],
}

impl Finer {
    /// # Errors
    /// Why no finer mesh was made.
    pub(super) fn of(model: &Model, laid: [&Vec<Gauge>; 3]) -> Result<Self, String> {
        let refined = refined_mesh(model, laid.first().map(|g| g.as_slice()))?;
        let lost = || "a gauge is not on the refined mesh".to_owned();
        let on = |gauges: &Vec<Gauge>| -> Option<Vec<Gauge>> {
            gauges
                .iter()
                .map(|g| on_refined(g, model, &refined))
                .collect()
        };
        let of = |k: usize| laid.get(k).and_then(|g| on(g)).ok_or_else(lost);
        let laid = [of(0)?, of(1)?, of(2)?];
        Ok(Self { refined, laid })
    }
}
