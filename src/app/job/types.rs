//! A job with its defaults filled in and its words checked. Lengths, forces and masses are in the job's units unless a field says so.

pub use super::shapes::Ids;
use crate::app::file_read::FileRead;
use crate::fe::SupportChoice;
use crate::units::{Quantity, ReportUnits, Unit, UnitSystem};
use crate::vehicle::adjustment::{Lag, Slip};
use crate::vehicle::chassis::LeafSeat;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A file that the job names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedFile {
    /// Path as written, relative to the job's folder.
    pub given: String,
    /// The key that names it, such as `model.deck`.
    pub key: String,
    /// Line of the job.
    pub line: u32,
}

/// A job.
#[derive(Clone, Debug)]
pub struct Job {
    /// The job file as given on the command line.
    pub file: String,
    /// Its folder: what paths in it are relative to.
    pub folder: PathBuf,
    /// The files it was read from: itself, then tables read with it.
    pub read: Vec<FileRead>,
    /// Title; the file's name where there is none.
    pub title: String,
    /// Unit system of the model.
    pub units: UnitSystem,
    /// Units of reports.
    pub report_units: ReportUnits,
    /// `[model]`.
    pub model: Option<ModelFiles>,
    /// `[[load]]`, in job order.
    pub loads: Vec<JobLoad>,
    /// `[calibration]`; the default where absent.
    pub calibration: CalibrationKeys,
    /// `[[combination]]`, in job order.
    pub combinations: Vec<Combination>,
    /// `[[correction]]`, in job order.
    pub corrections: Vec<Correction>,
    /// `[[gauge]]`, then those of `[gauges] file`.
    pub gauges: Vec<JobGauge>,
    /// `[gauges] file`.
    pub gauge_file: Option<NamedFile>,
    /// `[candidates]`; the default where absent.
    pub candidates: Candidates,
    /// `[placement]`; the default where absent.
    pub placement: Placement,
    /// `[measured]`.
    pub measured: Option<Measured>,
    /// `[runs]`.
    pub runs: Option<Runs>,
    /// `[ballast]`.
    pub ballast: Option<Ballast>,
    /// `[payload]`.
    pub payload: Option<Payload>,
    /// `[recover]`; the default where absent.
    pub recover: Recover,
    /// `[respond]`; the default where absent.
    pub respond: Respond,
    /// `[study]`.
    pub study: Option<Study>,
    /// `[vehicle]`.
    pub vehicle: Option<Vehicle>,
    /// `[reconcile]`.
    pub reconcile: Option<Reconcile>,
    /// `[sensitivity]`: S and signatures computed elsewhere.
    pub sensitivity: Option<GivenSensitivity>,
    /// `[fleet]`.
    pub fleet: Option<Fleet>,
}

/// `[model]`.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelFiles {
    /// The deck, or an OP2 with the mesh.
    pub deck: NamedFile,
    /// Result files; empty: the built-in solver computes them.
    pub results: Vec<NamedFile>,
    /// What holds the structure.
    pub support: SupportChoice,
    /// Line of `support`, or of the section.
    pub support_line: u32,
    /// Whether what the mesh makes is taken out of the strain of the built-in solver, and what is left of it weighed.
    pub mesh_error: bool,
}

/// A force or moment component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Component {
    FX,
    FY,
    FZ,
    MX,
    MY,
    MZ,
}

impl Component {
    /// All, in dof order.
    pub const ALL: [Component; 6] = [Self::FX, Self::FY, Self::FZ, Self::MX, Self::MY, Self::MZ];

    /// As in a job.
    pub fn name(self) -> &'static str {
        ["FX", "FY", "FZ", "MX", "MY", "MZ"][self as usize]
    }

    /// 0 to 5.
    pub fn dof(self) -> usize {
        self as usize
    }

    /// A force, not a moment.
    pub fn is_force(self) -> bool {
        (self as usize) < 3
    }

    /// Force or moment.
    pub fn quantity(self) -> Quantity {
        if self.is_force() {
            Quantity::Force
        } else {
            Quantity::Moment
        }
    }

    /// A force or moment of `size` as a vector in the axes of the load.
    pub fn vector(self, size: f64) -> [f64; 3] {
        let mut v = [0.0; 3];
        v[self.dof() % 3] = size;
        v
    }
}

