//! A scene as numbers in a page.

use super::paint::Values;
use super::part::{Owner, Part};
use super::planning_tools::script_data;
use super::types::{Arrow, Field, Mark, PickTargets, Scene, Twist};
use crate::fe::strain_tensor::Surface;
use crate::model::{Model, Vec3};
use crate::report::figure::{STEPS, packed_deltas, round_number, round_numbers, steps_of};
use serde_json::{Value, json};

/// Raster steps along the longest side of the drawn model. A millionth of it is finer than a pixel, and finer than the accuracy of gluing by hand.
const GRAIN: f64 = 1_048_576.0;
/// Raster steps in one step of the centres of shells, which is 1/16,384 of the longest side. Centres are needed for shells that can be picked but are
/// not drawn one by one.
const MIDDLE: f64 = 64.0;

/// Origin and step size of the packed coordinates.
struct Raster {
    origin: Vec3,
    step: f64,
}

impl Raster {
    fn from_extent(lo: Vec3, hi: Vec3) -> Self {
        let longest = (hi - lo).max();
        Self {
            origin: lo,
            step: if longest > 0.0 { longest / GRAIN } else { 1.0 },
        }
    }

    fn pack_points(&self, points: impl Iterator<Item = Vec3>) -> Value {
        let steps: Vec<i64> = points
            .flat_map(|p| {
                ((p - self.origin) / self.step)
                    .map(|v| v.round() as i64)
                    .data
                    .0[0]
            })
            .collect();
        packed_deltas(&steps, 3)
    }
}

/// Returns all data that `page/scene.js` draws.
pub(super) fn packed_scene(
    scene: &Scene,
    parts: &[Part],
    edges: &[[Vec3; 2]],
    rods: &[[Vec3; 2]],
) -> Value {
    let points = parts.iter().flat_map(|p| vertices(scene.model, p));
    let ends = edges.iter().chain(rods).flatten().copied();
    let (lo, hi) = extent(points.chain(ends).chain(scene.marks.iter().map(|m| m.at)));
    let raster = Raster::from_extent(lo, hi);
    json!({
        "size": round_number((hi - lo).norm()),
        "box": [three(lo), three(hi)],
        "origin": [lo.x, lo.y, lo.z],
        "step": raster.step,
        "middle_step": MIDDLE * raster.step,
        "length": scene.length,
        "steps": STEPS,
        "parts": parts.iter().map(|p| part(scene, p, &raster)).collect::<Vec<_>>(),
        "edges": raster.pack_points(edges.iter().flatten().copied()),
        "bars": raster.pack_points(rods.iter().flatten().copied()),
        "marks": scene.marks.iter().map(mark).collect::<Vec<_>>(),
        "fields": scene.fields.iter().map(|f| field(scene.model, f, parts)).collect::<Vec<_>>(),
        "arrows": scene.arrows.iter().map(|set| {
            json!({ "name": set.name, "list": set.arrows.iter().map(|a| arrow(a, scene)).collect::<Vec<_>>() })
        }).collect::<Vec<_>>(),
        "pointing": script_data(&scene.pointing),
    })
}

fn vertices<'a>(model: &'a Model, p: &'a Part) -> impl Iterator<Item = Vec3> + 'a {
    let at = |v: &u32| {
        let grid = p.grids[*v as usize];
        model.grids.get(grid.us()).map_or_else(Vec3::zeros, |g| g.x)
    };
    p.drawn.vertices.iter().map(at)
}

/// Points, faces (four corners, a triangle repeats its third), ids of grids; where something is planned, elements and properties too.
fn part(scene: &Scene, p: &Part, raster: &Raster) -> Value {
    let model = scene.model;
    let faces: Vec<i64> = if p.drawn.whole {
        p.faces.iter().flat_map(|f| f.1).map(i64::from).collect()
    } else {
        let triangles = p.drawn.triangles.iter();
        triangles
            .flat_map(|[a, b, c]| [*a, *b, *c, *c])
            .map(i64::from)
            .collect()
    };
    let id = |v: &u32| {
        let grid = model.grids.get(p.grids[*v as usize].us());
        grid.map_or(0, |g| i64::from(g.id))
    };
    let grids: Vec<i64> = p.drawn.vertices.iter().map(id).collect();
    let mut out = json!({
        "name": p.name, "whole": p.drawn.whole,
        "points": raster.pack_points(vertices(model, p)),
        "faces": packed_deltas(&faces, 4),
        "grids": packed_deltas(&grids, 1),
    });
    let shells: Option<Vec<[i64; 2]>> = p.faces.iter().map(|f| shell(model, f.0)).collect();
    if let (Some(shells), false) = (shells, scene.pointing == PickTargets::Nothing) {
        let column = |k: usize| packed_deltas(&shells.iter().map(|s| s[k]).collect::<Vec<_>>(), 1);
        out["elements"] = column(0);
        out["properties"] = column(1);
        if !p.drawn.whole {
            out["middles"] = middles(model, p, MIDDLE * raster.step);
        }
    }
    out
}

