//! Signatures of a stiffness that may be wrong: the changed model solved again.

use super::deck_frame::DeckFrame;
use super::described_effects::{effect_of, factor_at};
use super::stiffness_changes::DeckStiffnessChange;
use crate::host::fault::{Fault, Faults};
use crate::job::Job;
use crate::model::Model;
use crate::reconcile::strain::{StiffnessOf, StiffnessSignature};

/// Small thickness change at which a zone's signature is computed first, percent: its derivative. The size that is found is solved exactly.
const ZONE_PERCENT: f64 = 0.1;
/// Stiffness of a joint at which its signature is computed first, natural log times 100: half and double.
const JOINT_PERCENT: [f64; 2] = [-69.314_718_055_994_53, 69.314_718_055_994_53];
/// Prior sd of a thickness, percent.
const ZONE_PRIOR: f64 = 15.0;
/// Prior sd of a joint's stiffness, natural log times 100: known to a factor of two.
const JOINT_PRIOR: f64 = 70.0;
/// Bushes of a deck that names none: more of them are springs of something else.
const MOST_JOINTS: usize = 12;

/// Returns the factor on a stiffness for a size. The size of a zone is in percent, and the size of a joint is its natural log times 100. A user's own
/// edit has its own size. Returns `None` for a table, which is not a stiffness of the deck.
pub(super) fn factor(job: &Job, of: StiffnessOf, place: &str, size: f64) -> Option<f64> {
    match of {
        StiffnessOf::Joint | StiffnessOf::Local => Some((size / 100.0).exp()),
        StiffnessOf::Zone => Some(1.0 + size / 100.0),
        StiffnessOf::Described => factor_at(&effect_of(job, place)?.source, size),
    }
}

/// Returns the bushes whose stiffness is tested: the bushes that the job names, or all bushes of a deck with few bushes.
fn joints(job: &Job, model: &Model) -> Vec<u32> {
    let named = job.reconcile.as_ref().and_then(|r| r.joints.as_ref());
    let chosen: Vec<u32> = match named {
        Some(ids) => model
            .bushes
            .iter()
            .map(|b| b.id)
            .filter(|b| ids.contains(*b))
            .collect(),
        None => model.bushes.iter().map(|b| b.id).collect(),
    };
    if named.is_none() && chosen.len() > MOST_JOINTS {
        return Vec::new();
    }
    chosen
}

impl DeckFrame {
    /// Returns the signatures of all zones and joints.
    pub(super) fn signatures(&self, job: &Job) -> Result<Vec<StiffnessSignature>, Faults> {
        let mut wanted: Vec<(StiffnessOf, String, Vec<f64>, f64)> = self
            .zones
            .keys()
            .map(|z| (StiffnessOf::Zone, z.clone(), vec![ZONE_PERCENT], ZONE_PRIOR))
            .collect();
        let joints = joints(job, self.fields.model());
        wanted.extend(joints.iter().map(|j| {
            (
                StiffnessOf::Joint,
                j.to_string(),
                JOINT_PERCENT.to_vec(),
                JOINT_PRIOR,
            )
        }));
        let mut models: Vec<DeckStiffnessChange> = Vec::new();
        for (of, place, sizes, _) in &wanted {
            for percent in sizes {
                models.push(self.resolve_change(job, *of, place, *percent)?);
            }
        }
        let mut changes = self.small_changes_by(job, &models)?.into_iter();
        let signature =
            |(of, place, sizes, prior_percent): (_, _, Vec<f64>, _)| StiffnessSignature {
                of,
                place,
                at_percent: sizes.into_iter().zip(&mut changes).collect(),
                prior_percent,
            };
        Ok(wanted.into_iter().map(signature).collect())
    }

    /// Returns the change of the influence matrix when the stiffness of a zone or a joint changes by `percent` (see [`factor`]). The changed model is
    /// solved on the mesh of the deck.
    pub(super) fn stiffness_change(
        &self,
        job: &Job,
        of: StiffnessOf,
        place: &str,
        percent: f64,
    ) -> Result<Vec<f64>, Faults> {
        if let (StiffnessOf::Described, Some(e)) = (of, effect_of(job, place)) {
            return self.described_change(job, e, percent);
        }
        let changed = self.resolve_change(job, of, place, percent)?;
        let mut changes = self.changes_by(job, &[changed])?;
        Ok(changes.pop().unwrap_or_default())
    }

    fn resolve_change(
        &self,
        job: &Job,
        of: StiffnessOf,
        place: &str,
        percent: f64,
    ) -> Result<DeckStiffnessChange, Faults> {
        let factor = factor(job, of, place, percent).unwrap_or(1.0);
        Ok(match of {
            StiffnessOf::Joint => DeckStiffnessChange::Bush(place.to_owned(), factor),
            StiffnessOf::Local => DeckStiffnessChange::Shells(self.shells_of_region(place), factor),
            StiffnessOf::Zone | StiffnessOf::Described => {
                DeckStiffnessChange::Thickness(self.properties_of_zone(job, place)?, factor)
            }
        })
    }

    fn properties_of_zone(&self, job: &Job, zone: &str) -> Result<Vec<u32>, Faults> {
        let fault = |wrong: String, remedy: &str| {
            Faults::from(Fault::new(&*job.file, "reconcile.zones", wrong, remedy))
        };
        let Some(ids) = self.zones.get(zone) else {
            return Err(fault(format!("no zone `{zone}`"), "name its properties"));
        };
        let found = self.shell_properties(|id| ids.contains(id));
        if found.is_empty() {
            let wrong = format!("zone `{zone}` names no PSHELL of the deck");
            return Err(fault(wrong, "name PSHELL ids"));
        }
        Ok(found)
    }
}
