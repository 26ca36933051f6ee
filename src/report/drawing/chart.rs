//! A figure as pictures, for traces that the page draws by its script.

use super::heat::heat;
use super::picture::{FAINT, LONGEST, Picture, Shape, UPRIGHT};
use super::scale::Scale;
use super::traces::{Kind, Series, names_of, series_of};
use crate::report::figure::Figure;
use serde_json::Value;

/// Colours of series without a stated colour.
const COLOURS: [&str; 9] = [
    "#1f618d", "#d35400", "#1e8449", "#7d3c98", "#b7950b", "#c0392b", "#148f77", "#5d6d7e",
    "#a04000",
];
/// Height of the space of curves and points, and of one row of names, mm.
const HEIGHT: f64 = 68.0;
const ROW: f64 = 4.4;
const MOST_HIGH: f64 = 190.0;
/// Widest group of bars, mm.
const WIDEST: f64 = 20.0;

/// The choices of a figure that are meant for paper, each a picture.
pub(in crate::report) fn pictures(figure: &Figure) -> Vec<Picture> {
    let shown = figure.choices.iter().take(figure.on_paper);
    shown
        .flat_map(|(name, traces)| {
            let mut list = match traces.iter().find(|t| t["type"] == "heatmap") {
                Some(map) => heat(map),
                None => vec![chart(traces, &figure.layout)],
            };
            if let Some(first) = list.first_mut() {
                first.title.clone_from(name);
            }
            list
        })
        .collect()
}

/// One axis: names at equal distances, or a scale.
enum Axis {
    Names(Vec<String>, [f64; 2]),
    Values(Scale),
}

impl Axis {
    fn of(series: &[Series], k: usize, layout: &Value, place: [f64; 2]) -> Self {
        if let Some(names) = names_of(series, k) {
            return Self::Names(names, place);
        }
        let from_zero = layout["rangemode"] == "tozero";
        let values = series.iter().flat_map(|s| s.reach(k));
        let values = values.chain(from_zero.then_some(0.0));
        Self::Values(Scale::over(values, place, layout["type"] == "log"))
    }

    fn at(&self, series: &Series, k: usize, i: usize) -> Option<f64> {
        match self {
            Self::Names(names, [from, to]) => {
                let name = series.name_at(k, i)?;
                let n = names.iter().position(|x| x == name)?;
                Some(from + (to - from) * (n as f64 + 0.5) / names.len() as f64)
            }
            Self::Values(scale) => scale.at(series.value_at(k, i)?),
        }
    }

    fn ticks(&self) -> Vec<(f64, String)> {
        match self {
            Self::Names(names, [from, to]) => {
                let n = names.len() as f64;
                // Names of 7 points need 2.6 mm.
                let each = (2.6 / ((to - from).abs() / n)).ceil().max(1.0) as usize;
                let place = |i: usize| from + (to - from) * (i as f64 + 0.5) / n;
                let named = names.iter().enumerate().step_by(each);
                named.map(|(i, x)| (place(i), x.clone())).collect()
            }
            Self::Values(scale) => {
                let ticks = scale.ticks().into_iter();
                ticks
                    .filter_map(|(v, word)| Some((scale.at(v)?, word)))
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

fn chart(traces: &[Value], layout: &Value) -> Picture {
    let series = series_of(traces, &COLOURS);
    let (x_names, y_names) = (names_of(&series, 0), names_of(&series, 1));
    let rows = y_names.as_ref().map(|n| n.len() as f64 * ROW);
    let inner = rows.unwrap_or(HEIGHT).clamp(2.0 * ROW, MOST_HIGH);
    let mut picture = Picture::default();
    let top = legend(&mut picture, &series);
    let left = Axis::room(y_names, 19.0);
    let below = Axis::room(x_names, 4.5);
    let (bottom, right) = (top + inner, UPRIGHT - 4.0);
    picture.size = [UPRIGHT, bottom + below + 4.5];
    let x = Axis::of(&series, 0, &layout["xaxis"], [left, right]);
    // Names read downwards, values grow upwards.
    let upwards = match names_of(&series, 1) {
        Some(_) => [top, bottom],
        None => [bottom, top],
    };
    let y = Axis::of(&series, 1, &layout["yaxis"], upwards);
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
    let below = [(left + right) / 2.0, picture.size[1]];
    picture.word(below, [0.5, 1.0], &title("x"));
    let beside = [0.0, (top + bottom) / 2.0];
    picture.word_upwards(beside, [0.0, 0.5], &title("y"));
    let bars = series.iter().filter(|s| s.kind == Kind::Bars).count();
    let mut bar = 0;
    for s in &series {
        let points: Vec<Option<[f64; 2]>> = (0..s.len())
            .map(|i| Some([x.at(s, 0, i)?, y.at(s, 1, i)?]))
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
        let ends = |i: usize| Some(s.interval_at(i)?.map(|v| scale.at(v)));
        let mut bars = Vec::new();
        for (i, p) in points.iter().enumerate() {
            if let (Some([_, py]), Some([Some(a), Some(b)])) = (p, ends(i)) {
                bars.push(vec![[a, *py], [b, *py]]);
                bars.extend([a, b].map(|e| vec![[e, py - 0.8], [e, py + 0.8]]));
            }
        }
        picture.strokes(bars, &s.colour, 0.35);
    }
    if s.kind == Kind::Lines {
        return;
    }
    // Points that would cover each other are drawn once.
    let mut seen = std::collections::BTreeSet::new();
    for p in points.iter().flatten() {
        if !seen.insert(p.map(|v| (v * 3.0).round() as i64)) {
            continue;
        }
        match s.symbol.as_str() {
            "line-ew-open" => {
                picture.line([p[0] - 2.0, p[1]], [p[0] + 2.0, p[1]], &s.colour, 0.4);
            }
            "diamond-open" => picture.circle(*p, 0.8, &s.colour, 0.25),
            _ => picture.circle(*p, 0.8, &s.colour, 0.0),
        }
    }
}

/// Names of the series with their colours, in lines at the top; where the space below begins.
fn legend(picture: &mut Picture, series: &[Series]) -> f64 {
    let named: Vec<&Series> = series.iter().filter(|s| !s.name.is_empty()).collect();
    if named.is_empty() {
        return 2.0;
    }
    let (mut x, mut y) = (0.0, 2.0);
    for s in named {
        let width = 8.0 + 1.25 * s.name.chars().count().min(LONGEST) as f64;
        if x + width > UPRIGHT {
            (x, y) = (0.0, y + 4.0);
        }
        picture.line([x, y], [x + 4.0, y], &s.colour, 0.8);
        picture.word([x + 5.0, y], [0.0, 0.5], &s.name);
        x += width;
    }
    y + 4.0
}
