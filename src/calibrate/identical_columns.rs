//! Columns of the calibration runs that are the same to the last digit.

use super::types::Task;
use crate::finding::{Finding, Severity, list_few};
use crate::input_faults::identical_columns::{identical_pairs, identical_readings};

/// Least number of different values in two equal columns of loads. Two are enough: the truck is present or absent.
const DIFFERENT_LOADS: usize = 2;

/// Returns findings on gauges with identical readings in all runs, and on loads with identical values in all runs.
pub(super) fn findings(task: &Task) -> Vec<Finding> {
    let of_gauge = |g: usize| task.runs.iter().map(|r| r.strain[g]).collect();
    let readings: Vec<Vec<f64>> = (0..task.gauges.len()).map(of_gauge).collect();
    let mut out: Vec<Finding> = identical_readings(&task.gauges, &readings)
        .into_iter()
        .collect();
    let k = task.loads.len();
    let known = |l: usize| -> Vec<f64> {
        let runs = task.runs.iter();
        // A load with uncertainty equals no other load (NaN).
        runs.map(|r| match r.loads.covariance[l * k + l] == 0.0 {
            true => r.loads.mean[l],
            false => f64::NAN,
        })
        .collect()
    };
    let loads: Vec<Vec<f64>> = (0..task.own_loads()).map(known).collect();
    let pairs = identical_pairs(&loads, DIFFERENT_LOADS);
    let names: Vec<String> = pairs
        .iter()
        .map(|[a, b]| format!("{} and {}", task.loads[*a].name, task.loads[*b].name))
        .collect();
    if !names.is_empty() {
        out.push(
            Finding::new(
                Severity::Warning,
                "columns-identical",
                list_few(&names),
                "these loads are the same in all calibration runs, to the last digit: the runs determine their sum alone",
                "check whether one column is a copy; add runs in which these loads differ",
            )
            .with_numbers(names.len() as f64, 0.0),
        );
    }
    out
}
