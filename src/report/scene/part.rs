//! Faces of one property, and their drawn geometry.

use crate::model::GridIx;

/// The element that a face belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Owner {
    /// Index into `shells`.
    Shell(usize),
    /// Index into `solids`.
    Solid(usize),
    /// No strain.
    Panel,
}

/// Faces of one property.
#[derive(Clone, Debug, Default)]
pub(super) struct Part {
    /// Name of the part.
    pub name: String,
    /// Grids of its faces.
    pub grids: Vec<GridIx>,
    /// Faces: owner, indices into `grids`; triangles repeat the third.
    pub faces: Vec<(Owner, [u32; 4])>,
    /// Drawn geometry of these faces.
    pub drawn: PartMesh,
}

impl Part {
    /// Triangles of its faces.
    pub(super) fn n_triangles(&self) -> usize {
        let quads = self.faces.iter().filter(|f| f.1[2] != f.1[3]).count();
        self.faces.len() + quads
    }
}

/// Drawn geometry of a part: its own faces, or a coarser version of them.
#[derive(Clone, Debug, Default)]
pub(super) struct PartMesh {
    /// By grid of the part: its vertex.
    pub vertex_of: Vec<u32>,
    /// By vertex: the grid of the part that it represents.
    pub vertices: Vec<u32>,
    /// Corners, indices into `vertices`.
    pub triangles: Vec<[u32; 3]>,
    /// Whether every face of the part is drawn as it is.
    pub whole: bool,
}
