//! Element properties.

/// PSHELL.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pshell {
    /// Property id.
    pub id: u32,
    /// Membrane material.
    pub mid1: Option<u32>,
    /// Default thickness.
    pub t: Option<f64>,
    /// Bending material; blank: no bending. -1: plane strain.
    pub mid2: Option<i32>,
    /// 12 I / T^3, default 1.
    pub bending_ratio: Option<f64>,
    /// Transverse shear material.
    pub mid3: Option<u32>,
    /// Ts / T, default 5/6.
    pub shear_ratio: Option<f64>,
    /// Non-structural mass per area.
    pub nsm: Option<f64>,
    /// Fibre distance Z1, default -t/2: the bottom surface.
    pub z1: Option<f64>,
    /// Fibre distance Z2, default +t/2: the top surface.
    pub z2: Option<f64>,
    /// Membrane-bending coupling material.
    pub mid4: Option<u32>,
}

/// PCOMP or PCOMPG.
#[derive(Clone, Debug, PartialEq)]
pub struct Pcomp {
    /// Property id.
    pub id: u32,
    /// Distance from the reference plane to the bottom surface, default half the total thickness, negative.
    pub z0: Option<f64>,
    /// Non-structural mass per area.
    pub nsm: f64,
    /// Allowable interlaminar shear.
    pub sb: Option<f64>,
    /// Reference temperature.
    pub tref: Option<f64>,
    /// Damping.
    pub ge: f64,
    /// Symmetric laminate: the plies are the lower half (LAM is SYM, SYMEM, SYBEND or SYSMEAR).
    pub symmetric: bool,
    /// LAM as written (`MEM`, `BEND`, `SMEAR` ..); empty where blank.
    pub lam: String,
    /// Plies from the bottom up, as listed.
    pub plies: Vec<Ply>,
}

/// A ply. A blank material or thickness is already replaced by the value of the ply before.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Ply {
    pub mid: u32,
    pub t: f64,
    /// Degrees from the material axis.
    pub theta_deg: f64,
    pub output: bool,
}

/// PSHEAR.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Pshear {
    pub id: u32,
    pub mid: u32,
    pub t: f64,
    pub nsm: f64,
    pub f1: f64,
    pub f2: f64,
}

/// PBAR.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Pbar {
    pub id: u32,
    pub mid: u32,
    pub area: f64,
    pub i1: f64,
    pub i2: f64,
    pub j: f64,
    pub nsm: f64,
    /// Stress recovery points C D E F: (y, z) in the element frame.
    pub recovery: [[f64; 2]; 4],
    /// Shear area factors K1, K2.
    pub k: [Option<f64>; 2],
    pub i12: f64,
}

/// PBARL: a bar by cross-section.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Pbarl {
    pub id: u32,
    pub mid: u32,
    /// TYPE, upper case: `ROD`, `TUBE`, `BAR`, `BOX`, `I`, `CHAN` ..
    pub section: String,
    pub dims: Vec<f64>,
    pub nsm: f64,
}

/// PBEAM.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Pbeam {
    pub id: u32,
    pub mid: u32,
    /// End A first, then as listed. The last station has x/xb = 1 (end B); if the card lacks it, a copy of end A is added.
    pub stations: Vec<BeamStation>,
    /// Shear stiffness factors K1, K2.
    pub k: [Option<f64>; 2],
    /// Shear relief S1, S2.
    pub s: [f64; 2],
    /// Non-structural mass moment of inertia per length at A, B.
    pub nsi: [Option<f64>; 2],
    /// Warping coefficients at A, B.
    pub cw: [Option<f64>; 2],
    /// Centre of non-structural mass, (y, z) at A and B.
    pub m: [[Option<f64>; 2]; 2],
    /// Neutral axis, (y, z) at A and B.
    pub n: [[Option<f64>; 2]; 2],
}

/// A section of a PBEAM.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct BeamStation {
    /// Share of the length from end A.
    pub x_xb: f64,
    /// SO: stress is output at this station.
    pub output: bool,
    pub area: f64,
    pub i1: f64,
    pub i2: f64,
    pub i12: f64,
    pub j: f64,
    pub nsm: f64,
    /// Stress recovery points C D E F: (y, z).
    pub recovery: [[f64; 2]; 4],
}

/// PBEAML.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Pbeaml {
    pub id: u32,
    pub mid: u32,
    pub section: String,
    /// End A first.
    pub stations: Vec<BeamlStation>,
}

/// A section of a PBEAML.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct BeamlStation {
    pub x_xb: f64,
    pub output: bool,
    pub dims: Vec<f64>,
    pub nsm: f64,
}

/// PROD.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Prod {
    pub id: u32,
    pub mid: u32,
    pub area: f64,
    pub j: f64,
    pub c: f64,
    pub nsm: f64,
}

/// PTUBE.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Ptube {
    pub id: u32,
    pub mid: u32,
    pub od: f64,
    pub t: Option<f64>,
    pub nsm: f64,
    pub od2: Option<f64>,
}

/// PBUSH.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Pbush {
    pub id: u32,
    /// K1..K6; a blank is 0 (free).
    pub k: [f64; 6],
    /// True where the card writes RIGID for a component.
    pub rigid: [bool; 6],
    pub b: [f64; 6],
    pub ge: [f64; 6],
    /// Stress and strain recovery coefficients SA, ST, EA, ET.
    pub recovery: [f64; 4],
    pub mass: f64,
}

/// PELAS, one property (a card may hold two).
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Pelas {
    pub id: u32,
    pub k: f64,
    pub ge: f64,
    pub s: f64,
}

/// PSOLID.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Psolid {
    pub id: u32,
    pub mid: u32,
    /// CORDM: material coordinate system, -1 element.
    pub cordm: Option<i32>,
    /// IN, STRESS, ISOP, FCTN as written, upper case.
    pub options: [Option<String>; 4],
}
