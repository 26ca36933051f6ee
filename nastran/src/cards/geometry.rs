//! GRID, GRDSET and coordinate systems.

/// GRID.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Grid id.
    pub id: u32,
    /// Coordinate system of `x`; `None` where blank (GRDSET or 0), `Some(0)` where stated.
    pub cp: Option<u32>,
    /// Location in `cp`: x y z, r theta(deg) z, or r theta(deg) phi(deg).
    pub x: [f64; 3],
    /// Displacement coordinate system; may be -1 (fluid grid).
    pub cd: Option<i32>,
    /// Permanent single-point constraints.
    pub ps: Option<Dofs>,
    /// Superelement.
    pub seid: Option<u32>,
}

/// GRDSET: defaults for the blank fields of GRID.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[allow(missing_docs)]
pub struct Grdset {
    pub cp: Option<u32>,
    pub cd: Option<i32>,
    pub ps: Option<Dofs>,
    pub seid: Option<u32>,
}

/// A set of degrees of freedom 1 to 6, a bit each (bit 0 is dof 1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Hash)]
pub struct Dofs(pub u8);

impl Dofs {
    /// All six.
    pub const ALL: Dofs = Dofs(0b11_1111);

    /// Reads the set from digits such as 123456; `None` if a digit is not 1 to 6. 0 is the empty set (scalar points).
    pub fn from_digits(mut digits: u32) -> Option<Dofs> {
        let mut bits = 0_u8;
        while digits > 0 {
            match digits % 10 {
                d @ 1..=6 => bits |= 1 << (d - 1),
                0 if digits == 0 => {}
                _ => return None,
            }
            digits /= 10;
        }
        Some(Dofs(bits))
    }

    /// Returns whether dof `d` (1 to 6) is in the set.
    pub fn has(self, d: u8) -> bool {
        (1..=6).contains(&d) && self.0 >> (d - 1) & 1 == 1
    }

    /// Returns the dofs, 0-based and ascending.
    pub fn iter0(self) -> impl Iterator<Item = usize> {
        (0..6).filter(move |i| self.0 >> i & 1 == 1)
    }

    /// Returns the number of dofs in the set.
    pub fn len(self) -> usize {
        self.0.count_ones() as usize
    }

    /// Returns whether the set is empty.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }
}

impl std::fmt::Display for Dofs {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.is_empty() {
            return f.write_str("0");
        }
        self.iter0().try_for_each(|i| write!(f, "{}", i + 1))
    }
}

/// Rectangular, cylindrical (theta in degrees) or spherical (theta, phi in degrees).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum CoordKind {
    Rectangular,
    Cylindrical,
    Spherical,
}

/// CORD1R, CORD1C, CORD1S, CORD2R, CORD2C, CORD2S.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coord {
    /// Coordinate system id.
    pub id: u32,
    /// Kind of the coordinates.
    pub kind: CoordKind,
    /// Definition by grids or points.
    pub definition: CoordDefinition,
}

/// Origin A, a point B on the z axis, a point C in the x-z plane.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub enum CoordDefinition {
    /// CORD1x: three grids.
    Grids([u32; 3]),
    /// CORD2x: three points in system `rid`.
    Points {
        rid: u32,
        a: [f64; 3],
        b: [f64; 3],
        c: [f64; 3],
    },
}
