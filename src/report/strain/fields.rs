//! The page of `strains`: what was read, and where it is hot.

use crate::fe::Solution;
use crate::fe::strain_rows::{Location, Point, StrainRow, hottest, largest_strain};
use crate::finding::Finding;
use crate::model::Model;
use crate::report::page::{Section, number, page, table};
use maud::html;

/// Subcases and elements a subcase that the page lists; `strains.csv` holds all.
const MOST_CASES: usize = 40;
const HOTTEST: usize = 10;

/// Page of the strain fields of `solution`: numbers of elements by subcase, then the hottest elements of each.
pub fn strains_page(
    title: &str,
    model: &Model,
    solution: &Solution,
    findings: &[Finding],
) -> String {
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
    let mut sections = vec![Section {
        title: "Subcases".into(),
        body: html! {
            p { "From " (solution.source) ". Every row is in strains.csv." }
            (table(&["subcase", "label", "shells", "read from", "bars and beams"], &cases))
        },
    }];
    for case in solution.cases.iter().take(MOST_CASES) {
        let rows: Vec<Vec<String>> = hottest(model, case, HOTTEST).iter().map(line).collect();
        sections.push(Section {
            title: format!("Subcase {}: largest strain", case.subcase),
            body: html! {
                (table(&["element", "type", "place", "surface", "largest, any direction", "exx", "eyy", "gxy"], &rows))
            },
        });
    }
    if solution.cases.len() > MOST_CASES {
        sections.push(Section {
            title: "More subcases".into(),
            body: html! { p { (solution.cases.len() - MOST_CASES) " more are in strains.csv." } },
        });
    }
    page(
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
    let value = |v: f64| if v.is_nan() { String::new() } else { number(v) };
    let mut out = vec![row.element.to_string(), row.card.to_owned(), place, point];
    out.push(value(largest_strain(row)));
    out.extend(row.local.map(value));
    out
}
