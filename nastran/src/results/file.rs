//! One interface to every kind of result file.

use super::{Block, GridPointWeight, Note, Rows, SalvagedFile};
use crate::cards::Cards;
use crate::h5::{H5, H5Error, is_h5};
use crate::op2::{Op2, Op2Error, Solver};
use crate::punch::{Punch, PunchError};

/// Result file of any kind: OP2, punch or HDF5. The bytes determine the kind, and all kinds give the same blocks and rows.
///
/// # Example
/// ```
/// use nastran::op2::Op2Writer;
/// use nastran::results::{Quantity, ResultsFile, RowId, Rows, columns};
///
/// # use nastran::results::{Analysis, Block};
/// # let block = Block { table: String::new(), quantity: Quantity::Displacement, analysis: Analysis::Statics, subcase: 7, mode: 0, step: 0.0,
/// #     element: None, form: None, von_mises: false, complex: false, sort2: false, num_wide: 0, entries: 0, titles: Default::default() };
/// let rows = Rows {
///     columns: columns::NODAL,
///     ids: vec![RowId { entity: 12, at: 1, layer: 0 }],
///     values: vec![1.5, 0.0, -0.25, 0.0, 0.125, 0.0], // exact in 32 bits
///     labels: Vec::new(),
/// };
/// let mut writer = Op2Writer::new(Vec::new(), [11, 27, 2026])?;
/// writer.write_block(&block, &rows)?; // `block`: displacements of subcase 7
/// let bytes = writer.finish()?;
///
/// let file = ResultsFile::read(&bytes, "run.op2")?;
/// assert_eq!((file.blocks()[0].quantity, file.blocks()[0].subcase), (Quantity::Displacement, 7));
/// assert_eq!(file.rows(0)?, rows);
/// // A file that is cut short is refused.
/// let cut = ResultsFile::read(&bytes[..bytes.len() - 40], "run.op2");
/// assert!(cut.is_err_and(|e| e.is_damage()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub enum ResultsFile<'a> {
    /// OP2.
    Op2(Box<Op2<'a>>),
    /// Punch.
    Punch(Punch<'a>),
    /// HDF5.
    H5(Box<H5>),
}

/// Why a result file, or a block of one, could not be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ResultsError {
    /// The file does not begin like a known kind of result file.
    #[error(
        "`{name}` is neither an OP2 nor a punch nor an HDF5 file: give a file with result output (PARAM,POST,-1 or (PUNCH) or MDLPRM,HDF5)"
    )]
    UnknownKind {
        /// The file's name, as the caller gave it.
        name: String,
    },
    /// OP2.
    #[error(transparent)]
    Op2(#[from] Op2Error),
    /// Punch.
    #[error(transparent)]
    Punch(#[from] PunchError),
    /// HDF5.
    #[error(transparent)]
    H5(#[from] H5Error),
}

impl ResultsError {
    /// Returns whether the file is cut or damaged, and is not only of a kind that is not read.
    pub fn is_damage(&self) -> bool {
        match self {
            Self::UnknownKind { .. } => false,
            Self::Op2(e) => e.is_damage(),
            Self::Punch(e) => e.is_damage(),
            Self::H5(e) => e.is_damage(),
        }
    }
}

impl<'a> ResultsFile<'a> {
    /// Reads the index of a whole result file; `name` affects errors only: a name that ends in `.op2` gives the error of the OP2 reader.
    ///
    /// # Errors
    /// [`ResultsError`]: a file that is cut or damaged ([`ResultsError::is_damage`]), and every error of [`ResultsFile::salvage`].
    pub fn read(bytes: &'a [u8], name: &str) -> Result<Self, ResultsError> {
        let SalvagedFile { file, damage } = Self::salvage(bytes, name)?;
        let Some(first) = damage.into_iter().next() else {
            return Ok(file);
        };
        Err(match file {
            Self::Op2(_) => Op2Error::Damaged(first).into(),
            Self::Punch(_) => PunchError::Damaged(first).into(),
            Self::H5(_) => H5Error::Damaged(first).into(),
        })
    }

    /// Indexes the readable part of a result file that may be cut or damaged, with the damage. Use it to describe the file, never to compute with it.
    ///
    /// # Errors
    /// [`ResultsError`]: an unknown kind of file, or a file without any readable part.
    pub fn salvage(bytes: &'a [u8], name: &str) -> Result<SalvagedFile<Self>, ResultsError> {
        if is_h5(bytes) {
            return Ok(H5::salvage(bytes)?.map(|f| Self::H5(Box::new(f))));
        }
        if looks_like_punch(bytes) {
            return Ok(Punch::salvage(bytes)?.map(Self::Punch));
        }
        match Op2::salvage(bytes) {
            Ok(op2) => Ok(op2.map(|f| Self::Op2(Box::new(f)))),
            Err(Op2Error::NotOp2 { .. }) if !name.to_ascii_lowercase().ends_with(".op2") => {
                Err(ResultsError::UnknownKind {
                    name: name.to_string(),
                })
            }
            Err(e) => Err(e.into()),
        }
    }

    /// Returns the solver, with its version if the file states it. Other programs write OP2 files in the form of MSC Nastran without a version.
    pub fn solver(&self) -> String {
        match self {
            Self::Op2(op2) => {
                let name = match op2.solver {
                    Solver::Msc => "MSC Nastran",
                    Solver::Nx => "NX/Simcenter Nastran",
                    Solver::Optistruct => "OptiStruct",
                    Solver::Autodesk => "Autodesk Nastran",
                    Solver::Mystran => "MYSTRAN",
                    Solver::Unknown => "unknown solver",
                };
                match op2.version_label.as_deref() {
                    Some(label) if !label.is_empty() && !label.starts_with("XXXX") => {
                        format!("{name} ({label})")
                    }
                    _ if op2.solver == Solver::Msc => {
                        format!("{name}, or a program that writes its form")
                    }
                    _ => name.to_string(),
                }
            }
            Self::Punch(_) => "punch file (solver not stated)".to_string(),
            Self::H5(h5) => match h5.schema {
                Some(schema) => format!("MSC Nastran (HDF5 schema {schema})"),
                None => "MSC Nastran (HDF5)".to_string(),
            },
        }
    }

    /// Returns the bytes of a number: 4 or 8 for OP2, 8 for HDF5, 0 for the text of a punch file.
    pub fn word_bytes(&self) -> usize {
        match self {
            Self::Op2(op2) => op2.word_bytes,
            Self::Punch(_) => 0,
            Self::H5(_) => 8,
        }
    }

    /// Returns the relative rounding of the numbers in the file: single or double precision, or the seven digits of a punch file.
    pub fn precision(&self) -> f64 {
        match self {
            Self::Op2(op2) if op2.word_bytes == 4 => f64::from(f32::EPSILON) / 2.0,
            Self::Punch(_) => 5e-7,
            Self::Op2(_) | Self::H5(_) => f64::EPSILON / 2.0,
        }
    }

    /// Returns the index of results, in file order.
    pub fn blocks(&self) -> &[Block] {
        match self {
            Self::Op2(op2) => &op2.blocks,
            Self::Punch(punch) => &punch.blocks,
            Self::H5(h5) => &h5.blocks,
        }
    }

    /// Returns the rows of block `index`.
    ///
    /// # Errors
    /// Errors of the reader: the block does not exist, is not decoded, or is damaged.
    pub fn rows(&self, index: usize) -> Result<Rows, ResultsError> {
        Ok(match self {
            Self::Op2(op2) => op2.rows(index)?,
            Self::Punch(punch) => punch.rows(index)?,
            Self::H5(h5) => h5.rows(index)?,
        })
    }

    /// Returns the notes on skipped content.
    pub fn notes(&self) -> &[Note] {
        match self {
            Self::Op2(op2) => &op2.notes,
            Self::Punch(punch) => &punch.notes,
            Self::H5(h5) => &h5.notes,
        }
    }

    /// Returns the cards of the geometry blocks with notes on skipped content; `None` if the file contains no grids.
    pub fn cards(&self) -> Option<(Cards, Vec<Note>)> {
        match self {
            Self::Op2(op2) => Some(op2.cards()).filter(|(cards, _)| !cards.grids.is_empty()),
            Self::Punch(_) | Self::H5(_) => None,
        }
    }

    /// Returns the solver's grid point weight, if the file contains it.
    pub fn grid_point_weight(&self) -> Option<GridPointWeight> {
        match self {
            Self::Op2(op2) => op2.grid_point_weight(),
            Self::Punch(_) => None,
            Self::H5(h5) => h5.grid_point_weight.clone(),
        }
    }
}

/// Returns whether the first non-blank line of the text is a `$` line (punch files begin with `$TITLE`).
fn looks_like_punch(bytes: &[u8]) -> bool {
    let start = bytes.get(..bytes.len().min(400)).unwrap_or(&[]);
    let text = start
        .iter()
        .position(|b| !b.is_ascii_whitespace())
        .and_then(|i| start.get(i..))
        .unwrap_or(&[]);
    text.starts_with(b"$")
        && text
            .iter()
            .all(|&b| b == b'\t' || b == b'\r' || b == b'\n' || b >= b' ')
}
