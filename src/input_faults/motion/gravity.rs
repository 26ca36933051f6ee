//! The sign and unit of an accelerometer by the gravity in its mean.

use super::{ChannelKind, MotionChannel, MotionFault, names, of_kind, other_units, shows};
use crate::finding::{Finding, Severity, list_few};
use crate::units::number;

/// Returns the faults that the means of accelerometers show: minus gravity, or gravity in another unit.
///
/// A unit counts only if every accelerometer shows gravity in this unit or in the unit of the job. The offset of a sensor that does not measure
/// gravity may also have this size.
pub fn faults_by_gravity(channels: &[MotionChannel], gravity: f64) -> Vec<MotionFault> {
    let mut signs = Vec::new();
    let mut units: Vec<MotionFault> = Vec::new();
    let accelerations = of_kind(channels, ChannelKind::Acceleration);
    for &i in &accelerations {
        let mean = channels[i].mean;
        if shows(mean.abs(), gravity) {
            if mean < 0.0 {
                signs.push(i);
            }
            continue;
        }
        let agreed = |factor: f64| {
            let mut all = accelerations.iter().map(|a| channels[*a].mean.abs());
            all.all(|m| shows(m, gravity) || shows(m * factor, gravity))
        };
        let unit = other_units(&channels[i])
            .into_iter()
            .find(|(_, f)| shows(mean.abs() * f, gravity) && agreed(*f));
        let Some((name, factor)) = unit else { continue };
        if mean < 0.0 {
            signs.push(i);
        }
        let same = units.iter_mut().find_map(|u| match u {
            MotionFault::Unit(list, n, f) if *n == name && *f == factor => Some(list),
            _ => None,
        });
        match same {
            Some(list) => list.push(i),
            None => units.push(MotionFault::Unit(vec![i], name, factor)),
        }
    }
    let sign = (!signs.is_empty()).then_some(MotionFault::Sign(signs));
    sign.into_iter().chain(units).collect()
}

/// Returns the names of the channels of [`faults_by_gravity`].
pub fn channels_by_gravity<'a>(channels: &[MotionChannel<'a>], gravity: f64) -> Vec<&'a str> {
    let faults = faults_by_gravity(channels, gravity);
    let each = faults.iter().flat_map(|f| names(f.channels(), channels));
    each.collect()
}

/// Returns the findings on [`faults_by_gravity`] in a record of `file`, errors.
pub fn findings_by_gravity(channels: &[MotionChannel], gravity: f64, file: &str) -> Vec<Finding> {
    let faults = faults_by_gravity(channels, gravity);
    let shown = format!(
        "gravity, which is {} in the unit of the job",
        number(gravity)
    );
    let each = faults.iter().map(|fault| {
        let first = fault
            .channels()
            .first()
            .map_or(f64::NAN, |c| channels[*c].mean);
        finding_of_means(channels, fault, &shown, file).with_numbers(first, gravity)
    });
    each.collect()
}

/// Returns an error if the sum of the mean wheel forces is minus the weight of the stated masses, or this weight in another unit.
/// A unit that the file states is not in question.
///
/// Wheels that stay on the road have a mean force above the scatter of the force. Forces without a static part have small means of any size.
pub fn finding_by_weight(channels: &[MotionChannel], weight: f64, file: &str) -> Option<Finding> {
    let forces = of_kind(channels, ChannelKind::Force);
    let first = &channels[*forces.first()?];
    let total: f64 = forces.iter().map(|c| channels[*c].mean).sum();
    let is_static = |c: &usize| channels[*c].scatter < channels[*c].mean.abs();
    if shows(total, weight) || !forces.iter().all(is_static) {
        return None;
    }
    let fault = match shows(-total, weight) {
        true => MotionFault::Sign(forces),
        false if first.is_unit_stated => return None,
        false => {
            let mut units = other_units(first).into_iter();
            let (unit, factor) = units.find(|(_, f)| shows(total.abs() * f, weight))?;
            MotionFault::Unit(forces, unit, factor)
        }
    };
    let shown = format!(
        "the weight of the stated masses, which is {}",
        number(weight)
    );
    Some(finding_of_means(channels, &fault, &shown, file).with_numbers(total, weight))
}

/// Returns the error of a fault that the means of its channels show.
fn finding_of_means(
    channels: &[MotionChannel],
    fault: &MotionFault,
    shown: &str,
    file: &str,
) -> Finding {
    let means = fault.channels().iter().map(|c| {
        let c = &channels[*c];
        format!("{} {}", c.name, number(c.mean))
    });
    let message = format!(
        "{} in `{file}`: the mean shows {shown} (means: {})",
        fault.describe(channels),
        list_few(&means.collect::<Vec<_>>())
    );
    Finding::new(
        Severity::Error,
        fault.code(),
        fault.subject(channels),
        message,
        fault.remedy(channels),
    )
}
