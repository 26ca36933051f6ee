//! Decoded rows of one block.

/// Entity of a row, and the location on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct RowId {
    /// Grid or element id (device code removed).
    pub entity: u32,
    /// Shells and solids: corner grid, 0 the centre. Beams: station grid (0 between the ends). Nodal rows: grid type.
    /// Plies: 0. Bars with stations: station number from 1. Grid point forces: the element (0 for totals).
    pub at: u32,
    /// Shells: 1 the first row (Z1 or mid-plane), 2 the second. Plies: ply number. Solids to be written: the coordinate system of the
    /// centre's row. Otherwise 0.
    pub layer: u32,
}

/// A label of a row, up to eight characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub struct Label([u8; 8]);

impl Label {
    /// Builds the label from text. Characters beyond eight bytes and characters that are not ASCII are omitted.
    pub fn new(text: &str) -> Self {
        let mut word = [b' '; 8];
        word.iter_mut()
            .zip(text.bytes().filter(u8::is_ascii))
            .for_each(|(w, c)| *w = c);
        Label(word)
    }

    /// Returns the text, trimmed.
    pub fn as_str(&self) -> &str {
        std::str::from_utf8(&self.0).unwrap_or("").trim_end()
    }
}

/// Rows of one block: `values` is row-major, `ids.len()` rows by `columns.len()`.
///
/// Columns by quantity:
/// - nodal vectors: `t1 t2 t3 r1 r2 r3`.
/// - shell strain: `fiber exx eyy gxy angle emax emin vm` (vm: von Mises or maximum shear; gxy is engineering shear).
///   Shell stress: `fiber oxx oyy txy angle omax omin vm`.
/// - bars: `s1a s2a s3a s4a axial smaxa smina mst s1b s2b s3b s4b smaxb sminb msc` (s1..s4 at recovery points C D E F).
///   With stations: `x_xb s1 s2 s3 s4 axial smax smin ms`.
/// - beams, one row for each station: `x_xb sxc sxd sxe sxf smax smin mst msc`.
/// - rods: `axial msa torsion mst`. Springs: `value`. Bushes: `t1 t2 t3 r1 r2 r3`. Shear panels: `max average margin`.
/// - plies: `s11 s22 s12 s1z s2z angle smax smin vm` in ply axes (shear strains are engineering shear).
/// - fasteners (CFAST): `t1 t2 t3 r1 r2 r3`. Grid point forces: `t1 t2 t3 r1 r2 r3`, with [`Rows::labels`].
/// - shell forces: `fx fy fxy mx my mxy qx qy` per length. Bar forces: `m1a m2a m1b m2b shear1 shear2 axial torque`.
///   With stations: `x_xb m1 m2 shear1 shear2 axial torque`.
///   Beam forces: `x_xb m1 m2 shear1 shear2 axial torque warping_torque`. Rod forces: `axial torque`.
/// - solids, one row for each location: `xx yy zz xy yz zx max mid min vm` (shear strain is engineering shear).
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Rows {
    /// Column names.
    pub columns: &'static [&'static str],
    /// Row ids in file order.
    pub ids: Vec<RowId>,
    /// Row-major values.
    pub values: Vec<f64>,
    /// Grid point forces: the source of each row (an element name, `APP-LOAD`, `F-OF-SPC`, `*TOTALS*`); otherwise empty.
    pub labels: Vec<Label>,
}

impl Rows {
    /// Returns the values of row `i`.
    pub fn row(&self, i: usize) -> &[f64] {
        let w = self.columns.len();
        self.values.get(i * w..(i + 1) * w).unwrap_or(&[])
    }

    /// Returns the number of rows.
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// Returns whether the block has no rows.
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }
}

/// Grid point weight of a solver (table OGPWG).
#[derive(Clone, Debug, PartialEq)]
pub struct GridPointWeight {
    /// Reference grid of PARAM,GRDPNT; 0 the origin.
    pub reference: u32,
    /// Rigid-body mass matrix about the reference point, 6 x 6 by rows.
    pub mo: [[f64; 6]; 6],
    /// S: axes of the principal mass frame.
    pub s: [[f64; 3]; 3],
    /// Mass in the three directions.
    pub mass: [f64; 3],
    /// Centre of gravity for the mass in each direction, from the reference point.
    pub cg: [[f64; 3]; 3],
    /// Inertia about the centre of gravity.
    pub inertia_cg: [[f64; 3]; 3],
}

/// Note on skipped content, with its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Table or record of the note.
    pub subject: String,
    /// Description of the content, and whether it was skipped or kept.
    pub message: String,
}
