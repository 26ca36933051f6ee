//! An effect in words, on the terminal and in the extended job, the same for strain and motion.

use super::answer::EffectFound;

/// `rail_stiffness:L4: 14.8 +- 1.1 percent`.
pub fn effect_in_words(e: &EffectFound) -> String {
    let Some(found) = e.size.as_ref() else {
        return e.id.clone();
    };
    let pairs = found.sizes.iter().zip(&found.sigmas);
    let sizes: Vec<String> = pairs
        .map(|(v, s)| format!("{} +- {}", number(*v), number(*s)))
        .collect();
    if sizes.is_empty() {
        e.id.clone()
    } else {
        format!("{}: {} {}", e.id, sizes.join(", "), found.unit)
    }
}

/// A number with four figures or so.
fn number(v: f64) -> String {
    if v == 0.0 || (1e-2..1e5).contains(&v.abs()) {
        format!("{v:.3}")
    } else {
        format!("{v:.4e}")
    }
}
