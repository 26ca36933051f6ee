//! Number of resampled run sets in which a set of effects wins.

use super::calibration_scatter::expected_precision;
use super::covariance::Selection;
use super::explanation::Explanation;
use super::frame::StrainFrame;
use super::likelihood::Fit;
use super::prediction::predict;
use super::size::RunBlocks;
use crate::linalg::spd::dot;
use crate::reconcile::effect::Candidate;
use crate::reconcile::search::ScoredSet;

/// Number of resampled run sets. It determines a share of wins to five in a hundred.
pub(super) const RESAMPLED_SETS: usize = 100;

/// Returns, by set, the number of 100 resampled run sets in which it has the highest log evidence. Each run set contains as many runs as were fitted,
/// drawn with replacement.
///
/// A win counts for the first set if its densities and the winner's differ by less than odds of twenty to one over all runs. In the log evidence on a
/// resampled run set, the log density of each run counts as often as the run is drawn. Parameters and sizes stay as fitted. Only the full evidence
/// contains the correlation between runs. Runs with an effect of single runs are in every resampled run set, since no other run shows this effect.
pub(super) fn count_resampled_wins(
    frame: &StrainFrame,
    candidates: &[Candidate],
    sets: &[&ScoredSet<Fit>],
) -> Vec<usize> {
    let runs = frame.observations.fit_runs();
    let members = sets.iter().flat_map(|s| &s.set);
    let touched: Vec<usize> = (members.filter_map(|&c| candidates.get(c)))
        .flat_map(|c| c.effect.runs())
        .filter_map(|r| runs.iter().position(|k| *k == r))
        .collect();
    let free: Vec<usize> = (0..runs.len()).filter(|k| !touched.contains(k)).collect();
    let by_run: Vec<Vec<f64>> = sets
        .iter()
        .map(|s| densities(frame, candidates, s, &runs))
        .collect();
    let mut numbers = Numbers(1);
    let alike = |k: usize| {
        let (Some(a), Some(b)) = (by_run.first(), by_run.get(k)) else {
            return false;
        };
        let apart = a.iter().zip(b).map(|(x, y)| (x - y).abs()).sum::<f64>();
        a.len() == b.len() && apart < frame.rules.indistinguishable
    };
    let stands_for: Vec<usize> = (0..sets.len())
        .map(|k| if alike(k) { 0 } else { k })
        .collect();
    let ahead = |counts: &[usize]| {
        let evidence = |(s, by_run): (&&ScoredSet<Fit>, &Vec<f64>)| {
            let drawn: f64 = by_run
                .iter()
                .zip(counts)
                .map(|(d, n)| d * (*n as f64 - 1.0))
                .sum();
            s.log_evidence + drawn
        };
        let all: Vec<f64> = sets.iter().zip(&by_run).map(evidence).collect();
        (0..all.len()).max_by(|a, b| all[*a].total_cmp(&all[*b]))
    };
    let mut won = vec![0; sets.len()];
    for _ in 0..RESAMPLED_SETS {
        let mut counts: Vec<usize> = (0..runs.len())
            .map(|k| usize::from(touched.contains(&k)))
            .collect();
        for _ in 0..free.len() {
            let drawn = free.get(numbers.draw_below(free.len()));
            if let Some(n) = drawn.and_then(|k| counts.get_mut(*k)) {
                *n += 1;
            }
        }
        if let Some(k) = ahead(&counts) {
            won[stands_for[k]] += 1;
        }
    }
    won
}

/// Returns the log density of the readings of each run under the set, without constants. If the covariance was estimated, the precision has the
/// factor that is expected from the residual of all runs.
fn densities(
    frame: &StrainFrame,
    candidates: &[Candidate],
    scored: &ScoredSet<Fit>,
    runs: &[usize],
) -> Vec<f64> {
    let e = Explanation::from_fit(frame, candidates, scored);
    let selection = Selection::of_runs(frame, runs);
    let blocks = RunBlocks::from_selection(frame, &e.members, &selection);
    let predicted = predict(frame, &e.members);
    let n_g = frame.n_gauges();
    let residual =
        |&(r, g): &(usize, usize)| frame.observations.value(r, g) - predicted[r * n_g + g];
    let residual: Vec<f64> = selection.0.iter().map(residual).collect();
    let by_run: Vec<[f64; 2]> = (blocks.precisions(&e.unknown).iter())
        .map(|run| {
            let r: Vec<f64> = run.at.iter().map(|&i| residual[i]).collect();
            [dot(&run.precision.apply(&r), &r), run.precision.log_det()]
        })
        .collect();
    let whole = by_run.iter().map(|run| run[0]).sum();
    let precision = expected_precision(frame, whole, selection.len());
    let density = |[chi2, log_det]: [f64; 2]| -0.5 * (precision * chi2 + log_det);
    by_run.into_iter().map(density).collect()
}

/// Linear congruential generator with Knuth's constants. Its numbers repeat from call to call, so results are reproducible.
struct Numbers(u64);

impl Numbers {
    fn draw_below(&mut self, n: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % n.max(1)
    }
}
