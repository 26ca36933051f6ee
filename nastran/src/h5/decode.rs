//! Decodes records into rows.

use super::H5Error;
use super::layout::{Kind, Layout};
use super::table::{Field, Table};
use crate::results::{RowId, Rows};

/// Returns the rows of records `start .. start + count`.
pub(super) fn rows(
    table: &Table<'_>,
    layout: &Layout,
    start: u64,
    count: u64,
) -> Result<Rows, H5Error> {
    let id = table.need(layout.id)?;
    let fields = layout.fields.iter().map(|&name| {
        if name.is_empty() {
            Ok(None)
        } else {
            table.need(name).map(Some)
        }
    });
    let fields = fields.collect::<Result<Vec<Option<Field>>, _>>()?;
    let grid = match layout.kind {
        Kind::ShellCorner | Kind::Beam | Kind::Solid => Some(table.need("GRID")?),
        _ => None,
    };
    let ply = if layout.kind == Kind::Ply {
        Some(table.need("PLY")?)
    } else {
        None
    };
    // A damaged field could state any array length. The size of the record bounds the array, and so the number of locations.
    let places = grid.map_or(1, |g| g.count);
    let mut out = Rows {
        columns: layout.columns,
        ..Rows::default()
    };
    table.each_record(start, count, |r| {
        let entity = id.id(r, 0);
        let value = |f: &Option<Field>, k: usize| f.map_or(f64::NAN, |f| f.read_real(r, k));
        match layout.kind {
            Kind::Plain | Kind::Station | Kind::Ply => {
                let at = match (layout.kind, layout.element, out.ids.last()) {
                    (Kind::Plain, None, _) => 1,
                    (Kind::Station, _, Some(last)) if last.entity == entity => {
                        last.at.saturating_add(1)
                    }
                    (Kind::Station, ..) => 1,
                    _ => 0,
                };
                out.ids.push(RowId {
                    entity,
                    at,
                    layer: ply.map_or(0, |p| p.id(r, 0)),
                });
                out.values.extend(fields.iter().map(|f| value(f, 0)));
            }
            Kind::ShellCentre | Kind::ShellCorner => {
                for k in 0..places {
                    // At the centre the first word of GRID is the number of corners, not a grid.
                    let at = if k == 0 {
                        0
                    } else {
                        grid.map_or(0, |g| g.id(r, k))
                    };
                    for (layer, fibre) in (1..).zip(fields.chunks(4)) {
                        out.ids.push(RowId { entity, at, layer });
                        out.values
                            .extend(fibre.iter().map(|f| value(f, k)).chain([f64::NAN; 4]));
                    }
                }
            }
            Kind::Beam => {
                for k in 0..places {
                    let at = grid.map_or(0, |g| g.id(r, k));
                    let x_xb = fields.first().map_or(0.0, |f| value(f, k));
                    // The solver writes zeros for stations without an output request.
                    if k == 0 || at != 0 || x_xb != 0.0 {
                        out.ids.push(RowId {
                            entity,
                            at,
                            layer: 0,
                        });
                        out.values.extend(fields.iter().map(|f| value(f, k)));
                    }
                }
            }
            Kind::Solid => {
                for k in 0..places {
                    out.ids.push(RowId {
                        entity,
                        at: grid.map_or(0, |g| g.id(r, k)),
                        layer: 0,
                    });
                    out.values.extend(fields.iter().map(|f| value(f, k)));
                }
            }
        }
        Ok(())
    })?;
    Ok(out)
}
