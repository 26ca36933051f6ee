//! A figure as pictures, for traces that the page draws by its script.

use super::heat::heat;
use super::picture::{FAINT, LONGEST, Picture, Shape, UPRIGHT};
use super::scale::Scale;
use super::traces::{Kind, Series, names_of, on_white, series_of};
use crate::report::figure::Figure;
use serde_json::Value;

/// Colours of series without a stated colour.
const COLOURS: [&str; 9] = [
    "#1f618d", "#d35400", "#1e8449", "#7d3c98", "#b7950b", "#c0392b", "#148f77", "#5d6d7e",
    "#a04000",
];
const MOST_HIGH: f64 = 190.0;

/// Sizes of a picture, mm.
#[derive(Clone, Copy, Debug)]
struct Sheet {
    width: f64,
    /// Height of the space of curves and points.
    height: f64,
    /// Height of one row of names.
    row: f64,
    /// Side of a space whose axes are equal.
    equal: f64,
}

impl Sheet {
    /// For A4, and for screens that are wide.
    const PAPER: Self = Self {
        width: UPRIGHT,
        height: 68.0,
        row: 4.4,
        equal: 96.0,
    };
    /// For a card or a phone. Its text then has the same size as in a chart for A4.
    const CARD: Self = Self {
        width: 88.0,
        height: 44.0,
        row: 6.0,
        equal: 60.0,
    };
}

/// Maximum number of points along the edge of a filled area. Each point represents several of the data.
const MOST_EDGES: usize = 240;
/// Width of a bar that spans a range, mm.
const SPAN: f64 = 2.4;
/// Colour of a band of the x axis.
const BAND: &str = "rgba(214,137,16,.16)";
/// Widest group of bars, mm.
const WIDEST: f64 = 20.0;

/// Returns the choices of a figure that are meant for paper, each a picture.
pub(in crate::report) fn pictures(figure: &Figure) -> Vec<Picture> {
    let shown = figure.choices.iter().take(figure.on_paper);
    shown
        .flat_map(|(name, traces)| {
            let mut list = match traces.iter().find(|t| t["type"] == "heatmap") {
                Some(map) => heat(map),
                None => vec![chart(traces, &figure.layout, Sheet::PAPER)],
            };
            if let Some(first) = list.first_mut() {
                first.title.clone_from(name);
            }
            list
        })
        .collect()
}

/// Draws the first choice of a figure for a card or a phone. A map is drawn as on paper.
pub(in crate::report) fn card_picture(figure: &Figure) -> Option<Picture> {
    let (_, traces) = figure.choices.first()?;
    match traces.iter().any(|t| t["type"] == "heatmap") {
        true => pictures(figure).into_iter().next(),
        false => Some(chart(traces, &figure.layout, Sheet::CARD)),
    }
}

/// Axes in a layout.
const AXES: [&str; 2] = ["xaxis", "yaxis"];

/// One axis: names at equal distances, or a scale.
enum Axis {
    Names(Vec<String>, [f64; 2]),
    Values(Scale),
}

impl Axis {
    fn from_series(series: &[Series], k: usize, layout: &Value, place: [f64; 2]) -> Self {
        if let Some(names) = names_of(series, k) {
            return Self::Names(names, place);
        }
        let from_zero = layout[AXES[k]]["rangemode"] == "tozero";
        // Equal axes share one range, which covers the values of both.
        let axes = match layout["equal"] == true {
            true => 0..2,
            false => k..k + 1,
        };
        let values = axes.flat_map(|k| series.iter().flat_map(move |s| s.reach(k)));
        let values = values.chain(from_zero.then_some(0.0));
        Self::Values(Scale::from_values(
            values,
            place,
            layout[AXES[k]]["type"] == "log",
        ))
    }

    fn point_position(&self, series: &Series, k: usize, i: usize) -> Option<f64> {
        match self {
            Self::Names(names, [from, to]) => {
                let name = series.name_at(k, i)?;
                let n = names.iter().position(|x| x == name)?;
                Some(from + (to - from) * (n as f64 + 0.5) / names.len() as f64)
            }
            Self::Values(scale) => scale.position_of_value(series.value_at(k, i)?),
        }
    }

    fn ticks(&self) -> Vec<(f64, String)> {
        match self {
            Self::Names(names, [from, to]) => {
                let n = names.len() as f64;
                // A name in 7 point type needs 2.6 mm.
                let each = (2.6 / ((to - from).abs() / n)).ceil().max(1.0) as usize;
                let place = |i: usize| from + (to - from) * (i as f64 + 0.5) / n;
                let named = names.iter().enumerate().step_by(each);
                named.map(|(i, x)| (place(i), x.clone())).collect()
            }
            Self::Values(scale) => {
                let ticks = scale.ticks().into_iter();
                ticks
                    .filter_map(|(v, word)| Some((scale.position_of_value(v)?, word)))
                    .collect()
            }
        }
    }

