//! Statistics of samples.

/// Half of the values are smaller; of an even number the upper one of the middle. `None` of none.
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    if values.is_empty() {
        return None;
    }
    Some(*values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Value at which half of the weight is reached, of values with their weights; sorts them. `None` of none.
pub fn weighted_median(values: &mut [(f64, f64)]) -> Option<f64> {
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = values.iter().map(|v| v.1).sum();
    let mut sum = 0.0;
    let found = values.iter().find(|v| {
        sum += v.1;
        sum >= total / 2.0
    });
    found.map(|v| v.0)
}

/// Root mean square of the finite values; 0 without any.
pub fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut n) = (0.0, 0usize);
    for v in values.filter(|v| v.is_finite()) {
        sum += v * v;
        n += 1;
    }
    if n == 0 { 0.0 } else { (sum / n as f64).sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_the_values_are_smaller() {
        assert_eq!(median(Vec::new()), None);
        assert_eq!(median(vec![3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(vec![4.0, 1.0, 3.0, 2.0]), Some(3.0));
    }

    #[test]
    fn half_of_the_weight_lies_on_either_side() {
        assert_eq!(weighted_median(&mut []), None);
        let mut even = [(3.0, 1.0), (1.0, 1.0), (2.0, 1.0)];
        assert_eq!(weighted_median(&mut even), Some(2.0));
        let mut heavy = [(3.0, 5.0), (1.0, 1.0), (2.0, 1.0)];
        assert_eq!(weighted_median(&mut heavy), Some(3.0));
    }
}
