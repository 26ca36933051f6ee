//! Loads that exceed the loads of the calibration. A straight line through the applied loads is not valid beyond them.

use crate::estimate::NORMAL_95;
use crate::finding::{Finding, Severity, list_few};
use crate::units::number;
use statrs::distribution::{ContinuousCDF, Normal};

/// Code of loads beyond the range of the calibration.
pub const CODE: &str = "loads-outside-calibration";

/// Limits of the test of loads against the range of their calibration.
#[derive(Clone, Copy, Debug)]
pub struct RangeRules {
    /// Size of a load over the largest calibration load from which the finding is an error. For gauges with 5 % non-linearity at full load, the error
    /// at this size is as large as the interval. In a test, 16 of 600 intervals contained the load at 1.3 to 2.5 times the calibration load.
    pub error_from: f64,
    /// Share of the largest load by which a load may exceed the range: loads that are applied again are not repeated to better than this.
    pub margin: f64,
    /// Chance, over all values together, that the noise of a load at the end of the range exceeds the range.
    pub chance: f64,
    /// Ratio of the strain to the largest strain of the calibration, from which readings are reported although each load is within its range.
    pub strain_from: f64,
}

impl Default for RangeRules {
    fn default() -> Self {
        Self {
            error_from: 1.5,
            margin: 0.02,
            chance: 1e-3,
            strain_from: 1.5,
        }
    }
}

/// A load with its range in the calibration.
#[derive(Clone, Debug)]
pub struct CalibratedLoad<'a> {
    /// Name.
    pub name: &'a str,
    /// Smallest and largest known load, job units.
    pub range: [f64; 2],
    /// Size of one job unit in report units, with the name of the report unit.
    pub unit: (f64, &'a str),
}

/// A recovered load.
#[derive(Clone, Copy, Debug)]
pub struct RunLoad<'a> {
    /// Run.
    pub run: &'a str,
    /// Estimate, job units.
    pub value: f64,
    /// Half width of the 95 % interval.
    pub half: f64,
}

impl CalibratedLoad<'_> {
    /// Range with the state without load in it, and the largest size in it.
    fn span_with_zero(&self) -> ([f64; 2], f64) {
        let [low, high] = [self.range[0].min(0.0), self.range[1].max(0.0)];
        ([low, high], high.max(-low))
    }

    /// Size over the largest of the calibration, whichever the direction.
    fn ratio(&self, value: f64) -> f64 {
        value.abs() / self.span_with_zero().1
    }

    /// Returns whether a load is beyond the range by more than its noise, `factor` half widths.
    fn is_beyond(&self, reached: &RunLoad, factor: f64, rules: &RangeRules) -> bool {
        let ([low, high], largest) = self.span_with_zero();
        let beyond = (reached.value - high).max(low - reached.value);
        beyond > factor * reached.half + rules.margin * largest
    }
}

/// Returns the finding on a load that exceeds the range of the calibration in some of `runs`. `values` is the number of tested values of all loads.
/// If noise in so many values can explain the excess, the load counts as within the range.
pub fn check_load(
    load: &CalibratedLoad,
    runs: &[RunLoad],
    values: usize,
    rules: &RangeRules,
) -> Option<Finding> {
    if !(load.span_with_zero().1 > 0.0) {
        return None;
    }
    let share = rules.chance / values.max(1) as f64;
    let quantile = Normal::standard().inverse_cdf(1.0 - share);
    let factor = quantile / NORMAL_95;
    let beyond = runs.iter().filter(|r| load.is_beyond(r, factor, rules));
    let mut beyond: Vec<(f64, &RunLoad)> = beyond.map(|r| (load.ratio(r.value), r)).collect();
    beyond.sort_by(|a, b| b.0.total_cmp(&a.0));
    let (ratio, farthest) = *beyond.first()?;
    let severity = match ratio {
        r if r >= rules.error_from => Severity::Error,
        _ => Severity::Warning,
    };
    let (factor, unit) = load.unit;
    let shown = |v: f64| number(v * factor);
    let names: Vec<String> = beyond.iter().map(|b| format!("`{}`", b.1.run)).collect();
    let message = format!(
        "load `{}` reaches {} {unit} in `{}`, {} times the largest load of the calibration ({} to {} {unit}). Runs beyond the range: {}. \
         The calibration does not confirm proportional strain up to this load, and the interval does not include the error",
        load.name,
        shown(farthest.value),
        farthest.run,
        number(ratio),
        shown(load.range[0]),
        shown(load.range[1]),
        list_few(&names)
    );
    Some(
        Finding::new(
            severity,
            CODE,
            load.name,
            message,
            "calibrate with known loads of this size, or use only the loads within the range",
        )
        .with_numbers(
            ratio,
            if severity == Severity::Error {
                rules.error_from
            } else {
                1.0
            },
        ),
    )
}

