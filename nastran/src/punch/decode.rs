//! Decodes the values of an entry into rows.

use super::PunchError;
use super::entry::{Entry, Word};
use crate::results::{Block, Quantity, RowId, Rows, columns as c};
use std::ops::RangeInclusive;

/// Returns the table and the element type, for messages.
pub(super) fn name(block: &Block) -> String {
    match block.element {
        Some(e) => format!(
            "{} {}",
            block.table,
            e.name().map_or_else(|| e.0.to_string(), str::to_string)
        ),
        None => block.table.clone(),
    }
}

/// Returns why the rows of a block are not decoded; `None` if they are decoded.
pub(super) fn refusal(block: &Block) -> Option<String> {
    if block.complex {
        return Some("complex numbers".to_string());
    }
    if block.sort2 {
        return Some("SORT2 (one entity over many steps)".to_string());
    }
    if columns(block).is_none() {
        return Some(format!("no layout is known for {}", block.quantity.word()));
    }
    None
}

/// Returns whether the rows are shell strain or stress at fibres.
pub(super) fn is_shell(block: &Block) -> bool {
    matches!(
        layout(block),
        Some(Layout::ShellCentre | Layout::ShellCorner)
    )
}

/// Returns the column names of a block.
pub(super) fn columns(block: &Block) -> Option<&'static [&'static str]> {
    Some(match layout(block)? {
        Layout::Nodal | Layout::Bush => c::NODAL,
        Layout::ShellCentre | Layout::ShellCorner if block.quantity == Quantity::Strain => {
            c::SHELL_STRAIN
        }
        Layout::ShellCentre | Layout::ShellCorner => c::SHELL_STRESS,
        Layout::Ply => c::PLY,
        Layout::Bar => c::BAR,
        Layout::BarStation => c::BAR_STATION,
        Layout::Beam => c::BEAM,
        Layout::Rod => c::ROD,
        Layout::Spring => c::SPRING,
        Layout::ShearPanel => c::SHEAR_PANEL,
        Layout::Solid => c::SOLID,
    })
}

#[derive(Clone, Copy, PartialEq)]
enum Layout {
    Nodal,
    ShellCentre,
    ShellCorner,
    Ply,
    Bar,
    BarStation,
    Beam,
    Rod,
    Spring,
    Bush,
    ShearPanel,
    Solid,
}

fn layout(block: &Block) -> Option<Layout> {
    use Quantity::*;
    match block.quantity {
        Displacement | Velocity | Acceleration | Eigenvector | SpcForce | MpcForce
        | AppliedLoad => Some(Layout::Nodal),
        PlyStress | PlyStrain => Some(Layout::Ply),
        Stress | Strain => Some(match block.element?.0 {
            33 | 74 | 227 | 228 => Layout::ShellCentre,
            64 | 70 | 75 | 82 | 144 => Layout::ShellCorner,
            34 => Layout::Bar,
            100 => Layout::BarStation,
            2 => Layout::Beam,
            1 | 3 | 10 => Layout::Rod,
            11..=14 => Layout::Spring,
            102 => Layout::Bush,
            4 => Layout::ShearPanel,
            39 | 67 | 68 | 255 => Layout::Solid,
            _ => return None,
        }),
        _ => None,
    }
}

