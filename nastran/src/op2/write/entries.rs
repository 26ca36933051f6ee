//! Encodes rows as the words of entries, the inverse of decoding.

use super::error::WriteError;
use crate::op2::rows::{Layout, Shape};
use crate::results::{Block, RowId, Rows};

/// Number of stations of a beam in the file.
const BEAM_STATIONS: usize = 11;

/// Returns the words of all entries of a block.
pub(super) fn entries(block: &Block, rows: &Rows, layout: Layout) -> Result<Vec<u8>, WriteError> {
    if rows.columns.len() != layout.columns.len() {
        return Err(WriteError::Columns {
            found: rows.columns.len(),
            expected: layout.columns.len(),
        });
    }
    let mut out = Vec::with_capacity(rows.values.len().saturating_mul(5));
    let mut at = 0;
    while at < rows.len() {
        let n = rows_of_entry(block, rows, layout, at)?;
        let ids = rows.ids.get(at..at.saturating_add(n)).unwrap_or(&[]);
        let row = |i: usize| rows.row(at.saturating_add(i));
        push_entry(&mut out, layout, corner_word(block), ids, row)?;
        at = at.saturating_add(n);
    }
    Ok(out)
}

/// Returns the number of rows from `at` on that make one entry.
fn rows_of_entry(
    block: &Block,
    rows: &Rows,
    layout: Layout,
    at: usize,
) -> Result<usize, WriteError> {
    let entity = rows.ids.get(at).map_or(0, |id| id.entity);
    let same = rows
        .ids
        .iter()
        .skip(at)
        .take_while(|id| id.entity == entity)
        .count();
    let expected = match layout.shape {
        Shape::Nodal | Shape::Plain | Shape::Stations | Shape::Ply => return Ok(1),
        Shape::Beam => same.clamp(2, BEAM_STATIONS),
        Shape::ShellCentre => 2,
        Shape::ShellCorners => layout.wide.saturating_sub(2) / 17 * 2,
        Shape::ForceCorners => layout.wide.saturating_sub(2) / 9,
        Shape::Solid => layout.wide.saturating_sub(4) / 21,
        Shape::GridPoint => {
            return Err(WriteError::Unsupported {
                quantity: block.quantity,
                element: block.element,
            });
        }
    };
    if same < expected || (layout.shape == Shape::Beam && same > BEAM_STATIONS) {
        return Err(WriteError::Rows {
            quantity: block.quantity,
            entity,
            found: same,
            expected,
        });
    }
    Ok(expected)
}

/// Returns the word after `CEN/`, the element's number of grids.
fn corner_word(block: &Block) -> i32 {
    match block.element.map(|e| e.0) {
        Some(64) => 8,
        Some(75) => 6,
        Some(70) => 3,
        _ => 4,
    }
}

fn push_entry<'r>(
    out: &mut Vec<u8>,
    layout: Layout,
    corner_word: i32,
    ids: &[RowId],
    row: impl Fn(usize) -> &'r [f64],
) -> Result<(), WriteError> {
    let Some(first) = ids.first() else {
        return Ok(());
    };
    let word = i32::try_from(first.entity)
        .ok()
        .and_then(|id| id.checked_mul(10)?.checked_add(1))
        .ok_or(WriteError::Id(first.entity))?;
    int(out, word)?;
    match layout.shape {
        Shape::Nodal => {
            int(out, first.at.max(1))?;
            reals(out, row(0));
        }
        Shape::Ply => {
            int(out, first.layer)?;
            reals(out, row(0));
        }
        Shape::ShellCorners | Shape::ForceCorners => {
            let layers = if layout.shape == Shape::ShellCorners {
                2
            } else {
                1
            };
            out.extend_from_slice(b"CEN/");
            for (i, id) in ids.iter().enumerate() {
                if i == 0 {
                    int(out, corner_word)?;
                } else if i.is_multiple_of(layers) {
                    int(out, id.at)?;
                }
                reals(out, row(i));
            }
        }
        Shape::Solid => {
            // The first row's `layer` contains the coordinate system. The number of corners does not include the centre.
            int(out, first.layer)?;
            out.extend_from_slice(b"GRID");
            int(out, ids.len().saturating_sub(1))?;
            for (i, id) in ids.iter().enumerate() {
                int(out, id.at)?;
                reals(out, &solid_words(row(i)));
            }
        }
        Shape::Beam => {
            // End A is first and end B is last; the stations between them follow end A.
            let last = ids.len().saturating_sub(1);
            for slot in 0..BEAM_STATIONS {
                let i = if slot.saturating_add(1) == BEAM_STATIONS {
                    last
                } else {
                    slot
                };
                match ids
                    .get(i)
                    .filter(|_| i < last || slot.saturating_add(1) == BEAM_STATIONS)
                {
                    Some(id) => {
                        int(out, id.at)?;
                        reals(out, row(i));
                    }
                    None => out.resize(
                        out.len().saturating_add(
                            layout.columns.len().saturating_add(1).saturating_mul(4),
                        ),
                        0,
                    ),
                }
            }
        }
        _ => (0..ids.len()).for_each(|i| reals(out, row(i))),
    }
    Ok(())
}

/// Returns the 20 reals of a location of a solid from `xx yy zz xy yz zx max mid min vm`. The direction cosines of the principal axes are zero.
fn solid_words(row: &[f64]) -> [f64; 20] {
    let v = |i: usize| row.get(i).copied().unwrap_or(0.0);
    let pressure = -(v(0) + v(1) + v(2)) / 3.0;
    let mut words = [0.0; 20];
    let places = [
        (0, v(0)),
        (1, v(3)),
        (2, v(6)),
        (6, pressure),
        (7, v(9)),
        (8, v(1)),
        (9, v(4)),
        (10, v(7)),
        (14, v(2)),
        (15, v(5)),
        (16, v(8)),
    ];
    for (at, value) in places {
        if let Some(word) = words.get_mut(at) {
            *word = value;
        }
    }
    words
}

fn int(out: &mut Vec<u8>, value: impl TryInto<i32> + Copy) -> Result<(), WriteError> {
    let value: i32 = value.try_into().map_err(|_| WriteError::Id(u32::MAX))?;
    out.extend_from_slice(&value.to_le_bytes());
    Ok(())
}

fn reals(out: &mut Vec<u8>, values: &[f64]) {
    out.extend(values.iter().flat_map(|v| (*v as f32).to_le_bytes()));
}
