//! Relaxation of a placement of a bare matrix: weights instead of gauges, and the upper bound.

use crate::array::Named;
use crate::fault::{argument_fault, raise};
use crate::work::{Asked, run};
use numpy::{PyArray1, PyUntypedArrayMethods};
use pyo3::prelude::*;
use strainbridge::Faults;
use strainbridge::host::context::Progress;
use strainbridge::placement::Criterion;
use strainbridge::placement::candidates::{Candidates, Scatter};
use strainbridge::placement::column_generation::{Groups, solve};
use strainbridge::stop::Stop;

const S: Named = Named {
    function: "relax",
    name: "S",
    axes: "gauges x loads",
};

/// Weights of all rows, `log det` of the weighted sum, and the bound.
type Weighted = (Vec<f64>, f64, f64);

/// Returns the weights of the rows of `s`, whose sum is `n`, and the upper bound for any `n` rows.
#[pyfunction]
#[pyo3(signature = (s, n, tolerance, threads))]
pub(crate) fn relax<'py>(
    py: Python<'py>,
    s: &Bound<'py, PyAny>,
    n: usize,
    tolerance: f64,
    threads: Option<usize>,
) -> PyResult<(Bound<'py, PyArray1<f64>>, f64, f64)> {
    let s = S.matrix(s)?;
    let (k, rows) = (s.shape()[1], s.as_slice()?);
    let asked = Asked {
        threads,
        progress: None,
    };
    let found = run(py, &asked, |heard| {
        weights(rows, k, n, tolerance, &heard.stop())
    })?;
    let (weights, value, bound) = found.map_err(|f| raise(py, f))?;
    Ok((PyArray1::from_vec(py, weights), value, bound))
}

fn weights(
    rows: &[f64],
    k: usize,
    n: usize,
    tolerance: f64,
    stop: &Stop,
) -> Result<Weighted, Faults> {
    let fault = |argument: &str, said: &str, remedy: &str| {
        Faults::from(argument_fault(S.function, argument, said, remedy))
    };
    if k == 0 || rows.is_empty() {
        let remedy = "give one row for each gauge and one column for each load";
        return Err(fault("S", "it is empty", remedy));
    }
    if let Some(at) = rows.iter().position(|v| !v.is_finite()) {
        let said = format!("row {}, column {} is not a finite number", at / k, at % k);
        return Err(fault("S", &said, "drop that row"));
    }
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        let remedy = "give a gap for each load, such as 1e-6";
        return Err(fault("tolerance", "it is not a positive number", remedy));
    }
    let places = rows.len() / k;
    if n == 0 || n > places {
        let said = format!("{n} of {places} rows are asked for");
        return Err(fault("n", &said, "ask for 1 to as many as there are"));
    }
    let candidates =
        Candidates::from_rows(k, places, Scatter::with_uniform_noise(1.0), |place, row| {
            row.copy_from_slice(&rows[place * k..][..k]);
        });
    let none = vec![0.0; k * k];
    let criterion = Criterion::D;
    let found = solve(
        &candidates,
        n,
        &none,
        &criterion,
        &Groups::Rows,
        tolerance,
        &[],
        stop,
    );
    let found = found.ok_or_else(|| {
        let said = format!("no {n} of its rows separate the {k} loads");
        let remedy = "drop loads with the same effect, or ask for more gauges";
        fault("S", &said, remedy)
    })?;
    let mut weights = vec![0.0; places];
    for (choice, weight) in found.choices.iter().zip(&found.relaxed.weights) {
        weights[choice.place as usize] = *weight;
    }
    Ok((weights, found.relaxed.value(), found.upper_bound))
}
