//! Effects of a set that recur in resampled run sets.

use super::explanation::{ids, is_unmodelled, named_part};
use super::frame::StrainFrame;
use super::likelihood::Fit;
use super::own_covariance::under_own_covariance;
use super::resampled_runs::{RESAMPLED_SETS, count_resampled_wins};
use crate::reconcile::effect::Candidate;
use crate::reconcile::search::ScoredSet;

/// Result of the resampled run sets for the effects of the best set.
pub(super) struct Recurrence {
    /// Effects that recur: enough resampled run sets contain them.
    names: Vec<usize>,
    /// Message on the effects that do not recur; `None` if all recur.
    pub reason: Option<String>,
    /// Members of each compared set, and the number of resampled run sets that it wins.
    contest: Vec<(Vec<usize>, usize)>,
}

impl Recurrence {
    /// Compares `best` in resampled run sets with its alternatives, with no effect at all, and with `best` without its identified effects.
    pub fn compare(
        frame: &StrainFrame,
        candidates: &[Candidate],
        all: &[ScoredSet<Fit>],
        best: &ScoredSet<Fit>,
        rivals: &[(Vec<String>, ScoredSet<Fit>)],
    ) -> Self {
        let names = named_part(candidates, &best.set);
        let others = best.set.iter().copied().filter(|c| !names.contains(c));
        let noise: Vec<usize> = others.collect();
        let known = |set: &[usize]| all.iter().find(|s| s.set == set);
        let scored = match known(&noise) {
            None if !names.is_empty() => under_own_covariance(frame, candidates, &noise, best),
            _ => None,
        };
        let mut contest = vec![best];
        contest.extend(rivals.iter().map(|r| &r.1).filter(|s| s.set != best.set));
        for none in [known(&[]), known(&noise).or(scored.as_ref())] {
            contest.extend(none.filter(|s| contest.iter().all(|k| k.set != s.set)));
        }
        let won = count_resampled_wins(frame, candidates, &contest);
        let holds = |c: &usize| {
            let holding = contest.iter().zip(&won);
            let holding = holding.filter(|(s, _)| s.set.contains(c));
            holding.map(|(_, won)| won).sum::<usize>()
        };
        let stands = |c: &usize| holds(c) as f64 >= frame.rules.drawings * RESAMPLED_SETS as f64;
        let standing: Vec<usize> = names.iter().copied().filter(stands).collect();
        let reason = if standing.len() == names.len() {
            None
        } else if standing.is_empty() {
            Some(seldom_ahead(candidates, &contest, &won))
        } else {
            let unsure = names.iter().filter(|c| !standing.contains(c));
            let described =
                unsure.map(|c| format!("{} in {}", ids(candidates, &[*c]).concat(), holds(c)));
            let described: Vec<String> = described.collect();
            Some(format!(
                "fewer than {:.0} of {RESAMPLED_SETS} resampled run sets contain each of these effects, and they are not reported: {}",
                frame.rules.drawings * RESAMPLED_SETS as f64,
                described.join(", ")
            ))
        };
        let sets = contest.iter().map(|s| s.set.clone());
        Self {
            names: standing,
            reason,
            contest: sets.zip(won).collect(),
        }
    }

    /// Returns `best` without the effects that do not recur. `None` if all effects or no effect recurs, or if `best` contains a general form.
    pub fn keep_recurring_effects(
        &self,
        frame: &StrainFrame,
        candidates: &[Candidate],
        best: &ScoredSet<Fit>,
    ) -> Option<ScoredSet<Fit>> {
        let names = named_part(candidates, &best.set);
        let some = !self.names.is_empty() && self.names.len() < names.len();
        if !some || is_unmodelled(candidates, &best.set).is_some() {
            return None;
        }
        let dropped = |c: &usize| names.contains(c) && !self.names.contains(c);
        let kept: Vec<usize> = best.set.iter().copied().filter(|c| !dropped(c)).collect();
        under_own_covariance(frame, candidates, &kept, best)
    }

    /// Returns the number of 100 resampled run sets whose best set contains all of these effects.
    pub fn wins(&self, names: &[usize]) -> usize {
        let holding = |s: &&(Vec<usize>, usize)| names.iter().all(|c| s.0.contains(c));
        self.contest.iter().filter(holding).map(|s| s.1).sum()
    }
}

/// Returns a message that the first set wins in few resampled run sets, with the sets that win in the other run sets.
fn seldom_ahead(candidates: &[Candidate], contest: &[&ScoredSet<Fit>], won: &[usize]) -> String {
    let mut sets = contest.iter().zip(won);
    let (names, first) = sets.next().map_or((String::new(), 0), |(s, w)| {
        (ids(candidates, &s.set).join(" + "), *w)
    });
    let mut others: Vec<(usize, String)> = sets
        .filter(|o| *o.1 > 0)
        .map(|(s, w)| match ids(candidates, &s.set).join(" + ") {
            none if none.is_empty() => (*w, "no effect at all".to_owned()),
            some => (*w, some),
        })
        .collect();
    others.sort_by_key(|o| std::cmp::Reverse(o.0));
    let described: Vec<String> = others.iter().map(|(w, s)| format!("{s} in {w}")).collect();
    format!(
        "{names} explains most of the gap, but is the best set in {first} of {RESAMPLED_SETS} resampled run sets only; {}",
        described.join(", ")
    )
}
