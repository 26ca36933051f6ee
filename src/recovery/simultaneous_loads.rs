//! Runs with several loads at once, if each calibration run had one load alone.
//!
//! A single load may differ in strain from the calibration, for example a truck between two lanes or with another direction or speed. It is then
//! recovered as a combination of several loads. Each has the narrow interval that the scatter of the calibration runs gives. The strain is the same,
//! so the residual does not show the difference.

use super::types::RunEstimate;
use super::uncalibrated_strain::chance_estimated;
use super::verdict::SIGNIFICANT;
use crate::finding::{Finding, Severity};
use crate::linalg::spd;
use crate::sensitivity::Uncertainty;

/// Code of runs with several loads that act together in no calibration run.
pub const CODE: &str = "loads-unlike-known-runs";

/// Number of runs with several loads that shows normal use, if most runs have several loads. Of runs with a single load, one in a hundred appears to
/// have several loads.
const USUAL: usize = 3;

/// Returns the squared distance of the loads `f` of a run from the nearest single load, relative to their covariance `C`. With `G = C^-1` the
/// distance from load `l` alone is `f' G f - (G f)_l^2 / G_ll`. `None` if the covariance is not positive definite.
fn distance(run: &RunEstimate) -> Option<f64> {
    let f = &run.estimate.values;
    let k = f.len();
    let covariance = &run.estimate.covariance;
    let sd: Vec<f64> = (0..k).map(|l| covariance[l * k + l].sqrt()).collect();
    let even = covariance.iter().enumerate();
    let even: Vec<f64> = even.map(|(i, c)| c / (sd[i / k] * sd[i % k])).collect();
    let information = spd::gram_of_lower(&spd::inverse_lower(&spd::cholesky(&even, k)?, k), k);
    let z: Vec<f64> = f.iter().zip(&sd).map(|(f, s)| f / s).collect();
    let mut weighed = vec![0.0; k];
    spd::times(&information, &z, &mut weighed);
    let alone = (0..k).map(|l| weighed[l] * weighed[l] / information[l * k + l]);
    Some((spd::dot(&z, &weighed) - alone.fold(0.0, f64::max)).max(0.0))
}

/// A single load, of the size that comes nearest to the strain of all loads `f` of a run.
struct SingleLoad {
    load: usize,
    /// Share of this load in the mean square strain: the larger, the nearer.
    part: f64,
    /// Loads `f` minus this single load.
    apart: Vec<f64>,
}

/// Returns each single load, the nearest first: with `M = S' S / n` load `l` is `(M f)_l / M_ll`, its part `(M f)_l^2 / M_ll`.
fn each_alone(f: &[f64], known: &Uncertainty) -> Vec<SingleLoad> {
    let k = f.len();
    let mut strain = vec![0.0; k];
    spd::times(&known.mean_square, f, &mut strain);
    let one = |load: usize| {
        let own = known.mean_square[load * k + load];
        let mut apart = f.to_vec();
        apart[load] -= strain[load] / own;
        SingleLoad {
            load,
            part: strain[load] * strain[load] / own,
            apart,
        }
    };
    let mut out: Vec<SingleLoad> = (0..k).map(one).collect();
    out.sort_by(|a, b| b.part.total_cmp(&a.part));
    out
}

/// Finds runs whose loads differ from every single load by more than scatter (Hotelling's T-squared), if no calibration run had several loads. The
/// covariance of these runs is widened so that each of the two nearest single loads is one sigma away. It is not widened if most runs, and at least
/// [`USUAL`], have several loads.
///
/// # Reference
/// H. Hotelling, Ann. Math. Stat. 2 (1931) 360.
pub(super) fn check(runs: &mut [RunEstimate], known: &Uncertainty) -> Vec<Finding> {
    if !known.one_by_one {
        return Vec::new();
    }
    let several = |run: &RunEstimate| {
        let free = run.estimate.values.len().saturating_sub(1);
        let found = distance(run).filter(|_| run.rank == free + 1 && free > 0)?;
        (chance_estimated(found, free, known.dof) < SIGNIFICANT).then_some(found)
    };
    let found: Vec<(usize, f64)> = runs
        .iter()
        .enumerate()
        .filter_map(|(i, run)| Some((i, several(run)?)))
        .collect();
    if found.len() >= USUAL && 2 * found.len() > runs.len() {
        return vec![Finding::new(
            Severity::Info,
            CODE,
            "runs",
            format!(
                "{} of {} runs have several loads at once, and each calibration run has one load. The calibration did not \
                 test the sum of the strains of several loads",
                found.len(),
                runs.len()
            ),
            "calibrate with a run in which several known loads act at once",
        )];
    }
    found
        .into_iter()
        .map(|(i, distance)| widen(&mut runs[i], distance, known))
        .collect()
}

/// Adds `apart apart'` of the two nearest single loads to the covariance, and returns the finding.
fn widen(run: &mut RunEstimate, distance: f64, known: &Uncertainty) -> Finding {
    let nearest = each_alone(&run.estimate.values, known);
    let between = &nearest[..nearest.len().min(2)];
    for alone in between {
        spd::add_outer(&mut run.estimate.covariance, &alone.apart, 1.0);
    }
    let sigmas = (distance / (nearest.len() - 1) as f64).sqrt();
    let name = &run.estimate.run;
    let alone: Vec<String> = (between.iter())
        .map(|a| format!("`{}`", run.estimate.names[a.load]))
        .collect();
    let alone = alone.join(" or ");
    Finding::new(
        Severity::Warning,
        CODE,
        name,
        format!(
            "run `{name}` has several loads at once, and each calibration run had a single load. The nearest single load deviates \
             {sigmas:.1} times more than the scatter explains. Either several loads act, or one load acts at another place, direction or \
             speed than in the calibration. The intervals include both cases, also {alone} as the single load"
        ),
        "find out which case applies, and add such calibration runs: one load as it acted here, or several known loads at once",
    )
    .with_numbers(sigmas, 1.0)
}
