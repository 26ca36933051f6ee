//! An HDF5 result file as an index of blocks.

use super::domain::{Domain, domains};
use super::extent::stated_length;
use super::layout::{Kind, Layout, elemental_layout, nodal};
use super::table::Table;
use super::weight::grid_point_weight;
use super::{H5Error, decode};
use crate::results::{
    Analysis, Block, Damage, GridPointWeight, Note, Quantity, Rows, SalvagedFile, ShellForm,
};
use hdf5_pure::{AttrValue, File};
use std::collections::BTreeMap;

const RESULT: &str = "/NASTRAN/RESULT";

/// An HDF5 result file: `read` builds the index, rows are read block by block.
pub struct H5 {
    file: File,
    /// Blocks: nodal ones first, then strain and stress, each table by domain.
    pub blocks: Vec<Block>,
    /// Notes on skipped content.
    pub notes: Vec<Note>,
    /// The solver's grid point weight, if the file contains it.
    pub grid_point_weight: Option<GridPointWeight>,
    /// Number of the schema, if the file states it.
    pub schema: Option<i64>,
    spans: Vec<Span>,
    damage: Vec<Damage>,
}

/// Records of one block.
#[derive(Clone, Copy, Debug)]
struct Span {
    layout: Layout,
    start: u64,
    count: u64,
}

impl H5 {
    /// Builds the index of a whole HDF5 result file. The bytes are copied once, because the HDF5 layer owns its input.
    ///
    /// # Errors
    /// [`H5Error::Damaged`] for a file that is cut short or whose tables can't all be opened, and every error of [`H5::salvage`].
    pub fn read(bytes: &[u8]) -> Result<Self, H5Error> {
        Self::salvage(bytes)?
            .require_undamaged()
            .map_err(H5Error::Damaged)
    }

    /// Builds the index of the readable part of a file that may be cut or damaged, with the damage.
    ///
    /// # Errors
    /// [`H5Error`] if the container is damaged or contains no Nastran results.
    pub fn salvage(bytes: &[u8]) -> Result<SalvagedFile<Self>, H5Error> {
        let fail = |e: hdf5_pure::Error| H5Error::Container {
            path: "/".to_string(),
            reason: e.to_string(),
        };
        let file = File::from_bytes(bytes.to_vec()).map_err(fail)?;
        let attributes = file.root().attrs().unwrap_or_default();
        let schema = attributes.get("SCHEMA").and_then(|v| match v {
            AttrValue::I64(n) => Some(*n),
            AttrValue::I64Array(n) => n.first().copied(),
            _ => None,
        });
        let mut this = Self {
            file,
            blocks: Vec::new(),
            notes: Vec::new(),
            grid_point_weight: None,
            schema,
            spans: Vec::new(),
            damage: Vec::new(),
        };
        if let Some(stated) = stated_length(bytes).filter(|&n| n > bytes.len() as u64) {
            this.damage.push(Damage {
                at: "superblock".to_owned(),
                what: format!("{stated} bytes stated, the file has {}", bytes.len()),
            });
        }
        if this.file.group(RESULT).is_err() {
            return Err(H5Error::NoResults);
        }
        let domains = domains(&this.table(&format!("{RESULT}/DOMAINS"))?)?;
        this.nodal(&domains)?;
        this.index_elemental_tables(&domains)?;
        let damage = std::mem::take(&mut this.damage);
        Ok(SalvagedFile { file: this, damage })
    }

