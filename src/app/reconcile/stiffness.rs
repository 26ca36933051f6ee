//! Signatures of a stiffness that may be wrong: the changed model solved again.

use super::deck_frame::DeckFrame;
use super::described::{effect_of, factor_at};
use super::influence::{influence, solve};
use crate::app::fault::{Fault, Faults};
use crate::app::job::Job;
use crate::model::Model;
use crate::reconcile::strain::{StiffnessOf, StiffnessSignature};
use rayon::prelude::*;

/// Thickness change at which a zone's signature is computed first, percent.
const ZONE_PERCENT: f64 = 10.0;
/// Stiffness of a joint at which its signature is computed first, natural log times 100: half and double.
const JOINT_PERCENT: [f64; 2] = [-69.314_718_055_994_53, 69.314_718_055_994_53];
/// Prior sd of a thickness, percent.
const ZONE_PRIOR: f64 = 15.0;
/// Prior sd of a joint's stiffness, natural log times 100: known to a factor of two.
const JOINT_PRIOR: f64 = 70.0;
/// Bushes of a deck that names none: more of them are springs of something else.
const MOST_JOINTS: usize = 12;

/// Factor of a stiffness at a size: a zone counts in percent, a joint in its natural log times 100, an edit of the user's own in its own
/// size; `None` for a table, which is no stiffness of the deck.
pub(super) fn factor(job: &Job, of: StiffnessOf, place: &str, size: f64) -> Option<f64> {
    match of {
        StiffnessOf::Joint | StiffnessOf::Local => Some((size / 100.0).exp()),
        StiffnessOf::Zone => Some(1.0 + size / 100.0),
        StiffnessOf::Described => factor_at(&effect_of(job, place)?.source, size),
    }
}

/// Bushes whose stiffness is tried: those that the job names, or all of a deck that has few.
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
    /// Signatures of all zones and joints.
    pub(super) fn signatures(&self, job: &Job) -> Result<Vec<StiffnessSignature>, Faults> {
        let zones = job.reconcile.iter().flat_map(|r| r.zones.keys());
        let mut wanted: Vec<(StiffnessOf, String, Vec<f64>, f64)> = zones
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
        let solved = wanted
            .into_par_iter()
            .map(|(id, place, sizes, prior_percent)| {
                let at = sizes
                    .into_iter()
                    .map(|p| Ok((p, self.stiffness_change(job, id, &place, p)?)));
                Ok(StiffnessSignature {
                    of: id,
                    at_percent: at.collect::<Result<_, Faults>>()?,
                    prior_percent,
                    place,
                })
            });
        solved.collect()
    }

    /// Change of the influence matrix when the stiffness of a zone or a joint changes by `percent` (see [`factor`]), from a solution of
    /// the changed model on the mesh as it stands.
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
        let factor = factor(job, of, place, percent).unwrap_or(1.0);
        let model = match of {
            StiffnessOf::Joint => self.with_joint(place, factor),
            StiffnessOf::Local => self.with_region(place, factor),
            StiffnessOf::Zone | StiffnessOf::Described => self.with_zone(job, place, factor)?,
        };
        let solution = solve(job, &model, &self.columns, &self.stop)?;
        let now = influence(job, &model, &self.gauges, &solution, self.columns.len());
        Ok(now.iter().zip(&self.base).map(|(a, b)| a - b).collect())
    }

    pub(super) fn with_joint(&self, place: &str, factor: f64) -> Model {
        let mut model = self.fields.model().clone();
        for b in model
            .bushes
            .iter_mut()
            .filter(|b| b.id.to_string() == place)
        {
            b.k.iter_mut().for_each(|k| *k *= factor);
        }
        model
    }

    fn with_zone(&self, job: &Job, zone: &str, factor: f64) -> Result<Model, Faults> {
        let fault = |wrong: String, remedy: &str| {
            Faults::from(Fault::of(&*job.file, "reconcile.zones", wrong, remedy))
        };
        let Some(ids) = job.reconcile.as_ref().and_then(|r| r.zones.get(zone)) else {
            return Err(fault(format!("no zone `{zone}`"), "name its properties"));
        };
        self.with_properties(|id| ids.contains(id), factor)
            .ok_or_else(|| {
                fault(
                    format!("zone `{zone}` names no PSHELL of the deck"),
                    "name PSHELL ids",
                )
            })
    }

    /// The model with the thickness of the shell properties `wanted` scaled; `None` where there are none.
    pub(super) fn with_properties(
        &self,
        wanted: impl Fn(u32) -> bool,
        factor: f64,
    ) -> Option<Model> {
        let mut deck = self.fields.deck.deck.clone();
        let mut changed = false;
        for p in deck.cards.pshells.iter_mut().filter(|p| wanted(p.card.id)) {
            p.card.t = p.card.t.map(|t| t * factor);
            p.card.z1 = p.card.z1.map(|z| z * factor);
            p.card.z2 = p.card.z2.map(|z| z * factor);
            changed = true;
        }
        changed.then(|| Model::from_deck(&deck).0)
    }
}
