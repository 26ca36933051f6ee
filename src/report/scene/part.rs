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
    /// Grids of the faces.
    pub grids: Vec<GridIx>,
    /// Faces: owner, and indices into `grids`. Triangles repeat the third index.
    pub faces: Vec<(Owner, [u32; 4])>,
    /// Drawn geometry of these faces.
    pub drawn: PartMesh,
}

impl Part {
    /// Returns the number of triangles of the faces.
    pub(super) fn n_triangles(&self) -> usize {
        let quads = self.faces.iter().filter(|f| f.1[2] != f.1[3]).count();
        self.faces.len() + quads
    }
}

/// Drawn geometry of a part: its own faces, or a coarser version of them.
#[derive(Clone, Debug, Default)]
pub(super) struct PartMesh {
    /// Vertex of each grid of the part.
    pub vertex_of: Vec<u32>,
    /// Grid of the part that each vertex represents.
    pub vertices: Vec<u32>,
    /// Corners of the triangles, as indices into `vertices`.
    pub triangles: Vec<[u32; 3]>,
    /// Whether every face of the part is drawn unchanged.
    pub whole: bool,
}
