//! Damage of one cycle.

use serde::{Deserialize, Serialize};

/// Bend of an S-N line: the range at the bend, and the slope below it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Knee {
    /// Range at the bend. Smaller ranges cause less damage than the power gives.
    pub range: f64,
    /// Power below the knee. Infinite if cycles below the knee cause no damage.
    #[serde(deserialize_with = "super::nullable_numbers::number_or_infinity")]
    pub slope: f64,
}

/// Pseudo-damage of a cycle as a power of its range, without a factor that depends on the part.
///
/// The damage is `R^m`, and below a knee `R_k^m (R / R_k)^(m_2)`.
///
/// # Example
/// ```
/// use strainbridge::series::rainflow::{Knee, Law};
///
/// let line = Law::from_slope(5.0);
/// // A fifth more range does 1.2^5 = 2.49 times the damage.
/// assert!((line.damage(12.0) / line.damage(10.0) - 1.2_f64.powi(5)).abs() < 1e-12);
/// let bent = Law { knee: Some(Knee { range: 10.0, slope: 9.0 }), ..line };
/// assert_eq!(bent.damage(12.0), line.damage(12.0));
/// // The damage is continuous at the knee, and smaller below it.
/// assert!((bent.damage(10.0 - 1e-9) / line.damage(10.0) - 1.0).abs() < 1e-8);
/// assert!((bent.damage(5.0) / line.damage(5.0) - 0.5_f64.powi(4)).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Law {
    /// The power m: the slope of the S-N line.
    pub slope: f64,
    /// Bend of the line, if it has one.
    pub knee: Option<Knee>,
}

impl Law {
    /// Creates a straight line.
    pub fn from_slope(slope: f64) -> Self {
        Self { slope, knee: None }
    }

    /// Returns the damage of one cycle with this range.
    #[inline(always)]
    pub fn damage(&self, range: f64) -> f64 {
        match self.knee {
            Some(k) if range < k.range => {
                k.range.powf(self.slope) * (range / k.range).powf(k.slope)
            }
            _ => power(range, self.slope),
        }
    }

    /// Returns the change of the damage with the range.
    #[inline(always)]
    pub fn derivative(&self, range: f64) -> f64 {
        match self.knee {
            Some(k) if range < k.range => {
                if range > 0.0 && k.slope.is_finite() {
                    k.slope * self.damage(range) / range
                } else {
                    0.0
                }
            }
            _ => self.slope * power(range, self.slope - 1.0),
        }
    }
}

/// A power; whole ones, which most S-N lines have, by squares and products.
#[inline(always)]
fn power(x: f64, p: f64) -> f64 {
    let whole = p as u8;
    if f64::from(whole) != p || whole > 64 {
        return x.powf(p);
    }
    let (mut square, mut left, mut out) = (x, whole, 1.0);
    loop {
        if left & 1 == 1 {
            out *= square;
        }
        left >>= 1;
        if left == 0 {
            return out;
        }
        square *= square;
    }
}