/// What a load is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LoadActs {
    /// A component at a grid, in the axes of `cid` (0 basic) at that grid.
    AtGrid {
        /// Grid id.
        grid: u32,
        /// Component.
        component: Component,
        /// Coordinate system id.
        cid: u32,
    },
    /// A load set of the deck.
    Set(u32),
    /// A column of a given S: nothing but its name is known.
    Named,
}

/// `[calibration]`.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrationKeys {
    /// Runs that teach; `None`: every run whose loads are known.
    pub runs: Option<Vec<String>>,
    /// Columns of the runs file: runs alike in these are repeats.
    pub repeats: Vec<String>,
    /// Column of the runs file that the scale may depend on.
    pub depends_on: Option<String>,
    /// Stated relative error of the model's S, 1 sd: entry by entry, and common to a gauge.
    pub model_uncertainty_rel: f64,
    /// How far a gauge may sit from its drawing along and across its axis, 1 sd, job length; 0: it sits there.
    pub position_tolerance: f64,
    /// How far it may be turned, 1 sd; 0: it is not.
    pub angle_tolerance_deg: f64,
    /// Line of the job; 0 where the section is absent.
    pub line: u32,
}

/// `[[combination]]`: a sum of loads with an interval of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Combination {
    /// Name.
    pub name: String,
    /// Loads and their factors.
    pub terms: Vec<(String, f64)>,
    /// Line of the job.
    pub line: u32,
}

/// `[[correction]]`: what is known to be wrong with a channel. It reads `sign gain strain + offset`.
#[derive(Clone, Debug, PartialEq)]
pub struct Correction {
    /// Channel.
    pub gauge: String,
    /// 1, or -1 where it is wired backwards.
    pub sign: f64,
    /// What it reads of the strain.
    pub gain: f64,
    /// What it reads without strain, microstrain.
    pub offset_microstrain: f64,
    /// The channel with which it is exchanged.
    pub exchanged_with: Option<String>,
    /// What the gauge is turned by, degrees, beyond its stated angle.
    pub angle_deg: Option<f64>,
    /// The channel is taken for silent.
    pub ignore: bool,
    /// Line of the job.
    pub line: u32,
}

/// Whether a load is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Role {
    Wanted,
    Nuisance,
}

/// A column of S.
#[derive(Clone, Debug, PartialEq)]
pub struct JobLoad {
    /// Name.
    pub name: String,
    /// What acts.
    pub acts: LoadActs,
    /// The load in its subcase, job units, signed; not zero.
    pub applied: f64,
    /// Which of the results files, where the job says.
    pub result: Option<NamedFile>,
    /// Subcase, where the job says; else its number in job order.
    pub subcase: Option<u32>,
    /// Its number in job order, from 1: the subcase that `cases` gives it.
    pub number: u32,
    /// Wanted or nuisance.
    pub role: Role,
    /// Prior standard deviation, job units.
    pub expected: Option<f64>,
    /// How much its variance counts in criterion A; default 1.
    pub weight: f64,
    /// Line of the job.
    pub line: u32,
}

impl JobLoad {
    /// The subcase stated, else the one that `cases` gives.
    pub fn subcase(&self) -> u32 {
        self.subcase.unwrap_or(self.number)
    }

    /// Force or moment; `None` for a load set.
    pub fn quantity(&self) -> Option<Quantity> {
        match self.acts {
            LoadActs::AtGrid { component, .. } => Some(component.quantity()),
            LoadActs::Named => Some(super::quantity::quantity_of_name(&self.name)),
            LoadActs::Set(_) => None,
        }
    }

    /// The unit in which it is reported; `None` for a load set, which is counted in times the set.
    pub fn report_unit(&self, units: &ReportUnits) -> Option<Unit> {
        Some(units.unit(self.quantity()?))
    }
}

/// Surface of a shell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surface {
    /// Z1.
    Bottom,
    /// Z2.
    Top,
}

