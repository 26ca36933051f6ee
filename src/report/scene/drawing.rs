//! A scene as a part of a page: its switches, its data; for paper its lines and gauges.

use super::outline::{bars, outline};
use super::pack::packed_scene;
use super::part::Part;
use super::planning_tools::{result, tools};
use super::skin::{Finest, skin};
use super::still_picture::draw_still;
use super::types::{FieldValues, PickTargets, Scene};
use super::view::SceneView;
use crate::report::figure::embed_data;
use crate::report::page::{Block, Section};
use maud::{Markup, html};

/// Returns the section with the scene. The colour of strain is the largest principal strain by magnitude, at the surfaces of shells and at the centre
/// of solids.
pub fn scene_section(title: &str, scene: &Scene) -> Section {
    let finest = match scene.pointing {
        PickTargets::Places(_) => Finest::Always,
        PickTargets::Gauges | PickTargets::Nothing => Finest::FewFields,
    };
    let parts = skin(scene.model, scene.fields.len(), finest);
    let faces = parts
        .iter()
        .flat_map(|p| p.faces.iter().map(|f| f.1.map(|c| p.grids[c as usize])));
    let mut lines = outline(scene.model, faces);
    let rods = bars(scene.model);
    let data = embed_data(&packed_scene(scene, &parts, &lines, &rods));
    let markup = html! {
        figure.plot.scene aria-label="the model in three dimensions" data-figure="scene" {
            (switches(scene, &parts))
            (tools(&scene.pointing, scene.marks.len()))
            div.canvas tabindex="0" role="application" aria-label="drag to turn, arrow keys too" {}
            div.bar {}
            p.pick aria-live="polite" { "Turn: drag. Zoom: two fingers, + and -, or the wheel after a click on the picture. Point at a gauge, an arrow or the surface, \
             or tap it." }
            (result(&scene.pointing))
            (data)
            figcaption.muted { (scene.caption) }
        }
        (note(scene, &parts, data.0.len()))
    };
    lines.extend(rods);
    let view = SceneView {
        markup,
        caption: scene.caption.clone(),
        still: draw_still(scene),
        lines,
        marks: scene.marks.clone(),
    };
    Section::new(title, vec![Block::Scene(view)])
}

fn switches(scene: &Scene, parts: &[Part]) -> Markup {
    let options = |names: Vec<&str>| {
        html! { @for (i, name) in names.iter().enumerate() { option value=(i) { (name) } } }
    };
    // Circles of a gap are best visible on plain grey. Colours that show the places of an effect take precedence.
    let shows_places = matches!(
        scene.fields.first().map(|f| &f.values),
        Some(FieldValues::Magnitudes(_))
    );
    let plain = scene.marks.iter().any(|m| m.gap.is_some()) && !shows_places;
    let signed = match scene.fields.iter().all(|f| f.values.is_signed()) {
        true => ", signed",
        false => "",
    };
    html! {
        div.controls {
            @if !scene.fields.is_empty() {
                label { (colour_quantity(scene)) " " select data-role="field" {
                    (options(scene.fields.iter().map(|f| f.name.as_str()).collect()))
                    option value="-1" selected[plain] { "off: colour by property" }
                } }
                label { "at " select data-role="side" {
                    option value="2" { "either side, the larger magnitude" }
                    option value="1" { "top (Z2)" (signed) }
                    option value="0" { "bottom (Z1)" (signed) }
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
                @for (view, word) in [("iso", "3D"), ("x", "front"), ("y", "side"), ("z", "top")] {
                    button type="button" data-view=(view) title=(view_title(view)) { (word) }
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

/// Returns the quantity that the colours show.
fn colour_quantity(scene: &Scene) -> &'static str {
    let mut signed = scene.fields.iter().map(|f| f.values.is_signed());
    let first = signed.next();
    match (first, signed.all(|s| Some(s) == first)) {
        (Some(false), true) => "Stress",
        (_, true) => "Strain",
        (_, false) => "Colour",
    }
}

fn view_title(view: &str) -> String {
    match view {
        "iso" => "from a corner".to_owned(),
        axis => format!("look along {axis}"),
    }
}

fn note(scene: &Scene, parts: &[Part], bytes: usize) -> Markup {
    let all: usize = parts.iter().map(|p| p.faces.len()).sum();
    let drawn: usize = parts.iter().map(|p| p.drawn.triangles.len()).sum();
    let whole = parts.iter().all(|p| p.drawn.whole);
    html! {
        p.muted {
            @if scene.marks.iter().any(|m| m.axes.is_some()) { "Strokes are along the axes of the gauges: red on the top (Z2), blue on the bottom (Z1) of the element. " }
            @if scene.fields.iter().any(|f| matches!(f.values, FieldValues::Strain(_))) { "Colour: the largest principal strain by magnitude, from the centres of the elements. " }
            @if scene.fields.iter().any(|f| matches!(f.values, FieldValues::Magnitudes(_))) { "Colour: " (scene.fields.first().map_or("", |f| f.name.as_str())) ", from the centres of the elements. " }
            @if !scene.arrows.is_empty() { "Arrows end at the point of the load: green forces, violet moments (right-hand rule); lengths compare within a kind. " }
            @if !whole { "The picture is coarser than the model and shows the largest of the combined strains. No result depends on it. "
                @if matches!(scene.pointing, PickTargets::Places(_)) { "Brush and box select elements of the model by their centres. " }
                @if scene.pointing != PickTargets::Nothing && !scene.marks.is_empty() { "A dragged gauge is placed on the elements of the model by their centres, not on the picture. " }
            }
            span data-role="size" { (drawn) " triangles for " (all) " faces, " (bytes.div_ceil(1000)) " kB of this page." }
        }
    }
}
