//! The page of `solve`: what was solved, how the loads balance, how slow loads must be.

use crate::fe::{Balance, Reaction, Reactions, Solution, SolveReport};
use crate::finding::Finding;
use crate::report::page::{Block, Page, Section, number, table_section};
use crate::report::scene::{Scene, scene_section};
use crate::units::{Quantity, UnitSystem};

/// Returns the page of a solution: size of the model and its factor, resultants of applied and inertia loads, first elastic modes. `system` is the
/// unit system of the model, if a job states it.
pub fn solution_page(
    title: &str,
    system: Option<UnitSystem>,
    solution: &Solution,
    report: &SolveReport,
    scene: &Scene,
    findings: &[Finding],
) -> Page {
    let units = Units::from_system(system);
    let rows = model_rows(report, &units);
    let mut sections = vec![table_section("Model", &["quantity", "value"], &rows, "")];
    sections.push(scene_section("Loads and strain", scene));
    if !report.balance.is_empty() {
        let rows: Vec<Vec<String>> = report
            .balance
            .iter()
            .flat_map(|b| balance_rows(solution, b, &units))
            .collect();
        let head = [
            "subcase",
            "",
            "FX",
            "FY",
            "FZ",
            "MX",
            "MY",
            "MZ",
            "left, share",
        ];
        sections.push(Section::new(
            "Balance",
            vec![
                Block::Text("Resultants about the centre of gravity, basic frame. Inertia loads are mass times the rigid acceleration from the applied \
                 loads; both add up to zero.".into()),
                Block::table(&head, rows),
            ],
        ));
    }
    if !report.reactions.is_empty() {
        sections.push(reactions_section(&report.reactions, &units));
    }
    if !report.modes.is_empty() {
        let rows: Vec<Vec<String>> = (1..)
            .zip(&report.modes)
            .map(|(i, f)| vec![i.to_string(), number(*f)])
            .collect();
        sections.push(Section::new(
            "Elastic modes",
            vec![
                Block::Text("For the structure as supported. Loads recovered by these strains must be below a third of the first frequency.".into()),
                Block::table(&["mode", "Hz"], rows),
            ],
        ));
    }
    Page::new(title, "Solution of the built-in solver", findings, sections)
}

/// Maximum number of grids shown for a support. `result.json` contains all of them.
const GRIDS_SHOWN: usize = 12;

/// Resultants of what acts and of the reactions, and the grids that carry most.
fn reactions_section(all: &[Reactions], units: &Units) -> Section {
    let mut rows = Vec::new();
    let mut row = |first: String, what: String, six: &[f64; 6]| {
        let mut row = vec![first, what];
        row.extend(six.iter().map(|v| number(*v)));
        rows.push(row);
    };
    for r in all {
        let of_loads = |what: &str| format!("{what}, {}", units.loads);
        row(r.subcase.to_string(), of_loads("acts"), &r.applied);
        row(String::new(), of_loads("reactions"), &r.total);
        let mut grids: Vec<&Reaction> = r.grids.iter().collect();
        let size = |g: &Reaction| g.force[..3].iter().map(|v| v * v).sum::<f64>();
        grids.sort_by(|a, b| size(b).total_cmp(&size(a)));
        for g in grids.into_iter().take(GRIDS_SHOWN) {
            row(
                String::new(),
                of_loads(&format!("grid {}", g.grid)),
                &g.force,
            );
        }
    }
    let head = ["subcase", "", "FX", "FY", "FZ", "MX", "MY", "MZ"];
    Section::new(
        "Reactions",
        vec![
            Block::Text("Of the supports, basic frame; resultants about its origin, then the grids with the largest reactions.".into()),
            Block::table(&head, rows),
        ],
    )
}

/// Names of the model's units.
struct Units {
    mass: String,
    length: String,
    /// Forces, then moments.
    loads: String,
    /// Units of accelerations: of a translation, then of a rotation.
    acceleration: String,
}

impl Units {
    /// Returns the names of the units of a system; the deck's own units if none is stated.
    fn from_system(system: Option<UnitSystem>) -> Self {
        let Some(system) = system else {
            return Self {
                mass: "deck's unit".into(),
                length: "deck's unit".into(),
                loads: "deck's units".into(),
                acceleration: "deck's units".into(),
            };
        };
        let name = |q: Quantity| system.unit(q).name;
        Self {
            mass: name(Quantity::Mass).into(),
            length: name(Quantity::Length).into(),
            loads: format!("{}, {}", name(Quantity::Force), name(Quantity::Moment)),
            acceleration: format!("{}, rad/s2", name(Quantity::Acceleration)),
        }
    }
}

fn model_rows(report: &SolveReport, units: &Units) -> Vec<Vec<String>> {
    let mut rows = vec![
        vec!["Grids".to_owned(), report.grids.to_string()],
        vec!["Unknowns".into(), report.dofs.to_string()],
        vec![
            "Entries of the factor".into(),
            report.factor_nonzeros.to_string(),
        ],
        vec!["Smallest pivot, of 1".into(), number(report.smallest_pivot)],
        vec![
            "Epsilon of the worst case, |u'(f - K u)| / |u'f|, before and after refinement".into(),
            report.epsilon.map(number).join(", "),
        ],
    ];
    if let Some(m) = &report.mass {
        rows.push(vec![format!("Mass, {}", units.mass), number(m.mass)]);
        let cg = [m.cg.x, m.cg.y, m.cg.z].map(number).join(", ");
        rows.push(vec![format!("Centre of gravity, {}", units.length), cg]);
    }
    rows
}

fn balance_rows(solution: &Solution, b: &Balance, units: &Units) -> [Vec<String>; 3] {
    let label = solution
        .cases
        .iter()
        .find(|c| c.subcase == b.subcase)
        .map_or("", |c| c.label.as_str());
    let row = |first: String, what: String, six: &[f64; 6], last: String| {
        let mut row = vec![first, what];
        row.extend(six.iter().map(|v| number(*v)));
        row.push(last);
        row
    };
    [
        row(
            format!("{} {label}", b.subcase),
            format!("Applied, {}", units.loads),
            &b.applied,
            String::new(),
        ),
        row(
            String::new(),
            format!("Inertia, {}", units.loads),
            &b.inertia,
            number(b.residual),
        ),
        row(
            String::new(),
            format!("Acceleration, {}", units.acceleration),
            &b.acceleration,
            String::new(),
        ),
    ]
}
