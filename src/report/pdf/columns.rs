//! How a table fits the paper: size of type, upright or across, and where not even that is enough, columns dealt over several tables.

use crate::report::drawing::picture::UPRIGHT;
use crate::report::page::Table;

/// Width of the text on a sheet that is turned, mm.
const ACROSS: f64 = 261.0;
/// Width of a character, in millimetres per point of type size. It is a little less than half of the type size, the mean of digits, small letters and
/// spaces.
const PER_CHARACTER: f64 = 0.44 * 25.4 / 72.0;
/// Space next to a column, mm.
const COLUMN_SPACE_MM: f64 = 3.0;
/// Characters after which a cell goes on in the next line.
const WRAPPED: usize = 26;
/// Sizes of type tried, points.
const SIZES: [f64; 5] = [9.0, 8.5, 8.0, 7.5, 7.0];
/// Rows from which a narrow table is set in two columns, and the space between these, mm.
const LONG: usize = 45;
const GUTTER: f64 = 8.0;
/// Longest word that is not broken.
pub(super) const LONGEST_WORD: usize = 22;

/// Layout of a table, or of some of its columns.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TableLayout {
    /// Columns shown.
    pub(super) columns: Vec<usize>,
    /// Size of type, points.
    pub(super) size: f64,
    /// Whether the sheet is turned.
    pub(super) across: bool,
    /// Whether the page has two parts of the table next to each other.
    pub(super) halved: bool,
}

/// Returns the table in one piece if a font size allows this, or else in pieces that repeat the first column. A table without columns gives no piece.
pub(super) fn fit_table(table: &Table) -> Vec<TableLayout> {
    let n = table.rows.iter().map(Vec::len).max().unwrap_or(0);
    let n = n.max(table.head.len());
    if n == 0 {
        return Vec::new();
    }
    let widths: Vec<usize> = (0..n).map(|c| characters(table, c)).collect();
    let whole = |across: bool, size: f64| TableLayout {
        columns: (0..n).collect(),
        size,
        across,
        halved: false,
    };
    let wide = |size: f64| widths.iter().map(|w| width(*w, size)).sum::<f64>();
    if table.rows.len() > LONG
        && let Some(size) = SIZES.iter().find(|s| 2.0 * wide(**s) + GUTTER <= UPRIGHT)
    {
        return vec![TableLayout {
            halved: true,
            ..whole(false, *size)
        }];
    }
    // Small type is used only on landscape pages, for tables that are still too wide.
    let upright = SIZES.iter().filter(|s| **s > 7.5);
    let upright = upright.map(|s| (false, UPRIGHT, *s));
    let across = SIZES.iter().map(|s| (true, ACROSS, *s));
    if let Some((across, _, size)) = upright.chain(across).find(|t| wide(t.2) <= t.1) {
        return vec![whole(across, size)];
    }
    const SMALL: f64 = 7.0;
    let first = width(widths.first().copied().unwrap_or(0), SMALL);
    let mut out: Vec<TableLayout> = Vec::new();
    let mut used = f64::INFINITY;
    for (c, w) in widths.iter().enumerate().skip(1) {
        let own = width(*w, SMALL);
        if used + own > ACROSS {
            out.push(TableLayout {
                columns: vec![0],
                ..whole(true, SMALL)
            });
            used = first;
        }
        used += own;
        if let Some(last) = out.last_mut() {
            last.columns.push(c);
        }
    }
    out
}

/// Characters that a column is wide: its longest cell, or what that wraps to.
fn characters(table: &Table, column: usize) -> usize {
    let cells = table.rows.iter().chain(std::iter::once(&table.head));
    let cells = cells.filter_map(|row| row.get(column));
    let wide = |cell: &String| {
        let word = cell.split_whitespace().map(|w| w.chars().count()).max();
        let word = word.unwrap_or(0).min(LONGEST_WORD);
        cell.chars().count().min(WRAPPED).max(word)
    };
    cells.map(wide).max().unwrap_or(0)
}

fn width(characters: usize, size: f64) -> f64 {
    characters as f64 * size * PER_CHARACTER + COLUMN_SPACE_MM
}

/// Returns whether a column contains numbers, which are right-aligned.
pub(super) fn is_numeric(table: &Table, column: usize) -> bool {
    let mut cells = table.rows.iter().filter_map(|row| row.get(column));
    let numeric = |cell: &String| {
        let bare = cell.trim_end_matches('%').trim();
        bare.is_empty() || bare == "-" || bare == "∞" || bare.parse::<f64>().is_ok()
    };
    column > 0 && cells.all(numeric)
}
