//! The likelihood as the search asks it: sets scored, additions screened, which candidates go together.

use super::likelihood::{Fit, Likelihood};
use crate::reconcile::effect::{Candidate, full_id};
use crate::reconcile::search::{Addition, Scored, Scorer};

impl Scorer for Likelihood<'_> {
    type Fit = Fit;

    fn score(
        &mut self,
        set: &[usize],
        from: Option<(&Scored<Fit>, Option<&Addition>)>,
    ) -> Option<Scored<Fit>> {
        self.evidence_of(set, from)
    }

    fn screen(&mut self, base: &Scored<Fit>) -> Vec<Addition> {
        self.additions_to(base)
    }

    fn is_stopped(&self) -> bool {
        self.frame.stop.is_asked()
    }

    fn compatible(&self, a: usize, b: usize) -> bool {
        let (Some(a), Some(b)) = (self.candidates.get(a), self.candidates.get(b)) else {
            return false;
        };
        let (a, b) = (&a.effect, &b.effect);
        if full_id(a.as_ref()) == full_id(b.as_ref()) {
            return false;
        }
        let shared = a.gauges().iter().any(|g| b.gauges().contains(g));
        !shared || a.kind().besides(b.kind())
    }

    fn kin(&self, candidate: usize) -> usize {
        let Some(c) = self.candidates.get(candidate) else {
            return usize::MAX;
        };
        if let [one] = c.effect.gauges().as_slice() {
            return *one;
        }
        // One effect at many places that overlap: pairs of gauges, stretches of a card, runs.
        let same = |o: &Candidate| o.effect.id() == c.effect.id() && o.effect.gauges().len() != 1;
        let first = self.candidates.iter().position(same).unwrap_or(candidate);
        let places = !c.effect.gauges().is_empty() || !c.effect.runs().is_empty();
        self.frame.n_gauges() + if places { first } else { candidate }
    }

    fn variants(&self, candidate: usize) -> Vec<usize> {
        let Some(own) = self
            .candidates
            .get(candidate)
            .map(|c| full_id(c.effect.as_ref()))
        else {
            return Vec::new();
        };
        let same = |(c, o): (usize, &Candidate)| {
            (c != candidate && full_id(o.effect.as_ref()) == own).then_some(c)
        };
        self.candidates
            .iter()
            .enumerate()
            .filter_map(same)
            .collect()
    }
}