impl Surface {
    /// As in a job and in `strains.csv`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bottom => "bottom",
            Self::Top => "top",
        }
    }
}

/// How the arms of a gauge are wired.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bridge {
    /// One grid.
    Quarter,
    /// Two grids: this one less the other pair's.
    HalfBending,
    /// Four grids: twice this one less twice the other.
    FullBending,
    /// Two grids at +45 and -45 degrees: their difference is the shear strain.
    Shear,
}

impl Bridge {
    /// All of them.
    pub const ALL: [Bridge; 4] = [
        Self::Quarter,
        Self::HalfBending,
        Self::FullBending,
        Self::Shear,
    ];

    /// As in a job.
    pub fn name(self) -> &'static str {
        match self {
            Self::Quarter => "quarter",
            Self::HalfBending => "half-bending",
            Self::FullBending => "full-bending",
            Self::Shear => "shear",
        }
    }

    /// From a job or a table; `full` and `half` mean bending.
    pub fn from_name(name: &str) -> Option<Self> {
        match name {
            "full" => Some(Self::FullBending),
            "half" => Some(Self::HalfBending),
            _ => Self::ALL.into_iter().find(|b| b.name() == name),
        }
    }
}

/// A rosette's legs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rosette {
    /// Legs a, b, c at 0, 45, 90 degrees.
    Rectangular,
    /// Legs a, b, c at 0, 60, 120 degrees.
    Delta,
}

/// Where a gauge sits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GaugePlace {
    /// At the centre of an element.
    Element(u32),
    /// At a point in the axes of `cid`: the nearest surface is taken.
    Position([f64; 3], u32),
    /// At a bar or beam: recovery point 0 to 3 (C D E F) at a share of the length from end A.
    BeamPoint {
        /// Element id.
        element: u32,
        /// 0 to 3: C D E F.
        point: u8,
        /// x/xb.
        station: f64,
    },
    /// Not stated: enough for a job whose S is given.
    Unstated,
}

/// A gauge.
#[derive(Clone, Debug, PartialEq)]
pub struct JobGauge {
    /// Name: the column of the strain file.
    pub name: String,
    /// Where it sits.
    pub place: GaugePlace,
    /// Location in job units as the table states it beside the element, where it does: for drawings.
    pub position: Option<[f64; 3]>,
    /// Surface.
    pub surface: Surface,
    /// Whether the job states the surface (else it is `top`, or the nearest for a position).
    pub surface_stated: bool,
    /// Direction to be laid on the surface, basic frame or that of `cid`; `None`: the element x axis.
    pub direction: Option<[f64; 3]>,
    /// Coordinate system of the direction.
    pub cid: u32,
    /// Angle from that direction, degrees, right-handed about the element normal.
    pub angle_deg: f64,
    /// Wiring.
    pub bridge: Bridge,
    /// The sum of signed arm strains is divided by this.
    pub bridge_factor: f64,
    /// Length over which strain is averaged; 0: at the point.
    pub grid_length: f64,
    /// Element and surface of the other pair.
    pub pair: Option<(u32, Surface)>,
    /// Three legs instead of one grid.
    pub rosette: Option<Rosette>,
    /// Transverse sensitivity Kt, a fraction.
    pub transverse_sensitivity: f64,
    /// Free columns of the table, such as `member`.
    pub member: String,
    /// File that states it.
    pub file: String,
    /// Line there.
    pub line: u32,
}

/// The angles of candidates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AngleStep {
    /// Every so many degrees from the element x axis.
    Degrees(f64),
    /// Any angle.
    Continuous,
}

