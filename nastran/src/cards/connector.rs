//! CWELD, PWELD, CFAST, PFAST, CGAP, PGAP.

use super::Orientation;

/// How a CWELD names the two patches that it joins.
#[derive(Clone, Debug, PartialEq)]
pub enum WeldPatches {
    /// GRIDID: corner grids of each patch, three or four; an empty one is the grid GA or GB itself.
    Grids([Vec<u32>; 2]),
    /// ELEMID: a shell on each side; `None` is the grid GB itself.
    Elements(u32, Option<u32>),
    /// ELPAT: as ELEMID, but tied by auxiliary points that may be on neighbouring shells.
    ElementPatches(u32, u32),
    /// PARTPAT: shell properties.
    Properties(u32, u32),
    /// ALIGN: the grids GA and GB.
    Align,
    /// Another keyword.
    Unknown(String),
}

/// CWELD.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Weld {
    pub id: u32,
    pub pid: Option<u32>,
    /// GS: the point that is projected onto both patches.
    pub gs: Option<u32>,
    pub patches: WeldPatches,
    /// GA, GB: the piercing points.
    pub grids: [Option<u32>; 2],
    /// XS, YS, ZS: instead of GS, basic frame.
    pub xs: Option<[f64; 3]>,
    /// A list of GRIDID contains a mid-side grid.
    pub mid_sides: bool,
}

/// PWELD.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Pweld {
    pub id: u32,
    pub mid: u32,
    pub d: f64,
    /// TYPE is SPOT: the length counts as half the sum of the plates.
    pub spot: bool,
    /// LDMIN, LDMAX: bounds of length over diameter.
    pub ld: [f64; 2],
}

/// CFAST.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Fastener {
    pub id: u32,
    pub pid: Option<u32>,
    /// PROP, ELEM, or another keyword.
    pub kind: String,
    /// IDA, IDB: shell properties or shells.
    pub patches: [u32; 2],
    pub gs: Option<u32>,
    /// GA, GB: the piercing points.
    pub grids: [Option<u32>; 2],
    /// XS, YS, ZS: instead of GS, basic frame.
    pub xs: Option<[f64; 3]>,
}

/// PFAST.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Pfast {
    pub id: u32,
    pub d: f64,
    /// MCID; `None` is blank or -1: the frame of the element.
    pub mcid: Option<u32>,
    /// MFLAG is 1: the axes of MCID as they are.
    pub absolute: bool,
    /// KT1..KT3, KR1..KR3.
    pub k: [f64; 6],
    pub mass: f64,
}

/// CGAP.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Gap {
    pub id: u32,
    pub pid: Option<u32>,
    pub grids: [u32; 2],
    pub orientation: Orientation,
    pub cid: Option<u32>,
}

/// PGAP.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Pgap {
    pub id: u32,
    /// Initial opening.
    pub u0: f64,
    /// Preload.
    pub f0: f64,
    /// Stiffness along the axis, closed.
    pub ka: f64,
    /// Stiffness along the axis, open.
    pub kb: Option<f64>,
    /// Stiffness across the axis, closed.
    pub kt: Option<f64>,
    /// Coefficient of friction; the default of KT is this coefficient times KA.
    pub mu1: f64,
}