/// Adds the rows of one entry.
pub(super) fn push(block: &Block, entry: &Entry, rows: &mut Rows) -> Result<(), PunchError> {
    let words = &entry.words;
    let id = |at, layer| RowId {
        entity: entry.id,
        at,
        layer,
    };
    match layout(block) {
        // A scalar point has one value; its other components stay zero.
        Some(Layout::Nodal) => {
            let kind = match entry.letter {
                Some(b'S') => 2,
                _ => 1,
            };
            let wanted = if kind == 2 {
                words.len().clamp(1, 6)
            } else {
                6
            };
            count(entry, wanted)?;
            let missing = 6 - wanted.min(6);
            push_row(rows, id(kind, 0), words);
            rows.values.extend(std::iter::repeat_n(0.0, missing));
        }
        // A margin of safety that is blank at the end of an entry is removed with the trailing blanks of the line.
        Some(Layout::Bar) => push_padded_row(entry, 13..=15, id(0, 0), rows)?,
        Some(Layout::Rod) => push_padded_row(entry, 3..=4, id(0, 0), rows)?,
        Some(Layout::Spring) => push_padded_row(entry, 1..=1, id(0, 0), rows)?,
        Some(Layout::Bush) => push_padded_row(entry, 6..=6, id(0, 0), rows)?,
        Some(Layout::ShearPanel) => push_padded_row(entry, 2..=3, id(0, 0), rows)?,
        Some(Layout::BarStation) => {
            let station = match rows.ids.last() {
                Some(last) if last.entity == entry.id => last.at.saturating_add(1),
                _ => 1,
            };
            push_padded_row(entry, 8..=9, id(station, 0), rows)?;
        }
        Some(Layout::Ply) => {
            count(entry, 10)?;
            let (ply, values) = words.split_first().unwrap_or((&Word::Blank, &[]));
            let ply = ply.id().ok_or_else(|| not_an_id(entry))?;
            push_row(rows, id(0, ply), values);
        }
        Some(Layout::ShellCentre) => {
            count(entry, 16)?;
            two_fibres(entry, 0, words, rows);
        }
        Some(Layout::ShellCorner) => {
            // Layout: CEN/, corner count, 16 reals, then a grid and 16 reals for each corner.
            let corners = words.len().saturating_sub(18) / 17;
            count(entry, 18 + 17 * corners)?;
            two_fibres(entry, 0, words.get(2..18).unwrap_or(&[]), rows);
            for corner in words.get(18..).unwrap_or(&[]).chunks_exact(17) {
                let (grid, values) = corner.split_first().unwrap_or((&Word::Blank, &[]));
                two_fibres(
                    entry,
                    grid.id().ok_or_else(|| not_an_id(entry))?,
                    values,
                    rows,
                );
            }
        }
        Some(Layout::Beam) => {
            let stations = words.len().saturating_add(2) / 10;
            if words.len() < 8 || words.len() > 10 * stations {
                return Err(PunchError::WordCount {
                    line: entry.line,
                    found: words.len(),
                    expected: 10 * stations.max(1),
                });
            }
            for (i, station) in words.chunks(10).enumerate() {
                let (grid, values) = station.split_first().unwrap_or((&Word::Blank, &[]));
                let x_xb = values.first().map_or(0.0, |w| w.to_real());
                // The solver writes zeros for stations without an output request.
                if i == 0 || grid.id().unwrap_or(0) != 0 || x_xb != 0.0 {
                    push_row(rows, id(grid.id().unwrap_or(0), 0), values);
                    rows.values.extend(std::iter::repeat_n(
                        f64::NAN,
                        9_usize.saturating_sub(values.len()),
                    ));
                }
            }
        }
        Some(Layout::Solid) => {
            // Layout: CID, CTYPE, corner count. Then each location: grid, xx xy max 3 cosines pressure vm, yy yz mid 3 cosines, zz zx min 3 cosines.
            let locations = words.len().saturating_sub(3) / 21;
            count(entry, 3 + 21 * locations)?;
            for location in words.get(3..).unwrap_or(&[]).chunks_exact(21) {
                let w = |i: usize| location.get(i).copied().unwrap_or(Word::Blank);
                let ordered = [
                    w(1),
                    w(9),
                    w(15),
                    w(2),
                    w(10),
                    w(16),
                    w(3),
                    w(11),
                    w(17),
                    w(8),
                ];
                push_row(
                    rows,
                    id(w(0).id().ok_or_else(|| not_an_id(entry))?, 0),
                    &ordered,
                );
            }
        }
        None => {}
    }
    Ok(())
}

fn push_padded_row(
    entry: &Entry,
    wanted: RangeInclusive<usize>,
    id: RowId,
    rows: &mut Rows,
) -> Result<(), PunchError> {
    let found = entry.words.len();
    if !wanted.contains(&found) {
        return Err(PunchError::WordCount {
            line: entry.line,
            found,
            expected: *wanted.end(),
        });
    }
    push_row(rows, id, &entry.words);
    rows.values.extend(std::iter::repeat_n(
        f64::NAN,
        wanted.end().saturating_sub(found),
    ));
    Ok(())
}

fn count(entry: &Entry, expected: usize) -> Result<(), PunchError> {
    let found = entry.words.len();
    if found == expected && expected > 0 {
        Ok(())
    } else {
        Err(PunchError::WordCount {
            line: entry.line,
            found,
            expected,
        })
    }
}

fn not_an_id(entry: &Entry) -> PunchError {
    PunchError::BadField {
        line: entry.line,
        text: entry.id.to_string(),
        expected: "a grid id in the entry",
    }
}

fn push_row(rows: &mut Rows, id: RowId, words: &[Word]) {
    rows.ids.push(id);
    rows.values.extend(words.iter().map(|w| w.to_real()));
}

fn two_fibres(entry: &Entry, at: u32, words: &[Word], rows: &mut Rows) {
    for (layer, fibre) in (1..).zip(words.chunks_exact(8)) {
        push_row(
            rows,
            RowId {
                entity: entry.id,
                at,
                layer,
            },
            fibre,
        );
    }
}
