//! Cards of a deck changed by columns.

use crate::fault::argument_fault;
use nastran::bdf::{Deck, Edits, ToFields};
use nastran::cards::{Conm2, Grid, MaterialAngle, Shell, ShellShape};
use nastran::place::PlacedCard;
use numpy::PyReadonlyArray1;
use std::collections::HashMap;
use strainbridge::{Fault, Faults};

/// Columns of the cards with a name, all as reals, row by row.
pub(crate) type Columns<'py> = HashMap<String, PyReadonlyArray1<'py, f64>>;

/// Shapes of shells.
const SHAPES: [ShellShape; 6] = [
    ShellShape::Quad4,
    ShellShape::QuadR,
    ShellShape::Quad8,
    ShellShape::Tria3,
    ShellShape::TriaR,
    ShellShape::Tria6,
];

/// Columns of one card name.
struct Rows<'a, 'py> {
    name: &'a str,
    columns: &'a Columns<'py>,
}

impl Rows<'_, '_> {
    fn fault(&self, field: &str, said: &str, remedy: &str) -> Fault {
        argument_fault(
            "Deck.write",
            &format!("{}.{field}", self.name),
            said,
            remedy,
        )
    }

    /// Returns `width` numbers of row `i` of a column.
    fn reals<const N: usize>(&self, column: &str, i: usize) -> Result<[f64; N], Fault> {
        let found = self.columns.get(column);
        let slice = found.and_then(|c| c.as_slice().ok());
        let row = slice.and_then(|v| v.get(i * N..(i + 1) * N));
        let row = row.and_then(|r| <[f64; N]>::try_from(r).ok());
        row.ok_or_else(|| {
            let said = format!("the column is missing or does not have {N} numbers in each row");
            self.fault(column, &said, "keep the columns of `Deck.cards`")
        })
    }

    /// Returns one or several finite numbers.
    fn finite_numbers<const N: usize>(&self, column: &str, i: usize) -> Result<[f64; N], Fault> {
        let row = self.reals(column, i)?;
        if row.iter().all(|v| v.is_finite()) {
            return Ok(row);
        }
        let said = format!("row {i} is not finite");
        Err(self.fault(column, &said, "give numbers"))
    }

    /// Returns ids, which are at least `least` (0 or 1).
    fn ids<const N: usize>(&self, column: &str, i: usize, least: f64) -> Result<[u32; N], Fault> {
        let row: [f64; N] = self.reals(column, i)?;
        let is_id = |v: &f64| v.fract() == 0.0 && (least..=f64::from(i32::MAX)).contains(v);
        match row.iter().find(|v| !is_id(v)) {
            None => Ok(row.map(|v| v as u32)),
            Some(v) => {
                let said = format!("{v} in row {i} is not an id");
                Err(self.fault(column, &said, "give whole numbers"))
            }
        }
    }

    fn len(&self) -> usize {
        self.columns.get("id").map_or(0, |c| c.as_array().len())
    }
}

/// Adds the edits that make the cards of `name` in the deck equal to the columns. Cards that differ are replaced, missing ids are removed, new ids
/// are added.
pub(crate) fn edit(
    deck: &Deck,
    edits: &mut Edits,
    name: &str,
    columns: &Columns,
) -> Result<(), Faults> {
    let rows = Rows { name, columns };
    let cards = &deck.cards;
    match name {
        "GRID" => lay(deck, edits, &rows, &cards.grids, |c| c.id, grid),
        "CONM2" => lay(deck, edits, &rows, &cards.conm2s, |c| c.id, conm2),
        _ => {
            let shape = SHAPES.into_iter().find(|s| s.card() == name);
            let shape = shape.ok_or_else(|| {
                let remedy = "GRID, CONM2 and shells can be changed; others by their text";
                rows.fault("id", "these cards cannot be changed here", remedy)
            })?;
            let list = cards.shells.iter().filter(|c| c.card.shape == shape);
            let list: Vec<PlacedCard<Shell>> = list.cloned().collect();
            lay(
                deck,
                edits,
                &rows,
                &list,
                |c| c.id,
                |r, i, old| shell(r, i, old, shape),
            )
        }
    }
}

