//! The gluing sheet to print: a card for each gauge, with a sketch of its place and instructions in workshop terms.

use super::tables::corner_distances;
use crate::model::{Model, Shell, Vec3};
use crate::placement::Role;
use crate::report::drawing::picture::{Picture, Shape};
use crate::report::drawing::round_step;
use crate::report::page::{Block, Card, Page, Section, number};
use crate::report::scene::{Scene, still_of};
use crate::workflow::place::PlacedGauge;

/// Width and height of a sketch, mm.
const SKETCH: [f64; 2] = [84.0, 46.0];
/// Half the width of what a sketch shows, in sizes of the element.
const AROUND: f64 = 5.0;
/// Minimum cosine between two normals: the element then faces the same way as the element of the gauge.
const SAME_FACE: f64 = 0.7;

/// Returns `gluing_sheet.html`: the model with all gauges, then a card for each gauge. The sketch shows the gauge from outside.
pub fn gluing_page(title: &str, placed: &[PlacedGauge], scene: &Scene) -> Page {
    let model = scene.model;
    let overview = Card {
        title: "All gauges".to_owned(),
        text: "Red: on the top (Z2) of the element. Blue: on the bottom (Z1). Strokes are along the axes of the gauges.".to_owned(),
        ..Card::of_picture(still_of(scene))
    };
    let cards = placed.iter().map(|p| card(model, p, scene.length));
    let sections = vec![
        Section::new("Overview", vec![Block::Cards(vec![overview])]),
        Section::new("Gauges", vec![Block::Cards(cards.collect())]),
    ];
    let lead = format!(
        "Positions are in the basic frame of the deck, lengths in {}. Each sketch shows the gauge from outside. Budgets are the errors of \
         angle and place that change some load by 5 % of its expected size.",
        match scene.length {
            "" => "the unit of the deck",
            unit => unit,
        }
    );
    let page = Page::new(&format!("Gluing sheet: {title}"), &lead, &[], sections);
    page.with_summary(format!(
        "{} gauges to glue. Tick each one with its final place and angle.",
        placed.len()
    ))
}

fn card(model: &Model, p: &PlacedGauge, length: &str) -> Card {
    let g = &p.gauge;
    let view = View::from_gauge(p);
    let corners = corner_distances(model, g);
    let corners = corners
        .iter()
        .map(|(id, d)| format!("{} from grid {id}", number(*d)));
    let corners: Vec<String> = corners.collect();
    let mut text = format!(
        "{}. {}.",
        place_in_words(model, p, length),
        view.axis_in_words(g.direction)
    );
    if p.role == Role::Validation {
        text.push_str(" For validation: its reading is never used for loads.");
    }
    if !corners.is_empty() {
        text.push_str(&format!(
            " Element {} ({}): {}.",
            g.element,
            g.surface.word(),
            corners.join(", ")
        ));
    }
    let budget = |b: Option<f64>, unit: &str| match b {
        Some(v) => format!("{v:.2} {unit}").trim_end().to_owned(),
        None => "any".to_owned(),
    };
    let x = g.position;
    Card {
        title: format!("{}, {}", g.name, p.bridge),
        text,
        numbers: vec![
            (
                [x.x, x.y, x.z].map(format_tenths).join(", "),
                format!("x, y, z, {length}")
                    .trim_end_matches(", ")
                    .to_owned(),
            ),
            (
                format!("{:.0} µε", p.expected_microstrain),
                "under the expected loads".to_owned(),
            ),
            (
                budget(p.position_budget, length),
                "budget of place".to_owned(),
            ),
            (
                budget(p.angle_budget_deg, "°"),
                "budget of angle".to_owned(),
            ),
        ],
        ..Card::of_picture(sketch(model, p, &view))
    }
}

/// One digit after the point; nothing is written as -0.
fn format_tenths(v: f64) -> String {
    format!("{:.1}", (v * 10.0).round() / 10.0 + 0.0)
}

/// Directions to the right and up, for a view of the gauge from outside.
struct View {
    right: Vec3,
    up: Vec3,
}

