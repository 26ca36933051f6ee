//! The wheels of a job: loads that carry the structure, and its support on them.

use crate::fe::FeError;
use crate::fe::floor::FloorError;
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::work::cancelled_fault;
use crate::job::{Job, JobLoad, LoadActs};
use crate::model::{GridIx, Model, Vec3};

/// Vertical loads of a job that are not the payload.
pub struct Wheels {
    /// Axis along which the wheel forces act: 0 x, 1 y, 2 z.
    pub axis: usize,
    /// Index of each in the job's loads.
    pub loads: Vec<usize>,
    /// Grids of the wheels.
    pub grids: Vec<GridIx>,
}

/// Returns the wheels of the job: forces along the most frequent axis of its forces, at grids other than the payload grid.
///
/// # Errors
/// Fewer than three wheels, or grids that the deck lacks.
pub fn wheels_of(job: &Job, model: &Model) -> Result<Wheels, Faults> {
    let payload = job.payload_grid();
    let force = |l: &JobLoad| match l.acts {
        LoadActs::AtGrid {
            grid,
            component,
            cid,
        } if component.is_force() && Some(grid) != payload => {
            Some((grid, basic_axis(model, grid, component.dof(), cid)?))
        }
        _ => None,
    };
    let wanted: Vec<(usize, u32, usize)> = job
        .loads
        .iter()
        .enumerate()
        .filter(|(_, l)| l.role == crate::job::LoadRole::Wanted)
        .filter_map(|(i, l)| force(l).map(|(g, a)| (i, g, a)))
        .collect();
    let axis = (0..3)
        .rev()
        .max_by_key(|a| wanted.iter().filter(|w| w.2 == *a).count())
        .unwrap_or(2);
    let mut out = Wheels {
        axis,
        loads: Vec::new(),
        grids: Vec::new(),
    };
    let mut faults = FaultList::new();
    // A point between the wheels with moments in addition to its force belongs to the payload, even if [payload] does not state this.
    let has_moment = |id: u32| {
        job.loads.iter().any(|l| {
            matches!(l.acts, LoadActs::AtGrid { grid, component, .. } if grid == id && component.dof() > 2)
                && l.role == crate::job::LoadRole::Wanted
        })
    };
    for (i, id, _) in wanted
        .into_iter()
        .filter(|w| w.2 == axis && !has_moment(w.1))
    {
        match model.grid_ix(id) {
            Some(g) => {
                out.loads.push(i);
                out.grids.push(g);
            }
            None => faults.push(Fault::with_line(
                &*job.file,
                job.loads[i].line,
                "load.grid",
                format!("load `{}`: the deck has no grid {id}", job.loads[i].name),
                "correct the id, or name another deck",
            )),
        }
    }
    if out.grids.len() < 3 && faults.is_empty() {
        faults.push(Fault::new(
            &*job.file,
            "load",
            format!(
                "{} vertical wheel loads (forces along one basic axis at a grid), expected three or more",
                out.grids.len()
            ),
            "name every wheel: [[load]] grid = 101, component = \"FZ\"",
        ));
    }
    Faults::check(faults)?;
    Ok(out)
}

/// Returns the basic degree of freedom (0 to 5) along which component `dof` acts at a grid in a coordinate system. `None` if it acts along no basic
/// axis.
pub fn basic_dof(model: &Model, grid: u32, dof: usize, cid: u32) -> Option<usize> {
    let axis = basic_axis(model, grid, dof % 3, cid)?;
    Some(axis + dof - dof % 3)
}

/// Returns the basic axis in whose positive direction axis `dof` of a coordinate system points at a grid. `None` if it points along no basic axis.
fn basic_axis(model: &Model, grid: u32, dof: usize, cid: u32) -> Option<usize> {
    /// Cosine from which two directions are the same: a thousandth of a degree.
    const ALIGNED: f64 = 1.0 - 1e-10;
    if cid == 0 {
        return Some(dof);
    }
    let frame = model.frames.get(model.frame_ix(cid)?.us())?;
    let at = model.grids.get(model.grid_ix(grid)?.us())?.x;
    let along = Vec3::from_fn(|axis, _| f64::from(u8::from(axis == dof)));
    let direction = frame.vector_to_basic(along.into(), at);
    (0..3).find(|axis| direction[*axis] > ALIGNED)
}

/// Returns the faults of the job's model if the floor cannot be computed.
pub fn floor_fault(job: &Job, e: &FloorError) -> Faults {
    if matches!(e, FloorError::Solver(FeError::Stopped)) {
        return cancelled_fault().into();
    }
    let of = |(wrong, remedy)| Fault::new(&*job.file, "model", wrong, remedy);
    let unknown = Fault::new(&*job.file, "model", e.to_string(), "repair the deck");
    Faults::or(e.parts().into_iter().map(of).collect(), unknown)
}
