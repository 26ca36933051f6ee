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

use crate::place::Placed;

/// Every typed card of a deck or of the geometry blocks of an OP2, each list in file order.
#[derive(Clone, Debug, Default, PartialEq)]
#[allow(missing_docs)] // the names are the card names
pub struct Cards {
    pub grids: Vec<Placed<Grid>>,
    pub grdset: Option<Placed<Grdset>>,
    pub spoints: Vec<Placed<IdList>>,
    /// Ends of CMASSi and CDAMPi without a component, which are scalar points where no grid has their id.
    pub connected_points: Vec<Placed<u32>>,
    pub coords: Vec<Placed<Coord>>,
    pub shells: Vec<Placed<Shell>>,
    pub shear_panels: Vec<Placed<ShearPanel>>,
    pub snorms: Vec<Placed<Snorm>>,
    pub bars: Vec<Placed<Bar>>,
    pub baror: Option<Placed<BarDefaults>>,
    pub beams: Vec<Placed<Beam>>,
    pub beamor: Option<Placed<BarDefaults>>,
    pub rods: Vec<Placed<Rod>>,
    pub conrods: Vec<Placed<Conrod>>,
    pub bushes: Vec<Placed<Bush>>,
    pub springs: Vec<Placed<Spring>>,
    pub welds: Vec<Placed<Weld>>,
    pub fasteners: Vec<Placed<Fastener>>,
    pub gaps: Vec<Placed<Gap>>,
    pub solids: Vec<Placed<Solid>>,
    pub conm1s: Vec<Placed<Conm1>>,
    pub conm2s: Vec<Placed<Conm2>>,
    pub scalar_masses: Vec<Placed<ScalarMass>>,
    pub pmasses: Vec<Placed<Pmass>>,
    pub nsms: Vec<Placed<NonstructuralMass>>,
    pub nsmadds: Vec<Placed<SetSum>>,
    pub rbe1s: Vec<Placed<Rbe1>>,
    pub rbe2s: Vec<Placed<Rbe2>>,
    pub rbe3s: Vec<Placed<Rbe3>>,
    pub rbars: Vec<Placed<Rbar>>,
    pub rsplines: Vec<Placed<Rspline>>,
    pub mpcs: Vec<Placed<Mpc>>,
    pub mpcadds: Vec<Placed<SetSum>>,
    pub spcs: Vec<Placed<Spc>>,
    pub spcds: Vec<Placed<Spc>>,
    pub spc1s: Vec<Placed<Spc1>>,
    pub spcadds: Vec<Placed<SetSum>>,
    pub suports: Vec<Placed<Suport>>,
    pub pshells: Vec<Placed<Pshell>>,
    pub pcomps: Vec<Placed<Pcomp>>,
    pub pshears: Vec<Placed<Pshear>>,
    pub pbars: Vec<Placed<Pbar>>,
    pub pbarls: Vec<Placed<Pbarl>>,
    pub pbeams: Vec<Placed<Pbeam>>,
    pub pbeamls: Vec<Placed<Pbeaml>>,
    pub prods: Vec<Placed<Prod>>,
    pub ptubes: Vec<Placed<Ptube>>,
    pub pbushes: Vec<Placed<Pbush>>,
    pub pelas: Vec<Placed<Pelas>>,
    pub pwelds: Vec<Placed<Pweld>>,
    pub pfasts: Vec<Placed<Pfast>>,
    pub pgaps: Vec<Placed<Pgap>>,
    pub psolids: Vec<Placed<Psolid>>,
    pub mat1s: Vec<Placed<Mat1>>,
    pub mat2s: Vec<Placed<Mat2>>,
    pub mat8s: Vec<Placed<Mat8>>,
    pub mat9s: Vec<Placed<Mat9>>,
    pub matt1s: Vec<Placed<Matt1>>,
    pub material_tables: Vec<Placed<MaterialTable>>,
    pub forces: Vec<Placed<Force>>,
    pub moments: Vec<Placed<Force>>,
    pub forces_along: Vec<Placed<ForceAlong>>,
    pub sloads: Vec<Placed<Sload>>,
    pub ploads: Vec<Placed<Pload>>,
    pub pload1s: Vec<Placed<Pload1>>,
    pub pload2s: Vec<Placed<Pload2>>,
    pub pload4s: Vec<Placed<Pload4>>,
    pub gravs: Vec<Placed<Grav>>,
    pub rforces: Vec<Placed<Rforce>>,
    pub accels: Vec<Placed<Accel>>,
    pub accel1s: Vec<Placed<Accel1>>,
    pub loads: Vec<Placed<LoadSum>>,
    pub temps: Vec<Placed<Temp>>,
    pub tempds: Vec<Placed<Tempd>>,
    pub tempp1s: Vec<Placed<Tempp1>>,
    pub temprbs: Vec<Placed<Temprb>>,
    pub params: Vec<Placed<Param>>,
    /// Entries of an OP2 that act and have no struct; decks keep them word for word instead.
    pub unread: Vec<Placed<UnreadEntry>>,
}

/// An entry of the geometry blocks of an OP2 that acts and has no struct.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct UnreadEntry {
    /// Name of the entry, or the code of its record where the name is not known.
    pub name: String,
    /// Id of the element, property or set; `None` for a record whose entries have no known length.
    pub id: Option<u32>,
    /// Whether it is a load, which acts where its set is selected.
    pub is_load: bool,
}
