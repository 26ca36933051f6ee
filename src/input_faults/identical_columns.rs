//! Columns of a table that are the same to the last digit: one is a copy.

use crate::finding::{Finding, Severity, list_few};
use std::collections::HashMap;

/// Least number of different readings in two equal columns. Fewer may be equal by chance if numbers are rounded.
const DIFFERENT_READINGS: usize = 3;

/// Returns pairs of columns with the same numbers in all rows. Each pair contains the first of the equal columns. Columns with fewer than
/// `different_at_least` different values are left out.
pub fn identical_pairs(columns: &[Vec<f64>], different_at_least: usize) -> Vec<[usize; 2]> {
    let mut first: HashMap<Vec<u64>, usize> = HashMap::new();
    let mut out = Vec::new();
    for (i, column) in columns.iter().enumerate() {
        let mut different: Vec<u64> = (column.iter())
            .filter(|v| v.is_finite())
            .map(|v| v.to_bits())
            .collect();
        different.sort_unstable();
        different.dedup();
        if different.len() < different_at_least {
            continue;
        }
        // All missing values count as equal.
        let bits = column
            .iter()
            .map(|v| if v.is_finite() { v.to_bits() } else { u64::MAX });
        let kept = *first.entry(bits.collect()).or_insert(i);
        if kept != i {
            out.push([kept, i]);
        }
    }
    out
}

/// Returns the finding on gauges with the same readings in all rows. `readings` has a column for each gauge.
pub fn identical_readings(gauges: &[String], columns: &[Vec<f64>]) -> Option<Finding> {
    let pairs = identical_pairs(columns, DIFFERENT_READINGS);
    let names: Vec<String> = (pairs.iter())
        .map(|[a, b]| format!("{} and {}", gauges[*a], gauges[*b]))
        .collect();
    let (copy, count) = (pairs.first()?[1], names.len());
    Some(
        Finding::new(
            Severity::Warning,
            "columns-identical",
            list_few(&names),
            "these gauges have the same readings in every row, to the last digit. Two sound gauges never agree to this precision. One column is a copy, and \
             its reading counts twice",
            format!(
                "check the channels in the logger\'s files. To exclude a copy: [[correction]] gauge = \"{}\", ignore = true",
                gauges[copy]
            ),
        )
        .with_numbers(count as f64, 0.0),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_copy_of_a_column_is_found_and_rounded_or_constant_columns_are_not() {
        let column = |values: [f64; 4]| values.to_vec();
        let columns = [
            column([1.25, -3.5, 7.0, f64::NAN]),
            column([1.25, -3.5, 7.1, f64::NAN]),
            column([0.0; 4]),
            column([1.25, -3.5, 7.0, f64::NAN]),
            column([0.0; 4]),
            column([1.0, 1.0, 2.0, 2.0]),
            column([1.0, 1.0, 2.0, 2.0]),
        ];
        assert_eq!(identical_pairs(&columns, DIFFERENT_READINGS), [[0, 3]]);
        let names: Vec<String> = (0..7).map(|i| format!("G{i}")).collect();
        let finding = identical_readings(&names, &columns).unwrap();
        assert_eq!(
            (finding.code, &*finding.subject),
            ("columns-identical", "G0 and G3")
        );
        assert!(identical_readings(&names[1..3], &columns[1..3]).is_none());
    }
}
