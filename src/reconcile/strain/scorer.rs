//! Scorer of the search by likelihood: scores sets, screens additions, and determines which candidates are compatible.

use super::likelihood::{Fit, Likelihood};
use crate::reconcile::effect::{Candidate, full_id};
use crate::reconcile::search::{Addition, ScoredSet, Scorer};

impl Scorer for Likelihood<'_> {
    type Fit = Fit;

    fn score(
        &mut self,
        set: &[usize],
        from: Option<(&ScoredSet<Fit>, Option<&Addition>)>,
    ) -> Option<ScoredSet<Fit>> {
        self.evidence_of(set, from)
    }

    fn screen(&mut self, base: &ScoredSet<Fit>) -> Vec<Addition> {
        self.additions_to(base)
    }

    fn is_stopped(&self) -> bool {
        self.frame.stop.is_asked()
    }

    fn is_compatible_pair(&self, a: usize, b: usize) -> bool {
        let (Some(a), Some(b)) = (self.candidates.get(a), self.candidates.get(b)) else {
            return false;
        };
        let (a, b) = (&a.effect, &b.effect);
        if full_id(a.as_ref()) == full_id(b.as_ref()) {
            return false;
        }
        let (at_a, at_b) = (a.gauges(), b.gauges());
        let shared = at_a.iter().any(|g| at_b.contains(g));
        let n = self.frame.n_gauges();
        !shared
            || a.kind().is_distinguishable_from(b.kind())
            || is_distinguishable(&at_a, &at_b, n)
            || is_distinguishable(&at_b, &at_a, n)
    }

    fn kin(&self, candidate: usize) -> usize {
        let Some(c) = self.candidates.get(candidate) else {
            return usize::MAX;
        };
        if let [one] = c.effect.gauges().as_slice() {
            return *one;
        }
        // One effect at many overlapping places, such as pairs of gauges, channel ranges of a card, or runs.
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

/// Returns whether other gauges distinguish a fault at the gauge of `one` from a fault at `many`, in file order, of `n` gauges in all. They do if
/// `many` is all gauges, or a range that contains the gauge away from its ends. At an end, a shorter range explains as much.
fn is_distinguishable(one: &[usize], many: &[usize], n: usize) -> bool {
    let &[gauge] = one else {
        return false;
    };
    let within = many.len() > 3 && many.first() < Some(&gauge) && Some(&gauge) < many.last();
    many.len() == n && n > 3 || within && many.contains(&gauge)
}

#[cfg(test)]
mod tests {
    use super::is_distinguishable;

    #[test]
    fn a_fault_of_one_gauge_is_found_together_with_one_of_all_or_within_a_stretch_but_not_at_its_end()
     {
        let all: Vec<usize> = (0..9).collect();
        assert!(is_distinguishable(&[0], &all, 9) && is_distinguishable(&[4], &all, 9));
        assert!(is_distinguishable(&[4], &all[2..7], 9));
        assert!(
            !is_distinguishable(&[2], &all[2..7], 9) && !is_distinguishable(&[6], &all[2..7], 9)
        );
        assert!(!is_distinguishable(&[3], &[3, 7], 9) && !is_distinguishable(&[3, 4], &all, 9));
    }
}
