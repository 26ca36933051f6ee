//! The completed deck: cards of the masses, and the reactions of a new solution.

use super::task::{DECK, Task};
use crate::fe::floor::solve_standing;
use crate::host::fault::{Fault, Faults};
use crate::host::work::Work;
use crate::measured::wheels::floor_fault;
use crate::model::GridIx;
use crate::payload::{BallastFit, Carriers};
use crate::strain_chain::deck::model_of_deck;
use nastran::bdf::{Field, format_card};

/// Ids of one mass in the completed deck.
pub(super) struct MassCards {
    pub grid: u32,
    pub rbe3: u32,
    pub conm2: u32,
}

/// Returns the cards of the masses: for each mass a grid, an RBE3 that ties it to the carriers, and a CONM2.
pub(super) fn cards(
    task: &Task,
    carriers: &Carriers,
    fit: &BallastFit,
    height: f64,
) -> (Vec<MassCards>, String) {
    let m = &task.read.model;
    let mut grid = m.grids.iter().map(|g| g.id).max().unwrap_or(0);
    let elements = m.elements().map(|e| m.element_id(e));
    let others = m.masses.iter().map(|e| e.id);
    let ids = elements.chain(others).chain(m.rigids.iter().map(|e| e.id));
    let mut element = ids.max().unwrap_or(0);
    let (mut ids, mut text) = (Vec::new(), String::new());
    for (k, b) in fit.masses.iter().enumerate() {
        let own = MassCards {
            grid: grid + 1,
            rbe3: element + 1,
            conm2: element + 2,
        };
        (grid, element) = (own.grid, own.conm2);
        let x = carriers.point(b.at, height);
        text += &format!("$ Ballast {} of {}\n", k + 1, fit.masses.len());
        text += &format_card(
            "GRID",
            &[
                own.grid.into(),
                0_u32.into(),
                x.x.into(),
                x.y.into(),
                x.z.into(),
                0_u32.into(),
            ],
        );
        let mut fields: Vec<Field> = vec![
            own.rbe3.into(),
            Field::Blank,
            own.grid.into(),
            123_456_u32.into(),
            1.0.into(),
            123_u32.into(),
        ];
        fields.extend(
            carriers
                .arms(b.at)
                .iter()
                .filter_map(|g| m.grids.get(g.us()))
                .map(|g| Field::from(g.id)),
        );
        text += &format_card("RBE3", &fields);
        let mass = b.weight / task.gravity / m.params.wtmass;
        text += &format_card(
            "CONM2",
            &[own.conm2.into(), own.grid.into(), Field::Blank, mass.into()],
        );
        ids.push(own);
    }
    (ids, text)
}

/// Reads the written deck, solves it and returns its reactions.
pub(super) fn solve_completed(
    work: &mut Work,
    task: &Task,
    edited: &[(String, Vec<u8>)],
) -> Result<Vec<f64>, Faults> {
    let program = |wrong: String| {
        Faults::from(Fault::new(
            format!("{DECK}.bdf"),
            "deck",
            wrong,
            "report this as an error of the program",
        ))
    };
    let bytes = edited
        .first()
        .map(|f| f.1.clone())
        .ok_or_else(|| program("no file".into()))?;
    let completed = model_of_deck(&mut work.inputs, &task.job.folder, &task.read.given, &bytes);
    if let Some(f) = completed.faults.first() {
        return Err(program(f.to_string()));
    }
    let grids: Option<Vec<GridIx>> = task
        .wheels
        .grids
        .iter()
        .map(|g| {
            completed
                .model
                .grid_ix(task.read.model.grids.get(g.us())?.id)
        })
        .collect();
    let grids = grids.ok_or_else(|| program("a wheel is missing".into()))?;
    let standing = solve_standing(&completed.model, task.wheels.axis, &grids, &[], None)
        .map_err(|e| floor_fault(task.job, &e))?;
    Ok(standing.under_weight(&completed.model, task.gravity))
}
