//! Result files and meshes from arrays.

use crate::fault::{argument_fault, raise};
use crate::work::{Asked, run};
use nastran::op2::write_blocks;
use nastran::results::{Analysis, Block, ElementType, Quantity, RowId, Rows, ShellForm, columns};
use numpy::{PyReadonlyArray1, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::collections::HashMap;
use strainbridge::Faults;
use strainbridge::report::{MeshArrays, NamedArray, Numbers, write_arrays_vtu};

/// Date in the files. It is constant, so that equal arrays give equal bytes.
const DATE: [u32; 3] = [1, 1, 2000];

/// Lists of columns that a table may have.
const LISTS: [&[&str]; 15] = [
    columns::NODAL,
    columns::SHELL_STRAIN,
    columns::SHELL_STRESS,
    columns::PLY,
    columns::BAR,
    columns::BAR_STATION,
    columns::BEAM,
    columns::ROD,
    columns::SPRING,
    columns::SHEAR_PANEL,
    columns::SOLID,
    columns::SHELL_FORCE,
    columns::BAR_FORCE,
    columns::BEAM_FORCE,
    columns::ROD_FORCE,
];

/// Quantities that are written.
const QUANTITIES: [Quantity; 12] = [
    Quantity::Displacement,
    Quantity::Velocity,
    Quantity::Acceleration,
    Quantity::Eigenvector,
    Quantity::SpcForce,
    Quantity::MpcForce,
    Quantity::AppliedLoad,
    Quantity::ElementForce,
    Quantity::Stress,
    Quantity::Strain,
    Quantity::PlyStress,
    Quantity::PlyStrain,
];

/// Table to be written.
#[derive(FromPyObject)]
pub(crate) struct Given<'py> {
    #[pyo3(item)]
    quantity: String,
    #[pyo3(item)]
    analysis: String,
    #[pyo3(item)]
    subcase: u32,
    #[pyo3(item)]
    mode: i32,
    #[pyo3(item)]
    step: f64,
    #[pyo3(item)]
    element_type: Option<String>,
    #[pyo3(item)]
    fibre: bool,
    #[pyo3(item)]
    titles: [String; 3],
    #[pyo3(item)]
    entity: PyReadonlyArray1<'py, i64>,
    #[pyo3(item)]
    at: PyReadonlyArray1<'py, i64>,
    #[pyo3(item)]
    layer: PyReadonlyArray1<'py, i64>,
    #[pyo3(item)]
    columns: HashMap<String, PyReadonlyArray1<'py, f64>>,
}

fn fault(said: &str, remedy: &str) -> Faults {
    argument_fault("write_op2", "tables", said, remedy).into()
}

/// Returns the tables as the bytes of an OP2.
#[pyfunction]
pub(crate) fn op2_bytes<'py>(py: Python<'py>, tables: Vec<Given>) -> PyResult<Bound<'py, PyBytes>> {
    let made: Result<Vec<(Block, Rows)>, Faults> = tables.iter().map(prepare_block).collect();
    let made = made.map_err(|f| raise(py, f))?;
    let bytes = run(py, &Asked::default(), |_| {
        write_blocks(made.iter().map(|(b, r)| (b, r)), DATE)
    })?;
    let bytes = bytes.map_err(|e| {
        let remedy = "give rows as `Results.table` gives them";
        raise(py, fault(&e.to_string(), remedy))
    })?;
    Ok(PyBytes::new(py, &bytes))
}

