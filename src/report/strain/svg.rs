//! Drawings: the model's outline with gauges, a heat map, measured against predicted.

use crate::fe::strain_tensor::Surface;
use crate::gauge::Gauge;
use crate::model::{Model, Vec3};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Edges drawn at most; larger models are thinned evenly.
const MOST_EDGES: usize = 12_000;

/// Edges of shells at which the outline shows: free edges, edges of three and more shells, folds; and all beams.
pub(super) fn outline(model: &Model) -> Vec<[Vec3; 2]> {
    let mut edges: BTreeMap<[u32; 2], (usize, Vec3, bool)> = BTreeMap::new();
    for s in &model.shells {
        let n = s.shape.n_corners();
        let x = |i: usize| model.grids.get(s.grids[i].us()).map(|g| g.x);
        let (Some(a), Some(b), Some(c)) = (x(0), x(1), x(n - 1)) else {
            continue;
        };
        let normal = (b - a)
            .cross(&(c - a))
            .try_normalize(0.0)
            .unwrap_or_else(Vec3::zeros);
        for i in 0..n {
            let (p, q) = (s.grids[i].0, s.grids[(i + 1) % n].0);
            let e = edges
                .entry([p.min(q), p.max(q)])
                .or_insert((0, normal, false));
            e.0 += 1;
            // A fold of more than 30 degrees shows.
            e.2 |= e.1.dot(&normal).abs() < 0.866;
        }
    }
    let at = |g: u32| model.grids.get(g as usize).map(|g| g.x);
    let mut out: Vec<[Vec3; 2]> = edges
        .iter()
        .filter(|(_, (n, _, fold))| *n != 2 || *fold)
        .filter_map(|([p, q], _)| Some([at(*p)?, at(*q)?]))
        .collect();
    out.extend(
        model
            .beams
            .iter()
            .filter_map(|b| Some([at(b.grids[0].0)?, at(b.grids[1].0)?])),
    );
    let stride = out.len().div_ceil(MOST_EDGES).max(1);
    out.into_iter().step_by(stride).collect()
}

/// A view from above, to the side and in front, with gauges as strokes along their axes and their names.
pub fn model_with_gauges(model: &Model, gauges: &[&Gauge]) -> String {
    // Rows of the view: right and up on paper, basic frame; a common engineering view for vehicles with z up.
    let (right, up) = (Vec3::new(0.92, 0.39, 0.0), Vec3::new(-0.20, 0.46, 0.866));
    let flat = |x: Vec3| (x.dot(&right), -x.dot(&up));
    let edges: Vec<[(f64, f64); 2]> = outline(model)
        .into_iter()
        .map(|[a, b]| [flat(a), flat(b)])
        .collect();
    let points = edges
        .iter()
        .flatten()
        .copied()
        .chain(gauges.iter().map(|g| flat(g.position)));
    let (mut lo, mut hi) = ((f64::MAX, f64::MAX), (f64::MIN, f64::MIN));
    for (x, y) in points {
        lo = (lo.0.min(x), lo.1.min(y));
        hi = (hi.0.max(x), hi.1.max(y));
    }
    if lo.0 > hi.0 {
        return String::new();
    }
    let width = 1040.0;
    let scale = width / (hi.0 - lo.0).max(1e-12);
    let height = ((hi.1 - lo.1) * scale).max(1.0);
    let px = |p: (f64, f64)| (30.0 + (p.0 - lo.0) * scale, 24.0 + (p.1 - lo.1) * scale);
    let mut svg = format!(
        "<svg viewBox=\"0 0 {:.0} {:.0}\" role=\"img\" aria-label=\"model with gauges\"><path fill=\"none\" stroke=\"#9aa7b5\" stroke-width=\".6\" d=\"",
        width + 60.0,
        height + 48.0
    );
    for [a, b] in &edges {
        let (a, b) = (px(*a), px(*b));
        let _ = write!(svg, "M{:.1} {:.1}L{:.1} {:.1}", a.0, a.1, b.0, b.1);
    }
    svg.push_str("\"/>");
    for g in gauges {
        let (x, y) = px(flat(g.position));
        let d = flat(g.direction);
        let n = d.0.hypot(d.1).max(1e-9);
        let (dx, dy) = (9.0 * d.0 / n, 9.0 * d.1 / n);
        let colour = if g.surface == Surface::Top {
            "#c0392b"
        } else {
            "#1f618d"
        };
        let _ = write!(
            svg,
            "<path stroke=\"{colour}\" stroke-width=\"3\" d=\"M{:.1} {:.1}L{:.1} {:.1}\"/><text x=\"{:.1}\" y=\"{:.1}\" font-size=\"11\" fill=\"{colour}\">{}</text>",
            x - dx,
            y - dy,
            x + dx,
            y + dy,
            x + 7.0,
            y - 5.0,
            escaped(&g.name)
        );
    }
    svg.push_str("</svg>");
    svg
}

