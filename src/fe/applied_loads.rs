//! Forces at grids and enforced displacements of a load case.

use super::UnitLoad;
use super::error::FeError;
use super::load::load_vector;
use super::load_case::{LoadCase, Relief, has_suport1};
use super::mass::Mass;
use super::prepared_model::PreparedModel;
use super::temperature::Temperatures;
use super::thermal_force::thermal_forces;
use crate::model::{GridIx, Load, Model};
use nastran::cards::Dofs;

/// Returns the largest absolute value in a field.
pub(super) fn largest_component(f: &[[f64; 6]]) -> f64 {
    f.iter().flatten().fold(0.0, |a, v| a.max(v.abs()))
}

/// Returns the displacements that SPCD enforces in a case.
pub(super) fn enforced_of(model: &Model, case: &LoadCase) -> Vec<(GridIx, Dofs, f64)> {
    let mut all = Vec::new();
    for load in &case.loads {
        let UnitLoad::Set(sid) = load else { continue };
        for set in model.load_sets.iter().filter(|s| s.sid == *sid) {
            all.extend(set.loads.iter().filter_map(|(factor, l)| match l {
                Load::Enforced { grid, dofs, value } => Some((*grid, *dofs, factor * value)),
                _ => None,
            }));
        }
    }
    all
}

/// # Errors
/// A set that a case names and the deck lacks.
pub(super) fn check_sets(model: &Model, cases: &[&LoadCase]) -> Result<(), FeError> {
    for case in cases {
        let missing = |kind, sid: Option<u32>, known: bool| match sid {
            Some(sid) if !known => Err(FeError::MissingSet {
                kind,
                sid,
                subcase: case.subcase,
            }),
            _ => Ok(()),
        };
        missing(
            "SPC",
            case.spc,
            model.spcs.iter().any(|s| Some(s.sid) == case.spc),
        )?;
        missing(
            "MPC",
            case.mpc,
            model.mpcs.iter().any(|s| Some(s.sid) == case.mpc),
        )?;
        if let Relief::Suport(set) = case.relief {
            let known = set.is_none_or(|s| has_suport1(model, s));
            missing("SUPORT1", set, known)?;
        }
        for load in &case.loads {
            if let UnitLoad::Set(sid) = load {
                missing(
                    "LOAD",
                    Some(*sid),
                    model.load_sets.iter().any(|s| s.sid == *sid),
                )?;
            }
        }
    }
    Ok(())
}

/// Returns the forces and moments on every grid in a case, basic frame.
///
/// # Errors
/// Sets that the deck lacks; elements that can't be formed.
pub(super) fn applied_forces(
    prepared: &PreparedModel<'_>,
    mass: &Mass,
    case: &LoadCase,
) -> Result<Vec<[f64; 6]>, FeError> {
    let model = prepared.model;
    let mut f = vec![[0.0; 6]; model.grids.len()];
    if let Some(t) = Temperatures::from_case(model, case)? {
        thermal_forces(prepared, &t, &mut f)?;
    }
    for load in &case.loads {
        match load {
            UnitLoad::Temperature { .. } => {}
            UnitLoad::AtGrid {
                grid,
                force,
                moment,
            } => {
                for i in 0..3 {
                    f[grid.us()][i] += force[i];
                    f[grid.us()][3 + i] += moment[i];
                }
            }
            UnitLoad::Set(sid) => {
                let set =
                    model
                        .load_sets
                        .iter()
                        .find(|s| s.sid == *sid)
                        .ok_or(FeError::MissingSet {
                            kind: "LOAD",
                            sid: *sid,
                            subcase: case.subcase,
                        })?;
                let loads = load_vector(model, mass, set).map_err(|r| FeError::Refused(vec![r]))?;
                for (f, add) in f.iter_mut().zip(loads) {
                    f.iter_mut().zip(add).for_each(|(f, a)| *f += a);
                }
            }
        }
    }
    Ok(f)
}
