//! OP2 files: result tables, geometry blocks and grid point weight, of MSC, NX/Simcenter, OptiStruct, Autodesk and MYSTRAN.
//!
//! [`Op2::read`] makes one fast pass over the records and decodes no rows. [`Op2::rows`] decodes one block at a time, so a caller can decode many
//! blocks in parallel.
//!
//! - `words`: words of 4 or 8 bytes in either byte order, text in both 64-bit forms.
//! - `fortran`: the length marks around every record. `container`: tables, trailers, records.
//! - `ident`: identification records. `index`: result blocks. `rows`: layouts of the rows and their decoding.
//! - `weight`: grid point weight. `geom`: cards of the geometry blocks.
//!
//! [`Op2Writer`] writes result tables, one block at a time.
//!
//! # Reference
//!
//! MSC Nastran DMAP programmer's guide, data blocks OUG, OQG, OPG, OES, OEF, OGPFB, OGPWG and module OUTPUT2; NX Nastran DMAP manual, the same
//! blocks. If a manual and the files of a solver differ, the reader follows the files.

mod container;
mod error;
mod file;
mod fortran;
mod geom;
mod ident;
mod index;
mod rows;
mod weight;
mod words;
mod write;

pub use container::{TableEntry, TableKind};
pub use error::{Op2Error, UnsupportedRows};
pub use file::{Op2, Solver};
pub use words::ByteOrder;
pub use write::{EncodedBlock, Op2Writer, WriteError, write_blocks};
