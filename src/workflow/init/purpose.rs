//! Jobs for one command: the sections that the command needs, commented, instead of the sections that follow placing.

use super::Proposal;
use super::text::{JOB, LATER};
use crate::host::context::Context;
use crate::host::fault::{Fault, Faults};
use crate::host::outcome::{Outcome, StatedUnits};
use crate::host::work::Work;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Command of a job, other than placing gauges and recovering loads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// `payload`.
    Payload,
    /// `identify`.
    Identify,
    /// `reconcile`.
    Reconcile,
    /// `calibrate`.
    Calibrate,
}

const GAUGES: &str = r#"
[gauges]
file = "job.out/gauges.csv"           # as `place` wrote it; or a [[gauge]] each

[measured]
strain = "strain.csv"                 # check: one column for each gauge, microstrain; one row for each run (`run`) or sample (`time`)
# zero = "zero.csv"                   # readings without load: their mean is subtracted
noise_microstrain = 1.0               # check: of a reading, 1 sd
model_uncertainty_rel = 0.02          # check: of the predicted strain, 1 sd
"#;

const RUNS: &str = r#"
[runs]
file = "runs.csv"                     # check: `run`, one column for each load (names as above), payload_mass, payload_x, payload_y
# columns = { "LF.FZ" = "FZ_LF_kN" }  # if the file has other names
units = { force = "kN", mass = "kg", length = "m" }
noise = { force = 0.1 }               # check: of the scales, 1 sd
wheel_forces = "measured"             # "flat_ground_model": computed, not evidence
"#;

const PAYLOAD: &str = r#"
[payload]
# grid = 901                          # fill in: the grid through which the payload acts
position = "free"                     # "known": it is at payload_x, payload_y of the runs
use = ["strain", "reactions"]         # or one of them
# unloaded = "R00"                    # run without payload: it is subtracted
# region = [[1000.0, 3000.0], [-300.0, 300.0]]   # possible places, job units of length
"#;

const RECONCILE: &str = r#"
[payload]
# grid = 901                          # fill in: the grid through which the payload acts
position = "known"

[reconcile]
path = "static"                       # strain of runs; "dynamic": accelerations, with a [vehicle]
effects = "all"                       # or a list of ids
# places = { rear = 9204 }            # grids where a mass may be
# thermal_microstrain_per_degC = { quarter = 1.4 }
# Hold runs out in [measured]: hold_out = ["R10", "R11"]. They test the identified cause.
"#;

const CALIBRATION: &str = r#"
[calibration]
# runs = ["R01", "R02"]               # default: every run of [measured] whose loads [runs] gives; the others are recovered
# repeats = ["lane"]                  # columns of the runs file: runs with equal values are repeats
# depends_on = "speed"                # tests whether recovered loads depend on it
# model_uncertainty_rel = 0.1         # with a [model]: of its S, 1 sd
"#;

/// A whole job: a vehicle needs no deck.
const IDENTIFY: &str = r#"# Written by `strainbridge init --for identify`. Read every line with `check`.
title = "Quarter truck"
units = "m-kg-s"                      # of [vehicle]: m/s2, N

[vehicle]
model = "front2"                      # check: "rear3", "front_pair", "half", "full2", "full3"
terms = ["k_s", "c_s"]                # check: what the model contains, a coefficient and a link each
data = "data.csv"                     # check: t, a_body, a_wheel (m/s2), f_wheel (N); also RPC III, Parquet, MDF4
hold_out = "holdout.csv"              # check: another stretch of road, which tests the fit
sample_rate = 500                     # check: Hz
# known = { m_b = 3200.0 }            # weighed values
noise = { acc = 0.02, force = 60.0 }  # check: of the sensors, 1 sd
tolerance = { gain = 0.01, sync = 0.0004 }   # check: of the measuring chain, 1 sd
band_hz = [0.7, 20.0]                 # check: where model and record are compared

# To find a missing effect, run `strainbridge reconcile` on this job with:
# [reconcile]
# path = "dynamic"
"#;

/// A job whose S comes from runs alone.
const CALIBRATE_ALONE: &str = r#"# Written by `strainbridge init --for calibrate`. Read every line with `check`.
title = "Calibrated by runs of known load"
units = "m-kg-s"                      # check
report_units = { force = "kN", moment = "kN m" }

# One [[load]] for each known load of the runs.
[[load]]
name = "front"                        # check: a column of the runs file

[[load]]
name = "rear"

[measured]
strain = "strain.csv"                 # check: one column for each gauge, microstrain; one row for each run (`run`)
noise_microstrain = 1.0               # check: of a reading, 1 sd
"#;

