//! Search for the set of effects with the best evidence: it adds, removes and exchanges effects. It does not depend on strain or acceleration.

use std::collections::BTreeMap;

/// A set of effects with its evidence.
#[derive(Clone, Debug)]
pub struct ScoredSet<F> {
    /// Candidate numbers, ascending.
    pub set: Vec<usize>,
    /// Log evidence, prior weights included.
    pub log_evidence: f64,
    /// Parameters and further results of the fit.
    pub fit: F,
}

/// A candidate that might join a set.
#[derive(Clone, Debug)]
pub struct Addition {
    /// Candidate number.
    pub candidate: usize,
    /// Approximate gain of log evidence, prior weight included.
    pub gain: f64,
    /// Start values of the parameters.
    pub parameters: Vec<f64>,
    /// Sizes of the amplitudes.
    pub sizes: Vec<f64>,
}

/// Scorer of sets of effects.
pub trait Scorer {
    /// Result of a fit.
    type Fit: Clone;
    /// Fits `set` exactly, from scratch or from a fit of its neighbour.
    fn score(
        &mut self,
        set: &[usize],
        from: Option<(&ScoredSet<Self::Fit>, Option<&Addition>)>,
    ) -> Option<ScoredSet<Self::Fit>>;
    /// Candidates to add to `base`, best first.
    fn screen(&mut self, base: &ScoredSet<Self::Fit>) -> Vec<Addition>;
    /// Returns whether both candidates can be in one set.
    fn is_compatible_pair(&self, a: usize, b: usize) -> bool;
    /// Returns a number that is common to candidates without a relevant difference. The screen keeps few candidates of each number.
    fn kin(&self, candidate: usize) -> usize;
    /// Returns whether the search is to stop; its result is then of no use.
    fn is_stopped(&self) -> bool {
        false
    }
    /// Returns the other forms of the same effect at the same place.
    fn variants(&self, _candidate: usize) -> Vec<usize> {
        Vec::new()
    }
}

/// Breadth of the search.
#[derive(Clone, Copy, Debug)]
pub struct Breadth {
    /// Largest number of effects in a set.
    pub largest: usize,
    /// Number of sets that are kept from level to level.
    pub beam: usize,
    /// Number of additions to each set that are fitted exactly.
    pub tries: usize,
    /// Log evidence by which a set must exceed the same set without one of its effects.
    pub decisive: f64,
}

/// Searches the sets of effects and returns every scored set, best first. The empty set is always included.
pub fn search<S: Scorer>(scorer: &mut S, breadth: Breadth) -> Vec<ScoredSet<S::Fit>> {
    let mut seen: ScoreCache<S::Fit> = BTreeMap::new();
    let Some(null) = scorer.score(&[], None) else {
        return Vec::new();
    };
    seen.insert(Vec::new(), Some(null.clone()));
    let mut level = vec![null];
    for _ in 0..breadth.largest {
        let mut next = Vec::new();
        for base in &level {
            next.extend(extend(scorer, base, breadth, &mut seen));
        }
        next.sort_by(|a, b| b.log_evidence.total_cmp(&a.log_evidence));
        next.dedup_by(|a, b| a.set == b.set);
        next.truncate(breadth.beam);
        // If no addition raises the log evidence decisively, the search ends, since larger sets are not expected to raise it either.
        let best_before = level
            .iter()
            .map(|s| s.log_evidence)
            .fold(f64::NEG_INFINITY, f64::max);
        let pays = next
            .first()
            .is_some_and(|s| s.log_evidence > best_before + breadth.decisive);
        level = next;
        if !pays {
            break;
        }
    }
    exchange(scorer, breadth, &mut seen);
    best_first(seen)
}

/// Searches from known good sets: scores them, extends the best one and exchanges its members.
pub fn search_near<S: Scorer>(
    scorer: &mut S,
    breadth: Breadth,
    known: &[ScoredSet<S::Fit>],
) -> Vec<ScoredSet<S::Fit>> {
    let mut seen: ScoreCache<S::Fit> = BTreeMap::new();
    seen.insert(Vec::new(), scorer.score(&[], None));
    for old in known {
        if scorer.is_stopped() {
            break;
        }
        seen.entry(old.set.clone())
            .or_insert_with(|| scorer.score(&old.set, Some((old, None))));
    }
    let all: Vec<_> = seen.values().flatten().cloned().collect();
    if let Some(best) = settle(&all, breadth.decisive)
        && best.set.len() < breadth.largest
    {
        extend(scorer, &best, breadth, &mut seen);
    }
    exchange(scorer, breadth, &mut seen);
    best_first(seen)
}

