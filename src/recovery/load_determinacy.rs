//! Tests whether the readings determine the loads: interval widths against the loads, and loads against their expected size.

use super::types::RunEstimate;
use crate::finding::{Finding, Severity, list_few};
use crate::sensitivity::Sensitivity;
use crate::units::number;

/// Half width of the interval over the largest load of the kind (or `expected`) from which a load counts as unknown.
const WIDE: f64 = 0.5;
/// Ratio of the planned standard deviation to the expected load above which noise or loads are probably in another unit.
const HOPELESS: f64 = 10.0;
/// Ratio to `expected` (1 sd) above which a size or a unit is wrong.
const FAR_BEYOND: f64 = 10.0;
/// Ratio to `expected` (1 sd) from which the finding is an error. Units that are confused differ by a factor of 1000, and a stated size is known to
/// better than a tenth of this factor.
const OTHER_UNIT: f64 = 100.0;

/// Returns findings on loads that the gauges don't determine, and on loads much larger than expected.
pub fn check(s: &Sensitivity, runs: &[RunEstimate]) -> Vec<Finding> {
    let values = move |l: usize| {
        runs.iter()
            .filter_map(move |r| r.estimate.values.get(l).copied())
    };
    let loads = s.loads.iter().enumerate();
    let mut out: Vec<Finding> = loads
        .filter_map(|(l, load)| beyond_expected(&load.name, load.expected, values(l)))
        .collect();
    out.extend(far_below_expected(s, runs));
    out.extend(report_undetermined_loads(s, runs));
    out
}

/// Returns the finding on wanted loads that stay far below `expected` in every run. It is an error if all loads do, because a unit is wrong then. It
/// is a warning on single loads if their intervals stay below `expected` too.
fn far_below_expected(s: &Sensitivity, runs: &[RunEstimate]) -> Option<Finding> {
    let mut small: Vec<(&str, f64)> = Vec::new();
    let mut stated = 0;
    let mut all_known = true;
    for (l, load) in s.loads.iter().enumerate().filter(|(_, l)| l.wanted) {
        let Some(expected) = load.expected.filter(|e| *e > 0.0) else {
            continue;
        };
        stated += 1;
        let values = runs.iter().filter_map(|r| r.estimate.values.get(l));
        let size = values.fold(f64::NAN, |a, v| a.max(v.abs())) / expected;
        let ends = runs.iter().flat_map(|r| r.estimate.interval(l));
        let known = ends.fold(0.0_f64, |a, v| a.max(v.abs())) < expected / FAR_BEYOND;
        if size < 1.0 / OTHER_UNIT {
            small.push((&load.name, size));
            all_known &= known;
        }
    }
    let all = stated > 1 && small.len() == stated;
    let largest = small.iter().map(|s| s.1).max_by(f64::total_cmp)?;
    if !all && !all_known {
        return None;
    }
    let (severity, subject) = match all {
        true => (Severity::Error, "all".to_owned()),
        false => {
            let names: Vec<&str> = small.iter().map(|s| s.0).collect();
            (Severity::Warning, list_few(&names))
        }
    };
    let whose = if all {
        "all loads stay"
    } else {
        "these loads stay"
    };
    Some(
        Finding::new(
            severity,
            "load-far-below-expected",
            subject,
            format!(
                "{whose} below {} % of their `expected` size in every run",
                number(100.0 * largest)
            ),
            "check the unit of the strain file (the default is microstrain; mm/m is 1000 times as large), `applied`, `expected`, and \
             whether these loads acted",
        )
        .with_numbers(largest, 1.0 / OTHER_UNIT),
    )
}

/// Returns the finding on wanted loads that the gauges do not determine. For these loads the half width of the interval exceeds half of the largest
/// load in every run.
fn report_undetermined_loads(s: &Sensitivity, runs: &[RunEstimate]) -> Option<Finding> {
    let mut out: Vec<(&str, f64)> = Vec::new();
    for (l, load) in s.loads.iter().enumerate().filter(|(_, l)| l.wanted) {
        let widths = runs.iter().map(|r| {
            let alike = s.loads.iter().enumerate();
            let largest = alike
                .filter(|(_, m)| m.wanted && m.quantity == load.quantity)
                .filter_map(|(m, _)| r.estimate.values.get(m).map(|v| v.abs()))
                .fold(load.expected.unwrap_or(0.0), f64::max);
            let [low, high] = r.estimate.interval(l);
            (high - low) / 2.0 / largest
        });
        let best = widths.filter(|w| !w.is_nan()).fold(f64::INFINITY, f64::min);
        if best > WIDE && best.is_finite() {
            out.push((&load.name, best));
        }
    }
    let worst = out.iter().map(|o| o.1).max_by(f64::total_cmp)?;
    let names: Vec<&str> = out.iter().map(|o| o.0).collect();
    Some(
        Finding::new(
            Severity::Error,
            "loads-not-determined",
            list_few(&names),
            format!(
                "the gauges do not determine these loads: the 95 % interval exceeds half of the largest load in every run (condition \
                 number {:.0}). The values are mostly noise and model error",
                s.condition_number_scaled()
            ),
            "add gauges at places where these loads differ (`place`), or drop loads",
        )
        .with_numbers(worst, WIDE),
    )
}

/// Returns the finding on loads that planned gauges don't determine. It compares `sigma`, by load in the unit of S, with the largest `expected` load
/// of the kind. Both are one standard deviation: runs will have loads of twice `expected`, and intervals of twice `sigma`. A kind without a stated
/// size is not tested. The finding is an error from `HOPELESS` on, because a guessed size is not too small by such a factor.
pub fn check_planned(s: &Sensitivity, sigma: &[f64]) -> Option<Finding> {
    let mut out: Vec<(&str, f64)> = Vec::new();
    for (load, sigma) in s.loads.iter().zip(sigma).filter(|(l, _)| l.wanted) {
        let alike = s
            .loads
            .iter()
            .filter(|m| m.wanted && m.quantity == load.quantity);
        let largest = alike.filter_map(|m| m.expected).fold(0.0, f64::max);
        let width = sigma / largest;
        if largest > 0.0 && width > WIDE {
            out.push((&load.name, width));
        }
    }
    let worst = out.iter().map(|o| o.1).max_by(f64::total_cmp)?;
    let severity = match worst {
        w if w > HOPELESS => Severity::Error,
        _ => Severity::Warning,
    };
    let names: Vec<&str> = out.iter().map(|o| o.0).collect();
    Some(
        Finding::new(
            severity,
            "loads-not-determined",
            list_few(&names),
            "the gauges do not determine these loads: the planned standard deviation exceeds half of the largest `expected` load",
            "place more gauges, state the actual noise of the gauges, or drop loads",
        )
        .with_numbers(worst, WIDE),
    )
}

/// Returns the finding on a load many times larger than `expected` in some state.
pub fn beyond_expected(
    load: &str,
    expected: Option<f64>,
    values: impl Iterator<Item = f64>,
) -> Option<Finding> {
    let expected = expected.filter(|e| *e > 0.0)?;
    let ratio = values.map(f64::abs).fold(0.0, f64::max) / expected;
    let severity = match ratio {
        r if r > OTHER_UNIT => Severity::Error,
        r if r > FAR_BEYOND => Severity::Warning,
        _ => return None,
    };
    let times = number(ratio);
    Some(
        Finding::new(
            severity,
            "load-beyond-expected",
            load,
            format!("load `{load}` is up to {times} times its `expected` size"),
            "check `applied`, the units of the strain file or of the table of loads, and `expected`",
        )
        .with_numbers(ratio, FAR_BEYOND),
    )
}
