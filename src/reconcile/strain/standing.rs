//! Which names of a set stand when the runs are drawn anew.

use super::explanation::{ids, is_unmodelled, named_part};
use super::frame::StrainFrame;
use super::likelihood::Fit;
use super::own_covariance::under_own_covariance;
use super::resampled::{DRAWINGS, drawings_won};
use crate::reconcile::effect::Candidate;
use crate::reconcile::search::Scored;

/// The names of the best set before the drawings of the runs.
pub(super) struct Standing {
    /// Names that enough resampled run sets hold.
    names: Vec<usize>,
    /// What speaks against the others, in words; `None` where all stand.
    pub doubt: Option<String>,
    /// By set of the contest: its members, and the drawings that it wins.
    contest: Vec<(Vec<usize>, usize)>,
}

impl Standing {
    /// Of the names of `best`, against its rivals, no effect at all, and what noise alone it takes besides.
    pub fn of(
        frame: &StrainFrame,
        candidates: &[Candidate],
        all: &[Scored<Fit>],
        best: &Scored<Fit>,
        rivals: &[(Vec<String>, Scored<Fit>)],
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
        let won = drawings_won(frame, candidates, &contest);
        let holds = |c: &usize| {
            let holding = contest.iter().zip(&won);
            let holding = holding.filter(|(s, _)| s.set.contains(c));
            holding.map(|(_, won)| won).sum::<usize>()
        };
        let stands = |c: &usize| holds(c) as f64 >= frame.rules.drawings * DRAWINGS as f64;
        let standing: Vec<usize> = names.iter().copied().filter(stands).collect();
        let doubt = if standing.len() == names.len() {
            None
        } else if standing.is_empty() {
            Some(seldom_ahead(candidates, &contest, &won))
        } else {
            let unsure = names.iter().filter(|c| !standing.contains(c));
            let told =
                unsure.map(|c| format!("{} in {}", ids(candidates, &[*c]).concat(), holds(c)));
            let told: Vec<String> = told.collect();
            Some(format!(
                "fewer than {:.0} of {DRAWINGS} resampled run sets contain each of these effects, and they are not reported: {}",
                frame.rules.drawings * DRAWINGS as f64,
                told.join(", ")
            ))
        };
        let sets = contest.iter().map(|s| s.set.clone());
        Self {
            names: standing,
            doubt,
            contest: sets.zip(won).collect(),
        }
    }

    /// The set of those of its names that stand, where these are some and not all; a general form has no names to stand.
    pub fn fewer(
        &self,
        frame: &StrainFrame,
        candidates: &[Candidate],
        best: &Scored<Fit>,
    ) -> Option<Scored<Fit>> {
        let names = named_part(candidates, &best.set);
        let some = !self.names.is_empty() && self.names.len() < names.len();
        if !some || is_unmodelled(candidates, &best.set).is_some() {
            return None;
        }
        let dropped = |c: &usize| names.contains(c) && !self.names.contains(c);
        let kept: Vec<usize> = best.set.iter().copied().filter(|c| !dropped(c)).collect();
        under_own_covariance(frame, candidates, &kept, best)
    }

    /// Of 100 drawings, those whose best set holds all of these names.
    pub fn wins(&self, names: &[usize]) -> usize {
        let holding = |s: &&(Vec<usize>, usize)| names.iter().all(|c| s.0.contains(c));
        self.contest.iter().filter(holding).map(|s| s.1).sum()
    }
}

/// That the first set is ahead in few of the drawings, and what is ahead in the others, in words.
fn seldom_ahead(candidates: &[Candidate], contest: &[&Scored<Fit>], won: &[usize]) -> String {
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
    let told: Vec<String> = others.iter().map(|(w, s)| format!("{s} in {w}")).collect();
    format!(
        "{names} explains most, but stays ahead in {first} of {DRAWINGS} drawings of the runs; {}",
        told.join(", ")
    )
}