/// `[candidates]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidates {
    /// Property ids; `None`: all shells.
    pub properties: Option<Ids>,
    /// Element ids; `None`: all.
    pub elements: Option<Ids>,
    /// Surfaces; default both.
    pub surfaces: Vec<Surface>,
    /// Angles; default 15 degrees.
    pub angles: AngleStep,
    /// Grid length of the gauges to be placed.
    pub grid_length: f64,
    /// Wirings to choose from; default quarter bridges alone.
    pub bridges: Vec<Bridge>,
    /// Rosettes too.
    pub rosette: Option<Rosette>,
    /// SETs of the deck's case control that name the elements; `None`: not limited so.
    pub sets: Option<Ids>,
    /// Properties left out.
    pub exclude_properties: Option<Ids>,
    /// Elements left out.
    pub exclude_elements: Option<Ids>,
    /// Elements of which each gets a gauge.
    pub wanted_elements: Option<Ids>,
    /// A file with lists of properties and elements.
    pub file: Option<NamedFile>,
    /// Boxes in which gauges may sit; empty: anywhere.
    pub boxes: Vec<Region>,
    /// Boxes in which they may not.
    pub exclude_boxes: Vec<Region>,
    /// Least distances, job units.
    pub clear: Clearances,
    /// Line of the job; 0 where the section is absent.
    pub line: u32,
}

/// `clear_of` of `[candidates]`: least distances, 0 where not stated.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Clearances {
    /// From free edges; from rims of holes too, where `holes` is not stated.
    pub edges: f64,
    /// From rims of holes.
    pub holes: Option<f64>,
    /// From edges where plates meet: welds.
    pub joints: f64,
    /// From grids at which loads act.
    pub loads: f64,
    /// From grids that rigid elements, RBE3 and bushes hold.
    pub attachments: f64,
}

/// Gauges of the job that stay.
#[derive(Clone, Debug, PartialEq)]
pub enum Keep {
    /// None: the layout is new.
    None,
    /// All of them.
    All,
    /// These.
    Named(Vec<String>),
}

/// What placement maximises.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Criterion {
    /// Determinant for all loads.
    D,
    /// Determinant for the wanted loads, nuisance loads estimated along.
    Ds,
    /// Least sum of the wanted loads' weighed variances, each in shares of its expected size.
    A,
    /// Least mean variance of the strain predicted at the candidates.
    I,
    /// Determinant for all loads, each known beforehand to its expected size.
    BayesianD,
    /// Least condition number of S with columns in the loads' expected sizes.
    Condition,
}

impl Criterion {
    /// As in a job.
    pub fn name(self) -> &'static str {
        match self {
            Self::D => "D",
            Self::Ds => "Ds",
            Self::A => "A",
            Self::I => "I",
            Self::BayesianD => "Bayesian-D",
            Self::Condition => "condition",
        }
    }
}

/// `[placement]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Placement {
    /// How many; `None`: twice the number of loads, which the command says.
    pub gauges: Option<usize>,
    /// Criterion; default `Ds` with nuisance loads, else `D`.
    pub criterion: Criterion,
    /// Smallest distance between gauges; default 0.
    pub spacing: f64,
    /// Noise, microstrain; default: that of `[measured]`, else 1.
    pub noise_microstrain: f64,
    /// Gluing tolerance, degrees, 1 sd; default 0.
    pub angle_tolerance_deg: f64,
    /// Model uncertainty, of the predicted strain; default: that of `[measured]`, else 0.
    pub model_uncertainty_rel: f64,
    /// Seed of everything random.
    pub seed: u64,
    /// Misplacement along each direction, 1 sd, job units; default 0.
    pub position_tolerance: f64,
    /// Tolerance of the gauge factor, 1 sd, a fraction; default 0.
    pub gauge_factor_rel: f64,
    /// Noise of a wiring's reading, microstrain, where it is not `noise_microstrain`.
    pub noise_by_bridge: Vec<(Bridge, f64)>,
    /// Whether the layout is chosen for what is left after the worst loss of a gauge.
    pub loss: crate::placement::Loss,
    /// Gauges of the job that stay; `gauges` counts those to be added.
    pub keep: Keep,
    /// Pairs that mirror each other at the plane through 0 normal to this axis (0 to 2).
    pub symmetric: Option<usize>,
    /// Cost of a wiring's name (`quarter`, .., `rosette`) in channels; default 1, a rosette 3.
    pub costs: Vec<(String, f64)>,
    /// What a layout may cost; default: `gauges`.
    pub budget: Option<f64>,
    /// Numbers of gauges for the curve; empty: none is drawn.
    pub curve: Vec<usize>,
    /// Gauges reserved for validation.
    pub reserve: usize,
    /// Named reference points of the gluing sheet: grids.
    pub references: Vec<(String, u32)>,
    /// Line of the job; 0 where the section is absent.
    pub line: u32,
}

