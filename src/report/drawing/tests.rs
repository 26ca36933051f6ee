use super::picture::{Picture, Shape};
use super::scale::Scale;
use super::to_svg;
use super::trails::trails;
use std::collections::BTreeSet;

type Point = [i64; 2];

/// The steps of length one along the axes that lines take, each once, whichever way it is walked.
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
    // Of 10 rows and 13 columns each needs its two ends.
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
    // The foot of the words stands at the place; upwards their right side, and their end.
    assert!(text.contains("<text x=\"100\" y=\"100\""), "{text}");
    assert!(
        text.contains("text-anchor=\"end\" transform=\"rotate(-90 100 100)\""),
        "{text}"
    );
    assert!(!text.contains("<b") && !text.contains("<i") && text.contains("&lt;b"));
}

#[test]
fn ticks_are_round_and_inside() {
    let scale = Scale::over([0.0, 9.3].into_iter(), [0.0, 100.0], false);
    let words: Vec<String> = scale.ticks().into_iter().map(|t| t.1).collect();
    assert_eq!(words, ["0", "2", "4", "6", "8"]);
    let powers = Scale::over([2e-3, 60.0].into_iter(), [0.0, 100.0], true);
    let words: Vec<String> = powers.ticks().into_iter().map(|t| t.1).collect();
    assert_eq!(words, ["1e-2", "1e-1", "1e0", "1e1"]);
}
