//! Messages about parameters that a record does not determine.

use super::fit::Fit;
use super::layout::Parameter;

/// A parameter is known when one standard deviation is below this share of it ..
const KNOWN_SHARE: f64 = 0.5;
/// .. or moves the equations by less than this share of their forces (a damper that is truly zero).
const IMMATERIAL_SHARE: f64 = 0.05;

/// Returns whether a parameter is known, from its value, its standard deviation and `effect_of_sigma`. This is the effect of one sigma, as a share of
/// the forces in the equations of the parameter.
pub fn is_known(value: f64, sigma: f64, effect_of_sigma: f64) -> bool {
    value.is_finite()
        && sigma.is_finite()
        && (sigma <= KNOWN_SHARE * value.abs() || effect_of_sigma <= IMMATERIAL_SHARE)
}

/// Returns the message about a group of parameters that scale together, given the reference.
pub fn scale_sentence(group: &[String], reference: &str, springs: &[String]) -> String {
    let list = group.join(", ");
    let spring = springs.first().map_or("a spring rate", String::as_str);
    format!(
        "{list} are known only up to one common factor: without a wheel force, a common factor does not change the accelerations. The \
         ratios to {reference} are known. One more number determines all: {reference} (weigh the axle and subtract the unsprung mass), or \
         {spring} (deflection under a known load), or a wheel force."
    )
}

/// Returns the sentence on parameters without a value. Either all their equations contain `unmeasured` wheel forces, or no wheel force is missing and
/// no value fits.
pub fn absent_sentence(names: &[String], unmeasured: &[String]) -> String {
    let names = names.join(", ");
    if unmeasured.is_empty() {
        return format!(
            "{names} cannot be determined: no values within their limits fit the record. Check signs and units of the channels."
        );
    }
    format!(
        "{names} cannot be determined: every equation with them also contains an unmeasured wheel force ({}). Measure this force, or weigh the part.",
        unmeasured.join(", ")
    )
}

/// Returns sentences for combinations of parameters that the record cannot distinguish. They come from the weak directions of a fit and the sigmas of
/// the parameters.
pub fn weak_sentences(fit: &Fit, parameters: &[Parameter], unknown: &[usize]) -> Vec<String> {
    /// Share of a direction above which a parameter takes part in it.
    const PART: f64 = 0.3;
    let mut sentences = Vec::new();
    let mut said: Vec<usize> = Vec::new();
    for direction in fit.solution.directions.iter().rev() {
        let members: Vec<usize> = direction
            .iter()
            .enumerate()
            .filter(|(_, v)| v.abs() > PART)
            .filter_map(|(k, _)| fit.free.get(k).copied())
            .collect();
        if !members
            .iter()
            .any(|m| unknown.contains(m) && !said.contains(m))
        {
            continue;
        }
        said.extend(&members);
        let names: Vec<&str> = members
            .iter()
            .filter_map(|&i| parameters.get(i))
            .map(|p| p.name.as_str())
            .collect();
        sentences.push(if let [one] = names.as_slice() {
            format!("{one} is not excited in this record, and its interval is unbounded. Record a manoeuvre that excites it, or state it in `known`.")
        } else {
            format!(
                "{} have indistinguishable effects in this record: only a combination of them is known. State one of them in `known`, or record a drive that separates them.",
                names.join(" and ")
            )
        });
    }
    sentences
}