    /// Width of the longest name, mm.
    fn room(names: Option<Vec<String>>, otherwise: f64) -> f64 {
        let longest = |n: Vec<String>| n.iter().map(|x| x.chars().count()).max().unwrap_or(0);
        names.map_or(otherwise, |n| 4.0 + 1.3 * longest(n).min(LONGEST) as f64)
    }
}

fn chart(traces: &[Value], layout: &Value, sheet: Sheet) -> Picture {
    let series = series_of(traces, &COLOURS);
    let (x_names, y_names) = (names_of(&series, 0), names_of(&series, 1));
    // A few rows share the height of a chart of curves. Each row has at most twice its normal height.
    let rows = y_names.as_ref().map(|n| {
        let n = n.len().max(1) as f64;
        n * (sheet.height / n).clamp(sheet.row, 2.0 * sheet.row)
    });
    let is_equal = layout["equal"] == true;
    let inner = match is_equal {
        true => sheet.equal,
        false => rows
            .unwrap_or(sheet.height)
            .clamp(2.0 * sheet.row, MOST_HIGH),
    };
    let mut picture = Picture::default();
    let named = layout["band"]["name"].as_str();
    let band = named.and_then(|name| Some((name, on_white(BAND)?)));
    let top = legend(&mut picture, &series, band.as_ref(), sheet.width);
    let left = Axis::room(y_names, 19.0);
    let below = Axis::room(x_names, 4.5);
    let bottom = top + inner;
    let right = match is_equal {
        true => left + inner,
        false => sheet.width - 4.0,
    };
    picture.size = [sheet.width, bottom + below + 5.5];
    let x = Axis::from_series(&series, 0, layout, [left, right]);
    // Names read downwards, values grow upwards.
    let upwards = match names_of(&series, 1) {
        Some(_) => [top, bottom],
        None => [bottom, top],
    };
    let y = Axis::from_series(&series, 1, layout, upwards);
    if let (Some((_, colour)), Axis::Values(scale)) = (band, &x) {
        let ends = [0, 1].map(|i| scale.position_of_value(layout["band"]["ends"][i].as_f64()?));
        if let [Some(from), Some(to)] = ends.map(|e| e.map(|v| v.clamp(left, right))) {
            let area = [from, top, to - from, inner];
            picture.shapes.push(Shape::Area(area, colour));
        }
    }
    for (at, word) in x.ticks() {
        picture.line([at, top], [at, bottom], "#e6eaef", 0.15);
        match x {
            Axis::Names(..) => picture.word_upwards([at, bottom + 1.0], [0.5, 0.0], &word),
            Axis::Values(_) => picture.word([at, bottom + 1.2], [0.5, 0.0], &word),
        }
    }
    for (at, word) in y.ticks() {
        picture.line([left, at], [right, at], "#e6eaef", 0.15);
        picture.word([left - 1.2, at], [1.0, 0.5], &word);
    }
    let title = |axis: &str| {
        let [of_all, of_choice] = ["axis", "title"].map(|word| format!("{axis}{word}"));
        let of_choice = || traces.iter().find_map(|t| t[&of_choice].as_str());
        let title = layout[&of_all]["title"]["text"].as_str().or_else(of_choice);
        title.unwrap_or_default().to_owned()
    };
    let below = [(left + right) / 2.0, picture.size[1] - 1.0];
    picture.word(below, [0.5, 1.0], &title("x"));
    let left_middle = [0.0, (top + bottom) / 2.0];
    picture.word_upwards(left_middle, [0.0, 0.5], &title("y"));
    let bars = series.iter().filter(|s| s.kind == Kind::Bars).count();
    let mut bar = 0;
    for s in &series {
        let points: Vec<Option<[f64; 2]>> = (0..s.len())
            .map(|i| Some([x.point_position(s, 0, i)?, y.point_position(s, 1, i)?]))
            .collect();
        match s.kind {
            Kind::Bars => {
                let slot = (0.8 * (right - left) / points.len().max(1) as f64).min(WIDEST);
                let width = slot / bars.max(1) as f64;
                for [px, py] in points.into_iter().flatten() {
                    let from = px - slot / 2.0 + bar as f64 * width;
                    let area = [from, py, width, bottom - py];
                    picture.shapes.push(Shape::Area(area, s.colour.clone()));
                }
                bar += 1;
            }
            Kind::Filled => fill(&mut picture, s, &points, &y),
            _ => draw(&mut picture, s, &points, &x),
        }
    }
    let corners = [
        [left, top],
        [right, top],
        [right, bottom],
        [left, bottom],
        [left, top],
    ];
    picture.strokes(vec![corners.to_vec()], FAINT, 0.2);
    picture
}