/// State that is added to make loads totals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reference {
    /// Loads are changes.
    None,
    /// The structure's own weight.
    Gravity,
    /// A subcase of the results.
    Subcase(u32),
}

/// What is kept from fitting.
#[derive(Clone, Debug, PartialEq)]
pub enum HoldOut {
    /// Nothing.
    None,
    /// These runs of the strain file.
    Runs(Vec<String>),
    /// A file of its own.
    File(NamedFile),
}

/// `[measured]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Strain file.
    pub strain: NamedFile,
    /// Its mean is subtracted.
    pub zero: Option<NamedFile>,
    /// Runs of the strain file at which no load acts: the zero is followed through them.
    pub zero_runs: Vec<String>,
    /// Changes or totals.
    pub reference: Reference,
    /// Noise, microstrain, 1 sd; default 1.
    pub noise_microstrain: f64,
    /// Model uncertainty of the predicted strain, 1 sd; default 0.
    pub model_uncertainty_rel: f64,
    /// Runs kept from fitting.
    pub hold_out: HoldOut,
    /// Seconds in the unit of the column `time`, where the job states it.
    pub time_unit_s: Option<f64>,
    /// Line of the job.
    pub line: u32,
}

/// Where wheel forces of the runs file come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum WheelForces {
    Measured,
    FlatGroundModel,
}

/// `[runs]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Runs {
    /// The file.
    pub file: NamedFile,
    /// Load name or `payload_force`, `payload_mass`, `payload_x`, `payload_y` to the column's name.
    pub columns: BTreeMap<String, String>,
    /// Units of the file; the report units where not stated.
    pub units: ReportUnits,
    /// Quantities whose unit the job states.
    pub stated_units: Vec<Quantity>,
    /// 1 sd by quantity, in the file's units.
    pub noise: RunNoise,
    /// Measured or computed.
    pub wheel_forces: WheelForces,
    /// Line of the job.
    pub line: u32,
}

/// Noise of the runs file, 1 sd, in its units; `None` where not stated.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[allow(missing_docs)]
pub struct RunNoise {
    pub force: Option<f64>,
    pub moment: Option<f64>,
    pub mass: Option<f64>,
    pub length: Option<f64>,
}

/// A box in plan, and in height where stated: low and high by axis.
pub type Region = Vec<[f64; 2]>;

/// `[ballast]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Ballast {
    /// How many masses; default 1.
    pub masses: usize,
    /// Where they may sit.
    pub region: Option<Region>,
    /// Properties whose grids may carry them; `None`: all shells (bars where there are none).
    pub properties: Option<Ids>,
    /// The largest one.
    pub max_mass: Option<f64>,
    /// Run whose reactions count; default the first.
    pub run: Option<String>,
    /// Gravity, m/s^2 whatever the unit system; default 9.80665.
    pub gravity_m_s2: f64,
    /// Line of the job.
    pub line: u32,
}

/// Whether the payload's place is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum PayloadPosition {
    Known,
    Free,
}

/// `[payload]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Payload {
    /// Grid where it acts.
    pub grid: Option<u32>,
    /// Known or free.
    pub position: PayloadPosition,
    /// Gravity, m/s^2 whatever the unit system; default 9.80665.
    pub gravity_m_s2: f64,
    /// The payload's weight acts in the analyst's model.
    pub weight_in_model: bool,
    /// Where it may be.
    pub region: Option<Region>,
    /// Use strain; default both where present.
    pub use_strain: bool,
    /// Use reactions.
    pub use_reactions: bool,
    /// Run without payload: its wheel forces (and its strain, without a zero file) are subtracted.
    pub unloaded: Option<String>,
    /// Nominal position, job units.
    pub nominal_x: Option<f64>,
    /// Likewise across.
    pub nominal_y: Option<f64>,
    /// Line of the job.
    pub line: u32,
}

