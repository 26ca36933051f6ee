//! VTU of points with vectors on them: gauges with their axes, loads as arrows (glyphs of ParaView).

use super::vtu::{AppendedArrays, begin, finish, floats};
use std::io::{Result, Write};

const VERTEX: u8 = 1;

/// Numbers by point.
#[derive(Clone, Debug, PartialEq)]
pub enum PointValues {
    /// One number for each point.
    Scalars(Vec<f64>),
    /// Three numbers for each point.
    Vectors(Vec<[f64; 3]>),
    /// Ids.
    Ids(Vec<u32>),
}

/// Writes points, each as a separate cell, with named numbers. Reals have 32 bits, positions 64.
///
/// # Errors
/// Errors of `out`.
pub fn write_points_vtu(
    points: &[[f64; 3]],
    arrays: &[(String, PointValues)],
    out: &mut dyn Write,
) -> Result<()> {
    let n = points.len();
    let mut a: AppendedArrays = begin(n, n);
    let xyz = points.iter().flatten().flat_map(|x| x.to_le_bytes());
    a.array("Points", "Float64", 3, xyz.collect());
    a.xml += "</Points>\n<Cells>\n";
    let count = |from: i64| (from..).take(n).flat_map(i64::to_le_bytes).collect();
    a.array("connectivity", "Int64", 1, count(0));
    a.array("offsets", "Int64", 1, count(1));
    a.array("types", "UInt8", 1, vec![VERTEX; n]);
    a.xml += "</Cells>\n<PointData>\n";
    for (name, values) in arrays {
        match values {
            PointValues::Scalars(v) => {
                a.array(name, "Float32", 1, floats(v.iter().copied()));
            }
            PointValues::Vectors(v) => {
                a.array(name, "Float32", 3, floats(v.iter().flatten().copied()));
            }
            PointValues::Ids(v) => {
                let bytes = v.iter().flat_map(|id| (*id as i32).to_le_bytes());
                a.array(name, "Int32", 1, bytes.collect());
            }
        }
    }
    a.xml += "</PointData>\n<CellData>\n";
    finish(a, out)
}