impl View {
    fn from_gauge(p: &PlacedGauge) -> Self {
        let out = p.gauge.outward();
        // On a horizontal face, the y axis points up in the view.
        let upright = match out.z.abs() > 0.9 {
            true => Vec3::new(0.0, 1.0, 0.0),
            false => Vec3::new(0.0, 0.0, 1.0),
        };
        let up = (upright - out * upright.dot(&out)).normalize();
        Self {
            right: up.cross(&out),
            up,
        }
    }

    /// Describes the axis of a gauge in the view, by the basic axes that point right and up.
    fn axis_in_words(&self, axis: Vec3) -> String {
        let degrees = axis.dot(&self.up).atan2(axis.dot(&self.right)).to_degrees();
        let degrees = (degrees + 180.0).rem_euclid(180.0);
        let (right, up) = (direction(self.right), direction(self.up));
        match degrees.round() as i32 {
            0 | 180 => format!("Axis along {right}"),
            90 => format!("Axis along {up}"),
            d if d < 90 => format!("Axis {d}° from {right} towards {up}"),
            d => format!(
                "Axis {}° from {} towards {up}",
                180 - d,
                direction(-self.right)
            ),
        }
    }
}

/// The axis of the basic frame that a direction is nearest to, with its sign.
fn direction(v: Vec3) -> String {
    let parts = [(v.x, 'x'), (v.y, 'y'), (v.z, 'z')];
    let most = parts.iter().max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
    most.map_or_else(String::new, |(v, axis)| {
        format!("{}{axis}", if *v < 0.0 { '-' } else { '+' })
    })
}

/// Part, face and distances from the ends of the part: `Inner face of RailLeft (towards -y), 40 above its lower end`.
fn place_in_words(model: &Model, p: &PlacedGauge, length: &str) -> String {
    let g = &p.gauge;
    let out = g.outward();
    let ix = model.shell_ix(g.element);
    let Some(own) = ix.and_then(|ix| model.shells.get(ix.us())) else {
        return format!("On element {}", g.element);
    };
    let alike = || model.shells.iter().filter(|s| s.property == own.property);
    let id = model.shell_properties.get(own.property.us()).map(|q| q.id);
    let name = model.property_names.iter().find(|n| Some(n.0) == id);
    let part = match (name, id) {
        (Some((_, name)), _) => name.clone(),
        (None, Some(id)) => format!("property {id}"),
        (None, None) => "the part".to_owned(),
    };
    let centre = model.grids.iter().fold(Vec3::zeros(), |a, g| a + g.x);
    let centre = centre / model.grids.len().max(1) as f64;
    let mut inwards = centre - g.position;
    inwards.z = 0.0;
    let face = match out.z {
        z if z > SAME_FACE => "Upper",
        z if z < -SAME_FACE => "Lower",
        _ if out.dot(&inwards) > 0.0 => "Inner",
        _ => "Outer",
    };
    let mut low = Vec3::repeat(f64::INFINITY);
    let mut high = Vec3::repeat(f64::NEG_INFINITY);
    for x in alike().flat_map(|s| corners(model, s)) {
        low = low.inf(&x);
        high = high.sup(&x);
    }
    let largest = (high - low).amax();
    let unit = match length {
        "" => String::new(),
        unit => format!(" {unit}"),
    };
    // A direction in which the part is thin gives no useful distance from an end.
    let ways = (0..3).filter(|&k| high[k] - low[k] > 0.02 * largest && out[k].abs() < SAME_FACE);
    let ways = ways.map(|k| {
        let (from_low, from_high) = (g.position[k] - low[k], high[k] - g.position[k]);
        let (far, end) = match (k, from_low <= from_high) {
            (2, true) => (from_low, "above its lower end".to_owned()),
            (2, false) => (from_high, "below its upper end".to_owned()),
            (k, true) => (from_low, format!("from its -{} end", ['x', 'y', 'z'][k])),
            (k, false) => (from_high, format!("from its +{} end", ['x', 'y', 'z'][k])),
        };
        format!("{}{unit} {end}", number(far.max(0.0)))
    });
    let ways: Vec<String> = ways.collect();
    let mut words = format!("{face} face of {part} (towards {})", direction(out));
    for way in ways {
        words.push_str(&format!(", {way}"));
    }
    if let Some((id, v)) = &p.reference {
        let v = v.map(format_tenths).join(", ");
        words.push_str(&format!(". From {id}: {v}"));
    }
    words
}

