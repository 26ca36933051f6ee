//! A drawing as SVG for a page, in whole tenths of a millimetre.

use super::picture::{Picture, Shape, Word};
use super::trails::trails;
use maud::{Markup, PreEscaped, html};
use std::fmt::Write;

/// Millimetres of a point of type, and height of capital letters, of the size of type.
const POINT: f64 = 25.4 / 72.0;
const CAPITAL: f64 = 0.7;

/// Returns the drawing as SVG. `label` is the text for readers who can't see the drawing.
pub(in crate::report) fn to_svg(picture: &Picture, label: &str) -> Markup {
    let [wide, high] = picture.size.map(round_to_tenths);
    let mut body = String::new();
    let mut shapes = picture.shapes.as_slice();
    while let Some(first) = shapes.first() {
        let alike = shapes.iter().take_while(|s| same_pen(first, s)).count();
        let (group, rest) = shapes.split_at(alike.max(1));
        body.push_str(&format_shapes(group));
        shapes = rest;
    }
    html! {
        svg viewBox=(format!("0 0 {wide} {high}")) role="img" aria-label=(label) fill="none" stroke-linecap="round" stroke-linejoin="round" {
            (PreEscaped(body))
        }
    }
}

fn round_to_tenths(mm: f64) -> i64 {
    (10.0 * mm).round() as i64
}

/// A length that needs finer steps, such as the width of a pen.
fn round_pen_width(mm: f64) -> f64 {
    (100.0 * mm).round() / 10.0
}

/// Returns whether two shapes are one path.
fn same_pen(a: &Shape, b: &Shape) -> bool {
    match (a, b) {
        (
            Shape::Strokes { colour, pen, .. },
            Shape::Strokes {
                colour: other,
                pen: wide,
                ..
            },
        ) => colour == other && pen == wide,
        (
            Shape::Circle {
                colour,
                pen,
                radius,
                ..
            },
            Shape::Circle {
                colour: other,
                pen: wide,
                radius: size,
                ..
            },
        ) => *pen == 0.0 && *wide == 0.0 && colour == other && radius == size,
        (Shape::Face { colour, .. }, Shape::Face { colour: other, .. }) => colour == other,
        _ => false,
    }
}

/// Shapes of one pen, one at least.
fn format_shapes(group: &[Shape]) -> String {
    let Some(first) = group.first() else {
        return String::new();
    };
    let element = match first {
        Shape::Strokes { colour, pen, .. } => {
            let lines = group.iter().flat_map(|s| match s {
                Shape::Strokes { lines, .. } => lines.as_slice(),
                _ => &[],
            });
            let lines = lines.map(|l| l.iter().map(|p| p.map(round_to_tenths)).collect());
            let d = path(&trails(lines.collect()));
            html! { path d=(d) stroke=(colour) stroke-width=(round_pen_width(*pen)) {} }
        }
        // A stroke in the fill colour closes the seams between neighbours.
        Shape::Face { colour, .. } => {
            let lines = group.iter().filter_map(|s| match s {
                Shape::Face { corners, .. } => {
                    Some(corners.map(|p| p.map(round_to_tenths)).to_vec())
                }
                _ => None,
            });
            let d = path(&lines.collect::<Vec<_>>());
            html! { path d=(d) fill=(colour) stroke=(colour) stroke-width="2" {} }
        }
        // A stroke of no length with a round pen is a dot.
        Shape::Circle {
            radius,
            colour,
            pen: 0.0,
            ..
        } => {
            let mut d = String::new();
            for shape in group {
                if let Shape::Circle { at, .. } = shape {
                    let [x, y] = at.map(round_to_tenths);
                    let _ = write!(d, "M{x} {y}h0");
                }
            }
            html! { path d=(d) stroke=(colour) stroke-width=(round_pen_width(2.0 * radius)) {} }
        }
        Shape::Circle {
            at,
            radius,
            colour,
            pen,
        } => {
            let [x, y] = at.map(round_to_tenths);
            html! { circle cx=(x) cy=(y) r=(round_pen_width(*radius)) stroke=(colour) stroke-width=(round_pen_width(*pen)) {} }
        }
        Shape::Region(corners, colour) => {
            let d = path(&[corners.iter().map(|p| p.map(round_to_tenths)).collect()]);
            html! { path d=(d) fill=(colour) {} }
        }
        Shape::Area([x, y, w, h], colour) => {
            let (x, y) = (round_pen_width(*x), round_pen_width(*y));
            html! { rect x=(x) y=(y) width=(round_pen_width(w.max(0.0))) height=(round_pen_width(h.max(0.0))) fill=(colour) {} }
        }
        Shape::Word(w) => word(w),
    };
    element.into_string()
}

/// Path data of polylines. The first point of each line is absolute, all further points are relative steps.
fn path(lines: &[Vec<[i64; 2]>]) -> String {
    let mut d = String::new();
    for line in lines {
        let Some(first) = line.first() else { continue };
        let _ = write!(d, "M{} {}", first[0], first[1]);
        let mut command = 'l';
        for (a, b) in line.iter().zip(line.iter().skip(1)) {
            let step = [b[0] - a[0], b[1] - a[1]];
            if step != [0, 0] {
                let _ = write!(d, "{command}{} {}", step[0], step[1]);
                command = ' ';
            }
        }
    }
    d
}

fn word(w: &Word) -> Markup {
    let size = w.size * POINT;
    let tall = CAPITAL * size;
    // Anchor of the text in the reading direction and across it.
    let (along, across) = match w.upwards {
        false => (w.anchor[0], w.anchor[1]),
        true => (1.0 - w.anchor[1], w.anchor[0]),
    };
    let anchor = match along {
        a if a < 0.25 => "start",
        a if a > 0.75 => "end",
        _ => "middle",
    };
    let base = (1.0 - across) * tall;
    let [x, y] = match w.upwards {
        false => [w.at[0], w.at[1] + base],
        true => [w.at[0] + base, w.at[1]],
    };
    let (x, y) = (round_to_tenths(x), round_to_tenths(y));
    let turn = w.upwards.then(|| format!("rotate(-90 {x} {y})"));
    html! {
        text x=(x) y=(y) font-size=(round_pen_width(size)) text-anchor=(anchor) transform=[turn] fill="#1c2530" { (w.text) }
    }
}
