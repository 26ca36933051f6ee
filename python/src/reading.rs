//! Decks and result files as arrays.

use crate::editing::{Columns as Changed, edit};
use crate::fault::raise;
use crate::files::Desk;
use crate::work::{Asked, run};
use nastran::bdf::Edits;
use nastran::cards::{MaterialAngle, Shell};
use nastran::results::{ResultsError, ResultsFile, Rows, ShellForm};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use strainbridge::fe::strain_rows::{Location, Point, each_row, n_elements};
use strainbridge::fe::strain_tensor::Surface;
use strainbridge::host::files::{FileBytes, Inputs};
use strainbridge::report::vtk_cells;
use strainbridge::strain_chain::deck::{DeckModel, read_model};
use strainbridge::units::MICROSTRAIN;
use strainbridge::workflow::cases::edited_files;
use strainbridge::{Context, Fault, Faults};

/// Numbers of a table, `columns` per row.
struct Columns<T> {
    values: Vec<T>,
    columns: usize,
}

/// Inserts columns into a dictionary: one number per row as a vector, more as a matrix.
fn insert_columns<T: numpy::Element>(
    out: &Bound<PyDict>,
    name: &str,
    c: Columns<T>,
) -> PyResult<()> {
    let rows = c.values.len() / c.columns.max(1);
    let array = PyArray1::from_vec(out.py(), c.values);
    match c.columns {
        1 => out.set_item(name, array),
        n => out.set_item(name, array.reshape([rows, n])?),
    }
}

fn ids(values: impl Iterator<Item = i64>) -> Columns<i64> {
    Columns {
        values: values.collect(),
        columns: 1,
    }
}

/// Deck with its model.
#[pyclass(frozen, name = "_Deck", module = "strainbridge._strainbridge")]
pub(crate) struct ReadDeck(DeckModel);

#[pymethods]
impl ReadDeck {
    /// Reads the deck at `path`. `files` are in memory, by path, and have priority over files on the disk.
    #[new]
    #[pyo3(signature = (path, files=BTreeMap::new()))]
    fn new(py: Python, path: PathBuf, files: BTreeMap<PathBuf, Vec<u8>>) -> PyResult<Self> {
        let (given, desk) = (path.display().to_string(), Desk(files));
        let read = run(py, &Asked::default(), |_| {
            read_model(&mut Inputs::new(&desk), Path::new(""), &given)
        })?;
        Ok(Self(read.map_err(|f| raise(py, f.into()))?))
    }