/// The area between a line and its foot, coarser where there are many points.
fn fill(picture: &mut Picture, s: &Series, points: &[Option<[f64; 2]>], y: &Axis) {
    let Axis::Values(scale) = y else { return };
    let edge = |(i, p): (usize, &Option<[f64; 2]>)| {
        let foot = scale.position_of_value(s.foot.get(i).copied().flatten()?)?;
        p.map(|[x, head]| (x, head, foot))
    };
    let edges: Vec<Option<(f64, f64, f64)>> = points.iter().enumerate().map(edge).collect();
    let step = points.len().div_ceil(MOST_EDGES).max(1);
    for part in edges.split(Option::is_none) {
        let known: Vec<(f64, f64, f64)> = part.iter().copied().flatten().collect();
        // Values grow upwards, millimetres grow downwards.
        let widest = |c: &[(f64, f64, f64)]| {
            let x = c.iter().map(|e| e.0).sum::<f64>() / c.len() as f64;
            let head = c.iter().map(|e| e.1).fold(f64::INFINITY, f64::min);
            let foot = c.iter().map(|e| e.2).fold(f64::NEG_INFINITY, f64::max);
            (x, head, foot)
        };
        let coarse: Vec<(f64, f64, f64)> = known.chunks(step).map(widest).collect();
        let there = coarse.iter().map(|e| [e.0, e.1]);
        let back = coarse.iter().rev().map(|e| [e.0, e.2]);
        if coarse.len() > 1 {
            let corners = there.chain(back).collect();
            picture
                .shapes
                .push(Shape::Region(corners, s.colour.clone()));
        }
    }
}

/// Points and lines of a series, with the intervals of its values.
fn draw(picture: &mut Picture, s: &Series, points: &[Option<[f64; 2]>], x: &Axis) {
    if s.kind != Kind::Points {
        let lines: Vec<Vec<[f64; 2]>> = points
            .split(Option::is_none)
            .map(|part| part.iter().flatten().copied().collect())
            .filter(|l: &Vec<[f64; 2]>| l.len() > 1)
            .collect();
        picture.strokes(lines, &s.colour, 0.35);
    }
    if let Axis::Values(scale) = x {
        let ends = |i: usize| Some(s.interval_at(i)?.map(|v| scale.position_of_value(v)));
        let mut bars = Vec::new();
        for (i, p) in points.iter().enumerate() {
            if let (Some([_, py]), Some([Some(a), Some(b)])) = (p, ends(i)) {
                if s.is_span {
                    let area = [a.min(b), py - SPAN / 2.0, (b - a).abs(), SPAN];
                    let colour = on_white("rgba(31,97,141,.35)").unwrap_or_default();
                    picture.shapes.push(Shape::Area(area, colour));
                    continue;
                }
                bars.push(vec![[a, *py], [b, *py]]);
                bars.extend([a, b].map(|e| vec![[e, py - 0.8], [e, py + 0.8]]));
            }
        }
        picture.strokes(bars, &s.colour, 0.35);
    }
    if s.kind == Kind::Lines {
        return;
    }
    // Points that overlap are drawn once.
    let mut seen = std::collections::BTreeSet::new();
    for p in points.iter().flatten() {
        if !seen.insert(p.map(|v| (v * 3.0).round() as i64)) {
            continue;
        }
        match s.symbol.as_str() {
            "line-ew-open" => {
                picture.line([p[0] - 2.0, p[1]], [p[0] + 2.0, p[1]], &s.colour, 0.4);
            }
            "x" => {
                let [x, y] = *p;
                let arm = |d: f64| vec![[x - 1.1, y - d], [x + 1.1, y + d]];
                picture.strokes(vec![arm(1.1), arm(-1.1)], &s.colour, 0.5);
            }
            "diamond-open" => picture.circle(*p, 0.8, &s.colour, 0.25),
            _ => picture.circle(*p, 0.8, &s.colour, 0.0),
        }
    }
}

/// Draws the legend at the top: names and colours of the series, and of the band if there is one. Returns the height at which the space below begins.
fn legend(
    picture: &mut Picture,
    series: &[Series],
    band: Option<&(&str, String)>,
    wide: f64,
) -> f64 {
    let named = series.iter().filter(|s| !s.name.is_empty());
    let named = named.map(|s| (s.name.as_str(), s.colour.as_str()));
    let band = band.map(|(name, colour)| (*name, colour.as_str()));
    let named: Vec<(&str, &str)> = named.chain(band).collect();
    if named.is_empty() {
        return 2.0;
    }
    let (mut x, mut y) = (0.0, 2.0);
    for (name, colour) in named {
        let width = 9.0 + 1.35 * name.chars().count().min(LONGEST) as f64;
        if x > 0.0 && x + width > wide {
            (x, y) = (0.0, y + 4.0);
        }
        picture.line([x, y], [x + 4.0, y], colour, 1.2);
        picture.word([x + 5.0, y], [0.0, 0.5], name);
        x += width;
    }
    y + 4.0
}
