//! Several files, one solution.

use super::repeated_subcases::RepeatedSubcase;
use crate::fe::{BeamField, CaseResult, ShellField, Solution};
use std::sync::Arc;

/// Returns the cases of all files, sorted by subcase, in file order within a subcase. If the values of a subcase differ between files, there is one
/// case for each file.
pub(super) fn merge(solutions: Vec<Solution>, repeated: &[RepeatedSubcase]) -> Solution {
    let differs = |subcase: u32| {
        let mut found = repeated.iter().filter(|r| r.subcase == subcase);
        found.any(|r| r.files.len() > 1)
    };
    let mut all = Solution::default();
    for solution in solutions {
        let separator = if all.source.is_empty() { "" } else { "; " };
        all.source = format!("{}{separator}{}", all.source, solution.source);
        all.findings.extend(solution.findings);
        for case in solution.cases {
            let mut cases = all.cases.iter_mut();
            match cases.find(|c| c.subcase == case.subcase && !differs(c.subcase)) {
                Some(same) => complete_case(same, case),
                None => all.cases.push(case),
            }
        }
    }
    all.cases.sort_by_key(|c| c.subcase);
    all
}

/// Adds elements, displacements and label to a case that only another case has.
pub fn complete_case(case: &mut CaseResult, other: CaseResult) {
    if case.label.is_empty() {
        case.label = other.label;
    }
    complete_shells(&mut case.shells, other.shells);
    complete_beams(&mut case.beams, other.beams);
    if case.displacement.is_empty() {
        case.displacement = other.displacement;
    }
}

fn complete_shells(shells: &mut ShellField, other: ShellField) {
    if shells.elements.is_empty() {
        *shells = other;
        return;
    }
    let order = join_element_lists(&shells.elements, &other.elements);
    if order.iter().all(|(_, of_other, _)| !of_other) {
        return;
    }
    // If only one field has rows at corners, these rows would cover only some of the elements.
    let has_corners = !shells.corners.is_empty() && !other.corners.is_empty();
    *shells = ShellField {
        elements: Arc::new(order.iter().map(|o| o.0).collect()),
        centre: pick_values(&order, &shells.centre, &other.centre),
        corners: match has_corners {
            true => pick_values(&order, &shells.corners, &other.corners),
            false => Vec::new(),
        },
        from_stress: shells.from_stress || other.from_stress,
    };
}

fn complete_beams(beams: &mut BeamField, other: BeamField) {
    if beams.elements.is_empty() {
        *beams = other;
        return;
    }
    let order = join_element_lists(&beams.elements, &other.elements);
    if order.iter().all(|(_, of_other, _)| !of_other) {
        return;
    }
    *beams = BeamField {
        elements: Arc::new(order.iter().map(|o| o.0).collect()),
        stations: pick_values(&order, &beams.stations, &other.stations),
        axial: pick_values(&order, &beams.axial, &other.axial),
        solved: None,
        stations_alone: beams
            .stations_alone
            .union(&other.stations_alone)
            .copied()
            .collect(),
    };
}

/// The elements of both lists, ascending, each with whether it is taken from the other list and its place there.
fn join_element_lists<T: Copy + Ord>(own: &[T], other: &[T]) -> Vec<(T, bool, usize)> {
    let lacks = |e: &T| own.binary_search(e).is_err();
    let own_places = own.iter().enumerate().map(|(i, e)| (*e, false, i));
    let others = other.iter().enumerate().filter(|(_, e)| lacks(e));
    let mut all: Vec<(T, bool, usize)> = own_places
        .chain(others.map(|(i, e)| (*e, true, i)))
        .collect();
    all.sort_by_key(|o| o.0);
    all
}

fn pick_values<T, V: Clone>(order: &[(T, bool, usize)], own: &[V], other: &[V]) -> Vec<V> {
    let list = |of_other: bool| if of_other { other } else { own };
    let value = |o: &(T, bool, usize)| list(o.1).get(o.2).cloned();
    order.iter().filter_map(value).collect()
}