    /// Returns the mesh: `points` (n x 3, basic frame), `grid` (ids), and the cells as in VTK: `connectivity`, `offsets` (ends), `types`, `element`.
    fn mesh<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (out, model) = (PyDict::new(py), &self.0.model);
        let values = model.grids.iter().flat_map(|g| [g.x.x, g.x.y, g.x.z]);
        let values = values.collect();
        insert_columns(&out, "points", Columns { values, columns: 3 })?;
        insert_columns(
            &out,
            "grid",
            ids(model.grids.iter().map(|g| i64::from(g.id))),
        )?;
        let cells = vtk_cells(model);
        let (mut ends, mut end) = (Vec::with_capacity(cells.len()), 0);
        for cell in &cells {
            end += cell.2.len() as i64;
            ends.push(end);
        }
        let corners = cells.iter().flat_map(|c| &c.2);
        insert_columns(&out, "connectivity", ids(corners.map(|g| i64::from(g.0))))?;
        insert_columns(&out, "offsets", ids(ends.into_iter()))?;
        insert_columns(&out, "element", ids(cells.iter().map(|c| i64::from(c.1))))?;
        let types = cells.iter().map(|c| c.0).collect();
        out.set_item("types", PyArray1::<u8>::from_vec(py, types))?;
        Ok(out)
    }

    /// Returns name and bytes of the files of the deck after changes of cards by columns. The first is the deck. INCLUDE files are relative to
    /// `folder`.
    fn edit_files(
        &self,
        py: Python,
        folder: PathBuf,
        stem: &str,
        changed: BTreeMap<String, Changed>,
    ) -> PyResult<Vec<(String, Vec<u8>)>> {
        let mut edits = Edits::default();
        for (name, columns) in &changed {
            edit(&self.0.deck, &mut edits, name, columns).map_err(|f| raise(py, f))?;
        }
        Ok(edited_files(&self.0.deck, &edits, &folder, stem))
    }

    /// Returns the number of cards by name.
    #[getter]
    fn counts(&self) -> BTreeMap<String, usize> {
        self.0.deck.counts.clone()
    }

    /// Returns all faults of the deck, each as its parts.
    #[getter]
    fn faults(&self) -> Vec<(String, Option<u32>, String, String, String)> {
        let parts = |f: &Fault| {
            let f = f.clone();
            (f.file, f.line, f.field, f.wrong, f.remedy)
        };
        self.0.faults.iter().map(parts).collect()
    }

    /// Returns ids of the grids, and their locations in the basic frame.
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (out, grids) = (PyDict::new(py), &self.0.model.grids);
        insert_columns(&out, "id", ids(grids.iter().map(|g| i64::from(g.id))))?;
        let values = grids.iter().flat_map(|g| [g.x.x, g.x.y, g.x.z]).collect();
        insert_columns(&out, "x", Columns { values, columns: 3 })?;
        Ok(out)
    }

    /// Returns the cards of one name as columns, or `None` for a name without columns here.
    fn cards<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<Bound<'py, PyDict>>> {
        let (out, cards) = (PyDict::new(py), &self.0.deck.cards);
        match name {
            "GRID" => {
                let list = &cards.grids;
                insert_columns(&out, "id", ids(list.iter().map(|c| i64::from(c.card.id))))?;
                let cp = |c: Option<u32>| c.map_or(0, i64::from);
                insert_columns(&out, "cp", ids(list.iter().map(|c| cp(c.card.cp))))?;
                let cd = list.iter().map(|c| i64::from(c.card.cd.unwrap_or(0)));
                insert_columns(&out, "cd", ids(cd))?;
                let values = list.iter().flat_map(|c| c.card.x).collect();
                insert_columns(&out, "x", Columns { values, columns: 3 })?;
            }
            "CONM2" => {
                let list = &cards.conm2s;
                insert_columns(&out, "id", ids(list.iter().map(|c| i64::from(c.card.id))))?;
                insert_columns(
                    &out,
                    "grid",
                    ids(list.iter().map(|c| i64::from(c.card.grid))),
                )?;
                let values = list.iter().map(|c| c.card.mass).collect();
                insert_columns(&out, "mass", Columns { values, columns: 1 })?;
                let values = list.iter().flat_map(|c| c.card.offset).collect();
                insert_columns(&out, "offset", Columns { values, columns: 3 })?;
            }
            "CQUAD4" | "CQUADR" | "CQUAD8" | "CTRIA3" | "CTRIAR" | "CTRIA6" => {
                let list = cards.shells.iter().map(|c| &c.card);
                let list: Vec<&Shell> = list.filter(|c| c.shape.card() == name).collect();
                let width = list.first().map_or(4, |c| c.shape.n_grids());
                let rows = list.iter().map(|c| (c.id, c.pid, &c.grids[..width]));
                elements(&out, rows, width)?;
                let theta = list.iter().map(|c| match c.angle {
                    MaterialAngle::Theta(degrees) => degrees,
                    MaterialAngle::Mcid(_) => f64::NAN,
                });
                let values = theta.collect();
                insert_columns(&out, "theta", Columns { values, columns: 1 })?;
            }
            "CHEXA" | "CPENTA" | "CTETRA" | "CPYRAM" => {
                let list = cards.solids.iter().map(|c| &c.card);
                let list: Vec<_> = list.filter(|c| c.shape.card() == name).collect();
                elements(&out, list.iter().map(|c| (c.id, c.pid, &c.grids[..])), 20)?;
            }
            "CBAR" => {
                let list = cards.bars.iter().map(|c| &c.card);
                elements(&out, list.map(|c| (c.id, c.pid, &c.grids[..])), 2)?;
            }
            "CBEAM" => {
                let list = cards.beams.iter().map(|c| &c.card.bar);
                elements(&out, list.map(|c| (c.id, c.pid, &c.grids[..])), 2)?;
            }
            "CROD" | "CTUBE" => {
                let list = cards.rods.iter().map(|c| &c.card);
                let list = list.filter(|c| c.is_tube == (name == "CTUBE"));
                elements(&out, list.map(|c| (c.id, c.pid, &c.grids[..])), 2)?;
            }
            _ => return Ok(None),
        }
        Ok(Some(out))
    }
}

/// Inserts ids, properties (the id of the element if blank) and grids of elements.
fn elements<'a>(
    out: &Bound<PyDict>,
    rows: impl Iterator<Item = (u32, Option<u32>, &'a [u32])>,
    width: usize,
) -> PyResult<()> {
    let (mut id, mut pid, mut grids) = (Vec::new(), Vec::new(), Vec::new());
    for (number, property, corners) in rows {
        id.push(i64::from(number));
        pid.push(i64::from(property.unwrap_or(number)));
        grids.extend(corners.iter().map(|g| i64::from(*g)));
    }
    insert_columns(out, "id", ids(id.into_iter()))?;
    insert_columns(out, "pid", ids(pid.into_iter()))?;
    let columns = width;
    insert_columns(
        out,
        "grids",
        Columns {
            values: grids,
            columns,
        },
    )
}

/// Result file.
#[pyclass(frozen, name = "_Results", module = "strainbridge._strainbridge")]
pub(crate) struct ReadResults {
    name: String,
    bytes: FileBytes,
}

impl ReadResults {
    fn open_results<T: Send>(
        &self,
        py: Python,
        ask: impl FnOnce(&ResultsFile) -> Result<T, ResultsError> + Send,
    ) -> PyResult<T> {
        let done = run(py, &Asked::default(), |_| {
            ask(&ResultsFile::read(&self.bytes, &self.name)?)
        })?;
        done.map_err(|e| {
            let remedy = "give an OP2, punch or HDF5 file of Nastran";
            raise(
                py,
                Fault::new(&*self.name, "results", e.to_string(), remedy).into(),
            )
        })
    }
}

