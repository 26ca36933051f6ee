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
    /// # Errors
    /// Why no finer mesh was made.
    pub(super) fn of(model: &Model, laid: [&Vec<Gauge>; 3]) -> Result<Self, String> {
        let n = model.shells.len();
        if n > MOST_SHELLS {
            return Err(format!(
                "the model has {n} shells, and beyond {MOST_SHELLS} four times as many are not solved"
            ));
        }
        let refined = model.refined().ok_or(
            "the mesh can't be divided without tearing it (solids, shear panels, shells with mid-side grids, bars along the sides of shells, or no shells)",
        )?;
        let lost = || "a gauge is on no part of the divided mesh".to_owned();
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
