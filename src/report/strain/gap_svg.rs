//! Drawings of `reconcile`: where the gap sits on the model, and by gauge against its floor.

use super::svg::{escaped, outline};
use crate::model::{Model, Vec3};
use crate::reconcile::ChannelGap;
use std::fmt::Write as _;

/// A gauge on the drawing: its place (basic frame, the units of the model) and its gap.
pub struct GapMark<'a> {
    /// Place.
    pub at: Vec3,
    /// Gap.
    pub gap: &'a ChannelGap,
}

const BEFORE: &str = "#d68910";
const AFTER: &str = "#1f618d";
const FLOOR: &str = "#1c2530";

/// A view from above, to the side and in front: a circle at each gauge whose area grows with what the model misses there, open before and
/// full after; names where the gauge is above its floor.
pub(super) fn gap_on_model(model: Option<&Model>, marks: &[GapMark<'_>]) -> String {
    let (right, up) = (Vec3::new(0.92, 0.39, 0.0), Vec3::new(-0.20, 0.46, 0.866));
    let flat = |x: Vec3| (x.dot(&right), -x.dot(&up));
    let edges: Vec<[(f64, f64); 2]> = model
        .map(outline)
        .unwrap_or_default()
        .into_iter()
        .map(|e| e.map(flat))
        .collect();
    let (mut lo, mut hi) = ((f64::MAX, f64::MAX), (f64::MIN, f64::MIN));
    for (x, y) in edges
        .iter()
        .flatten()
        .copied()
        .chain(marks.iter().map(|m| flat(m.at)))
    {
        lo = (lo.0.min(x), lo.1.min(y));
        hi = (hi.0.max(x), hi.1.max(y));
    }
    if marks.is_empty() || lo.0 > hi.0 {
        return String::new();
    }
    let (width, margin) = (1000.0, 40.0);
    let scale = width / (hi.0 - lo.0).max(1e-12);
    let height = ((hi.1 - lo.1) * scale).max(1.0);
    let px = |p: (f64, f64)| (margin + (p.0 - lo.0) * scale, margin + (p.1 - lo.1) * scale);
    let mut svg = format!(
        "<svg viewBox=\"0 0 {:.0} {:.0}\" role=\"img\" aria-label=\"where the gap sits\"><path fill=\"none\" stroke=\"#9aa7b5\" stroke-width=\".6\" d=\"",
        width + 2.0 * margin,
        height + 2.0 * margin
    );
    for e in &edges {
        let [a, b] = e.map(px);
        let _ = write!(svg, "M{:.1} {:.1}L{:.1} {:.1}", a.0, a.1, b.0, b.1);
    }
    svg.push_str("\"/>");
    let most = marks.iter().map(|m| m.gap.before).fold(0.0, f64::max);
    /// Radius of the largest circle.
    const LARGEST: f64 = 26.0;
    let radius = |v: f64| {
        if most > 0.0 {
            LARGEST * (v / most).sqrt()
        } else {
            0.0
        }
    };
    for m in marks {
        let (x, y) = px(flat(m.at));
        let _ = write!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{:.1}\" fill=\"none\" stroke=\"{BEFORE}\" stroke-width=\"2\"/>\
             <circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{:.1}\" fill=\"{AFTER}\" fill-opacity=\".65\"/>",
            radius(m.gap.before),
            radius(m.gap.after)
        );
        if m.gap.before > 1.5 * m.gap.floor {
            let _ = write!(
                svg,
                "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"12\">{}</text>",
                x + 0.75 * radius(m.gap.before) + 3.0,
                y - 0.75 * radius(m.gap.before) - 3.0,
                escaped(&m.gap.channel)
            );
        }
    }
    svg.push_str("</svg>");
    svg
}

/// A row a gauge: RMS residual before and after as bars, the floor as a stroke, microstrain.
pub(super) fn gap_bars(channels: &[ChannelGap]) -> String {
    let (left, width, row) = (120.0, 820.0, 20.0);
    let most = channels
        .iter()
        .flat_map(|c| [c.before, c.after, c.floor])
        .fold(0.0, f64::max);
    if most <= 0.0 {
        return String::new();
    }
    let length = |v: f64| width * v / most;
    let mut svg = format!(
        "<svg viewBox=\"0 0 {:.0} {:.0}\" role=\"img\" aria-label=\"gap by gauge\" font-size=\"11\">",
        left + width + 90.0,
        row * channels.len() as f64 + 8.0
    );
    for (i, c) in channels.iter().enumerate() {
        let y = row * i as f64 + 4.0;
        let floor = left + length(c.floor);
        let _ = write!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>\
             <rect x=\"{left}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"7\" fill=\"{BEFORE}\"/>\
             <rect x=\"{left}\" y=\"{:.1}\" width=\"{:.1}\" height=\"7\" fill=\"{AFTER}\"/>\
             <path stroke=\"{FLOOR}\" stroke-width=\"2\" d=\"M{floor:.1} {:.1}V{:.1}\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\" fill=\"#516173\">{:.1} → {:.1}</text>",
            left - 8.0,
            y + 11.0,
            escaped(&c.channel),
            length(c.before),
            y + 8.0,
            length(c.after),
            y - 1.0,
            y + 16.0,
            left + length(c.before.max(c.after).max(c.floor)) + 6.0,
            y + 11.0,
            c.before,
            c.after
        );
    }
    svg.push_str("</svg>");
    svg
}
