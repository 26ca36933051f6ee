//! Gluing sheet for the technician, to print: as markdown, and as a section of the plan's report.

use super::tables::corner_distances;
use crate::fe::strain_tensor::Surface;
use crate::model::{Model, Vec3};
use crate::placement::Role;
use crate::report::page::{Block, Section};
use crate::workflow::place::PlacedGauge;

const FRAME: &str = "Positions and directions are in the basic frame. The arrow `outward` points away from the side of the gauge.";
const STRAIN: &str =
    "Strain is the sum under the expected loads: choose the range of the amplifier above it.";
const BUDGETS: &str =
    "Budgets are the errors of angle and place that change some load by 5 % of its expected size.";
const CORNERS: &str = "Distance of each gauge from the corners of its element (grid: distance):";

/// Returns the heading of a column with the unit of length; without a unit if the deck states none.
pub(super) fn in_length(word: &str, length: &str) -> String {
    match length {
        "" => word.to_owned(),
        unit => format!("{word}, {unit}"),
    }
}

fn head(length: &str) -> [String; 12] {
    [
        "gauge".to_owned(),
        "element".to_owned(),
        "side".to_owned(),
        in_length("position", length),
        in_length("from", length),
        "axis".to_owned(),
        "outward".to_owned(),
        "angle seen, deg".to_owned(),
        "strain, microstrain".to_owned(),
        "wiring".to_owned(),
        "budget, deg".to_owned(),
        in_length("budget", length),
    ]
}

/// Returns the gluing sheet in markdown. `length` is the unit of the model.
pub fn gluing_sheet_md(title: &str, placed: &[PlacedGauge], model: &Model, length: &str) -> String {
    let head = head(length);
    let mut t = format!("# Gluing sheet: {title}\n\n{FRAME}\n{STRAIN}\n\n{BUDGETS}\n\n");
    t.push_str(&format!(
        "| {} |\n|{}\n",
        head.join(" | "),
        "---|".repeat(head.len())
    ));
    for p in placed {
        t.push_str(&format!("| {} |\n", row(p).join(" | ")));
    }
    t.push_str(&format!("\n{CORNERS}\n\n"));
    for p in placed {
        t.push_str(&format!("- {}: {}\n", p.gauge.name, corners(model, p)));
    }
    t
}

/// Returns the gluing sheet as a section of a report. `length` is the unit of the model.
pub(super) fn gluing_section(placed: &[PlacedGauge], model: &Model, length: &str) -> Section {
    let head = head(length);
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    let far = |p: &PlacedGauge| vec![p.gauge.name.clone(), corners(model, p)];
    let text = |t: &str| Block::Text(t.to_owned());
    Section::new(
        "Gluing sheet",
        vec![
            text(FRAME),
            text(STRAIN),
            text(BUDGETS),
            Block::table(&head, placed.iter().map(row).collect()),
            text(CORNERS),
            Block::table(
                &["gauge", &in_length("corners of its element", length)],
                placed.iter().map(far).collect(),
            ),
        ],
    )
}

fn row(p: &PlacedGauge) -> Vec<String> {
    let g = &p.gauge;
    let outward = match g.surface {
        Surface::Top => g.normal,
        Surface::Bottom => -g.normal,
    };
    let from = p.reference.as_ref().map_or(String::new(), |(id, v)| {
        format!("{id}: {:+.1} {:+.1} {:+.1}", v[0], v[1], v[2])
    });
    // Adding 0 turns -0 into 0.
    let plain = |v: f64, d: usize| {
        let ten = 10f64.powi(d as i32);
        format!("{:.d$}", (v * ten).round() / ten + 0.0)
    };
    let three =
        |v: Vec3, d: usize| format!("{} {} {}", plain(v.x, d), plain(v.y, d), plain(v.z, d));
    let budget = |b: Option<f64>| b.map_or("any".to_owned(), |v| format!("{v:.1}"));
    let role = match p.role {
        Role::Estimate => "",
        Role::Validation => ", validation",
    };
    vec![
        g.name.clone(),
        g.element.to_string(),
        g.surface.word().to_owned(),
        three(g.position, 1),
        from,
        three(g.direction, 3),
        three(outward, 3),
        format!("{:.1}", p.angle_seen_deg),
        format!("{:.0}", p.expected_microstrain),
        format!("{}{role}", p.bridge),
        budget(p.angle_budget_deg),
        budget(p.position_budget),
    ]
}

fn corners(model: &Model, p: &PlacedGauge) -> String {
    let list = corner_distances(model, &p.gauge);
    let list: Vec<String> = list.iter().map(|(id, d)| format!("{id}: {d:.1}")).collect();
    list.join(", ")
}
