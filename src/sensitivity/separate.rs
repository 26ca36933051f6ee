//! Findings on loads that a set of gauges can't separate.

use super::Sensitivity;
use crate::finding::{Finding, Severity};
use crate::linalg::dense::{self, RANK_TOLERANCE};

/// Condition number (scaled) up to which small errors stay small. By the usual rule of thumb, 10 is stable and 50 is the largest acceptable value.
pub const CONDITION_LIMIT: f64 = 50.0;

/// Share of the largest coefficient below which the description of a combination omits a load.
const NAMED_SHARE: f64 = 0.1;

/// Returns findings on loads without strain, and on loads and combinations that these gauges can't separate (`error`) or only weakly (`warning`).
///
/// A combination is a right singular vector of S with scaled columns: a set of loads that together strain the gauges (almost) not at all.
///
/// # Example
/// ```
/// use strainbridge::Severity;
/// use strainbridge::linalg::Matrix;
/// use strainbridge::sensitivity::{Load, Sensitivity, check_separability};
///
/// let s = |values: &[f64]| Sensitivity {
///     gauges: ["G1", "G2", "G3"].map(str::to_owned).to_vec(),
///     loads: vec![Load::from_name("left"), Load::from_name("right")],
///     values: Matrix::from_row_slice(3, 2, values),
///     uncertainty: None,
///     noise: None,
/// };
/// assert!(check_separability(&s(&[1.0, 0.0, 0.0, 1.0, 1.0, 1.0])).is_empty());
/// // Each gauge reads the right load twice as much as the left one.
/// let found = check_separability(&s(&[1.0, 2.0, 2.0, 4.0, 3.0, 6.0]));
/// assert_eq!((found[0].code, found[0].severity), ("loads-not-separable", Severity::Error));
/// assert_eq!(found[0].subject, "left, right");
/// ```
pub fn check_separability(s: &Sensitivity) -> Vec<Finding> {
    let mut findings = Vec::new();
    if s.loads.is_empty() || s.gauges.is_empty() {
        return findings;
    }
    let largest = s.values.amax();
    for (load, column) in s.loads.iter().zip(s.values.column_iter()) {
        if column.amax() <= RANK_TOLERANCE * largest {
            findings.push(Finding::new(
                Severity::Error,
                "load-without-strain",
                &load.name,
                format!(
                    "load `{}` strains none of the gauges and cannot be recovered",
                    load.name
                ),
                "check its subcase and its `applied`, or add a gauge that it strains",
            ));
        }
    }
    let unit = dense::unit_columns(&s.values);
    let (n, k) = (s.gauges.len(), s.loads.len());
    if n < k {
        findings.push(
            Finding::new(
                Severity::Error,
                "fewer-gauges-than-loads",
                "gauges",
                format!("{n} gauges cannot separate {k} loads"),
                format!("add at least {} gauges, or drop loads", k - n),
            )
            .with_numbers(n as f64, k as f64),
        );
    }
    // If there are fewer gauges than loads, appended zero rows make the right singular vectors span all loads.
    let mut square = unit.clone();
    if n < k {
        square = square.resize_vertically(k, 0.0);
    }
    let Some(d) = dense::svd(&square) else {
        return findings;
    };
    let Some(&first) = d.s.first() else {
        return findings;
    };
    let scaled_condition = s.condition_number_scaled();
    for (i, &value) in d.s.iter().enumerate() {
        let ratio = if first > 0.0 { value / first } else { 0.0 };
        let coefficients: Vec<f64> = (0..k)
            .map(|l| {
                let norm = s.values.column(l).norm();
                d.v[(l, i)] / if norm > 0.0 { norm } else { 1.0 }
            })
            .collect();
        let shares: Vec<f64> = (0..k).map(|l| d.v[(l, i)]).collect();
        if ratio <= RANK_TOLERANCE {
            if shares.iter().filter(|v| v.abs() > 0.5).count() == 1
                && shares
                    .iter()
                    .zip(s.values.column_iter())
                    .any(|(v, c)| v.abs() > 0.99 && c.amax() == 0.0)
            {
                continue;
            }
            let (names, words) = combination(s, &shares, &coefficients);
            findings.push(
                Finding::new(
                    Severity::Error,
                    "loads-not-separable",
                    names.join(", "),
                    format!("these gauges cannot separate {}: the combination {words} strains none of them", list(&names)),
                    "add a gauge that this combination strains (`place` finds one), or drop or combine these loads",
                )
                .with_numbers(ratio, RANK_TOLERANCE),
            );
        } else if i + 1 == d.s.len()
            && scaled_condition > CONDITION_LIMIT
            && scaled_condition.is_finite()
        {
            let (names, words) = combination(s, &shares, &coefficients);
            findings.push(
                Finding::new(
                    Severity::Warning,
                    "loads-weakly-separable",
                    names.join(", "),
                    format!(
                        "the combination {words} is {:.0} times harder to resolve than the best one, and its errors are larger by this factor",
                        1.0 / ratio
                    ),
                    "add gauges with `place`, or recover the combination as one load",
                )
                .with_numbers(scaled_condition, CONDITION_LIMIT),
            );
        }
    }
    findings
}

/// Returns the names of the loads in a combination, and the combination as a sum. The largest term is first, with the coefficient 1.
fn combination(s: &Sensitivity, shares: &[f64], coefficients: &[f64]) -> (Vec<String>, String) {
    let top = shares.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
    let mut order: Vec<usize> = (0..shares.len())
        .filter(|&l| shares[l].abs() >= NAMED_SHARE * top)
        .collect();
    order.sort_by(|&a, &b| shares[b].abs().total_cmp(&shares[a].abs()).then(a.cmp(&b)));
    let base = order.first().map_or(1.0, |&l| coefficients[l]);
    let mut words = String::new();
    for (i, &l) in order.iter().enumerate() {
        let c = if base == 0.0 {
            0.0
        } else {
            coefficients[l] / base
        };
        let sign = if c < 0.0 { "-" } else { "+" };
        let size = c.abs();
        let number = if (size - 1.0).abs() < 5e-4 {
            String::new()
        } else {
            format!("{} ", digits(size))
        };
        match (i, c < 0.0) {
            (0, false) => words.push_str(&format!("{number}{}", s.loads[l].name)),
            (0, true) => words.push_str(&format!("-{number}{}", s.loads[l].name)),
            _ => words.push_str(&format!(" {sign} {number}{}", s.loads[l].name)),
        }
    }
    (
        order.iter().map(|&l| s.loads[l].name.clone()).collect(),
        words,
    )
}

/// Formats a number with three significant digits.
fn digits(x: f64) -> String {
    if !(1e-3..1e5).contains(&x) {
        return format!("{x:.2e}");
    }
    let decimals = (2 - x.log10().floor() as i32).clamp(0, 6) as usize;
    format!("{x:.decimals$}")
}

fn list(names: &[String]) -> String {
    match names {
        [one] => format!("a combination with `{one}`"),
        [rest @ .., last] => format!("{} and {last}", rest.join(", ")),
        [] => String::new(),
    }
}
