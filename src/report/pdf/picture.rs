//! Drawings of lines, areas and words, in millimetres from the upper left corner.

use super::glyphs::shortened;
use serde_json::{Value, json};

/// A drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Picture {
    /// Above it.
    pub(super) title: String,
    /// Under it.
    pub(super) caption: String,
    /// Width and height.
    pub(super) size: [f64; 2],
    /// From the lowest to the topmost.
    pub(super) shapes: Vec<Shape>,
}

/// A part of a drawing.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shape {
    /// Lines of one pen.
    Strokes {
        /// Each through its points.
        lines: Vec<Vec<[f64; 2]>>,
        /// Colour, `#rrggbb`.
        colour: String,
        /// Width of the pen.
        pen: f64,
    },
    /// An upright rectangle: corner, width and height, filled.
    Area([f64; 4], String),
    /// A circle about a point: an outline where the pen is not 0, else filled.
    Circle {
        /// Centre.
        at: [f64; 2],
        /// Radius.
        radius: f64,
        /// Colour, `#rrggbb`.
        colour: String,
        /// Width of the pen.
        pen: f64,
    },
    /// Words.
    Word(Word),
}

/// Words at a point.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Word {
    /// Where.
    pub(super) at: [f64; 2],
    /// Which part of the words stands there, of their width and height: 0 the beginning, 1 the end.
    pub(super) anchor: [f64; 2],
    /// What.
    pub(super) text: String,
    /// Size of type, points.
    pub(super) size: f64,
    /// Whether they run upwards.
    pub(super) upwards: bool,
}

/// Grey of what stands back.
pub(super) const FAINT: &str = "#9aa7b5";
/// Nearly black.
pub(super) const INK: &str = "#1c2530";

/// Characters of a name in a drawing.
pub(super) const LONGEST: usize = 40;

impl Picture {
    /// A line from `a` to `b`.
    pub(super) fn line(&mut self, a: [f64; 2], b: [f64; 2], colour: &str, pen: f64) {
        self.strokes(vec![vec![a, b]], colour, pen);
    }

    /// Lines of one pen.
    pub(super) fn strokes(&mut self, lines: Vec<Vec<[f64; 2]>>, colour: &str, pen: f64) {
        self.shapes.push(Shape::Strokes {
            lines,
            colour: colour.to_owned(),
            pen,
        });
    }

    /// A circle: an outline of this pen, filled where it is 0.
    pub(super) fn circle(&mut self, at: [f64; 2], radius: f64, colour: &str, pen: f64) {
        self.shapes.push(Shape::Circle {
            at,
            radius,
            colour: colour.to_owned(),
            pen,
        });
    }

    /// Words of 7 points.
    pub(super) fn word(&mut self, at: [f64; 2], anchor: [f64; 2], text: &str) {
        self.shapes.push(Shape::Word(Word {
            at,
            anchor,
            text: shortened(text, LONGEST),
            size: 7.0,
            upwards: false,
        }));
    }

    /// The same, running upwards.
    pub(super) fn word_upwards(&mut self, at: [f64; 2], anchor: [f64; 2], text: &str) {
        self.word(at, anchor, text);
        if let Some(Shape::Word(w)) = self.shapes.last_mut() {
            w.upwards = true;
        }
    }

    /// For the template.
    pub(super) fn to_json(&self) -> Value {
        let shapes: Vec<Value> = self.shapes.iter().map(shape).collect();
        json!({
            "title": shortened(&self.title, 120),
            "caption": shortened(&self.caption, 200),
            "width": self.size[0],
            "height": self.size[1],
            "shapes": shapes,
        })
    }
}

fn shape(s: &Shape) -> Value {
    match s {
        Shape::Strokes { lines, colour, pen } => {
            let lines: Vec<Vec<[f64; 2]>> = lines.iter().map(|l| rounded(l)).collect();
            json!({ "kind": "strokes", "lines": lines, "colour": colour, "pen": pen })
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
            "kind": "word", "at": w.at, "anchor": w.anchor, "text": w.text, "size": w.size, "upwards": w.upwards,
        }),
    }
}

/// To the hundredth of a millimetre.
fn rounded(line: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let near = |v: f64| (v * 100.0).round() / 100.0;
    line.iter().map(|p| p.map(near)).collect()
}