#[pymethods]
impl ReadResults {
    /// Reads the results at `path`. `files` are in memory, by path, and have priority over files on the disk.
    #[new]
    #[pyo3(signature = (path, files=BTreeMap::new()))]
    fn new(py: Python, path: PathBuf, files: BTreeMap<PathBuf, Vec<u8>>) -> PyResult<Self> {
        let (name, desk) = (path.display().to_string(), Desk(files));
        let read = run(py, &Asked::default(), |_| {
            Inputs::new(&desk).read(Path::new(""), &name)
        })?;
        let bytes = read.map_err(|f| raise(py, f.into()))?;
        let this = Self { name, bytes };
        this.open_results(py, |_| Ok(()))?;
        Ok(this)
    }

    /// Returns the headers of the result tables, as JSON.
    fn tables(&self, py: Python) -> PyResult<String> {
        self.open_results(py, |file| {
            let blocks = file.blocks().iter().map(|b| {
                serde_json::json!({
                    "table": b.table,
                    "quantity": b.quantity.word(),
                    "analysis": b.analysis.word(),
                    "subcase": b.subcase,
                    "mode": b.mode,
                    "step": b.step,
                    "element_type": b.element.and_then(|e| e.name()),
                    "fibre": b.form == Some(ShellForm::Fiber),
                    "titles": b.titles,
                })
            });
            Ok(serde_json::Value::from_iter(blocks).to_string())
        })
    }

    /// Returns the rows of a table: `entity`, `at`, `layer`, and the columns of the table.
    fn rows<'py>(&self, py: Python<'py>, table: usize) -> PyResult<Bound<'py, PyDict>> {
        let rows: Rows = self.open_results(py, |file| file.rows(table))?;
        let out = PyDict::new(py);
        insert_columns(
            &out,
            "entity",
            ids(rows.ids.iter().map(|r| i64::from(r.entity))),
        )?;
        insert_columns(&out, "at", ids(rows.ids.iter().map(|r| i64::from(r.at))))?;
        insert_columns(
            &out,
            "layer",
            ids(rows.ids.iter().map(|r| i64::from(r.layer))),
        )?;
        for (c, name) in rows.columns.iter().enumerate() {
            let values = (0..rows.len()).map(|i| rows.row(i)[c]).collect();
            insert_columns(&out, name, Columns { values, columns: 1 })?;
        }
        Ok(out)
    }
}

/// Returns strain of the shells of a subcase, microstrain: `element`, `grid` (0: the centre), `top`, `local` (n x 3), `basic` (n x 6).
#[pyfunction]
#[pyo3(signature = (deck, results, subcase, files=BTreeMap::new()))]
pub(crate) fn shell_strain<'py>(
    py: Python<'py>,
    deck: PathBuf,
    results: PathBuf,
    subcase: u32,
    files: BTreeMap<PathBuf, Vec<u8>>,
) -> PyResult<Bound<'py, PyDict>> {
    let desk = Desk(files);
    let found = run(py, &Asked::default(), |heard| {
        let cx = Context::new(&desk).progress(heard);
        let read = strainbridge::strains(&deck, std::slice::from_ref(&results), &cx)?;
        let case = read.solution.cases.iter().find(|c| c.subcase == subcase);
        let case = case.ok_or_else(|| {
            let said = format!("it has no static subcase {subcase}");
            let remedy = format!("ask for one of {:?}", read.subcase_ids);
            Faults::from(Fault::new(
                results.display().to_string(),
                "subcase",
                said,
                remedy,
            ))
        })?;
        let mut rows = (Vec::new(), Vec::new(), Vec::new(), Vec::new(), Vec::new());
        each_row(&read.model, case, 0..n_elements(case), |r| {
            let Point::Surface(surface) = r.point else {
                return;
            };
            rows.0.push(i64::from(r.element));
            rows.1.push(match r.location {
                Location::Grid(id) => i64::from(id),
                Location::Centre | Location::Station(_) => 0,
            });
            rows.2.push(i64::from(surface == Surface::Top));
            rows.3.extend(r.local.map(|v| v / MICROSTRAIN));
            rows.4.extend(r.basic.map(|v| v / MICROSTRAIN));
        });
        Ok(rows)
    })?;
    let rows = found.map_err(|f: Faults| raise(py, f))?;
    let out = PyDict::new(py);
    insert_columns(&out, "element", ids(rows.0.into_iter()))?;
    insert_columns(&out, "grid", ids(rows.1.into_iter()))?;
    insert_columns(&out, "top", ids(rows.2.into_iter()))?;
    insert_columns(
        &out,
        "local",
        Columns {
            values: rows.3,
            columns: 3,
        },
    )?;
    insert_columns(
        &out,
        "basic",
        Columns {
            values: rows.4,
            columns: 6,
        },
    )?;
    Ok(out)
}
