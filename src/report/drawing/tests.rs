use super::picture::{Picture, Shape};
use super::scale::Scale;
use super::trails::trails;
use super::{pictures, to_svg};
use crate::report::figure::{CrossPlot, Ends, Figure, LoadTrace, cross_plot, history, intervals};
use std::collections::BTreeSet;

type Point = [i64; 2];

/// Returns the steps of length one along the axes that the lines take. Each step counts once, in either direction.
fn steps(lines: &[Vec<Point>]) -> BTreeSet<[Point; 2]> {
    let mut out = BTreeSet::new();
    for pair in lines.iter().flat_map(|l| l.windows(2)) {
        let mut at = pair[0];
        while at != pair[1] {
            let next = [0, 1].map(|k| at[k] + (pair[1][k] - at[k]).signum());
            out.insert([at.min(next), at.max(next)]);
            at = next;
        }
    }
    out
}

#[test]
fn joined_lines_cover_what_they_were_made_of_and_a_mesh_takes_few() {
    // Edges of 12 by 9 squares.
    let mut mesh: Vec<Vec<Point>> = Vec::new();
    for i in 0..=12 {
        for j in 0..=9 {
            if i < 12 {
                mesh.push(vec![[i, j], [i + 1, j]]);
            }
            if j < 9 {
                mesh.push(vec![[i, j + 1], [i, j]]);
            }
        }
    }
    let joined = trails(mesh.clone());
    assert_eq!(steps(&joined), steps(&mesh));
    let points: usize = joined.iter().map(Vec::len).sum();
    // Each of the 10 rows and 13 columns needs its two ends.
    assert!((23..100).contains(&points), "{points} points");
    // No step is drawn twice.
    let length: i64 = joined
        .iter()
        .flat_map(|l| l.windows(2))
        .map(|p| (p[0][0] - p[1][0]).abs() + (p[0][1] - p[1][1]).abs())
        .sum();
    assert_eq!(length, mesh.len() as i64);
}

#[test]
fn a_drawing_keeps_its_places_and_its_words_are_no_markup() {
    let mut picture = Picture {
        size: [174.0, 20.0],
        ..Picture::default()
    };
    picture.line([1.0, 2.0], [11.0, 2.0], "#123456", 0.5);
    picture.circle([3.0, 4.0], 0.8, "#654321", 0.0);
    picture.circle([5.0, 4.0], 0.8, "#654321", 0.0);
    picture
        .shapes
        .push(Shape::Area([1.0, 1.0, 2.0, -1.0], "#abcdef".into()));
    picture.word([10.0, 10.0], [0.0, 1.0], "<b onclick=\"x\">");
    picture.word_upwards([10.0, 10.0], [1.0, 0.0], "up");
    let text = to_svg(&picture, "\"<i>").into_string();
    assert!(text.contains("viewBox=\"0 0 1740 200\""), "{text}");
    assert!(text.contains("d=\"M10 20l100 0\""), "{text}");
    // Two dots of one pen are one path, as wide as the dots.
    assert!(text.contains("d=\"M30 40h0M50 40h0\"") && text.contains("stroke-width=\"16\""));
    assert!(text.contains("height=\"0\""), "{text}");
    // Horizontal text has its baseline at the point. Upward text has its right side and its end there.
    assert!(text.contains("<text x=\"100\" y=\"100\""), "{text}");
    assert!(
        text.contains("text-anchor=\"end\" transform=\"rotate(-90 100 100)\""),
        "{text}"
    );
    assert!(!text.contains("<b") && !text.contains("<i") && text.contains("&lt;b"));
}

#[test]
fn ticks_are_round_and_inside() {
    let scale = Scale::from_values([0.0, 9.3].into_iter(), [0.0, 100.0], false);
    let words: Vec<String> = scale.ticks().into_iter().map(|t| t.1).collect();
    assert_eq!(words, ["0", "2", "4", "6", "8"]);
    let powers = Scale::from_values([2e-3, 60.0].into_iter(), [0.0, 100.0], true);
    let words: Vec<String> = powers.ticks().into_iter().map(|t| t.1).collect();
    assert_eq!(words, ["1e-2", "1e-1", "1e0", "1e1"]);
}

/// Returns the first picture of a figure.
fn first_picture(figure: &Figure) -> Picture {
    pictures(figure).remove(0)
}

#[test]
fn a_range_is_a_wide_bar_and_an_interval_a_line_with_caps() {
    let rows = [("A".to_owned(), [1.0, 2.0, 4.0])];
    let groups = [("run".to_owned(), rows.to_vec())];
    let picture = |ends| first_picture(&intervals(&groups, "kN", ends, "shorter is better"));
    let bars = |p: &Picture| {
        p.shapes
            .iter()
            .filter(|s| matches!(s, Shape::Area(..)))
            .count()
    };
    let caps = |p: &Picture| {
        let of = |s: &Shape| match s {
            Shape::Strokes { lines, .. } => lines.len() == 3,
            _ => false,
        };
        p.shapes.iter().filter(|s| of(s)).count()
    };
    let [interval, span] = [Ends::Interval, Ends::Span].map(picture);
    assert_eq!((bars(&interval), caps(&interval)), (0, 1));
    assert_eq!((bars(&span), caps(&span)), (1, 0));
    // The bar reaches from 1 to 4, three times as far as the point is from its lower end.
    let area = span.shapes.iter().find_map(|s| match s {
        Shape::Area(area, _) => Some(*area),
        _ => None,
    });
    let at = span.shapes.iter().find_map(|s| match s {
        Shape::Circle { at, .. } => Some(*at),
        _ => None,
    });
    let ([left, _, wide, _], [x, _]) = (area.unwrap(), at.unwrap());
    assert!((wide - 3.0 * (x - left)).abs() < 1e-9, "{left} {wide} {x}");
}

#[test]
fn axes_of_a_scatter_plot_are_equal() {
    let load = CrossPlot {
        name: "A",
        unit: "kN",
        points: &[[0.0, 0.1], [100.0, 101.0], [50.0, 49.0]],
    };
    let picture = first_picture(&cross_plot(&[load]));
    // The line of equality rises at 45 degrees.
    let line = picture.shapes.iter().find_map(|s| match s {
        // The line is thinner than in the legend.
        Shape::Strokes { lines, colour, pen } if colour == "#9aa7b5" && *pen < 0.5 => {
            lines.first().cloned()
        }
        _ => None,
    });
    let line = line.unwrap();
    let [a, b] = [line[0], line[1]];
    assert!((b[0] - a[0] - (a[1] - b[1])).abs() < 1e-9, "{line:?}");
}

#[test]
fn a_band_of_a_history_is_drawn_without_a_script() {
    let trace = LoadTrace {
        name: "A".into(),
        unit: "kN".into(),
        times: (0..1000)
            .map(|i| [f64::from(i), f64::from(i) + 1.0])
            .collect(),
        half: 1.0,
        spans: (0..1000)
            .map(|i| [f64::from(i), f64::from(i) + 1.0, f64::from(i) + 2.0])
            .collect(),
    };
    let picture = first_picture(&history(&[trace]));
    let regions: Vec<&Vec<[f64; 2]>> = picture
        .shapes
        .iter()
        .filter_map(|s| match s {
            Shape::Region(corners, _) => Some(corners),
            _ => None,
        })
        .collect();
    // The interval, then the band from smallest to largest. Both have fewer points than the samples.
    assert_eq!(regions.len(), 2);
    assert!(regions.iter().all(|r| r.len() > 100 && r.len() <= 480));
}
