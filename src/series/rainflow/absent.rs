//! Numbers that JSON has no word for: what is not finite is written as null and read back here.

use serde::{Deserialize, Deserializer};

/// A number; NaN where there is none.
///
/// # Errors
/// What is neither a number nor null.
pub fn number<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(from)?.unwrap_or(f64::NAN))
}

/// Numbers; NaN where there is none.
///
/// # Errors
/// What is no list of numbers and nulls.
pub fn numbers<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<f64>, D::Error> {
    let list = Vec::<Option<f64>>::deserialize(from)?;
    Ok(list.into_iter().map(|v| v.unwrap_or(f64::NAN)).collect())
}

/// A number; infinite where there is none.
///
/// # Errors
/// What is neither a number nor null.
pub fn infinite<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(from)?.unwrap_or(f64::INFINITY))
}
