//! Unit forces at the contacts, solved.

use super::{Floor, FloorError};
use crate::fe::free_motions::springs_in_words;
use crate::fe::{CaseResult, LoadCase, Relief, SolveOptions, Support, UnitLoad, solve_cases};
use crate::model::{GridIx, Model, Vec3};

/// A floor with the solutions of the free structure from which it was computed.
#[derive(Clone, Debug)]
pub struct FloorSolution {
    /// Reactions of any load.
    pub floor: Floor,
    /// Solutions under a unit force upwards at each contact. The displacements contain no rigid motion (orthogonal in the mass), so they are
    /// reciprocal.
    pub contacts: Vec<CaseResult>,
    /// The further loads, in the order given.
    pub others: Vec<CaseResult>,
}

/// Solves a unit force at every contact, and `others`, on the free structure, and computes the floor under the contacts.
///
/// # Errors
/// The errors of the solver; contacts on a line; springs to ground that already carry the structure.
pub fn solve_standing(
    model: &Model,
    axis: usize,
    contacts: &[GridIx],
    others: &[UnitLoad],
    rate: Option<f64>,
) -> Result<FloorSolution, FloorError> {
    let motions = Support::without_spc(model).by_springs;
    if motions > 0 {
        let springs = springs_in_words(model);
        return Err(FloorError::Springs { motions, springs });
    }
    let up = contacts.iter().map(|grid| {
        let mut force = Vec3::zeros();
        force[axis] = 1.0;
        UnitLoad::AtGrid {
            grid: *grid,
            force,
            moment: Vec3::zeros(),
        }
    });
    let cases: Vec<LoadCase> = (1..)
        .zip(up.chain(others.iter().cloned()))
        .map(|(subcase, load)| LoadCase {
            subcase,
            label: String::new(),
            loads: vec![load],
            spc: None,
            mpc: model.mpc,
            relief: Relief::Automatic,
        })
        .collect();
    let (solution, _) = solve_cases(model, &cases, &SolveOptions::default())?;
    let mut all = solution.cases;
    let others = all.split_off(contacts.len().min(all.len()));
    let lifts: Vec<Vec<f64>> = all
        .iter()
        .map(|case| lift(case, contacts, axis))
        .collect::<Option<_>>()
        .ok_or(FloorError::NoDisplacement)?;
    let floor = Floor::new(model, axis, contacts, &lifts, rate)?;
    Ok(FloorSolution {
        floor,
        contacts: all,
        others,
    })
}

/// Returns the displacement of the contacts along the axis in a case. `None` if the solution has no displacement there.
pub(crate) fn lift(case: &CaseResult, contacts: &[GridIx], axis: usize) -> Option<Vec<f64>> {
    contacts
        .iter()
        .map(|g| {
            case.displacement
                .get(g.us())
                .map(|u| u[axis])
                .filter(|v| v.is_finite())
        })
        .collect()
}

impl FloorSolution {
    /// Returns the displacement of the contacts in a case of the free structure. NaN if the solution has no displacement there.
    pub fn lift(&self, case: &CaseResult) -> Vec<f64> {
        lift(case, self.floor.contacts(), self.floor.axis())
            .unwrap_or_else(|| vec![f64::NAN; self.floor.contacts().len()])
    }

    /// Returns the reactions to the structure's own weight.
    pub fn under_weight(&self, model: &Model, gravity: f64) -> Vec<f64> {
        self.floor.reactions(&self.floor.weight(model, gravity))
    }

    /// Computes the reactions to forces at grids (basic frame) by reciprocity. The lift of contact j is the work of the forces on the displacement
    /// field of the unit force at j.
    pub fn under_forces(&self, model: &Model, forces: &[(GridIx, Vec3)]) -> Vec<f64> {
        let lift = self
            .contacts
            .iter()
            .map(|case| {
                forces
                    .iter()
                    .filter_map(|(g, f)| {
                        let u = case.displacement.get(g.us())?;
                        Some(f.x * u[0] + f.y * u[1] + f.z * u[2])
                    })
                    .sum()
            })
            .collect();
        let (mut force, mut moment) = (Vec3::zeros(), Vec3::zeros());
        for (g, f) in forces {
            if let Some(grid) = model.grids.get(g.us()) {
                force += f;
                moment += grid.x.cross(f);
            }
        }
        self.floor
            .reactions(&self.floor.load(Vec3::zeros(), force, moment, lift))
    }
}