fn prepare_block(given: &Given) -> Result<(Block, Rows), Faults> {
    let quantity = QUANTITIES.iter().find(|q| q.word() == given.quantity);
    let quantity = *quantity.ok_or_else(|| {
        let known: Vec<&str> = QUANTITIES.iter().map(|q| q.word()).collect();
        let said = format!("`{}` is not written", given.quantity);
        fault(&said, &format!("give one of {}", known.join(", ")))
    })?;
    let code = (1..=10).find(|c| Analysis::from_code(*c).word() == given.analysis);
    let analysis = code.map(Analysis::from_code).ok_or_else(|| {
        let said = format!("the analysis `{}` is not known", given.analysis);
        fault(&said, "give statics or modes")
    })?;
    let element = match &given.element_type {
        None => None,
        Some(name) => {
            let known = (1..=255).map(ElementType);
            let found = known.into_iter().find(|e| e.name() == Some(name));
            let said = format!("the element type `{name}` is not known");
            Some(found.ok_or_else(|| fault(&said, "give a name such as CQUAD4"))?)
        }
    };
    let columns = LISTS.iter().find(|list| {
        list.len() == given.columns.len() && list.iter().all(|c| given.columns.contains_key(*c))
    });
    let columns = columns.ok_or_else(|| {
        let mut names: Vec<&str> = given.columns.keys().map(String::as_str).collect();
        names.sort_unstable();
        let said = format!("no table has the columns {}", names.join(", "));
        fault(&said, "give the columns of `Results.table`")
    })?;
    let ids = [&given.entity, &given.at, &given.layer];
    let n = ids[0].shape()[0];
    let lengths = ids.iter().map(|a| a.shape()[0]);
    let lengths = lengths.chain(given.columns.values().map(|a| a.shape()[0]));
    if lengths.into_iter().any(|len| len != n) {
        return Err(fault(
            "columns of a table differ in length",
            "give one value for each row",
        ));
    }
    let number = |v: i64| {
        u32::try_from(v).map_err(|_| fault(&format!("{v} is not an id"), "give ids of 0 or more"))
    };
    let [entity, at, layer] = ids.map(|a| a.as_array());
    let mut rows = Rows {
        columns,
        ..Rows::default()
    };
    for i in 0..n {
        rows.ids.push(RowId {
            entity: number(entity[i])?,
            at: number(at[i])?,
            layer: number(layer[i])?,
        });
    }
    let of: Vec<_> = columns
        .iter()
        .filter_map(|c| given.columns.get(*c))
        .collect();
    let of: Vec<_> = of.iter().map(|a| a.as_array()).collect();
    rows.values = (0..n).flat_map(|i| of.iter().map(move |c| c[i])).collect();
    let form = element.map(|_| match given.fibre {
        true => ShellForm::Fiber,
        false => ShellForm::Curvature,
    });
    let block = Block {
        table: String::new(),
        quantity,
        analysis,
        subcase: given.subcase,
        mode: given.mode,
        step: given.step,
        element,
        form,
        von_mises: true,
        complex: false,
        sort2: false,
        num_wide: 0,
        entries: 0,
        titles: given.titles.clone(),
    };
    Ok((block, rows))
}

/// Numbers from Python on points or cells.
enum Held<'py> {
    Reals(PyReadonlyArrayDyn<'py, f64>),
    Whole(PyReadonlyArrayDyn<'py, i64>),
}

fn extract_arrays<'py>(arrays: &Bound<'py, PyDict>) -> PyResult<Vec<(String, usize, Held<'py>)>> {
    let mut out = Vec::new();
    for (name, a) in arrays {
        let held = match a.extract::<PyReadonlyArrayDyn<f64>>() {
            Ok(a) => Held::Reals(a),
            Err(_) => Held::Whole(a.extract()?),
        };
        let shape = match &held {
            Held::Reals(a) => a.shape().to_vec(),
            Held::Whole(a) => a.shape().to_vec(),
        };
        out.push((name.extract()?, shape.iter().skip(1).product(), held));
    }
    Ok(out)
}

fn name_arrays<'a>(list: &'a [(String, usize, Held)]) -> PyResult<Vec<NamedArray<'a>>> {
    let one = |(name, columns, held): &'a (String, usize, Held)| {
        Ok(NamedArray {
            name,
            columns: *columns,
            values: match held {
                Held::Reals(a) => Numbers::Reals(a.as_slice()?),
                Held::Whole(a) => Numbers::Whole(a.as_slice()?),
            },
        })
    };
    list.iter().map(one).collect()
}

/// Returns a mesh with numbers as the bytes of a VTU. Python checks the shapes.
#[pyfunction]
pub(crate) fn vtu_bytes<'py>(
    py: Python<'py>,
    points: PyReadonlyArrayDyn<'py, f64>,
    connectivity: PyReadonlyArray1<'py, i64>,
    offsets: PyReadonlyArray1<'py, i64>,
    types: PyReadonlyArray1<'py, u8>,
    point_data: &Bound<'py, PyDict>,
    cell_data: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyBytes>> {
    let mesh = MeshArrays {
        points: points.as_slice()?,
        connectivity: connectivity.as_slice()?,
        offsets: offsets.as_slice()?,
        types: types.as_slice()?,
    };
    let (of_points, of_cells) = (extract_arrays(point_data)?, extract_arrays(cell_data)?);
    let mut out = Vec::new();
    write_arrays_vtu(
        mesh,
        &name_arrays(&of_points)?,
        &name_arrays(&of_cells)?,
        &mut out,
    )?;
    Ok(PyBytes::new(py, &out))
}