fn corners<'a>(model: &'a Model, s: &'a Shell) -> impl Iterator<Item = Vec3> + 'a {
    let ids = s.grids.iter().take(s.shape.n_corners());
    ids.filter_map(|ix| Some(model.grids.get(ix.us())?.x))
}

/// The elements around a gauge that face its way, its own darker, and the gauge as a stroke along its axis.
fn sketch(model: &Model, p: &PlacedGauge, view: &View) -> Picture {
    let g = &p.gauge;
    let own = model.shell_ix(g.element);
    let size = own
        .and_then(|ix| model.shells.get(ix.us()))
        .map_or(1.0, |s| {
            let far = corners(model, s).map(|x| (x - g.position).norm());
            far.fold(0.0, f64::max)
        });
    let reach = AROUND * size.max(f64::MIN_POSITIVE);
    let scale = SKETCH[1] / (2.0 * reach);
    let flat = |x: Vec3| {
        let d = x - g.position;
        [
            SKETCH[0] / 2.0 + scale * d.dot(&view.right),
            SKETCH[1] / 2.0 - scale * d.dot(&view.up),
        ]
    };
    let inside =
        |q: [f64; 2]| (0.0..=SKETCH[0]).contains(&q[0]) && (0.0..=SKETCH[1]).contains(&q[1]);
    let mut picture = Picture {
        size: SKETCH,
        ..Picture::default()
    };
    let mut lines = Vec::new();
    for s in &model.shells {
        let points: Vec<Vec3> = corners(model, s).collect();
        let [a, b, c, rest @ ..] = points.as_slice() else {
            continue;
        };
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0);
        let faces = normal.is_some_and(|n| n.dot(&g.normal).abs() > SAME_FACE);
        let depth = (a - g.position).dot(&g.normal).abs();
        let drawn: Vec<[f64; 2]> = points.iter().map(|x| flat(*x)).collect();
        if !faces || depth > size || !drawn.iter().all(|q| inside(*q)) {
            continue;
        }
        let colour = match s.id == g.element {
            true => "#f3dc8e",
            false => "#e6ebf0",
        };
        let mut face = |k: [usize; 3]| {
            let corners = k.map(|i| drawn.get(i).copied().unwrap_or_default());
            picture.shapes.push(Shape::Face {
                corners,
                colour: colour.to_owned(),
            });
        };
        face([0, 1, 2]);
        if !rest.is_empty() {
            face([0, 2, 3]);
        }
        let mut line = drawn.clone();
        line.extend(drawn.first().copied());
        lines.push(line);
    }
    picture.strokes(lines, "#9aa7b5", 0.25);
    let along = [g.direction.dot(&view.right), -g.direction.dot(&view.up)];
    let end = |s: f64| [0, 1].map(|k| SKETCH[k] / 2.0 + s * along[k]);
    picture.line(end(-7.0), end(7.0), "#b2182b", 0.9);
    picture.circle(end(0.0), 1.0, "#b2182b", 0.0);
    // Two arrows show the directions right and up of the view. A bar shows the scale.
    let corner = [6.0, SKETCH[1] - 6.0];
    let tips = [[corner[0] + 12.0, corner[1]], [corner[0], corner[1] - 12.0]];
    for (tip, v) in tips.iter().zip([view.right, view.up]) {
        picture.line(corner, *tip, "#1c2530", 0.5);
        let at = [tip[0] + 1.5, tip[1] + 1.0];
        picture.word(at, [0.0, 1.0], &direction(v));
    }
    let bar = round_step(reach / 4.0);
    let y = SKETCH[1] - 4.0;
    let to = SKETCH[0] - 4.0;
    picture.line([to - scale * bar, y], [to, y], "#1c2530", 0.8);
    picture.word([to, y - 1.5], [1.0, 1.0], &number(bar));
    picture
}