/// What `recover` writes beside `loads.csv`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoadFile {
    /// `loads.rsp`: the history in RPC III.
    Rpc,
    /// `loads.bdf`: FORCE, MOMENT and LOAD, for a history TABLED1.
    Nastran,
    /// `rainflow.csv`: cycles and pseudo-damage of the history.
    Rainflow,
    /// `loads.parquet`: the history in Parquet.
    Parquet,
}

impl LoadFile {
    /// Whether this build can write it.
    pub fn is_built(self) -> bool {
        self != Self::Parquet || cfg!(feature = "parquet")
    }

    /// All of them, with the words of a job.
    pub const ALL: [(&'static str, LoadFile); 4] = [
        ("rpc", Self::Rpc),
        ("nastran", Self::Nastran),
        ("rainflow", Self::Rainflow),
        ("parquet", Self::Parquet),
    ];
}

/// `[recover]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Recover {
    /// Files asked for; `None`: all, but for long histories.
    pub files: Option<Vec<LoadFile>>,
    /// Power of the load range in pseudo-damage.
    pub slope: f64,
}

/// `[fleet]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Fleet {
    /// Form of file names, with `{vehicle}` and `{day}`.
    pub file_name: NamedFile,
    /// Range below which the S-N line is flatter, report unit of each load; `None`: a straight line.
    pub knee_range: Option<f64>,
    /// Power below the knee; infinite where cycles below do no harm.
    pub slope_below_knee: f64,
}

/// `[respond]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Respond {
    /// Elements to report; `None`: the hottest.
    pub elements: Option<Ids>,
    /// How many of the hottest; default 20.
    pub hottest: usize,
    /// Load histories; `None`: recovered from `[measured]`.
    pub loads: Option<NamedFile>,
    /// Line of the job; 0 where the section is absent.
    pub line: u32,
}

/// `[study]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// `given`, `random`, `D`, as written.
    pub layouts: Vec<String>,
    /// Gauge counts.
    pub gauges: Vec<usize>,
    /// Kind and size of each error.
    pub errors: Vec<(String, f64)>,
    /// Trials; default 1000.
    pub trials: usize,
    /// Seed; default 1.
    pub seed: u64,
    /// Line of the job.
    pub line: u32,
}

/// `[vehicle]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Vehicle {
    /// `front2`, `rear3`, `front_pair`, `half`, `full2`, `full3`.
    pub model: String,
    /// Terms of the analyst's model.
    pub terms: Vec<String>,
    /// Record.
    pub data: NamedFile,
    /// Held-out record.
    pub hold_out: Option<NamedFile>,
    /// Hz; `None`: from the time column.
    pub sample_rate: Option<f64>,
    /// Known parameters.
    pub known: BTreeMap<String, f64>,
    /// Noise of accelerations, m/s^2, 1 sd.
    pub noise_acc: Option<f64>,
    /// Noise of wheel forces, N, 1 sd.
    pub noise_force: Option<f64>,
    /// Declared tolerance of gains, a fraction.
    pub tolerance_gain: Option<f64>,
    /// Declared tolerance of synchronisation, s.
    pub tolerance_sync: Option<f64>,
    /// Band in which to compare, Hz.
    pub band_hz: Option<[f64; 2]>,
    /// Channel to column, where the file names them otherwise.
    pub columns: BTreeMap<String, String>,
    /// Places (x, y) of wheels (`lf`), springs (`spring_lf`) and body accelerometers (`body_lf`).
    pub places: BTreeMap<String, [f64; 2]>,
    /// Limits of parameters.
    pub bounds: BTreeMap<String, [f64; 2]>,
    /// Faults of channels that are known.
    pub corrections: BTreeMap<String, ChannelCorrection>,
    /// A mass that changes during the record.
    pub mass_change: Option<MassChange>,
    /// Leaf springs by link (`s`), whose force is divided between hanger and shackle.
    pub leaf: BTreeMap<String, LeafSeat>,
    /// Line of the job.
    pub line: u32,
}

