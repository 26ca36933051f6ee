//! `strains.csv`.

use crate::fe::Solution;
use crate::fe::strain_rows::{Location, Point, StrainRow, each_row, n_elements};
use crate::model::Model;
use crate::units::MICROSTRAIN;
use rayon::prelude::*;
use std::fmt::Write as _;
use std::io::{self, Write};

/// First line of `strains.csv`. Strain is in microstrain. Lower case names are in the element frame with engineering shear, upper case names in the
/// basic frame with tensor shear.
pub const STRAINS_HEADER: &str =
    "subcase,element,type,location,surface,exx,eyy,gxy,Exx,Eyy,Ezz,Exy,Eyz,Ezx";

/// Returns the columns of `strains.csv` with their units.
pub fn strains_columns() -> impl Iterator<Item = (&'static str, &'static str)> {
    let is_strain = |c: &str| c.len() == 3 && c.starts_with(['e', 'g', 'E']);
    STRAINS_HEADER
        .split(',')
        .map(move |c| (c, if is_strain(c) { "microstrain" } else { "" }))
}

/// Elements a piece of text: pieces are made in parallel and written in order.
const PIECE: usize = 2048;
/// Pieces held in memory at a time.
const PIECES: usize = 32;
const POINTS: [&str; 4] = ["C", "D", "E", "F"];

/// Writes the strain of every case, subcases in the solution's order, rows in the order of [`each_row`]; returns the number of rows.
///
/// Strain is in microstrain. Numbers are the shortest text that reads back to the same double; a number that does not exist is
/// an empty field. Bars: `surface` is the recovery point C, D, E or F, `location` an end grid or `x=<x/xb>` between the ends, `eyy` and
/// `gxy` are empty.
///
/// # Errors
/// Errors of `out`.
pub fn write_strains(
    model: &Model,
    solution: &Solution,
    out: &mut impl Write,
) -> io::Result<usize> {
    writeln!(out, "{STRAINS_HEADER}")?;
    let mut pieces = Vec::new();
    for case in &solution.cases {
        let n = n_elements(case);
        pieces.extend(
            (0..n)
                .step_by(PIECE)
                .map(|start| (case, start..(start + PIECE).min(n))),
        );
    }
    let mut n_rows = 0;
    for group in pieces.chunks(PIECES) {
        let texts: Vec<(String, usize)> = group
            .par_iter()
            .map(|(case, range)| {
                let (mut text, mut rows) = (String::new(), 0);
                each_row(model, case, range.clone(), |row| {
                    line(&mut text, case.subcase, row);
                    rows += 1;
                });
                (text, rows)
            })
            .collect();
        for (text, rows) in texts {
            out.write_all(text.as_bytes())?;
            n_rows += rows;
        }
    }
    Ok(n_rows)
}

fn line(text: &mut String, subcase: u32, row: &StrainRow) {
    // Writing to a `String` can't fail.
    let _ = write!(text, "{subcase},{},{},", row.element, row.card);
    let _ = match row.location {
        Location::Centre => write!(text, "centre"),
        Location::Grid(id) => write!(text, "{id}"),
        Location::Station(x) => write!(text, "x={x}"),
    };
    text.push(',');
    text.push_str(match row.point {
        Point::Surface(s) => s.word(),
        Point::Recovery(p) => POINTS.get(p).copied().unwrap_or(""),
    });
    for &strain in row.local.iter().chain(&row.basic) {
        let v = strain / MICROSTRAIN;
        text.push(',');
        if v == 0.0 {
            text.push('0');
        } else if !v.is_nan() {
            let _ = write!(text, "{v:e}");
        }
    }
    text.push('\n');
}
