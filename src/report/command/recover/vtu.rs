//! `loads.vtu`: recovered loads as arrows at their grids.

use crate::host::fault::Faults;
use crate::host::output::Output;
use crate::job::LoadActs;
use crate::report::{PointValues, write_points_vtu};
use crate::workflow::recover::{RecoveredLoads, RecoveredRuns};

/// Writes a point for each loaded grid with force and moment of every run, basic frame, report units. It writes nothing without a model.
///
/// # Errors
/// A file that can't be written.
pub(super) fn write(
    out: &mut Output,
    recovered: &RecoveredLoads,
    runs: &RecoveredRuns,
) -> Result<(), Faults> {
    let Some(model) = recovered.prepared.fields.as_ref().map(|f| f.model()) else {
        return Ok(());
    };
    let mut grids: Vec<(u32, [f64; 3])> = Vec::new();
    // Column, point, unit vector in the basic frame, and 1 for a moment or 0 for a force.
    let mut parts: Vec<(usize, usize, [f64; 3], usize)> = Vec::new();
    for (column, name) in runs.names.iter().enumerate() {
        let load = recovered.job.loads.iter().find(|l| &l.name == name);
        let Some(LoadActs::AtGrid {
            grid,
            component,
            cid,
        }) = load.map(|l| l.acts)
        else {
            continue;
        };
        let (Some(at), Some(frame)) = (
            model.grid_ix(grid).and_then(|ix| model.grids.get(ix.us())),
            model.frame_ix(cid).and_then(|ix| model.frames.get(ix.us())),
        ) else {
            continue;
        };
        let v = frame.vector_to_basic(component.vector(1.0), at.x);
        let point = grids.iter().position(|g| g.0 == grid).unwrap_or_else(|| {
            grids.push((grid, [at.x.x, at.x.y, at.x.z]));
            grids.len() - 1
        });
        parts.push((column, point, [v.x, v.y, v.z], component.dof() / 3));
    }
    if grids.is_empty() {
        return Ok(());
    }
    let mut arrays = vec![(
        "grid".to_owned(),
        PointValues::Ids(grids.iter().map(|g| g.0).collect()),
    )];
    for run in &runs.recovery.runs {
        let mut sums = [vec![[0.0; 3]; grids.len()], vec![[0.0; 3]; grids.len()]];
        for (column, point, v, kind) in &parts {
            let value = run.estimate.values[*column] * runs.units[*column].factor;
            for (sum, v) in sums[*kind][*point].iter_mut().zip(v) {
                *sum += value * v;
            }
        }
        let [forces, moments] = sums;
        let name = &run.estimate.run;
        arrays.push((format!("force {name}"), PointValues::Vectors(forces)));
        if parts.iter().any(|p| p.3 == 1) {
            arrays.push((format!("moment {name}"), PointValues::Vectors(moments)));
        }
    }
    let points: Vec<[f64; 3]> = grids.iter().map(|g| g.1).collect();
    out.write("loads.vtu", |w| write_points_vtu(&points, &arrays, w))?;
    Ok(())
}
