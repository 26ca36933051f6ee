//! A scene as a still picture: what it shows before anybody turns it. For pages without scripts and for small pictures of a result.

use super::paint::Values;
use super::skin::skin_within;
use super::types::{Arrow, Field, FieldValues, Scene, Twist};
use crate::model::Vec3;
use crate::report::drawing::picture::{Picture, Shape, UPRIGHT};
use crate::report::drawing::{Look, marks};
use crate::units::number;

/// Largest number of triangles of a still: the page contains its bytes in addition to the bytes of the scene.
const TRIANGLES: usize = 2_400;
/// Highest still, and space around the model for names, mm.
const HIGH: f64 = 105.0;
const AROUND: f64 = 7.0;
/// Towards the eye, as the scene begins.
const EYE: [f64; 3] = [1.1, -1.5, 0.95];
/// Colours of magnitudes from 0 to the largest; numbers of distinct steps of a value and of light.
const RAMP: [[f64; 3]; 5] = [
    [230.0, 235.0, 240.0],
    [243.0, 220.0, 142.0],
    [240.0, 160.0, 75.0],
    [209.0, 73.0, 46.0],
    [122.0, 15.0, 29.0],
];
const VALUES: f64 = 12.0;
const LIGHTS: f64 = 4.0;
/// Colour without a field.
const GREY: [f64; 3] = [201.0, 209.0, 217.0];
/// Share of the values that the colour range covers. The few largest values would otherwise make all others look pale.
const COVERED: f64 = 0.99;
/// Longest arrow, share of the width of the picture.
const ARROW: f64 = 0.1;

/// A triangle to be painted.
struct Face {
    corners: [[f64; 2]; 3],
    depth: f64,
    colour: [u8; 3],
}

/// Returns the picture: faces from the farthest to the nearest, the first field as colour, the first loads as arrows, all gauges.
pub(in crate::report) fn draw_still(scene: &Scene) -> Picture {
    let eye = Vec3::from(EYE).normalize();
    let right = Vec3::new(-eye.y, eye.x, 0.0).normalize();
    let up = eye.cross(&right);
    let flat = |x: Vec3| [x.dot(&right), -x.dot(&up)];
    let parts = skin_within(scene.model, TRIANGLES);
    let at = |part: &super::part::Part, vertex: u32| {
        let grid = part.grids[part.drawn.vertices[vertex as usize] as usize];
        scene.model.grids.get(grid.us()).map(|g| g.x)
    };
    let field = shown_field(scene);
    let values = field.map(|f| Values::of_field(scene.model, &f.values));
    let colours: Vec<Vec<f64>> = parts
        .iter()
        .map(|p| match &values {
            Some(v) => larger_of_sides(v.strain_at_vertices(p)),
            None => Vec::new(),
        })
        .collect();
    let most = colour_limit(&colours);
    let mut faces = Vec::new();
    for (part, values) in parts.iter().zip(&colours) {
        for t in &part.drawn.triangles {
            let [Some(a), Some(b), Some(c)] = t.map(|v| at(part, v)) else {
                continue;
            };
            let normal = (b - a).cross(&(c - a)).try_normalize(0.0);
            let light = normal.map_or(0.0, |n| n.dot(&eye).abs());
            let value = t.map(|v| values.get(v as usize).copied().unwrap_or(f64::NAN));
            faces.push(Face {
                corners: [a, b, c].map(flat),
                depth: (a + b + c).dot(&eye),
                colour: colour(value.iter().sum::<f64>() / 3.0 / most, light),
            });
        }
    }
    faces.sort_by(|a, b| a.depth.total_cmp(&b.depth));
    let bars: Vec<[[f64; 2]; 2]> = super::outline::bars(scene.model)
        .iter()
        .map(|l| l.map(flat))
        .collect();
    let frame = Frame::fit_points(
        (faces.iter().flat_map(|f| f.corners))
            .chain(bars.iter().flatten().copied())
            .chain(scene.marks.iter().map(|m| flat(m.at))),
        match scene.arrows.is_empty() {
            true => AROUND,
            false => AROUND.max(UPRIGHT * ARROW),
        },
    );
    let place = |x: Vec3| frame.place(flat(x));
    let mut picture = Picture {
        size: [UPRIGHT, frame.tall + 2.0 * frame.above],
        ..Picture::default()
    };
    let lines = bars.iter().map(|l| l.map(|p| frame.place(p)).to_vec());
    picture.strokes(lines.collect(), "#7b8794", 0.4);
    picture.shapes.extend(faces.iter().map(|f| Shape::Face {
        corners: f.corners.map(|p| frame.place(p)),
        colour: format!("#{:02x}{:02x}{:02x}", f.colour[0], f.colour[1], f.colour[2]),
    }));
    arrows(&mut picture, scene, &place, &flat);
    marks(
        &mut picture,
        &scene.marks,
        &Look {
            place: &place,
            turn: &flat,
        },
    );
    if let Some(field) = field.filter(|_| most > 0.0) {
        let all = colours.iter().flatten().copied().filter(|v| v.is_finite());
        legend(&mut picture, field, [most, all.fold(most, f64::max)]);
    }
    picture
}

/// The field whose colours a scene begins with; plain grey shows circles of a gap best.
fn shown_field<'a, 'b>(scene: &'b Scene<'a>) -> Option<&'b Field<'a>> {
    let first = scene.fields.first()?;
    let has_gap = scene.marks.iter().any(|m| m.gap.is_some());
    (!has_gap || matches!(first.values, FieldValues::Magnitudes(_))).then_some(first)
}

/// The larger magnitude of both sides.
fn larger_of_sides([bottom, top]: [Vec<f64>; 2]) -> Vec<f64> {
    let of = |(a, b): (&f64, &f64)| a.abs().max(b.abs());
    bottom.iter().zip(&top).map(of).collect()
}