/// Text inside an SVG.
pub(super) fn escaped(s: &str) -> String {
    s.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

/// Rows and columns coloured by their share of the largest in their column: blue negative, red positive.
pub fn heat_map(
    rows: &[String],
    columns: &[String],
    value: impl Fn(usize, usize) -> f64,
) -> String {
    let (cell_w, cell_h, left, top) = (64.0, 16.0, 90.0, 70.0);
    let mut svg = format!(
        "<svg viewBox=\"0 0 {:.0} {:.0}\" role=\"img\" aria-label=\"sensitivity\" font-size=\"11\">",
        left + cell_w * columns.len() as f64 + 40.0,
        top + cell_h * rows.len() as f64 + 4.0
    );
    for (c, name) in columns.iter().enumerate() {
        let x = left + cell_w * (c as f64 + 0.5);
        let _ = write!(
            svg,
            "<text transform=\"translate({x:.1},{:.1}) rotate(-35)\">{}</text>",
            top - 6.0,
            escaped(name)
        );
    }
    for (r, name) in rows.iter().enumerate() {
        let y = top + cell_h * r as f64;
        let _ = write!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            left - 6.0,
            y + 12.0,
            escaped(name)
        );
    }
    for c in 0..columns.len() {
        let largest = (0..rows.len())
            .map(|r| value(r, c).abs())
            .fold(0.0, f64::max);
        for r in 0..rows.len() {
            let share = if largest > 0.0 {
                value(r, c) / largest
            } else {
                0.0
            };
            let fade = (255.0 * (1.0 - share.abs())) as u8;
            let colour = if share >= 0.0 {
                format!("rgb(255,{fade},{fade})")
            } else {
                format!("rgb({fade},{fade},255)")
            };
            let _ = write!(
                svg,
                "<rect x=\"{:.0}\" y=\"{:.0}\" width=\"{cell_w}\" height=\"{cell_h}\" fill=\"{colour}\"><title>{} / {}: {:.4e}</title></rect>",
                left + cell_w * c as f64,
                top + cell_h * r as f64,
                escaped(&rows[r]),
                escaped(&columns[c]),
                value(r, c)
            );
        }
    }
    svg.push_str("</svg>");
    svg
}

/// Points about the line of equality, microstrain both ways.
pub fn measured_against_predicted(points: &[(f64, f64)]) -> String {
    let extent = points
        .iter()
        .map(|p| p.0.abs().max(p.1.abs()))
        .fold(1e-9, f64::max)
        * 1.05;
    let px = |v: f64| 40.0 + 400.0 * (v + extent) / (2.0 * extent);
    let mut svg = String::from(
        "<svg viewBox=\"0 0 520 480\" style=\"max-width:520px\" role=\"img\" aria-label=\"measured against predicted strain\" font-size=\"11\">\
<rect x=\"40\" y=\"20\" width=\"400\" height=\"400\" fill=\"none\" stroke=\"#9aa7b5\"/><path stroke=\"#9aa7b5\" d=\"M40 420L440 20\"/>",
    );
    for (predicted, measured) in points {
        let _ = write!(
            svg,
            "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"2.2\" fill=\"#1f618d\" fill-opacity=\".6\"/>",
            px(*predicted),
            460.0 - px(*measured)
        );
    }
    let _ = write!(
        svg,
        "<text x=\"440\" y=\"438\" text-anchor=\"end\">predicted, to {extent:.0} microstrain</text><text transform=\"translate(30,420) rotate(-90)\">measured</text></svg>"
    );
    svg
}

/// Values with 95 % bars, one row each; low, value, high.
pub fn interval_bars(rows: &[(String, [f64; 3])], unit: &str) -> String {
    let (lo, hi) = rows.iter().fold((0.0_f64, 0.0_f64), |(lo, hi), (_, v)| {
        (lo.min(v[0]), hi.max(v[2]))
    });
    let span = (hi - lo).max(1e-12);
    let px = |v: f64| 150.0 + 560.0 * (v - lo) / span;
    let mut svg = format!(
        "<svg viewBox=\"0 0 820 {}\" role=\"img\" aria-label=\"loads\" font-size=\"11\">",
        18 * rows.len() + 24
    );
    let _ = write!(
        svg,
        "<path stroke=\"#9aa7b5\" d=\"M{:.1} 4V{}\"/>",
        px(0.0),
        18 * rows.len() + 6
    );
    for (i, (name, [low, value, high])) in rows.iter().enumerate() {
        let y = 14.0 + 18.0 * i as f64;
        let _ = write!(
            svg,
            "<text x=\"140\" y=\"{:.1}\" text-anchor=\"end\">{}</text><path stroke=\"#1f618d\" stroke-width=\"2\" d=\"M{:.1} {y}H{:.1}\"/>\
<circle cx=\"{:.1}\" cy=\"{y}\" r=\"3.2\" fill=\"#1f618d\"/><text x=\"725\" y=\"{:.1}\">{value:.3} {}</text>",
            y + 4.0,
            escaped(name),
            px(*low),
            px(*high),
            px(*value),
            y + 4.0,
            escaped(unit)
        );
    }
    svg.push_str("</svg>");
    svg
}
