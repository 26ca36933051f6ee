//! Layouts that must have a gauge in each of some groups of places.

use super::candidates::{Angles, Candidates, Choice};
use super::perturbation::fits;
use super::quality;
use super::shortlist::excluder;
use super::spec::Spec;

/// Angles tried at a place where the angle is continuous.
const STEPS: usize = 36;

/// Returns the layout after exchanges that give each group of places one gauge, each with the least loss of information. Gauges that belong to
/// another group stay.
///
/// # Errors
/// The group for which no gauge fits.
pub fn with_one_in_each(
    c: &Candidates,
    spec: &Spec,
    mut gauges: Vec<Choice>,
    groups: &[Vec<usize>],
) -> Result<Vec<Choice>, usize> {
    let holds = |g: &Choice, group: &[usize]| group.contains(&(g.place as usize));
    for (number, group) in groups.iter().enumerate() {
        if gauges.iter().any(|g| holds(g, group)) {
            continue;
        }
        let free: Vec<usize> = (0..gauges.len())
            .filter(|i| !groups.iter().any(|g| holds(&gauges[*i], g)))
            .collect();
        let mut best: Option<(f64, usize, Choice)> = None;
        for choice in group.iter().flat_map(|p| choices(c, *p)) {
            let mut all = gauges.clone();
            all.push(choice);
            let new = gauges.len();
            let layout: Vec<usize> = (0..new).collect();
            let excludes = excluder(c, spec, &all);
            for &i in free.iter().filter(|i| fits(&layout, **i, new, &excludes)) {
                let mut next = gauges.clone();
                next[i] = choice;
                let value = value(c, spec, &next);
                if let Some(v) = value.filter(|v| best.is_none_or(|b| *v > b.0)) {
                    best = Some((v, i, choice));
                }
            }
        }
        let (_, i, choice) = best.ok_or(number)?;
        gauges[i] = choice;
    }
    Ok(gauges)
}

fn choices(c: &Candidates, place: usize) -> Vec<Choice> {
    let at = |(step, angle): (usize, f64)| Choice {
        place: place as u32,
        step: step as u16,
        angle,
    };
    match c.angles() {
        Angles::Fixed => vec![at((0, 0.0))],
        Angles::Grid(angles) => angles.iter().copied().enumerate().map(at).collect(),
        Angles::Continuous => {
            let turn = std::f64::consts::PI / STEPS as f64;
            (0..STEPS).map(|s| at((0, turn * s as f64))).collect()
        }
    }
}

/// Returns the criterion of a layout; `None` if it does not separate the loads.
pub fn value(c: &Candidates, spec: &Spec, gauges: &[Choice]) -> Option<f64> {
    let rows: Vec<Vec<f64>> = gauges.iter().map(|&g| c.row(g)).collect();
    quality::value(&rows, &spec.prior, c.n_loads(), &spec.criterion)
}
