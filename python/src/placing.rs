//! Layouts of a bare matrix.

use crate::array::Named;
use crate::fault::{argument_fault, raise};
use crate::work::{Asked, run};
use numpy::{PyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::time::Instant;
use strainbridge::host::context::Progress;
use strainbridge::linalg::{Matrix, dense};
use strainbridge::placement::candidates::{Candidates, Scatter};
use strainbridge::placement::{Layout, Spec, place};
use strainbridge::{Fault, Faults};

const S: Named = Named {
    function: "place_rows",
    name: "S",
    axes: "gauges x loads",
};
const POSITIONS: Named = Named {
    name: "positions",
    axes: "gauges x 3",
    ..S
};

/// Returns the rows of `s` with the largest determinant, and their certificate, by name.
#[pyfunction]
#[pyo3(signature = (s, n, spacing, positions, proof, threads))]
pub(crate) fn place_rows<'py>(
    py: Python<'py>,
    s: &Bound<'py, PyAny>,
    n: usize,
    spacing: Option<f64>,
    positions: Option<&Bound<'py, PyAny>>,
    proof: bool,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyDict>> {
    let s = S.matrix(s)?;
    let positions = positions.map(|p| points(p, s.shape()[0])).transpose()?;
    let (k, rows) = (s.shape()[1], s.as_slice()?);
    let asked = Asked {
        threads,
        progress: None,
    };
    let found = run(py, &asked, |heard| {
        let begin = Instant::now();
        let mut spec = Spec::new(n, k);
        spec.spacing = spacing.unwrap_or(0.0);
        spec.stop = heard.stop();
        if !proof {
            spec.proof = 0.0;
        }
        let found = layout(rows, k, positions.as_deref(), &spec)?;
        Ok((found, begin.elapsed().as_secs_f64()))
    })?;
    let ((layout, condition), seconds) = found.map_err(|f: Faults| raise(py, f))?;
    let chosen = layout.gauges.iter().map(|g| i64::from(g.place)).collect();
    let out = PyDict::new(py);
    out.set_item("rows", PyArray1::from_vec(py, chosen))?;
    out.set_item("log_det", layout.log_det)?;
    out.set_item("upper_bound", layout.upper_bound)?;
    out.set_item("efficiency_bound", layout.efficiency_bound)?;
    out.set_item("proved", layout.proved)?;
    out.set_item("condition_number", condition)?;
    // The time in the library, which shows the cost of the call.
    out.set_item("seconds", seconds)?;
    Ok(out)
}

/// Returns the positions of the rows.
fn points(a: &Bound<PyAny>, n: usize) -> PyResult<Vec<[f64; 3]>> {
    let array: PyReadonlyArray2<f64> = POSITIONS.matrix(a)?;
    if array.shape() != [n, 3] {
        let said = format!("its shape is {:?} and has to be [{n}, 3]", array.shape());
        return Err(POSITIONS.fault(a.py(), &said, "give a position for every row of S"));
    }
    let rows = array.as_slice()?.as_chunks::<3>().0;
    if !rows.as_flattened().iter().all(|v| v.is_finite()) {
        return Err(POSITIONS.fault(
            a.py(),
            "it contains numbers that are not finite",
            "drop those rows",
        ));
    }
    Ok(rows.to_vec())
}

/// Returns the layout, and the condition number of its rows.
fn layout(
    rows: &[f64],
    k: usize,
    positions: Option<&[[f64; 3]]>,
    spec: &Spec,
) -> Result<(Layout, f64), Faults> {
    let fault = |argument: &str, said: &str, remedy: &str| {
        Faults::from(argument_fault(S.function, argument, said, remedy))
    };
    if k == 0 || rows.is_empty() {
        return Err(fault(
            "S",
            "it is empty",
            "give one row for each gauge and one column for each load",
        ));
    }
    if let Some(at) = rows.iter().position(|v| !v.is_finite()) {
        let said = format!("row {}, column {} is not a finite number", at / k, at % k);
        return Err(fault("S", &said, "drop that row"));
    }
    if !(spec.spacing >= 0.0 && spec.spacing.is_finite()) {
        return Err(fault(
            "spacing",
            "it is not a distance",
            "give a number of 0 or more",
        ));
    }
    if spec.spacing > 0.0 && positions.is_none() {
        let remedy = "pass positions=, rows x 3, in the unit of the spacing";
        return Err(fault(
            "spacing",
            "a spacing needs the positions of the rows",
            remedy,
        ));
    }
    let n = rows.len() / k;
    let mut candidates =
        Candidates::from_rows(k, n, Scatter::with_uniform_noise(1.0), |place, row| {
            row.copy_from_slice(&rows[place * k..][..k]);
        });
    if let Some(p) = positions {
        candidates = candidates.with_positions(p.to_vec());
    }
    let found = place(&candidates, spec).map_err(|e| {
        let (said, remedy) = e.parts();
        Faults::from(Fault::new(S.function, "S", said, remedy))
    })?;
    let place_of = |i: usize| found.gauges[i].place as usize;
    let chosen = Matrix::from_fn(found.gauges.len(), k, |i, l| rows[place_of(i) * k + l]);
    if dense::rank(&dense::unit_columns(&chosen)) < k {
        let said = format!("no {} of its rows separate the {k} loads", spec.gauges);
        let remedy = "drop loads with the same effect, or ask for more gauges";
        return Err(fault("S", &said, remedy));
    }
    let condition = dense::condition(&chosen);
    Ok((found, condition))
}
