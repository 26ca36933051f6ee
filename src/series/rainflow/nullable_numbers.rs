//! Numbers that JSON can't represent. A number that is not finite is written as null and read back by this module.

use serde::{Deserialize, Deserializer};

/// Reads a number; null becomes NaN.
///
/// # Errors
/// A value that is neither a number nor null.
pub fn number<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(from)?.unwrap_or(f64::NAN))
}

/// Reads a list of numbers; null becomes NaN.
///
/// # Errors
/// A value that is not a list of numbers and nulls.
pub fn numbers<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<f64>, D::Error> {
    let list = Vec::<Option<f64>>::deserialize(from)?;
    Ok(list.into_iter().map(|v| v.unwrap_or(f64::NAN)).collect())
}

/// Reads a number; null becomes infinity.
///
/// # Errors
/// A value that is neither a number nor null.
pub fn number_or_infinity<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(from)?.unwrap_or(f64::INFINITY))
}
