//! An explanation: effects with their parameters, and amplitudes with their sizes.

use super::frame::StrainFrame;
use super::likelihood::Fit;
use crate::reconcile::effect::{Candidate, Discrepancy, Member, SizedAmplitudes, full_id};
use crate::reconcile::search::Scored;

/// An explanation: effects with parameters, and amplitudes.
pub struct Explanation<'a> {
    /// Effects with parameters.
    pub members: Vec<Member<'a>>,
    /// Amplitudes with sizes.
    pub unknown: Vec<SizedAmplitudes>,
}

impl<'a> Explanation<'a> {
    /// The explanation that a fit is.
    pub fn of(frame: &StrainFrame, candidates: &'a [Candidate], scored: &'a Scored<Fit>) -> Self {
        let member = |(&c, p): (&usize, &'a Vec<f64>)| {
            candidates.get(c).map(|c| Member {
                effect: c.effect.as_ref(),
                parameters: p.as_slice(),
            })
        };
        let sized = |(c, sizes): &(usize, Vec<f64>)| {
            let amplitudes = candidates.get(*c)?.effect.amplitudes(frame)?;
            Some(SizedAmplitudes {
                amplitudes,
                sizes: sizes.clone(),
            })
        };
        Self {
            members: scored
                .set
                .iter()
                .zip(&scored.fit.parameters)
                .filter_map(member)
                .collect(),
            unknown: scored.fit.sizes.iter().filter_map(sized).collect(),
        }
    }
}

/// What the general form of candidate `c` says, where it is one.
pub fn discrepancy(candidates: &[Candidate], c: usize) -> Option<Discrepancy> {
    candidates.get(c).and_then(|c| c.effect.discrepancy())
}

/// The effects of a set that could be named: all but noise.
pub fn named_part(candidates: &[Candidate], set: &[usize]) -> Vec<usize> {
    let noise = |c: &usize| matches!(discrepancy(candidates, *c), Some(Discrepancy::Noise(_)));
    set.iter().copied().filter(|c| !noise(c)).collect()
}

/// Does a set hold a general form that no name stands for?
pub fn is_unmodelled(candidates: &[Candidate], set: &[usize]) -> Option<&'static str> {
    set.iter().find_map(|&c| match discrepancy(candidates, c) {
        Some(Discrepancy::Form(words) | Discrepancy::Smooth(words)) => Some(words),
        _ => None,
    })
}

/// Ids with places of the effects of a set, noise left out.
pub fn ids(candidates: &[Candidate], set: &[usize]) -> Vec<String> {
    let named = named_part(candidates, set);
    named
        .iter()
        .filter_map(|&c| candidates.get(c))
        .map(|c| full_id(c.effect.as_ref()))
        .collect()
}