impl Purpose {
    /// All purposes with their names on the command line.
    pub const ALL: [(&'static str, Self); 4] = [
        ("payload", Self::Payload),
        ("identify", Self::Identify),
        ("reconcile", Self::Reconcile),
        ("calibrate", Self::Calibrate),
    ];

    /// Returns the name of the command.
    fn command(self) -> &'static str {
        let found = Self::ALL.into_iter().find(|p| p.1 == self);
        found.map_or("check", |p| p.0)
    }

    /// Returns the job of a deck with the sections of this purpose.
    pub fn put_into(self, job: &str, zones: &BTreeMap<String, BTreeSet<u32>>) -> String {
        let head = job.split(LATER).next().unwrap_or(job);
        let sections: &[&str] = match self {
            Self::Payload => &[GAUGES, RUNS, PAYLOAD],
            Self::Reconcile => &[GAUGES, RUNS, RECONCILE],
            Self::Calibrate => &[GAUGES, RUNS, CALIBRATION],
            Self::Identify => return IDENTIFY.to_owned(),
        };
        let zones = match self {
            Self::Reconcile => zones_text(zones),
            _ => String::new(),
        };
        [head, &sections.concat(), &zones].concat()
    }

    /// Returns a complete job, if the purpose needs no deck.
    fn job_without_deck(self) -> Option<String> {
        match self {
            Self::Identify => Some(IDENTIFY.to_owned()),
            Self::Calibrate => Some([CALIBRATE_ALONE, RUNS, CALIBRATION].concat()),
            Self::Payload | Self::Reconcile => None,
        }
    }
}

/// Returns one line for each zone of the deck's named properties, or an example if the deck names no property.
fn zones_text(zones: &BTreeMap<String, BTreeSet<u32>>) -> String {
    const HEAD: &str =
        "[reconcile.zones]                     # properties whose stiffness may be wrong together";
    let zone = |(name, ids): (&String, &BTreeSet<u32>)| {
        let ids: Vec<String> = ids.iter().map(u32::to_string).collect();
        format!("{name:?} = [{}]\n", ids.join(", "))
    };
    let listed: Vec<String> = zones.iter().map(zone).collect();
    match listed.is_empty() {
        true => format!(
            "\n# {HEAD}; left out: each property with gauges\n# left = [1]\n# right = [2]\n"
        ),
        false => format!("\n{HEAD}; check\n{}", listed.concat()),
    }
}

/// Proposes a commented job in `folder` for one purpose, from a deck if the purpose needs one. `identify` and `calibrate` need no deck.
///
/// # Errors
/// Returns the faults of [`super::init`], or a fault if a purpose that needs a deck has none.
///
/// # Example
/// ```
/// use std::path::Path;
/// use strainbridge::host::context::InMemory;
/// use strainbridge::workflow::init::Purpose;
/// use strainbridge::{Context, init_for};
///
/// let files = InMemory::default();
/// let cx = Context::new(&files);
/// let proposed = init_for(Purpose::Identify, None, &[], Path::new("bench"), &cx)?;
/// assert_eq!(proposed.path, Path::new("bench").join(proposed.job));
/// assert!(proposed.text.contains("\n[vehicle]\n"));
///
/// let no_deck = init_for(Purpose::Payload, None, &[], Path::new("bench"), &cx);
/// assert!(no_deck.is_err_and(|faults| faults[0].wrong == "no deck is given"));
/// # Ok::<(), strainbridge::Faults>(())
/// ```
pub fn init_for(
    purpose: Purpose,
    deck: Option<&Path>,
    results: &[PathBuf],
    folder: &Path,
    cx: &Context,
) -> Result<Outcome<Proposal>, Faults> {
    let mut work = Work::new(cx);
    if let (Some(deck), false) = (deck, purpose == Purpose::Identify) {
        let mut proposed = super::init(deck, results, folder, cx)?;
        proposed.answer.purpose = Some(purpose.command());
        proposed.answer.text = purpose.put_into(&proposed.answer.text, &proposed.answer.zones);
        return Ok(proposed);
    }
    let Some(text) = purpose.job_without_deck() else {
        let remedy = "name the deck: `strainbridge init truck.bdf --for payload`";
        return Err(Fault::new("init", "DECK", "no deck is given", remedy).into());
    };
    let path = super::free_target(folder, cx)?;
    let answer = Proposal {
        job: JOB,
        loads: Vec::new(),
        left_out: Vec::new(),
        placeable: false,
        zones: BTreeMap::new(),
        text,
        read: None,
        path,
        purpose: Some(purpose.command()),
    };
    if deck.is_some() {
        let note = "`identify` compares accelerations with a [vehicle]: the deck is not read";
        work.notes.push(note.to_owned());
    }
    Ok(work.finish(StatedUnits::default(), answer))
}
