//! Gauges next to each other that fail together. The probable cause is a crack or a loose joint between them, not as many bad gauges.

use super::frame::StrainFrame;
use crate::reconcile::effect::{Correction, Extension};
use crate::reconcile::outcome::NamedEffect;

/// Number of gauge and card faults from which card faults count too. Below this number, a card fault next to a gauge fault is an amplifier fault and
/// a gauge fault.
const WITH_CARDS: usize = 3;
/// Range of gains that a changed path of the strain can cause too. Gains of wrongly wired bridges and amplifiers are outside this range.
const GAIN: [f64; 2] = [0.5, 1.5];

/// Returns the names of neighbouring gauges that read more or less than modelled, as a message; `None` if there are fewer than two.
///
/// If the stiffness of a small region changed, the residual from its unknown shape looks like such gauges too. Then no gauge is named.
pub fn neighbours_that_fail(frame: &StrainFrame, effects: &[NamedEffect]) -> Option<String> {
    let region = (effects.iter()).find_map(|e| match &e.extension {
        Extension::LocalStiffness { place, .. } => Some(place),
        _ => None,
    });
    if let Some(place) = region {
        let explained: Vec<&str> = (effects.iter())
            .filter(|e| scales_or_turns(e))
            .map(|e| e.id.as_str())
            .collect();
        if !explained.is_empty() {
            return Some(format!(
                "its sign and size indicate that the stiffness of a small region at {place} changed. The unknown shape of the region may explain {}",
                explained.join(", ")
            ));
        }
    }
    let mut at: Vec<Vec<usize>> = effects.iter().map(|e| reads_otherwise(frame, e)).collect();
    at.retain(|gauges| !gauges.is_empty());
    if at.len() < WITH_CARDS {
        at.retain(|gauges| gauges.len() == 1);
    }
    let of = |(e, gauges): (usize, &Vec<usize>)| gauges.iter().map(|g| (e, *g)).collect::<Vec<_>>();
    let mut off: Vec<(usize, usize)> = at.iter().enumerate().flat_map(of).collect();
    off.sort_unstable_by_key(|o| o.1);
    off.dedup_by_key(|o| o.1);
    let near = frame.rules.near * usual_distance(frame)?;
    // Gauges of the same card do not count as neighbours, however near they are to each other.
    let close = |a: &(usize, usize), b: &(usize, usize)| {
        a.0 != b.0 && distance(frame, a.1, b.1).is_some_and(|d| d <= near)
    };
    let together: Vec<&str> = off
        .iter()
        .filter(|a| off.iter().any(|b| close(a, b)))
        .map(|o| frame.gauges[o.1].name.as_str())
        .collect();
    (together.len() > 1).then(|| {
        format!(
            "gauges {} are next to each other and deviate together: this indicates the stiffness of a small region between them (a crack, \
             a loose joint, a missing patch), not several faulty gauges",
            together.join(", ")
        )
    })
}

/// Returns the gauges that read another strain in an effect: with a gain within `GAIN`, or at another angle or place.
fn reads_otherwise(frame: &StrainFrame, e: &NamedEffect) -> Vec<usize> {
    let Extension::Channels(list) = &e.extension else {
        return Vec::new();
    };
    let may_be_strain = |correction: &Correction| match correction {
        Correction::Gain(gain) => *gain > GAIN[0] && *gain < GAIN[1],
        Correction::AngleDeg(_) | Correction::PositionMm(_) => true,
        _ => false,
    };
    let of_strain = list.iter().filter(|c| may_be_strain(&c.1));
    of_strain
        .filter_map(|(name, _)| frame.gauges.iter().position(|g| g.name == *name))
        .collect()
}

/// Returns whether an effect changes the gain, the direction or the place of channels, or adds a share of a neighbour.
fn scales_or_turns(e: &NamedEffect) -> bool {
    let of_strain = |c: &Correction| {
        matches!(
            c,
            Correction::Gain(_) | Correction::AngleDeg(_) | Correction::PositionMm(_)
        )
    };
    let listed =
        matches!(&e.extension, Extension::Channels(list) if list.iter().any(|c| of_strain(&c.1)));
    listed || e.id.starts_with("cross_sensitivity")
}

fn distance(frame: &StrainFrame, a: usize, b: usize) -> Option<f64> {
    let (p, q) = (
        frame.gauges.get(a)?.position?,
        frame.gauges.get(b)?.position?,
    );
    Some(
        p.iter()
            .zip(&q)
            .map(|(x, y)| (x - y) * (x - y))
            .sum::<f64>()
            .sqrt(),
    )
}

/// Returns the median over gauges of the distance to the nearest gauge outside the same rosette; `None` if the places are not known.
fn usual_distance(frame: &StrainFrame) -> Option<f64> {
    let n = frame.n_gauges();
    let nearest = |g: usize| {
        let legs = frame.rosette(g);
        let others = (0..n)
            .filter(|h| !legs.contains(h))
            .filter_map(|h| distance(frame, g, h));
        others.min_by(f64::total_cmp)
    };
    let mut all: Vec<f64> = (0..n).filter_map(nearest).collect();
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied().filter(|d| *d > 0.0)
}
