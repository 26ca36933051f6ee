//! VTU (VTK XML unstructured grid) that ParaView opens: mesh, displacements and shell strain of load cases.

use crate::fe::CaseResult;
use crate::fe::strain_tensor::largest_in_plane;
use crate::model::{GridIx, Model};
use nastran::cards::SolidShape;
use std::io::{Result, Write};

const LINE: u8 = 3;
const TRIANGLE: u8 = 5;
const QUAD: u8 = 9;

/// Arrays that are appended to the XML as raw little-endian bytes, each after its length in bytes (64 bit).
pub(super) struct AppendedArrays {
    pub(super) xml: String,
    offset: u64,
    blocks: Vec<Vec<u8>>,
}

impl AppendedArrays {
    pub(super) fn array(&mut self, name: &str, kind: &str, components: usize, bytes: Vec<u8>) {
        self.xml += &format!(
            "<DataArray type=\"{kind}\" Name=\"{}\" NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{}\"/>\n",
            escape(name),
            self.offset
        );
        self.offset += 8 + bytes.len() as u64;
        self.blocks.push(bytes);
    }
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

pub(super) fn floats(values: impl Iterator<Item = f64>) -> Vec<u8> {
    values.flat_map(|v| (v as f32).to_le_bytes()).collect()
}

/// Writes the mesh of shells, bars, rods, solids and shear panels with each case's displacement.
///
/// - Each shell has, at bottom and top, the strain in the element frame (exx, eyy, gxy, engineering shear). It also has the largest principal strain
///   by magnitude.
/// - Each solid has the strain at its centre (xx yy zz xy yz zx, engineering shear).
///
/// Values are 32-bit reals.
///
/// # Errors
/// Errors of `out`.
pub fn write_vtu(model: &Model, cases: &[CaseResult], out: &mut dyn Write) -> Result<()> {
    let (mut a, cells) = mesh(model);
    for case in cases
        .iter()
        .filter(|c| c.displacement.len() == model.grids.len())
    {
        let u = case.displacement.iter().flat_map(|u| [u[0], u[1], u[2]]);
        a.array(
            &format!("displacement {}", title(case)),
            "Float32",
            3,
            floats(u),
        );
    }
    begin_cell_data(&mut a, &cells);
    for case in cases {
        let mut by_shell = vec![[[f64::NAN; 3]; 2]; cells.len()];
        for (ix, strain) in case.shells.elements.iter().zip(&case.shells.centre) {
            if let Some(slot) = by_shell.get_mut(ix.us()) {
                *slot = *strain;
            }
        }
        for (surface, name) in ["bottom", "top"].iter().enumerate() {
            let strain = by_shell.iter().flat_map(|s| s[surface]);
            a.array(
                &format!("strain {name} {}", title(case)),
                "Float32",
                3,
                floats(strain),
            );
            let largest = by_shell.iter().map(|s| largest_in_plane(s[surface]));
            a.array(
                &format!("largest strain {name} {}", title(case)),
                "Float32",
                1,
                floats(largest),
            );
        }
    }
    let first_solid = model.shells.len() + model.beams.len() + model.rods.len();
    for case in cases.iter().filter(|c| !c.solids.centre.is_empty()) {
        let mut by_cell = vec![[f64::NAN; 6]; cells.len()];
        for (i, strain) in case.solids.elements.iter().zip(&case.solids.centre) {
            if let Some(slot) = by_cell.get_mut(first_solid + i) {
                *slot = *strain;
            }
        }
        let strain = by_cell.iter().flatten().copied();
        a.array(
            &format!("strain of solids {}", title(case)),
            "Float32",
            6,
            floats(strain),
        );
    }
    finish(a, out)
}

/// Writes the mesh with numbers by shell (indexed as in the model) and by bar or beam; rods have none. Values are 32-bit reals.
///
/// # Errors
/// Errors of `out`.
pub fn write_cells_vtu(
    model: &Model,
    arrays: &[(String, Vec<f64>, Vec<f64>)],
    out: &mut dyn Write,
) -> Result<()> {
    let (mut a, cells) = mesh(model);
    begin_cell_data(&mut a, &cells);
    for (name, shells, beams) in arrays {
        let of = |list: &[f64], i: usize| list.get(i).copied().unwrap_or(f64::NAN);
        let values = (0..cells.len()).map(|i| match i.checked_sub(model.shells.len()) {
            None => of(shells, i),
            Some(b) if b < model.beams.len() => of(beams, b),
            Some(_) => f64::NAN,
        });
        a.array(name, "Float32", 1, floats(values));
    }
    finish(a, out)
}

/// Cells of the mesh: VTK type, element id, grids.
type Cells = Vec<(u8, u32, Vec<GridIx>)>;

/// Returns the VTK cells of a model: cell type, element id and corner grids. Shells come first, then bars and beams, rods, solids and shear panels,
/// each in the order of the model.
pub fn vtk_cells(model: &Model) -> Vec<(u8, u32, Vec<GridIx>)> {
    let mut cells: Cells = Vec::new();
    for s in &model.shells {
        let n = s.shape.n_corners();
        cells.push((
            if n == 4 { QUAD } else { TRIANGLE },
            s.id,
            s.grids[..n].to_vec(),
        ));
    }
    cells.extend(model.beams.iter().map(|b| (LINE, b.id, b.grids.to_vec())));
    cells.extend(model.rods.iter().map(|r| (LINE, r.id, r.grids.to_vec())));
    for s in &model.solids {
        let kind = match s.shape {
            SolidShape::Tetra => 10,
            SolidShape::Hexa => 12,
            SolidShape::Penta => 13,
            SolidShape::Pyram => 14,
        };
        let corners = s.grids[..s.shape.n_corners()].iter().flatten();
        cells.push((kind, s.id, corners.copied().collect()));
    }
    let panels = model.shear_panels.iter();
    cells.extend(panels.map(|p| (QUAD, p.id, p.grids.to_vec())));
    cells
}

/// The document up to the grid numbers among the point data.
fn mesh(model: &Model) -> (AppendedArrays, Cells) {
    let cells = vtk_cells(model);
    let mut a = begin(model.grids.len(), cells.len());
    a.array(
        "Points",
        "Float64",
        3,
        model
            .grids
            .iter()
            .flat_map(|g| [g.x.x, g.x.y, g.x.z])
            .flat_map(f64::to_le_bytes)
            .collect(),
    );
    a.xml += "</Points>\n<Cells>\n";
    a.array(
        "connectivity",
        "Int64",
        1,
        cells
            .iter()
            .flat_map(|c| &c.2)
            .flat_map(|g| i64::from(g.0).to_le_bytes())
            .collect(),
    );
    let mut end = 0_i64;
    let ends = cells.iter().flat_map(|c| {
        end += c.2.len() as i64;
        end.to_le_bytes()
    });
    let ends = ends.collect();
    a.array("offsets", "Int64", 1, ends);
    a.array("types", "UInt8", 1, cells.iter().map(|c| c.0).collect());
    a.xml += "</Cells>\n<PointData>\n";
    a.array(
        "grid",
        "Int32",
        1,
        model
            .grids
            .iter()
            .flat_map(|g| (g.id as i32).to_le_bytes())
            .collect(),
    );
    (a, cells)
}

/// Returns the document up to the points.
pub(super) fn begin(points: usize, cells: usize) -> AppendedArrays {
    let xml = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">\n<Points>\n"
    );
    AppendedArrays {
        xml,
        offset: 0,
        blocks: Vec::new(),
    }
}

/// Ends the point data, begins the cell data with the element numbers.
fn begin_cell_data(a: &mut AppendedArrays, cells: &Cells) {
    a.xml += "</PointData>\n<CellData>\n";
    a.array(
        "element",
        "Int32",
        1,
        cells
            .iter()
            .flat_map(|c| (c.1 as i32).to_le_bytes())
            .collect(),
    );
}

pub(super) fn finish(mut a: AppendedArrays, out: &mut dyn Write) -> Result<()> {
    a.xml += "</CellData>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_";
    out.write_all(a.xml.as_bytes())?;
    for block in &a.blocks {
        out.write_all(&(block.len() as u64).to_le_bytes())?;
        out.write_all(block)?;
    }
    out.write_all(b"\n</AppendedData>\n</VTKFile>\n")
}

fn title(case: &CaseResult) -> String {
    if case.label.is_empty() {
        case.subcase.to_string()
    } else {
        format!("{} {}", case.subcase, case.label)
    }
}
