//! Curves over a common axis, as SVG.

use std::fmt::Write as _;

/// Points drawn at most for one curve; longer ones are thinned evenly.
const MOST_POINTS: usize = 1500;
const COLOURS: [&str; 3] = ["#9aa7b5", "#1f618d", "#c0392b"];

/// Axes of a plot.
#[derive(Clone, Copy)]
pub(super) enum Scale {
    /// Both linear.
    Linear,
    /// y by powers of ten.
    LogY,
}

/// Curves (label, x, y) over one another; the first is drawn lowest.
pub(super) fn lines(
    curves: &[(&str, &[f64], &[f64])],
    x_label: &str,
    y_label: &str,
    scale: Scale,
) -> String {
    let height = |y: f64| match scale {
        Scale::Linear => y,
        Scale::LogY => y.max(1e-300).log10(),
    };
    let (mut x0, mut x1, mut y0, mut y1) = (
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::INFINITY,
        f64::NEG_INFINITY,
    );
    for (_, xs, ys) in curves {
        for (x, y) in xs
            .iter()
            .zip(*ys)
            .filter(|(x, y)| x.is_finite() && y.is_finite())
        {
            (x0, x1) = (x0.min(*x), x1.max(*x));
            (y0, y1) = (y0.min(height(*y)), y1.max(height(*y)));
        }
    }
    if !(x0 < x1 && y0 < y1) {
        return String::new();
    }
    if matches!(scale, Scale::LogY) {
        // Six decades below the top show all that matters.
        y0 = y0.max(y1 - 6.0);
    }
    let px = |x: f64| 70.0 + 700.0 * (x - x0) / (x1 - x0);
    let py = |y: f64| 210.0 - 190.0 * (height(y).max(y0) - y0) / (y1 - y0);
    let mut svg = format!(
        "<svg viewBox=\"0 0 800 250\" role=\"img\" aria-label=\"{y_label} over {x_label}\" font-size=\"11\"><rect x=\"70\" y=\"20\" width=\"700\" height=\"190\" fill=\"none\" stroke=\"#d6dce3\"/>"
    );
    for (i, (label, xs, ys)) in curves.iter().enumerate() {
        let step = xs.len().div_ceil(MOST_POINTS).max(1);
        let colour = COLOURS[i % COLOURS.len()];
        let _ = write!(svg, "<polyline fill=\"none\" stroke=\"{colour}\" points=\"");
        for (x, y) in xs
            .iter()
            .zip(*ys)
            .step_by(step)
            .filter(|(x, y)| x.is_finite() && y.is_finite())
        {
            let _ = write!(svg, "{:.1},{:.1} ", px(*x), py(*y));
        }
        let _ = write!(
            svg,
            "\"/><text x=\"{}\" y=\"14\" fill=\"{colour}\">{label}</text>",
            70 + 160 * i
        );
    }
    let shown = |y: f64| match scale {
        Scale::Linear => format!("{y:.3e}"),
        Scale::LogY => format!("1e{y:.1}"),
    };
    let _ = write!(
        svg,
        "<text x=\"64\" y=\"28\" text-anchor=\"end\">{}</text><text x=\"64\" y=\"210\" text-anchor=\"end\">{}</text>\
<text x=\"70\" y=\"226\">{x0:.2}</text><text x=\"770\" y=\"226\" text-anchor=\"end\">{x1:.2}</text>\
<text x=\"420\" y=\"244\" text-anchor=\"middle\">{x_label}; {y_label}</text></svg>",
        shown(y1),
        shown(y0)
    );
    svg
}
