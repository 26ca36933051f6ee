//! Strain of shells along any direction.

use crate::array::Named;
use numpy::{PyArray1, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::prelude::*;
use strainbridge::fe::shell_frame::{quad_axes, tria_axes};
use strainbridge::fe::strain_tensor::{basic_tensor, strain_along as along};
use strainbridge::model::{Mat3, Vec3};

const STRAIN: Named = Named {
    function: "strain_along",
    name: "strain",
    axes: "places x 3 or 6",
};

/// Returns normal strain along directions.
///
/// For Exx Eyy Ezz Exy Eyz Ezx (tensor shear, places x 6), directions are taken as given. For exx, eyy, gxy (engineering shear, places x 3) of
/// elements, directions are in the frame of the element. With `corners` (places x 3 or 4 x 3), they are in the frame of the corners and projected
/// onto the element. The result is NaN if an element has no area or the direction is its normal.
#[pyfunction]
#[pyo3(signature = (strain, direction, corners))]
pub(crate) fn strain_along<'py>(
    py: Python<'py>,
    strain: &Bound<'py, PyAny>,
    direction: &Bound<'py, PyAny>,
    corners: Option<PyReadonlyArrayDyn<'py, f64>>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let strain = STRAIN.matrix(strain)?;
    let named = Named {
        name: "direction",
        ..STRAIN
    };
    let direction = named.matrix(direction)?;
    let n = strain.shape()[0];
    let columns = strain.shape()[1];
    if columns != 3 && columns != 6 {
        let said = format!("it has {columns} columns");
        let remedy = "give exx, eyy, gxy, or Exx, Eyy, Ezz, Exy, Eyz, Ezx";
        return Err(STRAIN.fault(py, &said, remedy));
    }
    if direction.shape() != [n, 3] {
        let said = format!("its shape is {:?}", direction.shape());
        let remedy = format!("give one direction, or {n} of them");
        return Err(named.fault(py, &said, &remedy));
    }
    let width = match &corners {
        None => 0,
        Some(c) if c.shape() == [n, 3, 3] => 9,
        Some(c) if c.shape() == [n, 4, 3] => 12,
        Some(c) => {
            let named = Named {
                name: "corners",
                ..STRAIN
            };
            let said = format!("its shape is {:?}", c.shape());
            let remedy = "give places x 3 x 3 of triangles, or places x 4 x 3 of quadrilaterals";
            return Err(named.fault(py, &said, remedy));
        }
    };
    let points = corners.as_ref().map(|c| c.as_slice()).transpose()?;
    let (strain, direction) = (strain.as_slice()?, direction.as_slice()?);
    let value = |i: usize| -> Option<f64> {
        let d = Vec3::from_column_slice(direction.get(3 * i..3 * i + 3)?);
        match *strain.get(columns * i..columns * (i + 1))? {
            [exx, eyy, gxy] => {
                let axes = match points {
                    None => Mat3::identity(),
                    Some(p) => axes(p.get(i * width..(i + 1) * width)?)?,
                };
                let z: Vec3 = axes.row(2).transpose();
                let flat = d - z * d.dot(&z);
                // The projection of a normal is only rounding.
                let has_direction = flat.norm() > 1e-9 * d.norm();
                let tensor = basic_tensor([exx, eyy, gxy], 0.0, &axes);
                has_direction.then(|| along(&tensor, &flat))
            }
            [xx, yy, zz, xy, yz, zx] => {
                Some(along(&Mat3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz), &d))
            }
            _ => None,
        }
    };
    let values = (0..n).map(|i| value(i).unwrap_or(f64::NAN));
    Ok(PyArray1::from_vec(py, values.collect()))
}

fn axes(p: &[f64]) -> Option<Mat3> {
    let at = |i: usize| Vec3::new(p[3 * i], p[3 * i + 1], p[3 * i + 2]);
    match p.len() {
        9 => tria_axes([at(0), at(1), at(2)]),
        _ => quad_axes([at(0), at(1), at(2), at(3)]),
    }
}
