//! A scene as a part of a page: its switches, its data; for paper its lines and gauges.

use super::outline::{bars, outline};
use super::paint::Values;
use super::part::Part;
use super::skin::skin;
use super::types::{Arrow, Field, Mark, Scene, Twist};
use super::view::SceneView;
use crate::fe::strain_tensor::Surface;
use crate::model::{Model, Vec3};
use crate::report::figure::{embedded, packed_f32, packed_i16, packed_u32, short, shorts};
use crate::report::page::{Block, Section};
use maud::{Markup, html};
use serde_json::{Value, json};

/// The section. Colour: the largest principal strain by magnitude at the surfaces of shells, at the centre of solids.
pub fn scene_section(title: &str, scene: &Scene) -> Section {
    let parts = skin(scene.model, scene.fields.len());
    let faces = parts
        .iter()
        .flat_map(|p| p.faces.iter().map(|f| f.1.map(|c| p.grids[c as usize])));
    let mut lines = outline(scene.model, faces);
    let rods = bars(scene.model);
    let data = data(scene, &parts, &lines, &rods);
    let markup = html! {
        figure.plot.scene aria-label="the model in three dimensions" data-figure="scene" {
            (switches(scene, &parts))
            div.canvas {}
            p.pick aria-live="polite" { "Turn: drag. Zoom: wheel or two fingers. Point at a gauge, an arrow or the surface, or tap it." }
            (embedded(&data))
        }
        (note(scene, &parts))
    };
    lines.extend(rods);
    let view = SceneView {
        markup,
        lines,
        marks: scene.marks.clone(),
    };
    Section::new(title, vec![Block::Scene(view)])
}

fn switches(scene: &Scene, parts: &[Part]) -> Markup {
    let options = |names: Vec<&str>| {
        html! { @for (i, name) in names.iter().enumerate() { option value=(i) { (name) } } }
    };
    // Circles of a gap are seen best on plain grey.
    let plain = scene.marks.iter().any(|m| m.gap.is_some());
    html! {
        div.controls {
            @if !scene.fields.is_empty() {
                label { "Strain " select data-role="field" {
                    (options(scene.fields.iter().map(|f| f.name.as_str()).collect()))
                    option value="-1" selected[plain] { "off: colour by property" }
                } }
                label { "at " select data-role="side" {
                    option value="2" { "either side, magnitude" }
                    option value="1" { "top (Z2), signed" }
                    option value="0" { "bottom (Z1), signed" }
                } }
            }
            @if !scene.arrows.is_empty() {
                label { "Loads " select data-role="arrows" {
                    (options(scene.arrows.iter().map(|a| a.name.as_str()).collect()))
                    option value="-1" { "off" }
                } }
            }
            @if !scene.marks.is_empty() {
                label { input type="checkbox" data-role="gauges" checked; " gauges" }
                label { input type="checkbox" data-role="names" checked[scene.marks.len() <= 60]; " names" }
            }
            label { input type="checkbox" data-role="edges" checked; " edges" }
            span.views {
                @for (view, word) in [("iso", "3D"), ("x", "x"), ("y", "y"), ("z", "z")] {
                    button type="button" data-view=(view) title=(format!("look along {view}")) { (word) }
                }
            }
            @if parts.len() > 1 {
                details { summary { (parts.len()) " properties" }
                    div.parts {
                        label { input type="checkbox" data-role="all" checked; " all" }
                        @for (i, p) in parts.iter().enumerate() {
                            label { input type="checkbox" data-part=(i) checked; " " (p.name) }
                        }
                    }
                }
            }
        }
    }
}

fn note(scene: &Scene, parts: &[Part]) -> Markup {
    let all: usize = parts.iter().map(|p| p.faces.len()).sum();
    let drawn: usize = parts.iter().map(|p| p.drawn.triangles.len()).sum();
    let whole = parts
        .iter()
        .all(|p| p.drawn.vertices.len() == p.grids.len());
    html! {
        p.muted {
            @if scene.marks.iter().any(|m| m.axes.is_some()) { "Strokes lie along the axes of the gauges: red on the top (Z2), blue on the bottom (Z1) of the element. " }
            @if !scene.fields.is_empty() { "Colour: the largest principal strain by magnitude, from the centres of the elements. " }
            @if !scene.arrows.is_empty() { "Arrows end where the load acts: green forces, violet moments (right-hand rule); a length compares within a kind. " }
            @if !whole { "The picture is coarser than the model: " (drawn) " triangles for " (all) " faces, of the strains drawn together the largest. Nothing was computed on it." }
        }
    }
}

