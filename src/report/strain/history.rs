//! Drawings of recover: histories as bands, measured against predicted strain gauge by gauge.

use super::svg::escaped;
use std::fmt::Write as _;

/// One load over time, thinned: by span of time the smallest, mean and largest sample, report unit.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct LoadTrace {
    /// Name.
    pub name: String,
    /// Report unit; empty for a load set.
    pub unit: String,
    /// Beginning and end of the record, s.
    pub time: [f64; 2],
    /// Half of the 95 % interval of a sample.
    pub half: f64,
    /// Spans of equal length: smallest, mean, largest; NaN where nothing was measured.
    pub spans: Vec<[f64; 3]>,
}

/// A history: what lies between smallest and largest of each span, its 95 % interval around it, and the mean.
pub fn history_band(trace: &LoadTrace) -> String {
    let (width, height, left, top) = (700.0, 110.0, 64.0, 18.0);
    let known: Vec<(usize, [f64; 3])> = trace
        .spans
        .iter()
        .copied()
        .enumerate()
        .filter(|(_, s)| s.iter().all(|v| v.is_finite()))
        .collect();
    let half = if trace.half.is_finite() {
        trace.half
    } else {
        0.0
    };
    let (mut low, mut high) = known.iter().fold((0.0_f64, 0.0_f64), |(a, b), (_, s)| {
        (a.min(s[0] - half), b.max(s[2] + half))
    });
    if high - low <= 0.0 {
        (low, high) = (low - 1.0, high + 1.0);
    }
    let n = trace.spans.len().max(1) as f64;
    let x = |i: usize| left + width * (i as f64 + 0.5) / n;
    let y = |v: f64| top + height * (high - v) / (high - low);
    let mut svg = format!(
        "<svg viewBox=\"0 0 790 {:.0}\" role=\"img\" aria-label=\"history of {name}\" font-size=\"11\"><text x=\"{left}\" y=\"12\">{name}, {unit}</text>",
        top + height + 20.0,
        name = escaped(&trace.name),
        unit = escaped(&trace.unit)
    );
    let band = |lower: &dyn Fn(&[f64; 3]) -> f64, upper: &dyn Fn(&[f64; 3]) -> f64| {
        let mut d = String::new();
        let there = known.iter().map(|(i, s)| (*i, upper(s)));
        let back = known.iter().rev().map(|(i, s)| (*i, lower(s)));
        for (k, (i, v)) in there.chain(back).enumerate() {
            let _ = write!(
                d,
                "{}{:.1} {:.1}",
                if k == 0 { "M" } else { "L" },
                x(i),
                y(v)
            );
        }
        d
    };
    let _ = write!(
        svg,
        "<path fill=\"#c9dbe9\" d=\"{}\"/><path fill=\"#5d8fb8\" stroke=\"#5d8fb8\" stroke-width=\".5\" d=\"{}\"/>",
        band(&|s| s[0] - half, &|s| s[2] + half),
        band(&|s| s[0], &|s| s[2])
    );
    let mean: String = known
        .iter()
        .enumerate()
        .map(|(k, (i, s))| {
            format!(
                "{}{:.1} {:.1}",
                if k == 0 { "M" } else { "L" },
                x(*i),
                y(s[1])
            )
        })
        .collect();
    let _ = write!(
        svg,
        "<path fill=\"none\" stroke=\"#1c2530\" stroke-width=\".8\" d=\"{mean}\"/><path stroke=\"#9aa7b5\" d=\"M{left} {zero:.1}H{end:.1}\"/>\
<text x=\"{label}\" y=\"{yh:.1}\" text-anchor=\"end\">{high}</text><text x=\"{label}\" y=\"{yl:.1}\" text-anchor=\"end\">{low}</text>\
<text x=\"{left}\" y=\"{foot:.1}\">{t0} s</text><text x=\"{end:.1}\" y=\"{foot:.1}\" text-anchor=\"end\">{t1} s</text></svg>",
        zero = y(0.0),
        end = left + width,
        label = left - 6.0,
        yh = top + 9.0,
        yl = top + height,
        high = super::number(high),
        low = super::number(low),
        foot = top + height + 14.0,
        t0 = super::number(trace.time[0]),
        t1 = super::number(trace.time[1]),
    );
    svg
}

/// One gauge: (predicted, measured) of each run, microstrain.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct GaugePoints {
    /// Name.
    pub name: String,
    /// Residual, microstrain rms.
    pub residual: f64,
    /// Runs.
    pub points: Vec<(f64, f64)>,
}

/// Measured (up) against predicted (right) strain of one gauge about the line of equality, on a scale of its own.
pub fn gauge_plot(gauge: &GaugePoints) -> String {
    let known = gauge
        .points
        .iter()
        .filter(|p| p.0.is_finite() && p.1.is_finite());
    let extent = known
        .clone()
        .map(|p| p.0.abs().max(p.1.abs()))
        .fold(1e-9, f64::max)
        * 1.08;
    let at = |v: f64| 100.0 * (v + extent) / (2.0 * extent);
    let mut svg = format!(
        "<svg viewBox=\"0 0 112 132\" role=\"img\" aria-label=\"gauge {name}\" font-size=\"9\"><rect x=\"6\" y=\"14\" width=\"100\" \
height=\"100\" fill=\"none\" stroke=\"#9aa7b5\"/><path stroke=\"#9aa7b5\" stroke-width=\".6\" d=\"M6 114L106 14\"/><text x=\"6\" y=\"10\">{name}</text>\
<text x=\"106\" y=\"10\" text-anchor=\"end\">&#177; {extent:.0}</text><text x=\"106\" y=\"126\" text-anchor=\"end\">residual {residual}</text>",
        name = escaped(&gauge.name),
        residual = super::number(gauge.residual)
    );
    for (predicted, measured) in known {
        let _ = write!(
            svg,
            "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"1.8\" fill=\"#1f618d\" fill-opacity=\".7\"/>",
            6.0 + at(*predicted),
            114.0 - at(*measured)
        );
    }
    svg.push_str("</svg>");
    svg
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_band_spans_the_extremes_with_their_interval_and_leaves_gaps_out() {
        let trace = LoadTrace {
            name: "A<B".into(),
            unit: "kN".into(),
            time: [0.0, 10.0],
            half: 1.0,
            spans: vec![[-3.0, 0.0, 4.0], [f64::NAN; 3], [1.0, 1.0, 1.0]],
        };
        let svg = history_band(&trace);
        // The scale runs from -3 - 1 to 4 + 1.
        assert!(svg.contains(">5.000<") && svg.contains(">-4.000<"), "{svg}");
        assert!(svg.contains("A&lt;B, kN") && !svg.contains("NaN"), "{svg}");
        // The mean: two spans, a sixth and five sixths of the way.
        assert!(svg.contains("M180.7") && svg.contains("L647.3"), "{svg}");
    }

    #[test]
    fn a_gauge_whose_runs_agree_lies_on_the_line_of_equality() {
        let gauge = GaugePoints {
            name: "P1".into(),
            residual: 0.0,
            points: vec![(0.0, 0.0), (f64::NAN, 1.0)],
        };
        let svg = gauge_plot(&gauge);
        assert_eq!(svg.matches("<circle").count(), 1);
        assert!(svg.contains("cx=\"56.0\" cy=\"64.0\""), "{svg}");
    }
}
