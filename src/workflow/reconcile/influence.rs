//! Rows of the influence matrix: readings of the gauges in a solution.

use crate::fe::{
    Adjoint, FeError, Solution, SolveOptions, StrainTerm, UnitLoad, reading_changes,
    solve_unit_loads_on, solve_variants,
};
use crate::gauge::{Gauge, gauge_reading};
use crate::host::fault::{Fault, Faults};
use crate::host::work::cancelled_fault;
use crate::job::Job;
use crate::model::{GridIx, Model};
use crate::reconcile::strain::N_PAYLOAD_COLUMNS;
use crate::stop::Stop;
use crate::strain_chain::built_in_solver::support_of_job;
use crate::units::MICROSTRAIN;

/// Returns the influence of the columns, `n_gauges x n_columns`, zero for columns without a load.
pub(super) fn influence(
    job: &Job,
    model: &Model,
    gauges: &[Gauge],
    solution: &Solution,
    n_columns: usize,
) -> Vec<f64> {
    let mut out = readings(gauges, solution, 0..n_columns);
    blank_payload(job, model, &mut out, n_columns);
    out
}

/// Sets the columns of an influence matrix without a load to zero.
pub(super) fn blank_payload(job: &Job, model: &Model, influence: &mut [f64], n_columns: usize) {
    let blank = if payload_grid(job, model).is_some() {
        1
    } else {
        N_PAYLOAD_COLUMNS
    };
    for row in influence.chunks_exact_mut(n_columns.max(1)) {
        row.iter_mut().rev().take(blank).for_each(|v| *v = 0.0);
    }
}

/// Returns the microstrain per unit of each case of `range`, `n_gauges x n_cases` by rows. NaN without strain.
pub(super) fn readings(
    gauges: &[Gauge],
    solution: &Solution,
    range: std::ops::Range<usize>,
) -> Vec<f64> {
    let mut out = Vec::with_capacity(gauges.len() * range.len());
    for g in gauges {
        for c in range.clone() {
            let value = solution
                .cases
                .get(c)
                .and_then(|case| gauge_reading(g, case));
            out.push(value.unwrap_or(f64::NAN) / MICROSTRAIN);
        }
    }
    out
}

/// Returns the model under these loads.
///
/// # Errors
/// Faults of the solver.
pub(super) fn solve(
    job: &Job,
    model: &Model,
    loads: &[UnitLoad],
    stop: &Stop,
) -> Result<Solution, Faults> {
    let support = support_of_job(job, model)?;
    let solved = solve_unit_loads_on(model, support, loads, &options_with_stop(stop));
    solved.map(|s| s.0).map_err(|e| of_solver(job, &e))
}

/// Solves each variant of the model under these loads and returns the results of `read`.
///
/// # Errors
/// Faults of the solver.
pub(super) fn solve_each<T>(
    job: &Job,
    model: &Model,
    loads: &[UnitLoad],
    variants: impl ExactSizeIterator<Item = Model>,
    stop: &Stop,
    read: impl FnMut(&Model, &Solution) -> T,
) -> Result<Vec<T>, Faults> {
    let support = support_of_job(job, model)?;
    let solved = solve_variants(
        model,
        support,
        loads,
        variants,
        &options_with_stop(stop),
        read,
    );
    solved.map_err(|e| of_solver(job, &e))
}

/// Returns the changes of these readings on variants of the model: by variant, microstrain, `n_readings x n_loads` by rows. They are exact for bushes
/// and of first order for shells. `None` if the variants need more than one factor.
///
/// # Errors
/// Faults of the solver.
pub(super) fn small_changes(
    job: &Job,
    model: &Model,
    (loads, readings): (&[UnitLoad], &[Vec<StrainTerm>]),
    variants: impl ExactSizeIterator<Item = Model>,
    stop: &Stop,
) -> Result<Option<Vec<Vec<f64>>>, Faults> {
    let support = support_of_job(job, model)?;
    let changes = reading_changes(
        model,
        support,
        loads,
        readings,
        variants,
        &options_with_stop(stop),
    )
    .map_err(|e| of_solver(job, &e))?;
    let in_microstrain = |rows: Vec<f64>| rows.iter().map(|v| v / MICROSTRAIN).collect();
    Ok(changes.map(|all| all.into_iter().map(in_microstrain).collect()))
}

/// Returns the displacements of the model under these loads and for these readings.
///
/// # Errors
/// Faults of the solver.
pub(super) fn adjoint<'a>(
    job: &Job,
    model: &'a Model,
    loads: &[UnitLoad],
    readings: &[Vec<StrainTerm>],
    stop: &Stop,
) -> Result<Adjoint<'a>, Faults> {
    let support = support_of_job(job, model)?;
    let solved = Adjoint::solve(model, support, loads, readings, &options_with_stop(stop));
    solved.map_err(|e| of_solver(job, &e))
}

fn options_with_stop(stop: &Stop) -> SolveOptions {
    SolveOptions {
        stop: stop.clone(),
        ..SolveOptions::default()
    }
}

/// Converts an error of the solver into faults.
pub(super) fn of_solver(job: &Job, e: &FeError) -> Faults {
    let remedy = "repair the deck, or give S as CSV files in `[sensitivity]`";
    match e {
        FeError::Stopped => Faults::from(cancelled_fault()),
        e => Faults::from(Fault::new(&*job.file, "model", e.to_string(), remedy)),
    }
}

/// Returns the grid of the payload.
pub(super) fn payload_grid(job: &Job, model: &Model) -> Option<GridIx> {
    model.grid_ix(job.payload_grid()?)
}
