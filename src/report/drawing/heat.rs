//! A matrix as colours on paper, with its numbers in the cells where they fit.

use super::picture::{LONGEST, Picture, Shape, UPRIGHT};
use crate::units::number;
use serde_json::Value;

/// Rows of one picture, height of a row, and width of a cell that holds its number, mm.
const ROWS: usize = 40;
const ROW: f64 = 4.6;
const HOLDS: f64 = 12.0;

/// Range of the colours.
const RANGE: &str =
    "Colours: blue −100 %, white 0, red 100 % of the largest magnitude in the column.";

/// Returns the map in pictures of at most [`ROWS`] rows.
pub(in crate::report) fn heat(map: &Value) -> Vec<Picture> {
    let names = |v: &Value| -> Vec<String> {
        let list = v.as_array().into_iter().flatten();
        list.map(|n| n.as_str().unwrap_or("").to_owned()).collect()
    };
    let (columns, rows) = (names(&map["x"]), names(&map["y"]));
    if columns.is_empty() {
        return Vec::new();
    }
    let firsts = (0..rows.len()).step_by(ROWS);
    firsts
        .map(|first| {
            let end = (first + ROWS).min(rows.len());
            part(map, &columns, &rows[first..end], first)
        })
        .collect()
}

fn part(map: &Value, columns: &[String], rows: &[String], first: usize) -> Picture {
    let longest = |names: &[String]| names.iter().map(|n| n.chars().count()).max();
    let room = |names: &[String]| 4.0 + 1.3 * longest(names).unwrap_or(0).min(LONGEST) as f64;
    let (left, top) = (room(rows), room(columns));
    // A map of few columns does not fill the page width.
    let width = ((UPRIGHT - left) / columns.len() as f64).min(22.0);
    let mut picture = Picture {
        size: [UPRIGHT, top + ROW * rows.len() as f64 + 1.0],
        caption: RANGE.to_owned(),
        ..Picture::default()
    };
    for (c, name) in columns.iter().enumerate() {
        let middle = left + width * (c as f64 + 0.5);
        picture.word_upwards([middle, top - 1.0], [0.5, 1.0], name);
    }
    for (r, name) in rows.iter().enumerate() {
        let y = top + ROW * r as f64;
        picture.word([left - 1.2, y + ROW / 2.0], [1.0, 0.5], name);
        for c in 0..columns.len() {
            let x = left + width * c as f64;
            let share = map["z"][first + r][c].as_f64().unwrap_or(0.0);
            let area = [x + 0.1, y + 0.1, width - 0.2, ROW - 0.2];
            picture.shapes.push(Shape::Area(area, colour(share)));
            if let Some(v) = map["customdata"][first + r][c].as_f64()
                && width >= HOLDS
            {
                let middle = [x + width / 2.0, y + ROW / 2.0];
                picture.word(middle, [0.5, 0.5], &number(v));
            }
        }
    }
    picture
}

/// White at 0, red towards 1, blue towards -1: light enough for dark numbers.
fn colour(share: f64) -> String {
    let end: [f64; 3] = if share < 0.0 {
        [120.0, 165.0, 215.0]
    } else {
        [235.0, 135.0, 115.0]
    };
    let mix = |k: usize| 250.0 + (end[k] - 250.0) * share.abs().min(1.0);
    format!(
        "#{:02x}{:02x}{:02x}",
        mix(0) as u8,
        mix(1) as u8,
        mix(2) as u8
    )
}
