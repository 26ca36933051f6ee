//! Rainflow cycles of a signal.

use crate::array::Named;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use strainbridge::series::rainflow::{Point, Rainflow};

/// Number of columns of a cycle: range, mean, count, and the samples of its two reversals.
const COLUMNS: usize = 5;

/// Returns cycles by rows: range, mean, count, first and second reversal.
#[pyfunction]
pub(crate) fn rainflow<'py>(
    py: Python<'py>,
    signal: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let named = Named {
        function: "rainflow",
        name: "signal",
        axes: "samples",
    };
    let signal = named.vector(signal)?;
    let samples = signal.as_slice()?;
    let cycles = py.detach(|| {
        let mut rows = Vec::new();
        let mut counted = |c: strainbridge::series::rainflow::Cycle| {
            let (from, to) = (c.from.at as f64, c.to.at as f64);
            rows.extend([c.range(), c.mean(), c.count, from, to]);
        };
        let mut count = Rainflow::default();
        for (at, &value) in samples.iter().enumerate() {
            count.push(Point { at, value }, &mut counted);
        }
        count.finish(&mut counted);
        rows
    });
    let n = cycles.len() / COLUMNS;
    PyArray1::from_vec(py, cycles).reshape([n, COLUMNS])
}