/// A known fault of a channel of `[vehicle]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelCorrection {
    /// Reading over truth.
    pub gain: f64,
    /// How late it reads, s.
    pub delay_s: f64,
    /// How much later it reads with every second of a record, millionths.
    pub clock_ppm: f64,
    /// Samples lost or written twice, in the fitted record.
    pub slip: Option<Slip>,
    /// A low-pass that it alone went through.
    pub lag: Option<Lag>,
    /// A mains line on it, Hz.
    pub line_hz: Option<f64>,
}

/// `mass_change` of `[vehicle]`.
#[derive(Clone, Debug, PartialEq)]
pub struct MassChange {
    /// Body, such as `b`.
    pub body: String,
    /// When it begins, s.
    pub at_s: f64,
    /// How long it takes, s.
    pub over_s: f64,
    /// Whether its weight comes with it (else its inertia alone).
    pub weight: bool,
}

/// Which world `reconcile` compares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum ReconcilePath {
    Static,
    Dynamic,
}

/// `[reconcile]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Reconcile {
    /// Static or dynamic.
    pub path: ReconcilePath,
    /// Zone to property ids.
    pub zones: BTreeMap<String, Ids>,
    /// Place to grid id.
    pub places: BTreeMap<String, u32>,
    /// Apparent strain per degree by bridge name.
    pub thermal_microstrain_per_degc: BTreeMap<String, f64>,
    /// Temperature set of the deck whose pattern `thermal_gradient` has.
    pub temperature_set: Option<u32>,
    /// Effect ids; `None`: all.
    pub effects: Option<Vec<String>>,
    /// Bushes whose stiffness may be wrong; `None`: all, where they are few.
    pub joints: Option<Ids>,
    /// Causes measured beside the readings: name, and column of the runs file.
    pub causes: BTreeMap<String, String>,
    /// Gluing tolerance of angles, degrees, 1 sd.
    pub angle_tolerance_deg: Option<f64>,
    /// Gluing tolerance of places, mm, 1 sd.
    pub position_tolerance_mm: Option<f64>,
    /// Hypotheses of the user's own.
    pub described: Vec<DescribedEffect>,
    /// Line of the job.
    pub line: u32,
}

/// `[[reconcile.effect]]`: a hypothesis of the user's own.
#[derive(Clone, Debug, PartialEq)]
pub struct DescribedEffect {
    /// Its id in results.
    pub id: String,
    /// What it does at size one.
    pub source: EffectSource,
    /// One standard deviation of its size before a run is seen.
    pub prior: f64,
    /// Line of the job.
    pub line: u32,
}

/// What a described effect does at size one.
#[derive(Clone, Debug, PartialEq)]
pub enum EffectSource {
    /// A table: the change of S, a row a gauge, a column a load.
    Signature(NamedFile),
    /// The thickness of a shell property times a factor.
    Thickness {
        /// Property id.
        property: u32,
        /// Factor.
        factor: f64,
    },
    /// The stiffness of a bush times a factor.
    Bush {
        /// Element id.
        element: u32,
        /// Factor.
        factor: f64,
    },
}

/// `[sensitivity]`.
#[derive(Clone, Debug, PartialEq)]
pub struct GivenSensitivity {
    /// A row a gauge, a column a load.
    pub file: NamedFile,
    /// Microstrain per these units.
    pub per: ReportUnits,
    /// Load name and column name, in job order; empty: every column is a load of its own name.
    pub columns: Vec<(String, String)>,
    /// Signature files.
    pub signatures: Signatures,
    /// Covariance of S, as `calibrate` writes it.
    pub covariance: Option<NamedFile>,
    /// Line of the job.
    pub line: u32,
}

/// Signatures of effects, computed elsewhere.
#[derive(Clone, Debug, PartialEq, Default)]
#[allow(missing_docs)]
pub struct Signatures {
    pub lateral_wheel_loads: Option<NamedFile>,
    pub thermal: Option<NamedFile>,
    pub payload: Option<NamedFile>,
    pub unaccounted_mass: Option<NamedFile>,
    pub gauge_angle: Option<NamedFile>,
    /// Zone to file.
    pub rail_stiffness: BTreeMap<String, NamedFile>,
}
