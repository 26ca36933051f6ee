//! Linear combinations of solved load cases.

use super::reactions::{Reaction, Reactions};
use super::relief::Balance;
use super::{BeamField, CaseResult, ShellField, SolidField};
use std::collections::BTreeMap;

/// Returns the sum of results, each multiplied by its factor. `None` if the results have different elements or stations, or if there are no results.
pub fn combine_results(
    subcase: u32,
    label: String,
    terms: &[(f64, &CaseResult)],
) -> Option<CaseResult> {
    let (_, first) = terms.first()?;
    let shells = terms.iter().map(|(f, c)| (*f, &c.shells));
    let beams = terms.iter().map(|(f, c)| (*f, &c.beams));
    let solids = terms.iter().map(|(f, c)| (*f, &c.solids));
    let mut sum = CaseResult {
        subcase,
        label,
        shells: ShellField {
            centre: sum_lists(shells.clone().map(|(f, s)| (f, &s.centre)), add_surfaces)?,
            corners: sum_lists(shells.map(|(f, s)| (f, &s.corners)), |to, by, c| {
                to.iter_mut()
                    .zip(c)
                    .for_each(|(t, c)| add_surfaces(t, by, c));
            })?,
            ..first.shells.clone()
        },
        beams: BeamField {
            stations: sum_lists(beams.clone().map(|(f, b)| (f, &b.stations)), |to, by, c| {
                to.iter_mut()
                    .zip(c)
                    .for_each(|(t, c)| add(&mut t.1, by, &c.1));
            })?,
            axial: sum_lists(beams.map(|(f, b)| (f, &b.axial)), |to, by, c| {
                to.iter_mut().zip(c).for_each(|(t, c)| *t += by * c);
            })?,
            elements: first.beams.elements.clone(),
            // Section forces belong to one case, so a combination has strain at the stations alone.
            solved: None,
            stations_alone: first.beams.elements.iter().copied().collect(),
        },
        solids: SolidField {
            centre: sum_lists(solids.clone().map(|(f, s)| (f, &s.centre)), add)?,
            corners: sum_lists(solids.map(|(f, s)| (f, &s.corners)), |to, by, c| {
                to.iter_mut().zip(c).for_each(|(t, c)| add(t, by, c));
            })?,
            ..first.solids.clone()
        },
        displacement: Vec::new(),
    };
    sum.displacement = sum_lists(terms.iter().map(|(f, c)| (*f, &c.displacement)), add)?;
    terms.iter().all(|t| same_places(first, t.1)).then_some(sum)
}

/// Returns the balance of a combination. `None` if inertia balances no term.
pub fn combine_balances(subcase: u32, terms: &[(f64, &Balance)]) -> Option<Balance> {
    let mut sum: Option<Balance> = None;
    for (factor, b) in terms {
        let to = sum.get_or_insert(Balance {
            subcase,
            applied: [0.0; 6],
            inertia: [0.0; 6],
            acceleration: [0.0; 6],
            residual: 0.0,
        });
        add(&mut to.applied, *factor, &b.applied);
        add(&mut to.inertia, *factor, &b.inertia);
        add(&mut to.acceleration, *factor, &b.acceleration);
        to.residual = to.residual.max(b.residual);
    }
    sum
}

/// Returns the reactions of a combination. `None` if no term has reactions.
pub fn combine_reactions(subcase: u32, terms: &[(f64, &Reactions)]) -> Option<Reactions> {
    let mut sum: Option<Reactions> = None;
    let mut grids: BTreeMap<u32, [f64; 6]> = BTreeMap::new();
    for (factor, r) in terms {
        let to = sum.get_or_insert(Reactions {
            subcase,
            applied: [0.0; 6],
            total: [0.0; 6],
            residual: 0.0,
            grids: Vec::new(),
        });
        add(&mut to.applied, *factor, &r.applied);
        add(&mut to.total, *factor, &r.total);
        to.residual = to.residual.max(r.residual);
        for g in &r.grids {
            add(grids.entry(g.grid).or_default(), *factor, &g.force);
        }
    }
    let grids = grids.into_iter();
    sum.map(|sum| Reactions {
        grids: grids
            .map(|(grid, force)| Reaction { grid, force })
            .collect(),
        ..sum
    })
}

fn add<const N: usize>(to: &mut [f64; N], factor: f64, by: &[f64; N]) {
    to.iter_mut().zip(by).for_each(|(t, b)| *t += factor * b);
}

fn add_surfaces(to: &mut [[f64; 3]; 2], factor: f64, by: &[[f64; 3]; 2]) {
    to.iter_mut().zip(by).for_each(|(t, b)| add(t, factor, b));
}

/// The sum of lists of equal length, the first minus itself to begin with; `None` where their lengths differ.
fn sum_lists<'a, T: Clone + 'a>(
    terms: impl Iterator<Item = (f64, &'a Vec<T>)> + Clone,
    add: impl Fn(&mut T, f64, &T),
) -> Option<Vec<T>> {
    let (_, first) = terms.clone().next()?;
    let mut sum = first.clone();
    for (to, by) in sum.iter_mut().zip(first) {
        add(to, -1.0, by);
    }
    for (factor, list) in terms {
        if list.len() != sum.len() {
            return None;
        }
        for (to, by) in sum.iter_mut().zip(list) {
            add(to, factor, by);
        }
    }
    Some(sum)
}

/// Returns whether two results are of the same elements, bars at the same stations.
fn same_places(a: &CaseResult, b: &CaseResult) -> bool {
    let stations = |c: &CaseResult| -> Vec<f64> {
        let all = c.beams.stations.iter().flatten();
        all.map(|s| s.0).collect()
    };
    a.shells.elements == b.shells.elements
        && a.beams.elements == b.beams.elements
        && a.solids.elements == b.solids.elements
        && stations(a) == stations(b)
}
