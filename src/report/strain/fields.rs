//! The page of `strains`: the files that were read, and the elements with the largest strain.

use crate::fe::Solution;
use crate::fe::strain_rows::{Location, Point, StrainRow, largest_strain, largest_strain_rows};
use crate::finding::Finding;
use crate::model::Model;
use crate::report::page::{Block, Page, Section, number};
use crate::report::scene::{scene_of_solution, scene_section};

/// Subcases and elements a subcase that the page lists; `strains.csv` holds all.
const MOST_CASES: usize = 40;
const HOTTEST: usize = 10;

/// Returns the page of the strain fields of `solution`: numbers of elements by subcase, then the hottest elements of each.
pub fn strains_page(title: &str, model: &Model, solution: &Solution, findings: &[Finding]) -> Page {
    let of_case = |case: &crate::fe::CaseResult| {
        vec![
            case.subcase.to_string(),
            case.label.clone(),
            case.shells.elements.len().to_string(),
            if case.shells.from_stress {
                "stress"
            } else {
                "strain"
            }
            .to_owned(),
            case.beams.elements.len().to_string(),
        ]
    };
    let cases: Vec<Vec<String>> = solution.cases.iter().map(of_case).collect();
    let head = ["subcase", "label", "shells", "read from", "bars and beams"];
    let mut sections = vec![Section::new(
        "Subcases",
        vec![
            Block::Text(format!(
                "From {}. Every row is in strains.csv.",
                solution.source
            )),
            Block::table(&head, cases),
        ],
    )];
    sections.push(scene_section(
        "Strain on the model",
        &scene_of_solution(model, &[], solution),
    ));
    for case in solution.cases.iter().take(MOST_CASES) {
        let rows: Vec<Vec<String>> = largest_strain_rows(model, case, HOTTEST)
            .iter()
            .map(line)
            .collect();
        let head = [
            "element",
            "type",
            "place",
            "surface",
            "largest in any direction, µε",
            "exx, µε",
            "eyy, µε",
            "gxy, µε",
        ];
        sections.push(Section::new(
            format!("Subcase {}: largest strain", case.subcase),
            vec![Block::table(&head, rows)],
        ));
    }
    if solution.cases.len() > MOST_CASES {
        let left = solution.cases.len() - MOST_CASES;
        sections.push(Section::new(
            "More subcases",
            vec![Block::Text(format!("{left} more are in strains.csv."))],
        ));
    }
    Page::new(
        title,
        "Strain in the element frame (gxy: engineering shear)",
        findings,
        sections,
    )
}

fn line(row: &StrainRow) -> Vec<String> {
    let place = match row.location {
        Location::Centre => "centre".to_owned(),
        Location::Grid(id) => format!("grid {id}"),
        Location::Station(x) => format!("x/xb {x}"),
    };
    let point = match row.point {
        Point::Surface(s) => s.word().to_owned(),
        Point::Recovery(p) => ["C", "D", "E", "F"]
            .get(p)
            .copied()
            .unwrap_or("")
            .to_owned(),
    };
    let value = |v: f64| match v.is_nan() {
        true => String::new(),
        false => number(1e6 * v),
    };
    let mut out = vec![row.element.to_string(), row.card.to_owned(), place, point];
    out.push(value(largest_strain(row)));
    out.extend(row.local.map(value));
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fe::strain_tensor::Surface;

    #[test]
    fn the_table_is_in_microstrain() {
        let row = StrainRow {
            element: 7,
            card: "CQUAD4",
            location: Location::Centre,
            point: Point::Surface(Surface::Bottom),
            local: [2e-6, 0.0, f64::NAN],
            basic: [0.0; 6],
        };
        assert_eq!(line(&row)[5..], ["2.000", "0", ""]);
    }
}
