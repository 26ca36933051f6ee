//! The deck's model on a mesh half as wide, with the gauges on it.

use crate::gauge::{Gauge, on_refined};
use crate::model::{Model, RefinedModel};

/// Beyond this many shells the mesh is fine enough as it is, and four times as many would take their time.
const MOST_SHELLS: usize = 20_000;

/// The finer model with the gauges as drawn, turned by 45 and by 90 degrees.
pub(super) struct Finer {
    pub(super) refined: RefinedModel,
    pub(super) laid: [Vec<Gauge>; 3],
}

impl Finer {
    /// `None` where the model can't be refined without tearing it, or needs no finer mesh.
    pub(super) fn of(model: &Model, laid: [&Vec<Gauge>; 3]) -> Option<Self> {
        if model.shells.len() > MOST_SHELLS {
            return None;
        }
        let refined = model.refined()?;
        let on = |gauges: &Vec<Gauge>| -> Option<Vec<Gauge>> {
            gauges
                .iter()
                .map(|g| on_refined(g, model, &refined))
                .collect()
        };
        let laid = [on(laid[0])?, on(laid[1])?, on(laid[2])?];
        Some(Self { refined, laid })
    }
}
