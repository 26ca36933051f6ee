//! TABLEM1 to TABLEM4: a material property at a temperature.

use nastran::cards::{MaterialTable, MaterialTableForm};

/// Returns the property at the temperature `x`; `z` is its value on the material card. `None` if the table needs this value and the card leaves it
/// blank.
///
/// # Reference
/// MSC Nastran Quick Reference Guide, TABLEM1 to TABLEM4: y(x), z y(x - x1), z y((x - x1) / x2), z sum of a_i ((x - x1) / x2)^i.
pub(super) fn property_at(table: &MaterialTable, z: Option<f64>, x: f64) -> Option<f64> {
    match &table.form {
        MaterialTableForm::Replaces(points) => Some(look_up(points, x)),
        MaterialTableForm::Shifted { x1, points } => Some(z? * look_up(points, x - x1)),
        MaterialTableForm::Scaled {
            x: [x1, x2],
            points,
        } => Some(z? * look_up(points, (x - x1) / x2)),
        MaterialTableForm::Series {
            x: [x1, x2, x3, x4],
            a,
        } => {
            let inside = x.max(*x3).min(*x4);
            let s = (inside - x1) / x2;
            Some(z? * a.iter().rev().fold(0.0, |sum, a| sum * s + a))
        }
    }
}

/// Returns the value of a table at `x`: linear between points, and extrapolated along the first and last line. At a jump, it is the mean of
/// the two values.
fn look_up(points: &[(f64, f64)], x: f64) -> f64 {
    let mut points = points.to_vec();
    if points.first().map(|p| p.0) > points.last().map(|p| p.0) {
        points.reverse();
    }
    let here: Vec<f64> = points.iter().filter(|p| p.0 == x).map(|p| p.1).collect();
    if !here.is_empty() {
        return here.iter().sum::<f64>() / here.len() as f64;
    }
    let after = points.partition_point(|p| p.0 < x);
    let first = after.clamp(1, points.len().saturating_sub(1).max(1)) - 1;
    match (points.get(first), points.get(first + 1)) {
        (Some((x0, y0)), Some((x1, y1))) if x1 > x0 => y0 + (y1 - y0) * (x - x0) / (x1 - x0),
        (Some((_, y)), _) => *y,
        (None, _) => 0.0,
    }
}
