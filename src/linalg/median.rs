//! The median of values that count unequally.

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_the_weight_lies_on_either_side() {
        assert_eq!(weighted_median(&mut []), None);
        let mut even = [(3.0, 1.0), (1.0, 1.0), (2.0, 1.0)];
        assert_eq!(weighted_median(&mut even), Some(2.0));
        let mut heavy = [(3.0, 5.0), (1.0, 1.0), (2.0, 1.0)];
        assert_eq!(weighted_median(&mut heavy), Some(3.0));
    }
}
