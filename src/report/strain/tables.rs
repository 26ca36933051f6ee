//! CSV of gauges and of S.

use crate::fe::strain_tensor::Surface;
use crate::gauge::Gauge;
use crate::job::{JobGauge, StatedPlace};
use crate::model::Model;
use crate::report::csv_cell;
use crate::sensitivity::Sensitivity;
use crate::workflow::place::{PlacedGauge, StrainOfLoad};
use std::io::{self, Write};

/// Writes S in microstrain per job unit: `gauge`, then one column for each load.
///
/// # Errors
/// Errors of `out`.
pub fn sensitivity_csv(out: &mut dyn Write, s: &Sensitivity) -> io::Result<()> {
    write!(out, "gauge")?;
    for l in &s.loads {
        write!(out, ",{}", csv_cell(&l.name))?;
    }
    writeln!(out)?;
    for (g, name) in s.gauges.iter().enumerate() {
        write!(out, "{}", csv_cell(name))?;
        for l in 0..s.loads.len() {
            write!(out, ",{}", s.values[(g, l)] * 1e6)?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// First columns of `gauges.csv`.
pub const GAUGES_HEAD: &str = "name,element,surface,dir_x,dir_y,dir_z,angle_deg,x,y,z,bridge,angle_from_element_x_deg,angle_seen_deg,leverage,role,grid_length";

/// A column of `gauges.csv` that only named spots need: name, and its field for a spot.
type SpotColumn = (&'static str, fn(&JobGauge) -> Option<String>);

/// Columns of named spots that are written where a chosen spot states them.
const OF_SPOTS: [SpotColumn; 7] = [
    ("bridge_factor", |s| {
        (s.bridge_factor != 1.0).then(|| s.bridge_factor.to_string())
    }),
    ("transverse_sensitivity", |s| {
        let kt = s.transverse_sensitivity;
        (kt != 0.0).then(|| kt.to_string())
    }),
    ("element2", |s| s.pair.map(|p| p.0.to_string())),
    ("surface2", |s| Some(s.pair?.1?.word().to_owned())),
    ("point", |s| match s.place {
        StatedPlace::BeamPoint { point, .. } => {
            let letters = ["C", "D", "E", "F"];
            letters.get(usize::from(point)).map(|l| (*l).to_owned())
        }
        _ => None,
    }),
    ("station", |s| match s.place {
        StatedPlace::BeamPoint { station, .. } => Some(station.to_string()),
        _ => None,
    }),
    ("member", |s| {
        (!s.member.is_empty()).then(|| s.member.clone())
    }),
];

/// Writes gauges as a job can name them: `dir` is the axis itself, so that `angle_deg` is 0. Gauges have the grid length of the candidates, and named
/// spots have their stated grid length. A spot stated by its position has a blank `element`, because the position determines where its strain is
/// taken.
///
/// # Errors
/// Errors of `out`.
pub fn gauges_csv(out: &mut dyn Write, placed: &[PlacedGauge], grid_length: f64) -> io::Result<()> {
    let spots = || placed.iter().filter_map(|p| p.spot.as_ref());
    let more: Vec<SpotColumn> = OF_SPOTS
        .into_iter()
        .filter(|(_, field)| spots().any(|s| field(s).is_some()))
        .collect();
    write!(out, "{GAUGES_HEAD}")?;
    for (name, _) in &more {
        write!(out, ",{name}")?;
    }
    writeln!(out)?;
    for p in placed {
        let g = &p.gauge;
        let (d, x) = (g.direction, g.position);
        let stated = p.spot.as_ref().map(|s| s.place);
        let element = match stated {
            Some(StatedPlace::Position(..)) => String::new(),
            _ => g.element.to_string(),
        };
        let direction = match stated {
            Some(StatedPlace::BeamPoint { .. }) => ",,,".to_owned(),
            _ => format!("{},{},{},0", d.x, d.y, d.z),
        };
        write!(
            out,
            "{},{element},{},{direction},{},{},{},{},{:.4},{:.4},{:.6},{},{}",
            csv_cell(&g.name),
            g.surface.word(),
            x.x,
            x.y,
            x.z,
            p.bridge,
            g.angle_rad.to_degrees(),
            p.angle_seen_deg,
            p.leverage,
            p.role.word(),
            p.grid_length(grid_length)
        )?;
        for (_, field) in &more {
            let text = p.spot.as_ref().and_then(field).unwrap_or_default();
            write!(out, ",{}", csv_cell(&text))?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// Returns the grids of the element under a gauge, with the distance of the gauge from each grid.
pub(in crate::report) fn corner_distances(model: &Model, g: &Gauge) -> Vec<(u32, f64)> {
    let Some(shell) = model
        .shell_ix(g.element)
        .and_then(|ix| model.shells.get(ix.us()))
    else {
        return Vec::new();
    };
    shell
        .grids
        .iter()
        .take(shell.shape.n_corners())
        .filter_map(|ix| model.grids.get(ix.us()))
        .map(|grid| (grid.id, (grid.x - g.position).norm()))
        .collect()
}

/// Writes the table that the technician takes to the structure. The axis has all digits: a job that names this table as its gauges reads the same S.
///
/// # Errors
/// Errors of `out`.
pub fn gluing_sheet_csv(
    out: &mut dyn Write,
    placed: &[PlacedGauge],
    model: &Model,
    grid_length: f64,
) -> io::Result<()> {
    write!(
        out,
        "name,element,side,x,y,z,from_grid,dx,dy,dz,axis_x,axis_y,axis_z,outward_x,outward_y,outward_z,angle_seen_deg,expected_microstrain,corner_grids,corner_distances,bridge,role,angle_budget_deg,position_budget,grid_length"
    )?;
    for StrainOfLoad { name: load, .. } in placed.first().map_or(&[][..], |p| &p.strain_by_load) {
        write!(out, ",{}", csv_cell(&format!("range_{load}_microstrain")))?;
    }
    writeln!(out)?;
    for p in placed {
        let g = &p.gauge;
        let outward = match g.surface {
            Surface::Top => g.normal,
            Surface::Bottom => -g.normal,
        };
        let (grid, way) = p
            .reference
            .clone()
            .unwrap_or((String::new(), [f64::NAN; 3]));
        let way = way.map(|v| {
            if v.is_finite() {
                format!("{v:.2}")
            } else {
                String::new()
            }
        });
        let corners = corner_distances(model, g);
        let ids: Vec<String> = corners.iter().map(|c| c.0.to_string()).collect();
        let far: Vec<String> = corners.iter().map(|c| format!("{:.2}", c.1)).collect();
        let budget = |b: Option<f64>| b.map_or(String::new(), |v| format!("{v:.2}"));
        write!(
            out,
            "{},{},{},{:.3},{:.3},{:.3},{grid},{},{},{},{},{},{},{:.5},{:.5},{:.5},{:.1},{:.1},{},{},{},{},{},{},{}",
            csv_cell(&g.name),
            g.element,
            g.surface.word(),
            g.position.x,
            g.position.y,
            g.position.z,
            way[0],
            way[1],
            way[2],
            g.direction.x,
            g.direction.y,
            g.direction.z,
            outward.x,
            outward.y,
            outward.z,
            p.angle_seen_deg,
            p.expected_microstrain,
            ids.join(" "),
            far.join(" "),
            p.bridge,
            p.role.word(),
            budget(p.angle_budget_deg),
            budget(p.position_budget),
            p.grid_length(grid_length)
        )?;
        for s in &p.strain_by_load {
            write!(out, ",{:.1}", s.microstrain.abs())?;
        }
        writeln!(out)?;
    }
    Ok(())
}