    fn table(&self, path: &str) -> Result<Table<'_>, H5Error> {
        Table::open(&self.file, path)
    }

    /// Returns the names of the tables and groups in a group, sorted; an empty list if the group does not exist.
    fn children(&self, path: &str) -> Result<(Vec<String>, Vec<String>), H5Error> {
        let Ok(group) = self.file.group(path) else {
            return Ok((Vec::new(), Vec::new()));
        };
        let fail = |e: hdf5_pure::Error| H5Error::Container {
            path: path.to_string(),
            reason: e.to_string(),
        };
        let (mut tables, mut groups) = (
            group.datasets().map_err(fail)?,
            group.groups().map_err(fail)?,
        );
        tables.sort();
        groups.sort();
        Ok((tables, groups))
    }

    fn nodal(&mut self, domains: &BTreeMap<i64, Domain>) -> Result<(), H5Error> {
        let group = format!("{RESULT}/NODAL");
        let (tables, groups) = self.children(&group)?;
        for name in tables {
            let path = format!("{group}/{name}");
            if name == "GRID_WEIGHT" {
                match self.table(&path).and_then(|t| grid_point_weight(&t)) {
                    Ok(weight) => self.grid_point_weight = weight,
                    Err(e) => self.note_unread_table(&path, &e),
                }
                continue;
            }
            self.index(&path, domains, |_| nodal(&name));
        }
        groups
            .iter()
            .for_each(|g| self.note(&format!("{group}/{g}"), "not read".to_string()));
        Ok(())
    }

    fn index_elemental_tables(&mut self, domains: &BTreeMap<i64, Domain>) -> Result<(), H5Error> {
        let root = format!("{RESULT}/ELEMENTAL");
        let (_, groups) = self.children(&root)?;
        for group in groups {
            let path = format!("{root}/{group}");
            let quantity = match group.as_str() {
                "STRAIN" => Quantity::Strain,
                "STRESS" => Quantity::Stress,
                _ => {
                    self.note(&path, "not read: only STRAIN and STRESS are".to_string());
                    continue;
                }
            };
            for name in self.children(&path)?.0 {
                self.index(&format!("{path}/{name}"), domains, |table| {
                    elemental_layout(quantity, &name, table)
                });
            }
        }
        Ok(())
    }

    /// Records a table that cannot be read, as damage or as a note on skipped content.
    fn note_unread_table(&mut self, path: &str, why: &H5Error) {
        if why.is_damage() {
            self.damage.push(Damage {
                at: path.to_string(),
                what: why.to_string(),
            });
        } else {
            self.note(path, why.to_string());
        }
    }

    fn note(&mut self, subject: &str, message: String) {
        self.notes.push(Note {
            subject: subject.to_string(),
            message,
        });
    }

    /// Adds the blocks of a table, one for each run of equal DOMAIN_ID, or a note.
    fn index(
        &mut self,
        path: &str,
        domains: &BTreeMap<i64, Domain>,
        layout: impl FnOnce(&Table<'_>) -> Option<Layout>,
    ) {
        let result = self.table(path).and_then(|table| {
            let Some(layout) = layout(&table) else {
                return Ok(Vec::new());
            };
            // The fields are looked up here so that a missing field becomes a note on the table, not an error when rows are read.
            table.need(layout.id)?;
            layout
                .fields
                .iter()
                .filter(|f| !f.is_empty())
                .try_for_each(|f| table.need(f).map(|_| ()))?;
            let domain = table.need("DOMAIN_ID")?;
            let mut runs: Vec<(i64, Span)> = Vec::new();
            let mut row = 0_u64;
            table.each_record(0, table.rows, |r| {
                let id = domain.integer(r, 0);
                match runs.last_mut() {
                    Some((last, span)) if *last == id => span.count += 1,
                    _ => runs.push((
                        id,
                        Span {
                            layout,
                            start: row,
                            count: 1,
                        },
                    )),
                }
                row += 1;
                Ok(())
            })?;
            let mut blocks = Vec::new();
            for (id, span) in runs {
                let form = form(&table, &span)?;
                blocks.push((id, span, form));
            }
            Ok(blocks)
        });
        let blocks = match result {
            Ok(blocks) if blocks.is_empty() => {
                return self.note(
                    path,
                    "not read: no layout is known, or no records".to_string(),
                );
            }
            Ok(blocks) => blocks,
            Err(e) => return self.note_unread_table(path, &e),
        };
        for (id, span, form) in blocks {
            let Some(d) = domains.get(&id) else {
                self.damage.push(Damage {
                    at: path.to_string(),
                    what: format!(
                        "{} records have DOMAIN_ID {id}, which DOMAINS does not list",
                        span.count
                    ),
                });
                continue;
            };
            let modal =
                span.layout.quantity == Quantity::Displacement && d.analysis == Analysis::Modes;
            self.blocks.push(Block {
                table: path.to_string(),
                quantity: if modal {
                    Quantity::Eigenvector
                } else {
                    span.layout.quantity
                },
                analysis: d.analysis,
                subcase: d.subcase,
                mode: d.mode,
                step: d.step,
                element: span.layout.element,
                form,
                von_mises: true,
                complex: false,
                sort2: false,
                num_wide: 0,
                entries: usize::try_from(span.count).unwrap_or(usize::MAX),
                titles: Default::default(),
            });
            self.spans.push(span);
        }
    }

    /// Returns the rows of block `index`.
    ///
    /// # Errors
    /// [`H5Error`]: no such block, or damage found while reading.
    pub fn rows(&self, index: usize) -> Result<Rows, H5Error> {
        let (Some(block), Some(span)) = (self.blocks.get(index), self.spans.get(index)) else {
            return Err(H5Error::NoSuchBlock {
                index,
                blocks: self.blocks.len(),
            });
        };
        decode::rows(
            &self.table(&block.table)?,
            &span.layout,
            span.start,
            span.count,
        )
    }
}

/// Returns the form of a shell block. Curvature form shows by its fibre column, 0 and -1; stress is always at fibres.
fn form(table: &Table<'_>, span: &Span) -> Result<Option<ShellForm>, H5Error> {
    if !matches!(span.layout.kind, Kind::ShellCentre | Kind::ShellCorner) {
        return Ok(None);
    }
    let rows = decode::rows(table, &span.layout, span.start, 1)?;
    let curvature = rows.row(0).first() == Some(&0.0) && rows.row(1).first() == Some(&-1.0);
    let curvature = curvature && span.layout.quantity == Quantity::Strain;
    Ok(Some(if curvature {
        ShellForm::Curvature
    } else {
        ShellForm::Fiber
    }))
}

impl std::fmt::Debug for H5 {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("H5")
            .field("schema", &self.schema)
            .field("blocks", &self.blocks.len())
            .finish_non_exhaustive()
    }
}
