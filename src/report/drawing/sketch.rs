//! The model with its gauges as line pictures along the axes of the basic frame.

use super::picture::{INK, Picture, Shape, UPRIGHT, Word, shorten_to};
use super::scale::round_step;
use crate::fe::strain_tensor::Surface;
use crate::model::Vec3;
use crate::report::scene::{Mark, SceneView};
use crate::units::number;
use std::collections::{BTreeSet, HashMap};

/// Largest height of a picture, and space around it for names, mm.
const HIGH: f64 = 120.0;
const AROUND: f64 = 9.0;
/// Share of the longest side below which a picture shows nothing.
const FLAT: f64 = 0.02;
/// Colour of the model.
const MESH: &str = "#b4bec9";
/// Half length of the stroke of a gauge, and radius of the largest circle of a gap, mm.
const STROKE: f64 = 2.2;
const LARGEST: f64 = 5.0;

/// Caption of a drawing of gauges.
pub(in crate::report) const STROKES: &str = "Strokes are along the axes of the gauges: red on the top (Z2), blue on the bottom (Z1) of the element. The model in three dimensions is in report.html.";

/// A direction to look along: which axes run right and up, by sign, and its name.
struct View {
    right: (usize, f64),
    up: (usize, f64),
    name: &'static str,
}

const VIEWS: [View; 4] = [
    View {
        right: (0, 1.0),
        up: (1, 1.0),
        name: "Seen along −z: x to the right, y up",
    },
    View {
        right: (1, 1.0),
        up: (0, -1.0),
        name: "Seen along −z: y to the right, x down",
    },
    View {
        right: (0, 1.0),
        up: (2, 1.0),
        name: "Seen along y: x to the right, z up",
    },
    View {
        right: (1, 1.0),
        up: (2, 1.0),
        name: "Seen along −x: y to the right, z up",
    },
];

/// Returns the two pictures that show most, the larger first.
pub(in crate::report) fn views(scene: &SceneView) -> Vec<Picture> {
    let ends = scene.lines.iter().flatten().copied();
    let points = ends.chain(scene.marks.iter().map(|m| m.at));
    let mut bounds: Option<[Vec3; 2]> = None;
    for x in points.filter(|x| x.iter().all(|v| v.is_finite())) {
        bounds = Some(bounds.map_or([x, x], |[lo, hi]| [lo.inf(&x), hi.sup(&x)]));
    }
    let Some(bounds) = bounds else {
        return Vec::new();
    };
    let side = bounds[1] - bounds[0];
    // In the view from above, the longer side is horizontal.
    let turned = side.y > side.x;
    let mut chosen: Vec<&View> = VIEWS
        .iter()
        .enumerate()
        .filter(|(i, v)| {
            let seen = side[v.right.0].min(side[v.up.0]);
            seen > FLAT * side.max() && *i != usize::from(!turned)
        })
        .map(|(_, v)| v)
        .collect();
    let area = |v: &View| side[v.right.0] * side[v.up.0];
    chosen.sort_by(|a, b| area(b).total_cmp(&area(a)));
    let mut out: Vec<Picture> = chosen
        .iter()
        .take(2)
        .map(|v| draw_view(scene, v, bounds))
        .collect();
    if out.is_empty() {
        // All points are on one line.
        let view = &VIEWS[usize::from(turned)];
        out.push(draw_view(scene, view, bounds));
    }
    out
}

fn draw_view(scene: &SceneView, view: &View, [low, high]: [Vec3; 2]) -> Picture {
    let flat = |v: Vec3| [view.right.1 * v[view.right.0], view.up.1 * v[view.up.0]];
    let (a, b) = (flat(low), flat(high));
    let [left, bottom] = [0, 1].map(|k| a[k].min(b[k]));
    let wide = [0, 1].map(|k| (a[k] - b[k]).abs());
    let room = UPRIGHT - 2.0 * AROUND;
    let fit = |room: f64, side: f64| {
        if side > 0.0 {
            room / side
        } else {
            f64::INFINITY
        }
    };
    let scale = fit(room, wide[0]).min(fit(HIGH, wide[1]));
    let scale = if scale.is_finite() { scale } else { 1.0 };
    let tall = wide[1] * scale;
    let aside = (UPRIGHT - wide[0] * scale) / 2.0;
    let place = |v: Vec3| {
        let p = flat(v);
        [
            aside + scale * (p[0] - left),
            AROUND + tall - scale * (p[1] - bottom),
        ]
    };
    let mut picture = Picture {
        size: [UPRIGHT, tall + 2.0 * AROUND + 3.0],
        ..Picture::default()
    };
    picture.strokes(outline(&scene.lines, &place), MESH, 0.12);
    let turn = |v: Vec3| {
        let p = flat(v);
        [p[0], -p[1]]
    };
    let look = Look {
        place: &place,
        turn: &turn,
    };
    marks(&mut picture, &scene.marks, &look);
    let bar = round_step(0.1 * room / scale);
    let y = picture.size[1] - 1.5;
    picture.line([0.0, y], [bar * scale, y], INK, 0.5);
    picture.word([bar * scale + 1.5, y], [0.0, 0.5], &number(bar));
    picture.caption = format!(
        "{}. The bar: {} in the model's length.",
        view.name,
        number(bar)
    );
    picture
}

