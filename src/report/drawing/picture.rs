//! Pictures of lines, areas and text, in millimetres from the upper left corner.

/// Picture with title and caption.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::report) struct Picture {
    /// Title above the picture.
    pub(in crate::report) title: String,
    /// Caption under the picture.
    pub(in crate::report) caption: String,
    /// Width and height.
    pub(in crate::report) size: [f64; 2],
    /// Shapes, from the lowest to the topmost.
    pub(in crate::report) shapes: Vec<Shape>,
}

/// Part of a picture.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::report) enum Shape {
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
    /// A filled polygon.
    Region(Vec<[f64; 2]>, String),
    /// A filled triangle.
    Face {
        /// Corners.
        corners: [[f64; 2]; 3],
        /// Colour, `#rrggbb`.
        colour: String,
    },
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
    /// Text.
    Word(Word),
}

/// Text at a point.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::report) struct Word {
    /// Position.
    pub(in crate::report) at: [f64; 2],
    /// Anchor: fraction of the width and height of the text that is at the position, 0 the beginning, 1 the end.
    pub(in crate::report) anchor: [f64; 2],
    /// Text.
    pub(in crate::report) text: String,
    /// Size of type, points.
    pub(in crate::report) size: f64,
    /// Whether the text runs upwards.
    pub(in crate::report) upwards: bool,
}

/// Grey of the background.
pub(in crate::report) const FAINT: &str = "#9aa7b5";
/// Nearly black.
pub(in crate::report) const INK: &str = "#1c2530";

/// Width of a drawing, mm. It equals the text width of A4 with margins of 18 mm.
pub(in crate::report) const UPRIGHT: f64 = 174.0;

/// Largest number of characters of a name in a drawing.
pub(in crate::report) const LONGEST: usize = 40;

impl Picture {
    /// Whether the picture shows a model. Its texts are the names of gauges and the colour range, which the caption also contains.
    pub(in crate::report) fn is_model(&self) -> bool {
        let is_face = |s: &Shape| matches!(s, Shape::Face { .. });
        self.shapes.iter().any(is_face)
    }

    /// Adds a line from `a` to `b`.
    pub(in crate::report) fn line(&mut self, a: [f64; 2], b: [f64; 2], colour: &str, pen: f64) {
        self.strokes(vec![vec![a, b]], colour, pen);
    }

    /// Adds lines with one pen.
    pub(in crate::report) fn strokes(&mut self, lines: Vec<Vec<[f64; 2]>>, colour: &str, pen: f64) {
        self.shapes.push(Shape::Strokes {
            lines,
            colour: colour.to_owned(),
            pen,
        });
    }

    /// Adds a circle. It is an outline with the width of the pen, or filled if the width is 0.
    pub(in crate::report) fn circle(&mut self, at: [f64; 2], radius: f64, colour: &str, pen: f64) {
        self.shapes.push(Shape::Circle {
            at,
            radius,
            colour: colour.to_owned(),
            pen,
        });
    }

    /// Adds text of 7 points.
    pub(in crate::report) fn word(&mut self, at: [f64; 2], anchor: [f64; 2], text: &str) {
        self.shapes.push(Shape::Word(Word {
            at,
            anchor,
            text: shorten_to(text, LONGEST),
            size: 7.0,
            upwards: false,
        }));
    }

    /// Adds text of 7 points that runs upwards.
    pub(in crate::report) fn word_upwards(&mut self, at: [f64; 2], anchor: [f64; 2], text: &str) {
        self.word(at, anchor, text);
        if let Some(Shape::Word(w)) = self.shapes.last_mut() {
            w.upwards = true;
        }
    }
}

/// Returns at most `most` characters on one line. A mark shows an omitted end.
pub(in crate::report) fn shorten_to(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        return text.to_owned();
    }
    let kept: String = text.chars().take(most.saturating_sub(1)).collect();
    format!("{kept}…")
}
