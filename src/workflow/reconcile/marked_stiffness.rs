//! Location of a wrong stiffness on the deck's model.

use super::deck_frame::DeckFrame;
use super::described_effects::effect_of;
use super::stiffness::factor;
use crate::job::{EffectSource, Job};
use crate::model::Vec3;
use crate::reconcile::NamedEffect;
use crate::reconcile::effect::Extension;
use crate::reconcile::strain::StiffnessOf;

/// Wrong stiffness, with its position on the model.
#[derive(Clone, Debug, PartialEq)]
pub struct MarkedStiffness {
    /// Id of the effect, with place.
    pub id: String,
    /// Factor on the stiffness.
    pub factor: f64,
    /// Indices of the shells of a zone or a small region; empty for a joint.
    pub shells: Vec<usize>,
    /// Place of a joint or middle of a small region, basic frame.
    pub at: Option<Vec3>,
}

impl DeckFrame {
    /// Returns the stiffnesses of `effects` with a position on the model.
    pub(super) fn mark_stiffnesses(
        &self,
        job: &Job,
        effects: &[NamedEffect],
    ) -> Vec<MarkedStiffness> {
        let of = |e: &NamedEffect| {
            let (of, place, size) = match &e.extension {
                Extension::ZoneStiffness { place, percent } => (StiffnessOf::Zone, place, *percent),
                Extension::JointStiffness { place, percent } => {
                    (StiffnessOf::Joint, place, *percent)
                }
                Extension::LocalStiffness { place, percent } => {
                    (StiffnessOf::Local, place, *percent)
                }
                Extension::Described { id, size } => (StiffnessOf::Described, id, *size),
                _ => return None,
            };
            let (shells, at) = self.place_of(job, of, place);
            let lies = !shells.is_empty() || at.is_some();
            lies.then_some(MarkedStiffness {
                id: e.id.clone(),
                factor: factor(job, of, place, size)?,
                shells,
                at,
            })
        };
        effects.iter().filter_map(of).collect()
    }

    /// Shells of a zone or region, place of a joint or region.
    fn place_of(&self, job: &Job, of: StiffnessOf, place: &str) -> (Vec<usize>, Option<Vec3>) {
        let joint = |id: &str| {
            let mut bushes = self.fields.model().bushes.iter();
            bushes.find(|b| b.id.to_string() == id).map(|b| b.location)
        };
        match of {
            StiffnessOf::Zone => {
                let ids = self.zones.get(place);
                let own = |id: u32| ids.is_some_and(|i| i.contains(id));
                (self.shells_of(own), None)
            }
            StiffnessOf::Local => {
                let region = self.regions.iter().find(|r| r.place == place);
                let shells = region.map_or_else(Vec::new, |r| r.shells.clone());
                (shells, region.map(|r| r.centre))
            }
            StiffnessOf::Joint => (Vec::new(), joint(place)),
            StiffnessOf::Described => match effect_of(job, place).map(|e| &e.source) {
                Some(EffectSource::Thickness { property, .. }) => {
                    (self.shells_of(|id| id == *property), None)
                }
                Some(EffectSource::Bush { element, .. }) => {
                    (Vec::new(), joint(&element.to_string()))
                }
                Some(EffectSource::Signature(_)) | None => (Vec::new(), None),
            },
        }
    }

    /// Indices of the shells whose property is one of the `wanted`.
    fn shells_of(&self, wanted: impl Fn(u32) -> bool) -> Vec<usize> {
        let model = self.fields.model();
        let property = |i: usize| {
            let ix = model.shells.get(i)?.property;
            Some(model.shell_properties.get(ix.us())?.id)
        };
        (0..model.shells.len())
            .filter(|&i| property(i).is_some_and(&wanted))
            .collect()
    }
}
