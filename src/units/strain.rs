//! Units of strain, as measuring systems write them.

/// Returns the microstrain in one unit. No stated unit means microstrain. `None` if the text is not a unit of strain.
pub fn microstrain_in(unit: &str) -> Option<f64> {
    let word: String = unit
        .to_lowercase()
        .chars()
        .filter(|c| !matches!(c, ' ' | '_' | '-' | '.'))
        .map(|c| if matches!(c, 'µ' | 'μ') { 'u' } else { c })
        .collect();
    match word.as_str() {
        "" | "microstrain" | "ustrain" | "ue" | "uε" | "um/m" | "ustr" | "us" | "1e6" | "ppm"
        | "uin/in" => Some(1.0),
        "strain" | "m/m" | "mm/mm" | "in/in" | "eps" => Some(1e6),
        "mm/m" | "millistrain" | "mstrain" | "me" => Some(1e3),
        _ => None,
    }
}
