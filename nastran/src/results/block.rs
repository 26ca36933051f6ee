//! Header of a result block, before any row is decoded.

use super::ElementType;

/// The quantity of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[allow(missing_docs)]
pub enum Quantity {
    Displacement,
    Velocity,
    Acceleration,
    Eigenvector,
    SpcForce,
    MpcForce,
    AppliedLoad,
    GridPointForce,
    ElementForce,
    Stress,
    Strain,
    /// Ply by ply, in ply axes.
    PlyStress,
    PlyStrain,
    /// Another quantity; the table is reported in a note and is not decoded.
    Other,
}

impl Quantity {
    /// Returns the name used in reports and in `result.json`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Eigenvector => "eigenvector",
            Self::SpcForce => "spc_force",
            Self::MpcForce => "mpc_force",
            Self::AppliedLoad => "applied_load",
            Self::GridPointForce => "grid_point_force",
            Self::ElementForce => "element_force",
            Self::Stress => "stress",
            Self::Strain => "strain",
            Self::PlyStress => "ply_stress",
            Self::PlyStrain => "ply_strain",
            Self::Other => "other",
        }
    }
}

/// Kind of analysis, by the approach code of the identification record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[allow(missing_docs)]
pub enum Analysis {
    Statics,
    Modes,
    Frequency,
    Transient,
    PreBuckling,
    PostBuckling,
    ComplexEigen,
    NonlinearStatics,
    Other(i32),
}

impl Analysis {
    /// Returns the kind of analysis from the approach code.
    pub fn from_code(code: i32) -> Self {
        match code {
            1 => Self::Statics,
            2..=4 => Self::Modes,
            5 => Self::Frequency,
            6 => Self::Transient,
            7 => Self::PreBuckling,
            8 => Self::PostBuckling,
            9 => Self::ComplexEigen,
            10 => Self::NonlinearStatics,
            other => Self::Other(other),
        }
    }

    /// Returns the name used in reports and in `result.json`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Statics => "statics",
            Self::Modes => "modes",
            Self::Frequency => "frequency",
            Self::Transient => "transient",
            Self::PreBuckling => "pre_buckling",
            Self::PostBuckling => "post_buckling",
            Self::ComplexEigen => "complex_eigenvalues",
            Self::NonlinearStatics => "nonlinear_statics",
            Self::Other(_) => "other",
        }
    }
}

/// Form in which shell strain or stress is output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ShellForm {
    /// Two rows at the fibre distances Z1 and Z2.
    Fiber,
    /// Row 1 the mid-plane strain, row 2 MINUS its derivative along z: strain(z) = row1 - z row2.
    Curvature,
}

/// A block of rows: one quantity, one subcase, one step, one element type.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Table name as in the file (`OUGV1`, `OSTR1X`); an HDF5 path. Vectors of tables `BOUGV1` and `BOUG1` are in the basic frame
    /// ([`Block::is_in_basic`]), others in the displacement frames of the grids.
    pub table: String,
    /// Quantity of the block. The stress code, not the table name, distinguishes strain and stress.
    pub quantity: Quantity,
    /// Kind of analysis.
    pub analysis: Analysis,
    /// Subcase id.
    pub subcase: u32,
    /// Mode number, load step or 0.
    pub mode: i32,
    /// Time, frequency, eigenvalue or load factor of the step; 0 in statics.
    pub step: f64,
    /// Element type of element results.
    pub element: Option<ElementType>,
    /// Form of shell strain and stress.
    pub form: Option<ShellForm>,
    /// The stress code's von Mises bit (else maximum shear).
    pub von_mises: bool,
    /// Whether the numbers are complex (rows are then not decoded).
    pub complex: bool,
    /// SORT2 tables run over steps for one entity. Rows are decoded in statics only, which has one step; a SORT1 block often contains the same rows.
    pub sort2: bool,
    /// Number of words in a row of the file; 0 if the file kind has no words.
    pub num_wide: u32,
    /// Number of file entries (elements, grids, or stations), as far as the sizes show it.
    pub entries: usize,
    /// TITLE, SUBTITLE, LABEL, trimmed.
    pub titles: [String; 3],
}

impl Block {
    /// Returns whether nodal vectors are in the basic frame instead of the grids' displacement frames (CD).
    pub fn is_in_basic(&self) -> bool {
        self.table.starts_with("BOUG")
    }
}