fn best_first<F>(seen: ScoreCache<F>) -> Vec<ScoredSet<F>> {
    let mut all: Vec<_> = seen.into_values().flatten().collect();
    all.sort_by(|a, b| b.log_evidence.total_cmp(&a.log_evidence));
    all
}

/// Returns the set with the largest log evidence after a cost of `decisive` for each member.
pub fn settle<F: Clone>(all: &[ScoredSet<F>], decisive: f64) -> Option<ScoredSet<F>> {
    let penalised = |s: &ScoredSet<F>| s.log_evidence - decisive * s.set.len() as f64;
    all.iter()
        .max_by(|a, b| penalised(a).total_cmp(&penalised(b)))
        .cloned()
}

type ScoreCache<F> = BTreeMap<Vec<usize>, Option<ScoredSet<F>>>;

fn extend<S: Scorer>(
    scorer: &mut S,
    base: &ScoredSet<S::Fit>,
    breadth: Breadth,
    seen: &mut ScoreCache<S::Fit>,
) -> Vec<ScoredSet<S::Fit>> {
    /// Largest number of candidates tried with one kin number, such as candidates at the same gauge.
    const PER_KIN: usize = 3;
    /// Approximate gain below which a gain has never become decisive. Fewer candidates are then tried.
    const HOPELESS: f64 = -3.0;
    let mut out = Vec::new();
    if scorer.is_stopped() {
        return out;
    }
    let mut kin_count: BTreeMap<usize, usize> = BTreeMap::new();
    for addition in scorer.screen(base) {
        let candidate = addition.candidate;
        // Two candidates are always tried, as alternative explanations and hints. More are tried only if their gain may justify them.
        let enough = if addition.gain < HOPELESS {
            2
        } else {
            breadth.tries
        };
        if out.len() >= enough || scorer.is_stopped() {
            break;
        }
        if base.set.contains(&candidate)
            || base
                .set
                .iter()
                .any(|&m| !scorer.is_compatible_pair(m, candidate))
        {
            continue;
        }
        let count = kin_count.entry(scorer.kin(candidate)).or_insert(0);
        if *count >= PER_KIN {
            continue;
        }
        *count += 1;
        let mut set = base.set.clone();
        set.push(candidate);
        set.sort_unstable();
        let scored = seen
            .entry(set.clone())
            .or_insert_with(|| scorer.score(&set, Some((base, Some(&addition)))))
            .clone();
        out.extend(scored);
    }
    out
}

/// Replaces each member of the best set by the candidates that best explain its absence, and by its other forms. Ends if no replacement improves the
/// set.
fn exchange<S: Scorer>(scorer: &mut S, breadth: Breadth, seen: &mut ScoreCache<S::Fit>) {
    /// Largest number of rounds. Each round strictly improves the set, and two are usual.
    const ROUNDS: usize = 4;
    for _ in 0..ROUNDS {
        let all: Vec<_> = seen.values().flatten().cloned().collect();
        let Some(best) = settle(&all, breadth.decisive) else {
            return;
        };
        if best.set.is_empty() {
            return;
        }
        for skip in 0..best.set.len() {
            if scorer.is_stopped() {
                return;
            }
            let mut reduced = best.set.clone();
            reduced.remove(skip);
            let scored = seen
                .entry(reduced.clone())
                .or_insert_with(|| scorer.score(&reduced, Some((&best, None))))
                .clone();
            if let Some(base) = scored {
                extend(scorer, &base, breadth, seen);
                for other in best
                    .set
                    .get(skip)
                    .map(|m| scorer.variants(*m))
                    .unwrap_or_default()
                {
                    if scorer.is_stopped() {
                        return;
                    }
                    let mut set = base.set.clone();
                    set.push(other);
                    set.sort_unstable();
                    seen.entry(set.clone())
                        .or_insert_with(|| scorer.score(&set, None));
                }
            }
        }
        let all: Vec<_> = seen.values().flatten().cloned().collect();
        if settle(&all, breadth.decisive).is_none_or(|s| s.set == best.set) {
            return;
        }
    }
}

#[cfg(test)]
mod tests;
