//! Loads of the job as loads on the model.

use crate::fe::UnitLoad;
use crate::host::fault::{Fault, FaultList, Faults};
use crate::job::{Component, Job, JobLoad, LoadActs};
use crate::model::{Model, Vec3};

/// Returns the unit loads of the job, each with its size `applied`.
///
/// # Errors
/// Grids and coordinate systems that the deck lacks.
pub fn unit_loads(job: &Job, model: &Model) -> Result<Vec<UnitLoad>, Faults> {
    let mut faults = FaultList::new();
    let loads = job
        .loads
        .iter()
        .filter_map(|l| match l.acts {
            // If the set contains only temperatures, the unit load is thermal.
            LoadActs::Set(sid)
                if model.load_sets.iter().all(|s| s.sid != sid)
                    && model.temperatures.iter().any(|t| t.sid == sid) =>
            {
                Some(UnitLoad::Temperature {
                    set: sid,
                    initial: None,
                })
            }
            LoadActs::Set(sid) => Some(UnitLoad::Set(sid)),
            LoadActs::Named => {
                faults.push(Fault::with_line(
                    &*job.file,
                    l.line,
                    "load.grid",
                    format!("load `{}` has no place in the deck", l.name),
                    "add `grid` and `component`, or `load_set`",
                ));
                None
            }
            LoadActs::AtGrid {
                grid,
                component,
                cid,
            } => {
                let (ix, frame) = (model.grid_ix(grid), model.frame_ix(cid));
                if ix.is_none() {
                    faults.push(no_grid(job, l, grid));
                }
                if frame.is_none() {
                    faults.push(Fault::with_line(
                        &*job.file,
                        l.line,
                        "load.cid",
                        format!("load `{}`: the deck has no coordinate system {cid}", l.name),
                        "correct the id, or name another deck",
                    ));
                }
                let (ix, frame) = (ix?, frame?);
                let point = model.grids.get(ix.us())?;
                if point.is_scalar() && (component != Component::FX || cid != 0) {
                    faults.push(Fault::with_line(
                        &*job.file,
                        l.line,
                        "load.component",
                        format!(
                            "load `{}`: {grid} is a scalar point, with one degree of freedom and no coordinate system",
                            l.name
                        ),
                        "give component = \"FX\" without cid, or name a grid",
                    ));
                    return None;
                }
                let v = component.vector(l.applied);
                let v = model.frames.get(frame.us())?.vector_to_basic(v, point.x);
                let (force, moment) = if component.is_force() {
                    (v, Vec3::zeros())
                } else {
                    (Vec3::zeros(), v)
                };
                Some(UnitLoad::AtGrid {
                    grid: ix,
                    force,
                    moment,
                })
            }
        })
        .collect();
    Faults::check(faults)?;
    Ok(loads)
}

/// Refuses loads of the job whose load set the deck lacks.
///
/// # Errors
/// Every such load.
pub(super) fn refuse_missing_sets(
    job: &Job,
    model: &Model,
    loads: &[UnitLoad],
) -> Result<(), Faults> {
    let mut faults = FaultList::new();
    for (load, unit) in job.loads.iter().zip(loads) {
        let UnitLoad::Set(sid) = unit else { continue };
        if model.load_sets.iter().all(|s| s.sid != *sid) {
            faults.push(Fault::with_line(
                &*job.file,
                load.line,
                "load.load_set",
                format!("load `{}`: the deck has no load set {sid}", load.name),
                "correct `load_set`, or add the set to the deck",
            ));
        }
    }
    Faults::check(faults)
}

/// Returns the fault of a load at a grid that the deck lacks.
fn no_grid(job: &Job, load: &JobLoad, grid: u32) -> Fault {
    Fault::with_line(
        &*job.file,
        load.line,
        "load.grid",
        format!("load `{}`: the deck has no grid {grid}", load.name),
        "correct the id, or name another deck",
    )
}
