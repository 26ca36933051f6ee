//! An explanation: effects with their parameters, and amplitudes with their sizes.

use super::frame::StrainFrame;
use super::likelihood::Fit;
use crate::reconcile::effect::{Candidate, Discrepancy, Member, SizedAmplitudes, full_id};
use crate::reconcile::search::ScoredSet;

/// An explanation: effects with parameters, and amplitudes.
pub struct Explanation<'a> {
    /// Effects with parameters.
    pub members: Vec<Member<'a>>,
    /// Amplitudes with sizes.
    pub unknown: Vec<SizedAmplitudes>,
}

impl<'a> Explanation<'a> {
    /// Returns the explanation of a fit.
    pub fn from_fit(
        frame: &StrainFrame,
        candidates: &'a [Candidate],
        scored: &'a ScoredSet<Fit>,
    ) -> Self {
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

/// Returns the general form of discrepancy of candidate `c`; `None` for an effect of the library.
pub fn discrepancy(candidates: &[Candidate], c: usize) -> Option<Discrepancy> {
    candidates.get(c).and_then(|c| c.effect.discrepancy())
}

/// Returns the effects of a set that can be named: all except noise.
pub fn named_part(candidates: &[Candidate], set: &[usize]) -> Vec<usize> {
    let noise = |c: &usize| matches!(discrepancy(candidates, *c), Some(Discrepancy::Noise(_)));
    set.iter().copied().filter(|c| !noise(c)).collect()
}

/// Returns the description of the general form of discrepancy in a set; `None` if the set has no such form.
pub fn is_unmodelled(candidates: &[Candidate], set: &[usize]) -> Option<&'static str> {
    set.iter().find_map(|&c| match discrepancy(candidates, c) {
        Some(Discrepancy::Form(words) | Discrepancy::Smooth(words)) => Some(words),
        _ => None,
    })
}

/// Returns the ids with places of the effects of a set. Effects that describe only noise are left out.
pub fn ids(candidates: &[Candidate], set: &[usize]) -> Vec<String> {
    let named = named_part(candidates, set);
    named
        .iter()
        .filter_map(|&c| candidates.get(c))
        .map(|c| full_id(c.effect.as_ref()))
        .collect()
}
