//! Influence with named effects in it: what the extended model of a job in matrix form holds.

use super::frame::StrainFrame;
use super::state::StrainState;
use crate::reconcile::effect::{Member, full_id, library};
use crate::reconcile::outcome::NamedEffect;

/// Influence with the effects of structure in it; the same as before where there are none.
pub fn extended_influence(frame: &StrainFrame, effects: &[NamedEffect]) -> Vec<f64> {
    let ids: Vec<String> = effects.iter().map(|e| e.id.clone()).collect();
    let candidates = library(frame, &ids);
    let member = |e: &'_ NamedEffect| {
        let parameters = |n: usize| e.size.get(..n);
        let found = candidates.iter().find(|c| full_id(c.effect.as_ref()) == e.id)?;
        Some((found.effect.as_ref(), parameters(found.effect.parameters().len())?.to_vec()))
    };
    let chosen: Vec<_> = effects.iter().filter_map(member).collect();
    let members: Vec<Member<'_>> = chosen.iter().map(|(effect, p)| Member { effect: *effect, parameters: p }).collect();
    StrainState::with(frame, &members).influence
}
