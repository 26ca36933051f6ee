//! Faulty input as the exception `strainbridge.Faults`.

use pyo3::prelude::*;
use strainbridge::{Fault, Faults};

/// Returns the exception with these faults.
pub(crate) fn raise(py: Python, faults: Faults) -> PyErr {
    let made = || -> PyResult<PyErr> {
        let list: Vec<_> = faults
            .into_iter()
            .map(|f| (f.file, f.line, f.field, f.wrong, f.remedy))
            .collect();
        let class = py.import("strainbridge._faults")?.getattr("Faults")?;
        Ok(PyErr::from_value(class.call1((list,))?))
    };
    made().unwrap_or_else(|e| e)
}

/// Returns a fault of an argument of a function.
pub(crate) fn argument_fault(function: &str, argument: &str, said: &str, remedy: &str) -> Fault {
    Fault::new(function, argument, said, remedy)
}