/// Returns the centres of the faces of a part that is drawn coarser. A row has the drawn vertex nearest to the centre, and the offset from it in
/// steps.
fn middles(model: &Model, p: &Part, step: f64) -> Value {
    let at = |grid: u32| {
        let grid = model.grids.get(p.grids[grid as usize].us());
        grid.map_or_else(Vec3::zeros, |g| g.x)
    };
    let row = |corners: &[u32; 4]| {
        let n = if corners[2] == corners[3] { 3 } else { 4 };
        let corners = &corners[..n];
        let middle = corners.iter().map(|g| at(*g)).sum::<Vec3>() / n as f64;
        let way = |v: u32| middle - at(p.drawn.vertices[v as usize]);
        let vertices = corners.iter().map(|g| p.drawn.vertex_of[*g as usize]);
        let nearest = vertices.min_by(|a, b| way(*a).norm().total_cmp(&way(*b).norm()));
        let vertex = nearest.unwrap_or(0);
        let [x, y, z] = (way(vertex) / step).map(|v| v.round() as i64).data.0[0];
        [i64::from(vertex), x, y, z]
    };
    let rows: Vec<i64> = p.faces.iter().flat_map(|f| row(&f.1)).collect();
    packed_deltas(&rows, 4)
}

/// Ids of a shell and of its property.
fn shell(model: &Model, owner: Owner) -> Option<[i64; 2]> {
    let Owner::Shell(i) = owner else { return None };
    let shell = model.shells.get(i)?;
    let property = model.shell_properties.get(shell.property.us());
    Some([shell.id, property.map_or(0, |p| p.id)].map(i64::from))
}

fn extent(points: impl Iterator<Item = Vec3>) -> (Vec3, Vec3) {
    let mut out: Option<(Vec3, Vec3)> = None;
    for x in points.filter(|x| x.iter().all(|v| v.is_finite())) {
        out = Some(out.map_or((x, x), |(lo, hi)| (lo.inf(&x), hi.sup(&x))));
    }
    out.unwrap_or((Vec3::zeros(), Vec3::new(1.0, 1.0, 1.0)))
}

fn three(v: Vec3) -> Vec<Value> {
    round_numbers([v.x, v.y, v.z])
}

fn mark(m: &Mark) -> Value {
    let side = match m.surface {
        Some(Surface::Bottom) => "bottom",
        _ => "top",
    };
    json!({
        "name": m.name, "at": three(m.at), "side": side, "note": m.note,
        "along": m.axes.map(|a| three(a[0])), "out": m.axes.map(|a| three(a[1])), "gap": m.gap.map(round_numbers),
    })
}

fn field(model: &Model, f: &Field, parts: &[Part]) -> Value {
    let values = Values::of_field(model, &f.values);
    let by_part: Vec<[Vec<f64>; 2]> = parts.iter().map(|p| values.strain_at_vertices(p)).collect();
    let all = by_part.iter().flatten().flatten();
    let most = all
        .filter(|v| v.is_finite())
        .fold(0.0, |a: f64, v| a.max(v.abs()));
    let packed: Vec<Value> = by_part
        .iter()
        .map(|sides| {
            json!(
                sides
                    .each_ref()
                    .map(|v| packed_deltas(&steps_of(v.iter().copied(), most), 1))
            )
        })
        .collect();
    json!({
        "name": f.name, "unit": f.unit, "signed": f.values.is_signed(), "step": round_number(most * f.scale / STEPS), "values": packed,
    })
}

fn arrow(a: &Arrow, scene: &Scene) -> Value {
    let of_kind = scene
        .arrows
        .iter()
        .flat_map(|s| &s.arrows)
        .filter(|b| b.twist == a.twist);
    let most = of_kind.map(|b| b.value.abs()).fold(0.0, f64::max);
    let share = if most > 0.0 { a.value / most } else { 0.0 };
    json!({
        "at": three(a.at), "along": three(a.along), "share": round_number(share), "label": a.label, "moment": a.twist == Twist::Moment,
    })
}
