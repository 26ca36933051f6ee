//! The restoring force of a link: from its model, and from the motion of the body that it carries.

use super::curve::{Curve, plots};
use crate::report::figure::Scale;
use crate::report::page::Section;
use crate::vehicle::identify::Identification;
use crate::vehicle::loads::link_forces;
use crate::vehicle::motion::Motion;
use crate::vehicle::term::UnitNames;

/// Returns `-m a` of the body that only link `l` carries, one value for each sample. The result is `None` if other links carry the body too, or if it
/// turns.
pub fn asked_force(found: &Identification, motion: &Motion, l: usize) -> Option<Vec<f64>> {
    let v = &found.vehicle;
    let link = v.links.get(l)?;
    let body = link
        .ends
        .iter()
        .filter(|e| e.0 > 0.0 && v.bodies[e.1.body].shape.n() == 1)
        .map(|e| e.1.body)
        .next()?;
    let links = v
        .links
        .iter()
        .filter(|k| k.ends.iter().any(|e| e.1.body == body));
    let mass = found.values[v.inertia_index(body, 0, 0)];
    (links.count() == 1).then(|| motion.bodies[body][0].iter().map(|a| -mass * a).collect())
}

/// Returns the links whose forces the record determines. Without a scale of forces, coefficients are ratios to a mass and not forces.
pub(super) fn find_determined_links(found: &Identification) -> impl Iterator<Item = usize> + '_ {
    let v = &found.vehicle;
    let is_determined = |i: usize| found.scaled[i] && found.values[i].is_finite();
    let all_determined =
        move |l: &usize| (0..v.links[*l].terms.len()).all(|t| is_determined(v.term_index(*l, t)));
    (0..v.links.len()).filter(all_determined)
}

/// Returns the mean force of every link that the record determines, by bins of its stretch. The force is from the model, and from `asked_force` if
/// known.
pub fn restoring_curves(found: &Identification, motion: &Motion) -> Vec<Curve> {
    const BINS: usize = 41;
    let forces = link_forces(&found.vehicle, &found.values, motion);
    let mut out = Vec::new();
    for l in find_determined_links(found) {
        let link = &found.vehicle.links[l];
        let d = &motion.stretch[l];
        let asked = asked_force(found, motion, l);
        let largest = d.iter().fold(0.0f64, |a, b| a.max(b.abs()));
        // Force from the model, force from `asked_force`, number of samples.
        let mut sums = vec![(0.0, 0.0, 0usize); BINS];
        for (t, (d, f)) in d.iter().zip(&forces[l]).enumerate() {
            if f.is_finite() {
                let bin = (((d / largest + 1.0) / 2.0 * BINS as f64) as usize).min(BINS - 1);
                sums[bin].0 += f;
                sums[bin].1 += asked.as_ref().map_or(0.0, |a| a[t]);
                sums[bin].2 += 1;
            }
        }
        let used: Vec<usize> = (0..BINS).filter(|&i| sums[i].2 > 0).collect();
        let mean = |of: &dyn Fn(usize) -> f64| used.iter().map(|&i| of(i)).collect::<Vec<f64>>();
        out.push(Curve {
            name: link.name.clone(),
            x: mean(&|i| ((i as f64 + 0.5) / BINS as f64 * 2.0 - 1.0) * largest),
            recovered: mean(&|i| sums[i].0 / sums[i].2 as f64),
            measured: match asked {
                Some(_) => mean(&|i| sums[i].1 / sums[i].2 as f64),
                None => Vec::new(),
            },
        });
    }
    out
}

/// Returns the curves as a section of a page.
pub fn restoring_section(curves: &[Curve], units: &UnitNames) -> Section {
    let stretch = format!("stretch, {}", units.length);
    let force = format!("force, {}", units.force);
    Section::new(
        "Restoring force over stretch (measured: required by the motion)",
        vec![plots(
            curves,
            [&stretch, &force],
            Scale::Linear,
            "Mean force of the link by its stretch, from the model and as the motion requires it: curves that agree are better.",
            None,
        )],
    )
}

/// Returns the unit of a column of `restoring_force.csv`. It is empty for a name or a count.
pub fn restoring_unit(column: &str, units: &UnitNames) -> String {
    match column {
        "stretch" => units.length.clone(),
        "rate" => units.speed(),
        "force_model" | "force_measured" => units.force.clone(),
        _ => String::new(),
    }
}