/// Returns the finding on readings far beyond the calibration readings. `readings` contains the name, the range in the calibration and the largest
/// reading of each gauge, in strain.
pub fn check_strain<'a>(
    readings: impl Iterator<Item = (&'a str, [f64; 2], f64)>,
    rules: &RangeRules,
) -> Option<Finding> {
    let ratio = |(name, [low, high], largest): (&'a str, [f64; 2], f64)| {
        (name, largest.abs() / high.max(-low))
    };
    let far = |r: &(&str, f64)| r.1.is_finite() && r.1 >= rules.strain_from;
    let mut beyond: Vec<(&str, f64)> = readings.map(ratio).filter(far).collect();
    beyond.sort_by(|a, b| b.1.total_cmp(&a.1));
    let (gauge, most) = *beyond.first()?;
    let names: Vec<&str> = beyond.iter().map(|b| b.0).collect();
    Some(
        Finding::new(
            Severity::Info,
            CODE,
            list_few(&names),
            format!(
                "gauge `{gauge}` reads up to {} times its largest strain of the calibration, because several loads act together. The \
                 calibration did not test the sum of their strains",
                number(most)
            ),
            "calibrate with a run in which the loads act together",
        )
        .with_numbers(most, rules.strain_from),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn load(range: [f64; 2]) -> CalibratedLoad<'static> {
        CalibratedLoad {
            name: "LF.FZ",
            range,
            unit: (1e-3, "kN"),
        }
    }

    fn check(range: [f64; 2], values: &[(f64, f64)]) -> Option<(Severity, f64, String)> {
        let names: Vec<String> = (0..values.len()).map(|i| format!("R{i}")).collect();
        let runs = values.iter().zip(&names);
        let runs: Vec<RunLoad> = runs
            .map(|(&(value, half), run)| RunLoad { run, value, half })
            .collect();
        let found = check_load(&load(range), &runs, runs.len(), &RangeRules::default())?;
        Some((found.severity, found.measured?, found.message))
    }

    #[test]
    fn loads_beyond_the_range_are_a_warning_and_an_error_from_half_as_much_again_on() {
        // Zero is in the range although no run has zero load, because the gauges read zero there.
        assert!(check([4e3, 12e3], &[(1e3, 10.0), (12.1e3, 10.0)]).is_none());
        let (severity, ratio, message) = check([4e3, 12e3], &[(11e3, 10.0), (15e3, 10.0)]).unwrap();
        assert_eq!((severity, ratio), (Severity::Warning, 1.25));
        assert!(
            message.contains("reaches 15.00 kN in `R1`") && message.contains("4.000 to 12.00 kN"),
            "{message}"
        );
        assert_eq!(
            check([4e3, 12e3], &[(18e3, 10.0)]).unwrap().0,
            Severity::Error
        );
        // A load of opposite sign is a warning up to the size of the largest calibration load.
        assert_eq!(
            check([0.0, 12e3], &[(-6e3, 10.0)]).unwrap().0,
            Severity::Warning
        );
        assert_eq!(
            check([0.0, 12e3], &[(-18e3, 10.0)]).unwrap().0,
            Severity::Error
        );
        assert_eq!(
            check([-12e3, 12e3], &[(-13e3, 10.0)]).unwrap().0,
            Severity::Warning
        );
        let many: Vec<(f64, f64)> = (0..20)
            .map(|i| (13e3 + 10.0 * f64::from(i), 10.0))
            .collect();
        assert!(check([0.0, 12e3], &many).unwrap().2.contains(" more"));
    }

    #[test]
    fn noise_at_the_end_of_the_range_is_no_load_beyond_it() {
        // The margin is 0.02 of 12 kN, and 0.5 kN is 1.96 sd. One value is reported beyond 3.1 sd, ten thousand values beyond 5.2 sd.
        assert!(check([0.0, 12e3], &[(12.9e3, 500.0)]).is_none());
        assert!(check([0.0, 12e3], &[(13.1e3, 500.0)]).is_some());
        let run = [RunLoad {
            run: "record",
            value: 13.1e3,
            half: 500.0,
        }];
        assert!(check_load(&load([0.0, 12e3]), &run, 10_000, &RangeRules::default()).is_none());
    }
}
