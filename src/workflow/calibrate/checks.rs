//! Check runs compared with the loads that were applied.

use super::outcome::CheckLoad;
use crate::calibrate::CheckedRun;
use crate::estimate::{NORMAL_95, TOO_FEW, chance_of_so_few};
use crate::finding::{Finding, Severity, list_few};
use crate::units::number;
use crate::workflow::recover::ListedLoads;

/// Probability of so few correct check loads within their intervals, up to which they are reported.
const SELDOM: f64 = 0.05;
/// Half widths by which a check load exceeds any chance deviation: four standard deviations.
const FAR: f64 = 2.0;

/// Returns the loads of the check runs, and combinations, report units. The interval of the comparison includes the error of the applied load.
pub(super) fn compare_check_loads(checked: &[CheckedRun], listed: &ListedLoads) -> Vec<CheckLoad> {
    let of_run = |c: &CheckedRun| -> Vec<CheckLoad> {
        let k = c.run.loads.mean.len();
        let mut estimate = c.estimate.clone();
        estimate.add_sums(&listed.names[k..], &listed.sums);
        let own = (0..k).map(|l| vec![(l, 1.0)]);
        let rows = own.chain(listed.sums.iter().cloned()).enumerate();
        let one = |(i, terms): (usize, Vec<(usize, f64)>)| {
            let unit = &listed.units[i];
            let applied: f64 = terms.iter().map(|(l, f)| f * c.run.loads.mean[*l]).sum();
            let pairs = terms.iter().flat_map(|a| terms.iter().map(move |b| (a, b)));
            let variance: f64 = pairs
                .map(|((l, a), (m, b))| a * b * c.run.loads.covariance[l * k + m])
                .sum();
            let half = (estimate.coverage_factor * estimate.sigma(i))
                .hypot(NORMAL_95 * variance.max(0.0).sqrt());
            let recovered = estimate.values[i];
            CheckLoad {
                run: c.run.run.clone(),
                load: listed.names[i].clone(),
                applied: applied * unit.factor,
                recovered: recovered * unit.factor,
                low: (recovered - half) * unit.factor,
                high: (recovered + half) * unit.factor,
                unit: unit.name.clone(),
                inside: (recovered - applied).abs() <= half,
            }
        };
        rows.map(one).collect()
    };
    checked.iter().flat_map(of_run).collect()
}

/// Returns the finding on check loads outside their intervals. `None` if no more loads are outside than expected for 95 % intervals.
pub(super) fn finding(checks: &[CheckLoad], loads: &[String]) -> Option<Finding> {
    let outside: Vec<&CheckLoad> = checks.iter().filter(|c| !c.inside).collect();
    let deviation = |c: &&CheckLoad| (c.recovered - c.applied).abs() / (0.5 * (c.high - c.low));
    let worst = outside
        .iter()
        .max_by(|a, b| deviation(a).total_cmp(&deviation(b)))?;
    // The error of a combination follows from its loads, so combinations are not counted.
    let alone = || checks.iter().filter(|c| loads.contains(&c.load));
    let (inside, of) = (alone().filter(|c| c.inside).count(), alone().count());
    let chance = chance_of_so_few(inside, of);
    let most = deviation(worst);
    let severity = match chance {
        _ if most > FAR => Severity::Error,
        c if c < TOO_FEW => Severity::Error,
        c if c <= SELDOM => Severity::Warning,
        _ => return None,
    };
    let names: Vec<String> = outside
        .iter()
        .map(|c| format!("{} in {}", c.load, c.run))
        .collect();
    Some(
        Finding::new(
            severity,
            "check-loads-outside",
            list_few(&names),
            format!(
                "{inside} of {of} check loads are within their 95 % intervals. The largest deviation has `{}` in run `{}`: {} {} \
                 applied, {} ± {} recovered",
                worst.load,
                worst.run,
                number(worst.applied),
                worst.unit,
                number(worst.recovered),
                number(0.5 * (worst.high - worst.low))
            ),
            "check load, place and zero of these runs; if they are right, calibrate with similar runs",
        )
        .with_numbers(most, 1.0),
    )
}
