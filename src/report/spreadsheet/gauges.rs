//! The gauge plan: place of each gauge, material for the technician, and expected readings.

use super::book::{Cell, Sheet};
use crate::model::Model;
use crate::report::strain::corner_distances;
use crate::sensitivity::Sensitivity;
use crate::strain_chain::LoadSigma;
use crate::workflow::place::{PlacedGauge, WorstLoss};

/// Returns the sheets `Gauges` (basic frame, the model's length unit), `Gluing sheet`, `Loads` and `Sensitivity` (microstrain per job unit of each
/// load).
pub fn gauge_sheets(
    placed: &[PlacedGauge],
    model: &Model,
    s: &Sensitivity,
    load_sigma: &[LoadSigma],
    worst: &WorstLoss,
) -> Vec<Sheet> {
    vec![
        plan(placed),
        gluing_sheet(placed, model),
        loads(load_sigma, worst),
        sensitivity(s),
    ]
}

fn loads(load_sigma: &[LoadSigma], worst: &WorstLoss) -> Sheet {
    let mut sheet = Sheet::new("Loads", &["load", "sigma", "sigma as glued", "unit"]);
    for l in load_sigma {
        sheet.rows.push(vec![
            l.name.clone().into(),
            l.sigma.into(),
            l.sigma_as_glued.unwrap_or(f64::NAN).into(),
            l.unit.clone().into(),
        ]);
    }
    sheet.rows.push(vec![
        format!("efficiency without gauge {}", worst.gauge).into(),
        worst.efficiency_left.into(),
    ]);
    sheet
}

fn plan(placed: &[PlacedGauge]) -> Sheet {
    let mut sheet = Sheet::new(
        "Gauges",
        &[
            "gauge",
            "element",
            "surface",
            "x",
            "y",
            "z",
            "axis x",
            "axis y",
            "axis z",
            "angle from element x axis, deg",
            "angle seen, deg",
            "leverage",
            "expected strain, microstrain",
            "bridge",
            "role",
        ],
    );
    for p in placed {
        let g = &p.gauge;
        let mut row: Vec<Cell> = vec![
            g.name.clone().into(),
            g.element.into(),
            g.surface.word().into(),
        ];
        let numbers = [
            g.position.x,
            g.position.y,
            g.position.z,
            g.direction.x,
            g.direction.y,
            g.direction.z,
            g.angle_rad.to_degrees(),
            p.angle_seen_deg,
            p.leverage,
            p.expected_microstrain,
        ];
        row.extend(numbers.map(Cell::from));
        row.extend([p.bridge, p.role.word()].map(Cell::from));
        sheet.rows.push(row);
    }
    sheet
}

fn gluing_sheet(placed: &[PlacedGauge], model: &Model) -> Sheet {
    let mut sheet = Sheet::new(
        "Gluing sheet",
        &[
            "gauge",
            "element",
            "side",
            "from",
            "dx",
            "dy",
            "dz",
            "outward x",
            "outward y",
            "outward z",
            "angle seen, deg",
            "expected strain, microstrain",
            "angle budget, deg",
            "position budget",
            "distance from corner grids",
            "glued by, date",
            "resistance, ohm",
        ],
    );
    for p in placed {
        let g = &p.gauge;
        let outward = g.outward();
        let (from, way) = p
            .reference
            .clone()
            .unwrap_or_else(|| (String::new(), [f64::NAN; 3]));
        let corners: Vec<String> = corner_distances(model, g)
            .iter()
            .map(|(id, d)| format!("{id}: {d:.1}"))
            .collect();
        sheet.rows.push(vec![
            g.name.clone().into(),
            g.element.into(),
            g.surface.word().into(),
            from.into(),
            way[0].into(),
            way[1].into(),
            way[2].into(),
            outward.x.into(),
            outward.y.into(),
            outward.z.into(),
            p.angle_seen_deg.into(),
            p.expected_microstrain.into(),
            p.angle_budget_deg.unwrap_or(f64::NAN).into(),
            p.position_budget.unwrap_or(f64::NAN).into(),
            corners.join(", ").into(),
        ]);
    }
    sheet
}

fn sensitivity(s: &Sensitivity) -> Sheet {
    let mut columns = vec!["gauge".to_owned()];
    columns.extend(
        s.loads
            .iter()
            .map(|l| format!("{}, microstrain per job unit", l.name)),
    );
    let rows = s.gauges.iter().enumerate().map(|(g, name)| {
        let mut row = vec![Cell::from(name.clone())];
        row.extend((0..s.loads.len()).map(|l| Cell::from(s.values[(g, l)] * 1e6)));
        row
    });
    Sheet {
        name: "Sensitivity".to_owned(),
        columns,
        rows: rows.collect(),
    }
}
