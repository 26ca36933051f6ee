//! One plain struct per card, as the file states it: ids are numbers, a blank field is `None`, nothing is resolved.

mod connector;
mod constraint;
mod geometry;
mod line;
mod load;
mod mass;
mod material;
mod param;
mod property;
mod rigid;
mod shell;
mod solid;

pub use connector::*;
pub use constraint::*;
pub use geometry::*;
pub use line::*;
pub use load::*;
pub use mass::*;
pub use material::*;
pub use param::*;
pub use property::*;
pub use rigid::*;
pub use shell::*;
pub use solid::*;

use crate::place::PlacedCard;

/// Every typed card of a deck or of the geometry blocks of an OP2, each list in file order.
#[derive(Clone, Debug, Default, PartialEq)]
#[allow(missing_docs)] // the names are the card names
pub struct Cards {
    pub grids: Vec<PlacedCard<Grid>>,
    pub grdset: Option<PlacedCard<Grdset>>,
    pub spoints: Vec<PlacedCard<IdList>>,
    /// Ends of CMASSi and CDAMPi without a component, which are scalar points where no grid has their id.
    pub connected_points: Vec<PlacedCard<u32>>,
    pub coords: Vec<PlacedCard<Coord>>,
    pub shells: Vec<PlacedCard<Shell>>,
    pub shear_panels: Vec<PlacedCard<ShearPanel>>,
    pub snorms: Vec<PlacedCard<Snorm>>,
    pub bars: Vec<PlacedCard<Bar>>,
    pub baror: Option<PlacedCard<BarDefaults>>,
    pub beams: Vec<PlacedCard<Beam>>,
    pub beamor: Option<PlacedCard<BarDefaults>>,
    pub rods: Vec<PlacedCard<Rod>>,
    pub conrods: Vec<PlacedCard<Conrod>>,
    pub bushes: Vec<PlacedCard<Bush>>,
    pub springs: Vec<PlacedCard<Spring>>,
    pub welds: Vec<PlacedCard<Weld>>,
    pub fasteners: Vec<PlacedCard<Fastener>>,
    pub gaps: Vec<PlacedCard<Gap>>,
    pub solids: Vec<PlacedCard<Solid>>,
    pub conm1s: Vec<PlacedCard<Conm1>>,
    pub conm2s: Vec<PlacedCard<Conm2>>,
    pub scalar_masses: Vec<PlacedCard<ScalarMass>>,
    pub pmasses: Vec<PlacedCard<Pmass>>,
    pub nsms: Vec<PlacedCard<NonstructuralMass>>,
    pub nsmadds: Vec<PlacedCard<SetSum>>,
    pub rbe1s: Vec<PlacedCard<Rbe1>>,
    pub rbe2s: Vec<PlacedCard<Rbe2>>,
    pub rbe3s: Vec<PlacedCard<Rbe3>>,
    pub rbars: Vec<PlacedCard<Rbar>>,
    pub rsplines: Vec<PlacedCard<Rspline>>,
    pub mpcs: Vec<PlacedCard<Mpc>>,
    pub mpcadds: Vec<PlacedCard<SetSum>>,
    pub spcs: Vec<PlacedCard<Spc>>,
    pub spcds: Vec<PlacedCard<Spc>>,
    pub spc1s: Vec<PlacedCard<Spc1>>,
    pub spcadds: Vec<PlacedCard<SetSum>>,
    pub suports: Vec<PlacedCard<Suport>>,
    pub pshells: Vec<PlacedCard<Pshell>>,
    pub pcomps: Vec<PlacedCard<Pcomp>>,
    pub pshears: Vec<PlacedCard<Pshear>>,
    pub pbars: Vec<PlacedCard<Pbar>>,
    pub pbarls: Vec<PlacedCard<Pbarl>>,
    pub pbeams: Vec<PlacedCard<Pbeam>>,
    pub pbeamls: Vec<PlacedCard<Pbeaml>>,
    pub prods: Vec<PlacedCard<Prod>>,
    pub ptubes: Vec<PlacedCard<Ptube>>,
    pub pbushes: Vec<PlacedCard<Pbush>>,
    pub pelas: Vec<PlacedCard<Pelas>>,
    pub pwelds: Vec<PlacedCard<Pweld>>,
    pub pfasts: Vec<PlacedCard<Pfast>>,
    pub pgaps: Vec<PlacedCard<Pgap>>,
    pub psolids: Vec<PlacedCard<Psolid>>,
    pub mat1s: Vec<PlacedCard<Mat1>>,
    pub mat2s: Vec<PlacedCard<Mat2>>,
    pub mat8s: Vec<PlacedCard<Mat8>>,
    pub mat9s: Vec<PlacedCard<Mat9>>,
    pub matt1s: Vec<PlacedCard<Matt1>>,
    pub material_tables: Vec<PlacedCard<MaterialTable>>,
    pub forces: Vec<PlacedCard<Force>>,
    pub moments: Vec<PlacedCard<Force>>,
    pub forces_along: Vec<PlacedCard<ForceAlong>>,
    pub sloads: Vec<PlacedCard<Sload>>,
    pub ploads: Vec<PlacedCard<Pload>>,
    pub pload1s: Vec<PlacedCard<Pload1>>,
    pub pload2s: Vec<PlacedCard<Pload2>>,
    pub pload4s: Vec<PlacedCard<Pload4>>,
    pub gravs: Vec<PlacedCard<Grav>>,
    pub rforces: Vec<PlacedCard<Rforce>>,
    pub accels: Vec<PlacedCard<Accel>>,
    pub accel1s: Vec<PlacedCard<Accel1>>,
    pub loads: Vec<PlacedCard<LoadSum>>,
    pub temps: Vec<PlacedCard<Temp>>,
    pub tempds: Vec<PlacedCard<Tempd>>,
    pub tempp1s: Vec<PlacedCard<Tempp1>>,
    pub temprbs: Vec<PlacedCard<Temprb>>,
    pub params: Vec<PlacedCard<Param>>,
    /// Entries of an OP2 that act and have no struct. A deck keeps such cards as text instead.
    pub unread: Vec<PlacedCard<UnreadEntry>>,
}

/// An entry of the geometry blocks of an OP2 that acts and has no struct.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct UnreadEntry {
    /// Name of the entry, or the code of its record if the name is not known.
    pub name: String,
    /// Id of the element, property or set; `None` for a record whose entries have no known length.
    pub id: Option<u32>,
    /// Whether the entry is a load, which acts if case control selects its set.
    pub is_load: bool,
}
