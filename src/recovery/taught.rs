//! Runs whose loads are of no kind that the calibration was taught: several at once, where each known run had one load alone.
//!
//! One load whose strain is not as taught (a truck between two lanes, another direction or speed) comes out as a combination of several, each with
//! the narrow interval that the scatter of the known runs gives: their strain is the same, so that the residual says nothing.

use super::types::RunEstimate;
use super::unlike::chance_estimated;
use crate::finding::{Finding, Severity};
use crate::linalg::spd;
use crate::sensitivity::Uncertainty;

/// Code of runs whose loads act together as none were taught.
pub const CODE: &str = "loads-unlike-known-runs";

/// Chance under which several loads count as more than what scatter makes of one.
const SIGNIFICANT: f64 = 1e-3;
/// So many runs with several loads, when most have them, are how the loads are used: of runs with one load one in a hundred looks so.
const USUAL: usize = 3;

/// The load alone that is nearest to what a run tells.
struct Nearest {
    load: usize,
    /// Told loads less that load alone.
    apart: Vec<f64>,
    /// `apart' C^-1 apart`, `C` the covariance of the loads.
    distance: f64,
}

/// Of loads `f` with covariance `C` and `G = C^-1`, load `l` alone is nearest at `(G f)_l / G_ll`, at the squared distance
/// `f' G f - (G f)_l^2 / G_ll`.
fn nearest(run: &RunEstimate) -> Option<Nearest> {
    let f = &run.estimate.values;
    let k = f.len();
    let sd: Vec<f64> = (0..k)
        .map(|l| run.estimate.covariance[l * k + l].sqrt())
        .collect();
    let covariance = run.estimate.covariance.iter().enumerate();
    let even: Vec<f64> = covariance
        .map(|(i, c)| c / (sd[i / k] * sd[i % k]))
        .collect();
    let information = spd::gram_of_lower(&spd::inverse_lower(&spd::cholesky(&even, k)?, k), k);
    let z: Vec<f64> = f.iter().zip(&sd).map(|(f, s)| f / s).collect();
    let mut weighed = vec![0.0; k];
    spd::times(&information, &z, &mut weighed);
    let told = |l: usize| weighed[l] * weighed[l] / information[l * k + l];
    let load = (0..k).max_by(|a, b| told(*a).total_cmp(&told(*b)))?;
    let alone = sd[load] * weighed[load] / information[load * k + load];
    let mut apart = f.clone();
    apart[load] -= alone;
    Some(Nearest {
        load,
        apart,
        distance: (spd::dot(&z, &weighed) - told(load)).max(0.0),
    })
}

/// Runs that tell several loads at once beyond what scatter makes of one (Hotelling's T-squared), where no known run had several. Their loads are
/// given so much more error that the nearest load alone is one sigma away, unless most of at least [`USUAL`] runs are such.
///
/// # Reference
/// H. Hotelling, Ann. Math. Stat. 2 (1931) 360.
pub(super) fn check(runs: &mut [RunEstimate], known: &Uncertainty) -> Vec<Finding> {
    if !known.one_by_one {
        return Vec::new();
    }
    let several = |run: &RunEstimate| {
        let free = run.estimate.values.len().saturating_sub(1);
        let found = nearest(run).filter(|_| run.rank == free + 1 && free > 0)?;
        (chance_estimated(found.distance, free, known.dof) < SIGNIFICANT).then_some(found)
    };
    let found: Vec<(usize, Nearest)> = runs
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
                "{} of {} runs have several loads at once, the known runs of the calibration one each: that the strain of several is the sum of theirs was not taught",
                found.len(),
                runs.len()
            ),
            "calibrate with a run in which several known loads act at once",
        )];
    }
    found
        .into_iter()
        .map(|(i, nearest)| widen(&mut runs[i], &nearest))
        .collect()
}

/// Adds `apart apart'` to the covariance, and says so.
fn widen(run: &mut RunEstimate, nearest: &Nearest) -> Finding {
    spd::add_outer(&mut run.estimate.covariance, &nearest.apart, 1.0);
    let sigmas = (nearest.distance / (nearest.apart.len() - 1) as f64).sqrt();
    let (name, load) = (&run.estimate.run, &run.estimate.names[nearest.load]);
    Finding::new(
        Severity::Warning,
        CODE,
        name,
        format!(
            "run `{name}` tells several loads at once, where each known run of the calibration had one alone; `{load}` alone is {sigmas:.1} times farther off than \
             scatter makes. Its strain is either of several loads, or of one whose strain is not as taught: between two places, in another direction or at another \
             speed. The intervals of its loads hold both"
        ),
        "look which it was; calibrate with such runs too: one load as it acted here, or several known loads at once",
    )
    .with_numbers(sigmas, 1.0)
}
