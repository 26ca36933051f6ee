//! A drawing for the template.

use super::glyphs::short_printable;
use crate::report::drawing::picture::{LONGEST, Picture, Shape};
use serde_json::{Value, json};

/// Returns the drawing as JSON. Every text in it is printable.
pub(super) fn picture_json(picture: &Picture) -> Value {
    let shapes: Vec<Value> = picture.shapes.iter().map(shape).collect();
    json!({
        "title": short_printable(&picture.title, 120),
        "caption": short_printable(&picture.caption, 200),
        "width": picture.size[0],
        "height": picture.size[1],
        "shapes": shapes,
    })
}

fn shape(s: &Shape) -> Value {
    match s {
        Shape::Strokes { lines, colour, pen } => {
            let lines: Vec<Vec<[f64; 2]>> = lines.iter().map(|l| round_points(l)).collect();
            json!({ "kind": "strokes", "lines": lines, "colour": colour, "pen": pen })
        }
        Shape::Face { corners, colour } => {
            json!({ "kind": "face", "corners": round_points(corners), "colour": colour })
        }
        Shape::Region(corners, colour) => {
            json!({ "kind": "face", "corners": round_points(corners), "colour": colour })
        }
        Shape::Area(area, colour) => json!({ "kind": "area", "area": area, "colour": colour }),
        Shape::Circle {
            at,
            radius,
            colour,
            pen,
        } => {
            json!({ "kind": "circle", "at": at, "radius": radius, "colour": colour, "pen": pen })
        }
        Shape::Word(w) => json!({
            "kind": "word", "at": w.at, "anchor": w.anchor, "text": short_printable(&w.text, LONGEST), "size": w.size, "upwards": w.upwards,
        }),
    }
}

/// To the hundredth of a millimetre.
fn round_points(line: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let near = |v: f64| (v * 100.0).round() / 100.0;
    line.iter().map(|p| p.map(near)).collect()
}
