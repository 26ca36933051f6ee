//! VTU of a mesh and numbers on it that are given as arrays, whatever made them.

use super::vtu::{begin, finish};
use std::io::{Result, Write};

/// Points and cells in the form of VTK.
#[derive(Clone, Copy, Debug)]
pub struct MeshArrays<'a> {
    /// `n x 3` by rows.
    pub points: &'a [f64],
    /// Points of all cells, cell after cell.
    pub connectivity: &'a [i64],
    /// Index in `connectivity` at which the points of each cell end.
    pub offsets: &'a [i64],
    /// VTK type of each cell.
    pub types: &'a [u8],
}

/// Numbers on every point or every cell, by rows of `columns`.
#[derive(Clone, Copy, Debug)]
pub struct NamedArray<'a> {
    /// Name of the array.
    pub name: &'a str,
    /// Numbers per point or cell.
    pub columns: usize,
    /// Numbers, by rows of `columns`.
    pub values: Numbers<'a>,
}

/// Reals or whole numbers.
#[derive(Clone, Copy, Debug)]
#[allow(missing_docs)]
pub enum Numbers<'a> {
    Reals(&'a [f64]),
    Whole(&'a [i64]),
}

/// Writes mesh and numbers with all digits. The caller checks the shapes.
///
/// # Errors
/// Errors of `out`.
pub fn write_arrays_vtu(
    mesh: MeshArrays,
    on_points: &[NamedArray],
    on_cells: &[NamedArray],
    out: &mut dyn Write,
) -> Result<()> {
    let mut a = begin(mesh.points.len() / 3, mesh.types.len());
    a.array("Points", "Float64", 3, reals(mesh.points));
    a.xml += "</Points>\n<Cells>\n";
    a.array("connectivity", "Int64", 1, integer_bytes(mesh.connectivity));
    a.array("offsets", "Int64", 1, integer_bytes(mesh.offsets));
    a.array("types", "UInt8", 1, mesh.types.to_vec());
    a.xml += "</Cells>\n<PointData>\n";
    let mut put = |arrays: &[NamedArray], end: &str| {
        for n in arrays {
            match n.values {
                Numbers::Reals(v) => a.array(n.name, "Float64", n.columns, reals(v)),
                Numbers::Whole(v) => a.array(n.name, "Int64", n.columns, integer_bytes(v)),
            }
        }
        a.xml += end;
    };
    put(on_points, "</PointData>\n<CellData>\n");
    put(on_cells, "");
    finish(a, out)
}

fn reals(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

fn integer_bytes(values: &[i64]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}