fn lay<T: ToFields + Clone + PartialEq>(
    deck: &Deck,
    edits: &mut Edits,
    rows: &Rows,
    list: &[PlacedCard<T>],
    id_of: impl Fn(&T) -> u32,
    make: impl Fn(&Rows, usize, Option<&T>) -> Result<T, Fault>,
) -> Result<(), Faults> {
    let mut row_of = HashMap::new();
    for i in 0..rows.len() {
        let [id] = rows.ids("id", i, 1.0)?;
        if row_of.insert(id, i).is_some() {
            let said = format!("{id} occurs twice");
            return Err(rows.fault("id", &said, "give each id once").into());
        }
    }
    for placed in list {
        let done = match row_of.remove(&id_of(&placed.card)) {
            None => edits.remove_card(deck, placed.at),
            Some(i) => match make(rows, i, Some(&placed.card))? {
                same if same == placed.card => continue,
                new => edits.replace_card(deck, placed.at, &new.to_card()),
            },
        };
        done.map_err(|e| rows.fault("id", &e.to_string(), "change the deck's text"))?;
    }
    let mut new: Vec<usize> = row_of.into_values().collect();
    new.sort_unstable();
    let mut text = String::new();
    for i in new {
        text.push_str(&make(rows, i, None)?.to_card());
    }
    if !text.is_empty() {
        edits.insert_cards(deck, &text);
    }
    Ok(())
}

fn grid(rows: &Rows, i: usize, old: Option<&Grid>) -> Result<Grid, Fault> {
    let [id] = rows.ids("id", i, 1.0)?;
    let [cp] = rows.ids("cp", i, 0.0)?;
    let [cd] = rows.finite_numbers("cd", i)?;
    let cd = cd as i32;
    let x = rows.finite_numbers("x", i)?;
    let old = old.copied();
    Ok(Grid {
        id,
        // A blank field remains blank, because GRDSET may give its value.
        cp: match old.and_then(|o| o.cp) {
            None if cp == 0 => None,
            _ => Some(cp),
        },
        x,
        cd: match old.and_then(|o| o.cd) {
            None if cd == 0 => None,
            _ => Some(cd),
        },
        ps: old.and_then(|o| o.ps),
        seid: old.and_then(|o| o.seid),
    })
}

fn conm2(rows: &Rows, i: usize, old: Option<&Conm2>) -> Result<Conm2, Fault> {
    let [id] = rows.ids("id", i, 1.0)?;
    let [grid] = rows.ids("grid", i, 1.0)?;
    let [mass] = rows.finite_numbers("mass", i)?;
    Ok(Conm2 {
        id,
        grid,
        cid: old.map_or(0, |o| o.cid),
        mass,
        offset: rows.finite_numbers("offset", i)?,
        inertia: old.map_or([0.0; 6], |o| o.inertia),
    })
}

fn shell(rows: &Rows, i: usize, old: Option<&Shell>, shape: ShellShape) -> Result<Shell, Fault> {
    let [id] = rows.ids("id", i, 1.0)?;
    let [pid] = rows.ids("pid", i, 1.0)?;
    let mut grids = [0; 8];
    match shape.n_grids() {
        3 => grids[..3].copy_from_slice(&rows.ids::<3>("grids", i, 1.0)?),
        4 => grids[..4].copy_from_slice(&rows.ids::<4>("grids", i, 1.0)?),
        6 => grids[..6].copy_from_slice(&rows.ids::<6>("grids", i, 0.0)?),
        _ => grids = rows.ids::<8>("grids", i, 0.0)?,
    }
    let [theta] = rows.reals("theta", i)?;
    let kept = old.map(|o| o.angle);
    let angle = match kept {
        Some(system @ MaterialAngle::Mcid(_)) if theta.is_nan() => system,
        _ if theta.is_finite() => MaterialAngle::Theta(theta),
        _ => return Err(rows.fault("theta", &format!("row {i} is not an angle"), "give degrees")),
    };
    Ok(Shell {
        id,
        pid: match old {
            Some(o) if o.pid.is_none() && pid == id => None,
            _ => Some(pid),
        },
        shape,
        grids,
        angle,
        zoffs: old.and_then(|o| o.zoffs),
        tflag: old.is_some_and(|o| o.tflag),
        thickness: old.map_or([None; 4], |o| o.thickness),
    })
}