/// Returns the lines that are distinct at a tenth of a millimetre, each once.
fn outline(lines: &[[Vec3; 2]], place: &dyn Fn(Vec3) -> [f64; 2]) -> Vec<Vec<[f64; 2]>> {
    let mut seen = BTreeSet::new();
    let near = |p: [f64; 2]| p.map(|v| (v * 10.0).round() as i64);
    for [p, q] in lines {
        let (p, q) = (near(place(*p)), near(place(*q)));
        if p != q {
            seen.insert((p.min(q), p.max(q)));
        }
    }
    let back = |p: [i64; 2]| p.map(|v| v as f64 / 10.0);
    seen.into_iter()
        .map(|(p, q)| vec![back(p), back(q)])
        .collect()
}

/// Projection of points and directions of the basic frame onto the paper.
pub(in crate::report) struct Look<'a> {
    pub(in crate::report) place: &'a dyn Fn(Vec3) -> [f64; 2],
    pub(in crate::report) turn: &'a dyn Fn(Vec3) -> [f64; 2],
}

/// Occupied rectangles (left, top, right, bottom), grouped by square cells of a lattice. The lattice keeps the search fast for many gauges.
#[derive(Default)]
struct OccupiedArea(HashMap<[i64; 2], Vec<[f64; 4]>>);

impl OccupiedArea {
    /// Width of a cell: a few letters.
    const CELL: f64 = 2.0;

    fn cells(area: [f64; 4]) -> impl Iterator<Item = [i64; 2]> {
        let [left, top, right, bottom] = area.map(|v| (v / Self::CELL).floor() as i64);
        (left..=right).flat_map(move |x| (top..=bottom).map(move |y| [x, y]))
    }

    fn add(&mut self, area: [f64; 4]) {
        for cell in Self::cells(area) {
            self.0.entry(cell).or_default().push(area);
        }
    }

    fn leaves_free(&self, area: [f64; 4]) -> bool {
        let free =
            |t: &[f64; 4]| area[0] > t[2] || area[2] < t[0] || area[1] > t[3] || area[3] < t[1];
        Self::cells(area).all(|cell| self.0.get(&cell).is_none_or(|near| near.iter().all(free)))
    }
}

/// Draws strokes along the gauges, circles of their gap, and their names.
pub(in crate::report) fn marks(picture: &mut Picture, marks: &[Mark], look: &Look) {
    let Look { place, turn } = look;
    let most = marks.iter().filter_map(|m| m.gap).flatten();
    let most = most.filter(|v| v.is_finite()).fold(0.0, f64::max);
    // Names must not cover any gauge.
    let mut taken = OccupiedArea::default();
    let mut keep = |p: [f64; 2], r: f64| taken.add([p[0] - r, p[1] - r, p[0] + r, p[1] + r]);
    for m in marks {
        let at = place(m.at);
        keep(at, 1.0);
        for (k, colour) in ["#d68910", "#1f618d"].iter().enumerate() {
            if let Some(gap) = m.gap
                && most > 0.0
                && gap[k].is_finite()
            {
                picture.circle(at, LARGEST * (gap[k] / most).max(0.0).sqrt(), colour, 0.4);
            }
        }
        match m.axes {
            Some([along, _]) => {
                let colour = match m.surface {
                    Some(Surface::Bottom) => "#1f4e8c",
                    _ => "#b2182b",
                };
                let d = turn(along).map(|v| STROKE * v);
                let [a, b] = [-1.0, 1.0].map(|s| [at[0] + s * d[0], at[1] + s * d[1]]);
                picture.line(a, b, colour, 0.6);
                keep(a, 0.7);
                keep(b, 0.7);
                picture.circle(at, 0.5, colour, 0.0);
            }
            None => picture.circle(at, 0.5, INK, 0.0),
        }
    }
    for m in marks {
        name(picture, &m.name, place(m.at), &mut taken);
    }
}

/// Draws the name at a free place, with a line to its gauge if it is far. If there is no free place, the name is left out.
fn name(picture: &mut Picture, name: &str, at: [f64; 2], taken: &mut OccupiedArea) {
    const SIZE: f64 = 6.0;
    let text = shorten_to(name, 16);
    let (wide, tall) = (1.35 * text.chars().count() as f64, 2.8);
    for far in [1.6, 3.0, 5.0, 8.0, 11.0] {
        for turn in 0..12 {
            let angle = f64::from(turn) * std::f64::consts::PI / 6.0;
            let (c, s) = (angle.cos(), -angle.sin());
            let near = [at[0] + far * c, at[1] + far * s];
            // The side of the text that faces the gauge is at `near`. In the reading direction, the text begins, is centred or ends there.
            let along = match (1.0 - c) / 2.0 {
                a if a < 0.25 => 0.0,
                a if a > 0.75 => 1.0,
                _ => 0.5,
            };
            let anchor = [along, (1.0 - s) / 2.0];
            let x = near[0] - anchor[0] * wide;
            let y = near[1] - anchor[1] * tall;
            let area = [x, y, x + wide, y + tall];
            let inside = x >= 0.0
                && y >= 0.0
                && area[2] <= picture.size[0]
                && area[3] <= picture.size[1] - 3.0;
            if inside && taken.leaves_free(area) {
                if far > 3.5 {
                    picture.line(at, near, INK, 0.1);
                }
                picture.shapes.push(Shape::Word(Word {
                    at: near,
                    anchor,
                    text,
                    size: SIZE,
                    upwards: false,
                }));
                taken.add(area);
                return;
            }
        }
    }
}
