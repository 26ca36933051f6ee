//! Signatures of a stiffness that may be wrong: the changed model solved again.

use super::deck_frame::DeckFrame;
use super::described::{effect_of, factor_at};
use super::influence::{influence, solve_each};
use super::local::softened;
use crate::app::fault::{Fault, Faults};
use crate::app::job::Job;
use crate::model::Model;
use crate::reconcile::strain::{StiffnessOf, StiffnessSignature};

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

/// A change of the deck's stiffness, and its factor.
pub(super) enum Changed {
    /// Of a bush, by id.
    Bush(String, f64),
    /// Of the moduli of some shells.
    Shells(Vec<usize>, f64),
    /// Of the thickness of some PSHELL cards.
    Thickness(Vec<u32>, f64),
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
        let mut models: Vec<Changed> = Vec::new();
        for (of, place, sizes, _) in &wanted {
            for percent in sizes {
                models.push(self.changed(job, *of, place, *percent)?);
            }
        }
        let mut changes = self.changes_by(job, &models)?.into_iter();
        let signature =
            |(of, place, sizes, prior_percent): (_, _, Vec<f64>, _)| StiffnessSignature {
                of,
                place,
                at_percent: sizes.into_iter().zip(&mut changes).collect(),
                prior_percent,
            };
        Ok(wanted.into_iter().map(signature).collect())
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
        let changed = self.changed(job, of, place, percent)?;
        let mut changes = self.changes_by(job, &[changed])?;
        Ok(changes.pop().unwrap_or_default())
    }

    /// Change of the influence matrix by each change of the deck, from solutions of the changed models on the mesh as it stands.
    pub(super) fn changes_by(&self, job: &Job, all: &[Changed]) -> Result<Vec<Vec<f64>>, Faults> {
        let models = all.iter().map(|c| self.model_with(c));
        let (model, n) = (self.fields.model(), self.columns.len());
        solve_each(
            job,
            model,
            &self.columns,
            models,
            &self.stop,
            |model, solution| {
                let now = influence(job, model, &self.gauges, solution, n);
                now.iter().zip(&self.base).map(|(a, b)| a - b).collect()
            },
        )
    }

    fn changed(
        &self,
        job: &Job,
        of: StiffnessOf,
        place: &str,
        percent: f64,
    ) -> Result<Changed, Faults> {
        let factor = factor(job, of, place, percent).unwrap_or(1.0);
        Ok(match of {
            StiffnessOf::Joint => Changed::Bush(place.to_owned(), factor),
            StiffnessOf::Local => Changed::Shells(self.shells_of_region(place), factor),
            StiffnessOf::Zone | StiffnessOf::Described => {
                Changed::Thickness(self.properties_of_zone(job, place)?, factor)
            }
        })
    }

    fn model_with(&self, changed: &Changed) -> Model {
        match changed {
            Changed::Bush(id, factor) => self.with_joint(id, *factor),
            Changed::Shells(shells, factor) => softened(self.fields.model(), shells, *factor),
            Changed::Thickness(ids, factor) => self.with_properties(ids, *factor),
        }
    }

    fn with_joint(&self, place: &str, factor: f64) -> Model {
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

    fn properties_of_zone(&self, job: &Job, zone: &str) -> Result<Vec<u32>, Faults> {
        let fault = |wrong: String, remedy: &str| {
            Faults::from(Fault::of(&*job.file, "reconcile.zones", wrong, remedy))
        };
        let Some(ids) = job.reconcile.as_ref().and_then(|r| r.zones.get(zone)) else {
            return Err(fault(format!("no zone `{zone}`"), "name its properties"));
        };
        let found = self.shell_properties(|id| ids.contains(id));
        if found.is_empty() {
            let wrong = format!("zone `{zone}` names no PSHELL of the deck");
            return Err(fault(wrong, "name PSHELL ids"));
        }
        Ok(found)
    }

    /// Ids of the PSHELL cards that are wanted.
    pub(super) fn shell_properties(&self, wanted: impl Fn(u32) -> bool) -> Vec<u32> {
        let cards = self.fields.deck.deck.cards.pshells.iter();
        cards.map(|p| p.card.id).filter(|id| wanted(*id)).collect()
    }

    /// The model with the thickness of these shell properties scaled.
    fn with_properties(&self, ids: &[u32], factor: f64) -> Model {
        let mut deck = self.fields.deck.deck.clone();
        let cards = deck.cards.pshells.iter_mut();
        for p in cards.filter(|p| ids.contains(&p.card.id)) {
            p.card.t = p.card.t.map(|t| t * factor);
            p.card.z1 = p.card.z1.map(|z| z * factor);
            p.card.z2 = p.card.z2.map(|z| z * factor);
        }
        Model::from_deck(&deck).0
    }
}
