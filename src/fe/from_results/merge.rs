//! Several files, one solution.

use crate::fe::{CaseResult, Solution};
use crate::finding::{Finding, Severity};

/// The cases of all files, subcases ascending, file order within a subcase.
pub(super) fn merge(solutions: Vec<Solution>) -> Solution {
    let mut all = Solution::default();
    for solution in solutions {
        let separator = if all.source.is_empty() { "" } else { "; " };
        all.source = format!("{}{separator}{}", all.source, solution.source);
        all.findings.extend(solution.findings);
        for case in solution.cases {
            add(&mut all, case);
        }
    }
    all.cases.sort_by_key(|c| c.subcase);
    all
}

fn add(all: &mut Solution, case: CaseResult) {
    let same = all
        .cases
        .iter_mut()
        .find(|c| c.subcase == case.subcase && !overlap(c, &case));
    if let Some(same) = same {
        complete(same, case);
        return;
    }
    if all.cases.iter().any(|c| c.subcase == case.subcase) {
        let message = format!(
            "subcase {} has strain in two files; both are kept, in file order",
            case.subcase
        );
        let remedy = "name the file and the subcase of each load in the job";
        all.findings.push(Finding::new(
            Severity::Warning,
            "subcase-in-two-files",
            case.subcase.to_string(),
            message,
            remedy,
        ));
    }
    all.cases.push(case);
}

/// Whether two cases both have strain of shells, or of bars. Displacements that come twice are the first file's.
fn overlap(a: &CaseResult, b: &CaseResult) -> bool {
    let both = |a_empty: bool, b_empty: bool| !a_empty && !b_empty;
    both(a.shells.elements.is_empty(), b.shells.elements.is_empty())
        || both(a.beams.elements.is_empty(), b.beams.elements.is_empty())
}

fn complete(case: &mut CaseResult, other: CaseResult) {
    if case.label.is_empty() {
        case.label = other.label;
    }
    if case.shells.elements.is_empty() {
        case.shells = other.shells;
    }
    if case.beams.elements.is_empty() {
        case.beams = other.beams;
    }
    if case.displacement.is_empty() {
        case.displacement = other.displacement;
    }
}
