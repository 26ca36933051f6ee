//! Decodes the words of a record into rows.

use super::{Layout, Shape};
use crate::op2::words::Words;
use crate::results::{Label, RowId, Rows};

/// An impossible id in a record, with its row and value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::op2) struct BadId {
    pub row: usize,
    pub found: i64,
}

/// Returns the rows of a record; an incomplete last entry is omitted. If the identification record names the entity (SORT2), `entity` is the id of
/// all rows. Otherwise each entry begins with its id.
///
/// # Errors
///
/// [`BadId`] for a negative id, or one of more than 32 bits.
pub(in crate::op2) fn decode(
    words: Words<'_>,
    layout: Layout,
    entity: Option<u32>,
) -> Result<Rows, BadId> {
    let entries = words.len() / layout.wide.max(1);
    let per_entry = rows_per_entry(layout);
    let n = entries.saturating_mul(per_entry);
    let mut rows = Rows {
        columns: layout.columns,
        ids: Vec::with_capacity(n),
        values: Vec::with_capacity(n.saturating_mul(layout.columns.len())),
        labels: Vec::new(),
    };
    for (i, entry) in words.entries(layout.wide).enumerate() {
        push_entry(entry, layout, entity, &mut rows).map_err(|found| BadId { row: i, found })?;
    }
    if layout.shape == Shape::Stations {
        number_stations(&mut rows.ids);
    }
    rows.ids.shrink_to_fit();
    rows.values.shrink_to_fit();
    Ok(rows)
}

/// Returns the number of rows to reserve for an entry. A beam has 11 stations, of which mostly 2 are used, so only 2 are reserved.
fn rows_per_entry(layout: Layout) -> usize {
    match layout.shape {
        Shape::Nodal | Shape::Plain | Shape::Stations | Shape::Ply | Shape::GridPoint => 1,
        Shape::ShellCentre | Shape::Beam => 2,
        Shape::ShellCorners => layout.wide.saturating_sub(2) / 17 * 2,
        Shape::ForceCorners => layout.wide.saturating_sub(2) / 9,
        Shape::Solid => layout.wide.saturating_sub(4) / 21,
    }
}

/// Adds the rows of one entry. `Err` contains the value found in place of an id.
fn push_entry(
    w: Words<'_>,
    layout: Layout,
    entity: Option<u32>,
    rows: &mut Rows,
) -> Result<(), i64> {
    let entity = entity.map_or_else(|| leading_id(w), Ok)?;
    let id = |at: u32, layer: u32| RowId { entity, at, layer };
    let grid = |i: usize| narrow_to_u32(w.int(i).unwrap_or(0));
    let columns = layout.columns.len();
    match layout.shape {
        Shape::Plain | Shape::Stations => {
            rows.ids.push(id(0, 0));
            w.push_reals(1, columns, &mut rows.values);
        }
        Shape::Nodal => {
            rows.ids.push(id(grid(1)?, 0));
            w.push_reals(2, columns, &mut rows.values);
        }
        Shape::Ply => {
            rows.ids.push(id(0, grid(1)?));
            w.push_reals(2, columns, &mut rows.values);
        }
        Shape::GridPoint => {
            rows.ids.push(id(grid(1)?, 0));
            rows.labels.push(Label::new(&w.text(2, 2)));
            w.push_reals(4, columns, &mut rows.values);
        }
        Shape::ShellCentre => {
            rows.ids.extend([id(0, 1), id(0, 2)]);
            w.push_reals(1, 2 * columns, &mut rows.values);
        }
        Shape::ShellCorners => {
            for (i, place) in w.rest(2).entries(17).enumerate() {
                let at = if i == 0 {
                    0
                } else {
                    narrow_to_u32(place.int(0).unwrap_or(0))?
                };
                rows.ids.extend([id(at, 1), id(at, 2)]);
                place.push_reals(1, 2 * columns, &mut rows.values);
            }
        }
        Shape::ForceCorners => {
            for (i, place) in w.rest(2).entries(9).enumerate() {
                let at = if i == 0 {
                    0
                } else {
                    narrow_to_u32(place.int(0).unwrap_or(0))?
                };
                rows.ids.push(id(at, 0));
                place.push_reals(1, columns, &mut rows.values);
            }
        }
        Shape::Beam => {
            for (i, station) in w.rest(1).entries(columns.saturating_add(1)).enumerate() {
                // The solver writes zeros for stations without an output request.
                if i == 0 || station.real_at(1).is_some_and(|x| x > 0.0) {
                    rows.ids
                        .push(id(narrow_to_u32(station.int(0).unwrap_or(0))?, 0));
                    station.push_reals(1, columns, &mut rows.values);
                }
            }
        }
        Shape::Solid => {
            for place in w.rest(4).entries(21) {
                rows.ids
                    .push(id(narrow_to_u32(place.int(0).unwrap_or(0))?, 0));
                push_solid(place, &mut rows.values);
            }
        }
    }
    Ok(())
}

/// Adds a location of a solid: `grid, xx xy p1 a1 a2 a3 pressure vm, yy yz p2 b1 b2 b3, zz zx p3 c1 c2 c3`, where a, b, c are direction cosines. The
/// file lists the principal values p1 p2 p3 in any order; the row contains them sorted.
fn push_solid(place: Words<'_>, out: &mut Vec<f64>) {
    let v = |i: usize| place.real_at(i).unwrap_or(f64::NAN);
    let mut principal = [v(3), v(11), v(17)];
    principal.sort_by(|a, b| b.total_cmp(a));
    let [max, mid, min] = principal;
    out.extend([v(1), v(9), v(15), v(2), v(10), v(16), max, mid, min, v(8)]);
}

/// Returns the id of `10 id + device`, without the device code.
fn leading_id(w: Words<'_>) -> Result<u32, i64> {
    let word = w.int(0).unwrap_or(0);
    if word < 0 {
        return Err(word);
    }
    narrow_to_u32(word / 10).map_err(|_| word)
}

fn narrow_to_u32(word: i64) -> Result<u32, i64> {
    u32::try_from(word).map_err(|_| word)
}

/// Numbers the entries of each bar from 1.
fn number_stations(ids: &mut [RowId]) {
    let mut last = (None, 0_u32);
    for id in ids {
        let n = if last.0 == Some(id.entity) {
            last.1.saturating_add(1)
        } else {
            1
        };
        last = (Some(id.entity), n);
        id.at = n;
    }
}