fn colour_limit(colours: &[Vec<f64>]) -> f64 {
    let mut sizes: Vec<f64> = colours.iter().flatten().copied().collect();
    sizes.retain(|v| v.is_finite());
    sizes.sort_by(f64::total_cmp);
    let at = (COVERED * sizes.len().saturating_sub(1) as f64) as usize;
    let end = sizes.last().copied().unwrap_or(1.0);
    match sizes.get(at) {
        Some(v) if *v > 0.0 => *v,
        _ if end > 0.0 => end,
        _ => 1.0,
    }
}

/// Returns the colour of a share of the largest value in light from the eye; `NaN` is a share without a value.
fn colour(share: f64, light: f64) -> [u8; 3] {
    let light = (light * LIGHTS).round() / LIGHTS;
    let (base, lit) = match share.is_finite() {
        true => {
            let s = (share.clamp(0.0, 1.0) * VALUES).round() / VALUES * 4.0;
            let k = (s as usize).min(3);
            let mix = |c: usize| RAMP[k][c] + (RAMP[k + 1][c] - RAMP[k][c]) * (s - k as f64);
            ([0, 1, 2].map(mix), 0.78 + 0.22 * light)
        }
        false => (GREY, 0.55 + 0.45 * light),
    };
    base.map(|v| (v * lit).round().clamp(0.0, 255.0) as u8)
}

/// Loads of the first set: a line that ends with its head where the load acts.
fn arrows(
    picture: &mut Picture,
    scene: &Scene,
    place: &dyn Fn(Vec3) -> [f64; 2],
    flat: &dyn Fn(Vec3) -> [f64; 2],
) {
    let Some(set) = scene.arrows.first() else {
        return;
    };
    let most = |twist: Twist| {
        let of_kind = set.arrows.iter().filter(|a| a.twist == twist);
        of_kind.map(|a| a.value.abs()).fold(0.0, f64::max)
    };
    let most = [Twist::Force, Twist::Moment].map(most);
    for a in &set.arrows {
        let (most, colour) = match a.twist {
            Twist::Force => (most[0], "#0b7a3e"),
            Twist::Moment => (most[1], "#7d3c98"),
        };
        if a.value == 0.0 || !a.value.is_finite() || most == 0.0 {
            continue;
        }
        arrow(picture, a, most, colour, (place, flat));
    }
}

fn arrow(
    picture: &mut Picture,
    a: &Arrow,
    most: f64,
    colour: &str,
    (place, flat): (&dyn Fn(Vec3) -> [f64; 2], &dyn Fn(Vec3) -> [f64; 2]),
) {
    let end = place(a.at);
    let along = flat(a.along * a.value.signum());
    let length = UPRIGHT * ARROW * (0.25 + 0.75 * a.value.abs() / most);
    let by = |s: f64, aside: f64| {
        [
            end[0] - s * along[0] - aside * along[1],
            end[1] - s * along[1] + aside * along[0],
        ]
    };
    picture.line(by(length, 0.0), end, colour, 0.7);
    picture.strokes(vec![vec![by(2.6, 1.1), end, by(2.6, -1.1)]], colour, 0.7);
}

/// The colours with their ends, at the lower left.
fn legend(picture: &mut Picture, field: &Field, most: [f64; 2]) {
    const CELL: f64 = 5.0;
    let y = picture.size[1] - 4.0;
    let steps = VALUES as usize;
    for i in 0..=steps {
        let [r, g, b] = colour(i as f64 / VALUES, 1.0);
        let area = [CELL * i as f64, y, CELL, 2.5];
        picture
            .shapes
            .push(Shape::Area(area, format!("#{r:02x}{g:02x}{b:02x}")));
    }
    let [covered, largest] = most.map(|v| number(v * field.scale));
    let words = match covered == largest {
        true => format!("0 to {covered} {}", field.unit),
        false => format!("0 to ≥ {covered}, largest {largest} {}", field.unit),
    };
    picture.caption = format!("Colours of {}: {words}.", field.name);
    picture.word(
        [CELL * (steps + 1) as f64 + 2.0, y + 1.25],
        [0.0, 0.5],
        &words,
    );
    picture.word([0.0, y - 1.2], [0.0, 1.0], &field.name);
}

/// Position and scale of the flat picture on the paper.
struct Frame {
    low: [f64; 2],
    scale: f64,
    aside: f64,
    above: f64,
    tall: f64,
}

impl Frame {
    /// Holds the points, with so much space above and below them.
    fn fit_points(points: impl Iterator<Item = [f64; 2]>, above: f64) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for p in points.filter(|p| p.iter().all(|v| v.is_finite())) {
            for k in 0..2 {
                low[k] = low[k].min(p[k]);
                high[k] = high[k].max(p[k]);
            }
        }
        let wide = [0, 1].map(|k| (high[k] - low[k]).max(0.0));
        let fit = |room: f64, side: f64| {
            if side > 0.0 {
                room / side
            } else {
                f64::INFINITY
            }
        };
        let scale = fit(UPRIGHT - 2.0 * AROUND, wide[0]).min(fit(HIGH, wide[1]));
        let scale = if scale.is_finite() { scale } else { 1.0 };
        let wide = wide.map(|w| if w.is_finite() { w } else { 0.0 });
        Self {
            low: low.map(|v| if v.is_finite() { v } else { 0.0 }),
            scale,
            aside: (UPRIGHT - wide[0] * scale) / 2.0,
            above,
            tall: wide[1] * scale,
        }
    }

    fn place(&self, p: [f64; 2]) -> [f64; 2] {
        [
            self.aside + self.scale * (p[0] - self.low[0]),
            self.above + self.scale * (p[1] - self.low[1]),
        ]
    }
}
