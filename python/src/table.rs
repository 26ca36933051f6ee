//! Tables for any reader of the Arrow PyCapsule interface, without an Arrow package on either side.

use crate::fault::{argument_fault, raise};
use arrow_array::builder::{
    BooleanBuilder, Float64Builder, Int64Builder, ListBuilder, StringBuilder,
};
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{
    Array, ArrayRef, Float64Array, Int64Array, RecordBatch, RecordBatchIterator,
    RecordBatchOptions, StringArray,
};
use arrow_schema::{DataType, Field, Schema, ffi::FFI_ArrowSchema};
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyDict};
use serde_json::{Map, Value};
use std::sync::Arc;

/// Table in the Arrow format.
#[pyclass(frozen, name = "_Table", module = "strainbridge._strainbridge")]
pub(crate) struct Table(RecordBatch);

#[pymethods]
impl Table {
    /// Creates a table of records or of columns.
    ///
    /// Records are JSON (a list of objects), with the names of the columns in order. Columns are arrays of numbers or lists of texts, by name.
    #[new]
    #[pyo3(signature = (records=None, names=Vec::new(), columns=None))]
    fn new(
        py: Python,
        records: Option<&str>,
        names: Vec<String>,
        columns: Option<&Bound<PyDict>>,
    ) -> PyResult<Self> {
        let mut of: Vec<(String, ArrayRef)> = Vec::new();
        if let Some(text) = records {
            let rows: Vec<Map<String, Value>> = serde_json::from_str(text)
                .map_err(|e| fault(py, &e.to_string(), "give a list of objects"))?;
            of = of_records(&rows, &names);
        }
        for (name, column) in columns.into_iter().flatten() {
            of.push((name.extract()?, of_column(&column)?));
        }
        let fields: Vec<Field> = of
            .iter()
            .map(|(name, a)| Field::new(name, a.data_type().clone(), true))
            .collect();
        // Without a column, the number of rows is zero.
        let n = of.first().map_or(0, |c| c.1.len());
        let arrays = of.into_iter().map(|c| c.1).collect();
        let options = RecordBatchOptions::new().with_row_count(Some(n));
        let batch =
            RecordBatch::try_new_with_options(Arc::new(Schema::new(fields)), arrays, &options)
                .map_err(|e| fault(py, &e.to_string(), "give columns of one length"))?;
        Ok(Self(batch))
    }

    #[getter]
    fn num_rows(&self) -> usize {
        self.0.num_rows()
    }

    #[getter]
    fn column_names(&self) -> Vec<String> {
        let schema = self.0.schema();
        schema.fields().iter().map(|f| f.name().clone()).collect()
    }

    /// Returns the schema as the interface requires.
    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        let schema = FFI_ArrowSchema::try_from(self.0.schema().as_ref())
            .map_err(|e| fault(py, &e.to_string(), "report it"))?;
        PyCapsule::new_with_value(py, schema, c"arrow_schema")
    }

    /// Returns the rows as a stream, as the interface requires. A requested schema is ignored, which the interface permits.
    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        let _ = requested_schema;
        let schema = self.0.schema();
        let rows = RecordBatchIterator::new([Ok(self.0.clone())], schema);
        let stream = FFI_ArrowArrayStream::new(Box::new(rows));
        PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
    }
}

fn fault(py: Python, said: &str, remedy: &str) -> PyErr {
    raise(py, argument_fault("to_arrow", "table", said, remedy).into())
}

fn of_column(column: &Bound<PyAny>) -> PyResult<ArrayRef> {
    if let Ok(a) = column.extract::<PyReadonlyArray1<f64>>() {
        return Ok(Arc::new(Float64Array::from(a.as_slice()?.to_vec())));
    }
    if let Ok(a) = column.extract::<PyReadonlyArray1<i64>>() {
        return Ok(Arc::new(Int64Array::from(a.as_slice()?.to_vec())));
    }
    Ok(Arc::new(StringArray::from(
        column.extract::<Vec<String>>()?,
    )))
}

/// Returns columns with these names, in order.
fn of_records(rows: &[Map<String, Value>], names: &[String]) -> Vec<(String, ArrayRef)> {
    let column = |name: &String| {
        let values = rows.iter().map(|r| r.get(name).filter(|v| !v.is_null()));
        (name.clone(), of_values(&values.collect::<Vec<_>>()))
    };
    names.iter().map(column).collect()
}

/// Converts values to whole numbers, reals, truth values, lists of reals or texts. The first type that fits all values is used, otherwise JSON.
fn of_values(values: &[Option<&Value>]) -> ArrayRef {
    let all = |fits: fn(&Value) -> bool| values.iter().flatten().all(|v| fits(v));
    let kind = if values.iter().all(Option::is_none) || all(Value::is_i64) {
        DataType::Int64
    } else if all(Value::is_number) {
        DataType::Float64
    } else if all(Value::is_boolean) {
        DataType::Boolean
    } else if all(|v| v.as_array().is_some_and(|a| a.iter().all(is_real))) {
        return lists(values);
    } else {
        DataType::Utf8
    };
    let values = values.iter().copied();
    match kind {
        DataType::Int64 if values.clone().all(|v| v.is_none()) => {
            let mut b = Float64Builder::new();
            values.for_each(|_| b.append_null());
            Arc::new(b.finish())
        }
        DataType::Int64 => {
            let mut b = Int64Builder::new();
            values.for_each(|v| b.append_option(v.and_then(Value::as_i64)));
            Arc::new(b.finish())
        }
        DataType::Float64 => {
            let mut b = Float64Builder::new();
            values.for_each(|v| b.append_option(v.and_then(Value::as_f64)));
            Arc::new(b.finish())
        }
        DataType::Boolean => {
            let mut b = BooleanBuilder::new();
            values.for_each(|v| b.append_option(v.and_then(Value::as_bool)));
            Arc::new(b.finish())
        }
        _ => {
            let mut b = StringBuilder::new();
            for v in values {
                match v {
                    Some(Value::String(text)) => b.append_value(text),
                    Some(other) => b.append_value(other.to_string()),
                    None => b.append_null(),
                }
            }
            Arc::new(b.finish())
        }
    }
}

fn is_real(v: &Value) -> bool {
    v.is_number() || v.is_null()
}

fn lists(values: &[Option<&Value>]) -> ArrayRef {
    let mut b = ListBuilder::new(Float64Builder::new());
    for v in values {
        let list = v.and_then(Value::as_array);
        for number in list.into_iter().flatten() {
            b.values().append_option(number.as_f64());
        }
        b.append(list.is_some());
    }
    Arc::new(b.finish())
}
