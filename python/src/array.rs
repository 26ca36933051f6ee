//! Reads numpy arrays as slices, without a copy, or reports their fault.

use crate::fault::{argument_fault, raise};
use numpy::{PyArrayDescrMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArray};
use numpy::{PyUntypedArrayMethods, prelude::*};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

/// Name and axes of an array.
#[derive(Clone, Copy)]
pub(crate) struct Named<'a> {
    /// The function that takes the array.
    pub function: &'a str,
    /// Name of the argument.
    pub name: &'a str,
    /// Axes of the array, such as `gauges x loads`.
    pub axes: &'a str,
}

impl Named<'_> {
    fn array_of_any_type<'a, 'py>(
        &self,
        a: &'a Bound<'py, PyAny>,
        ndim: usize,
    ) -> PyResult<&'a Bound<'py, PyUntypedArray>> {
        let Self { name, axes, .. } = self;
        let remedy = format!("pass numpy.ascontiguousarray({name}, dtype=numpy.float64)");
        let Ok(array) = a.cast::<PyUntypedArray>() else {
            let kind = a.get_type().name()?;
            return Err(PyTypeError::new_err(format!(
                "{name} is a {kind}, and a numpy array of float64 ({axes}) is needed: {remedy}"
            )));
        };
        if !array.dtype().is_equiv_to(&numpy::dtype::<f64>(a.py())) {
            let dtype = array.dtype().str()?;
            return Err(PyTypeError::new_err(format!(
                "{name} contains {dtype}, and float64 is needed: {remedy}"
            )));
        }
        if array.ndim() != ndim {
            let said = format!("it has {} dimensions and needs {ndim}", array.ndim());
            return Err(self.fault(a.py(), &said, &format!("give it the shape {axes}")));
        }
        if !array.is_c_contiguous() {
            let said = "its rows are not contiguous in memory (it is a view, a transpose, or in Fortran order)";
            return Err(self.fault(a.py(), said, &remedy));
        }
        Ok(array)
    }

    /// Returns an array of two dimensions.
    pub fn matrix<'py>(&self, a: &Bound<'py, PyAny>) -> PyResult<PyReadonlyArray2<'py, f64>> {
        self.array_of_any_type(a, 2)?;
        Ok(a.cast::<numpy::PyArray2<f64>>()?.try_readonly()?)
    }

    /// Returns an array of one dimension.
    pub fn vector<'py>(&self, a: &Bound<'py, PyAny>) -> PyResult<PyReadonlyArray1<'py, f64>> {
        self.array_of_any_type(a, 1)?;
        Ok(a.cast::<numpy::PyArray1<f64>>()?.try_readonly()?)
    }

    /// Returns the error about the array.
    pub fn fault(&self, py: Python, said: &str, remedy: &str) -> PyErr {
        raise(
            py,
            argument_fault(self.function, self.name, said, remedy).into(),
        )
    }
}
