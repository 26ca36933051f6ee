//! `[model]`.

use super::named_file::NamedFile;
use crate::fe::SupportChoice;

/// `[model]`.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelFiles {
    /// The deck, or an OP2 with the mesh.
    pub deck: NamedFile,
    /// Result files; empty: the built-in solver computes them.
    pub results: Vec<NamedFile>,
    /// Support of the structure.
    pub support: SupportChoice,
    /// Line of `support`, or of the section.
    pub support_line: u32,
    /// Whether the mesh error is subtracted from the strain of the built-in solver, with the remaining error in the covariance. `None` means: for
    /// small decks only.
    pub mesh_error: Option<bool>,
}