fn data(scene: &Scene, parts: &[Part], edges: &[[Vec3; 2]], rods: &[[Vec3; 2]]) -> Value {
    let at = |p: &Part, v: u32| {
        let grid = p.grids[v as usize];
        scene
            .model
            .grids
            .get(grid.us())
            .map_or_else(Vec3::zeros, |g| g.x)
    };
    let shown: Vec<Value> = parts
        .iter()
        .map(|p| {
            let points: Vec<Vec3> = p.drawn.vertices.iter().map(|v| at(p, *v)).collect();
            let corner =
                |k: usize| packed_u32(&p.drawn.triangles.iter().map(|t| t[k]).collect::<Vec<_>>());
            json!({
                "name": p.name, "xyz": axes(&points), "ijk": [corner(0), corner(1), corner(2)],
                "grid": packed_u32(&ids(scene.model, p)),
            })
        })
        .collect();
    let points = parts
        .iter()
        .flat_map(|p| p.drawn.vertices.iter().map(|v| at(p, *v)));
    let ends = edges.iter().chain(rods).flatten().copied();
    let (lo, hi) = extent(points.chain(ends).chain(scene.marks.iter().map(|m| m.at)));
    json!({
        "size": short((hi - lo).norm()),
        "box": [three(lo), three(hi)],
        "parts": shown,
        "edges": axes(&strokes(edges)),
        "bars": axes(&strokes(rods)),
        "marks": scene.marks.iter().map(mark).collect::<Vec<_>>(),
        "fields": scene.fields.iter().map(|f| field(scene.model, f, parts)).collect::<Vec<_>>(),
        "arrows": scene.arrows.iter().map(|set| {
            json!({ "name": set.name, "list": set.arrows.iter().map(|a| arrow(a, scene)).collect::<Vec<_>>() })
        }).collect::<Vec<_>>(),
    })
}

fn ids(model: &Model, p: &Part) -> Vec<u32> {
    let id = |v: &u32| {
        model
            .grids
            .get(p.grids[*v as usize].us())
            .map_or(0, |g| g.id)
    };
    p.drawn.vertices.iter().map(id).collect()
}

fn extent(points: impl Iterator<Item = Vec3>) -> (Vec3, Vec3) {
    let mut out: Option<(Vec3, Vec3)> = None;
    for x in points.filter(|x| x.iter().all(|v| v.is_finite())) {
        out = Some(out.map_or((x, x), |(lo, hi)| (lo.inf(&x), hi.sup(&x))));
    }
    out.unwrap_or((Vec3::zeros(), Vec3::new(1.0, 1.0, 1.0)))
}

fn axes(points: &[Vec3]) -> Vec<Value> {
    (0..3)
        .map(|k| packed_f32(points.iter().map(|p| p[k])))
        .collect()
}

/// Ends of each line, with nothing between it and the next.
fn strokes(lines: &[[Vec3; 2]]) -> Vec<Vec3> {
    let gap = Vec3::new(f64::NAN, f64::NAN, f64::NAN);
    lines.iter().flat_map(|[a, b]| [*a, *b, gap]).collect()
}

fn three(v: Vec3) -> Vec<Value> {
    shorts([v.x, v.y, v.z])
}

fn mark(m: &Mark) -> Value {
    let side = match m.surface {
        Some(Surface::Bottom) => "bottom",
        _ => "top",
    };
    json!({
        "name": m.name, "at": three(m.at), "side": side, "note": m.note,
        "along": m.axes.map(|a| three(a[0])), "out": m.axes.map(|a| three(a[1])), "gap": m.gap.map(shorts),
    })
}

fn field(model: &Model, f: &Field, parts: &[Part]) -> Value {
    let values = Values::of(model, f.case);
    let by_part: Vec<[Vec<f64>; 2]> = parts.iter().map(|p| values.on(p)).collect();
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
                    .map(|v| packed_i16(v.iter().copied(), most))
            )
        })
        .collect();
    json!({ "name": f.name, "unit": f.unit, "step": short(most * f.scale / 32767.0), "values": packed })
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
        "at": three(a.at), "along": three(a.along), "share": short(share), "label": a.label, "moment": a.twist == Twist::Moment,
    })
}
