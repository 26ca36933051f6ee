//! `modes`: the elastic modes of a deck's or job's structure, free or held, with their strain.

use crate::fe::{
    LoadCase, ModalSolution, SolveOptions, Support, SupportChoice, solve_modes, support_of,
};
use crate::gauge::{CornerRows, build, gauge_reading};
use crate::host::context::Context;
use crate::host::fault::{Fault, Faults};
use crate::host::outcome::{Answer, Outcome, StatedUnits, finite_or_none};
use crate::host::words::count_of;
use crate::host::work::Work;
use crate::job::Job;
use crate::model::Model;
use crate::strain_chain::built_in_solver::{faults_of, support_of_job};
use crate::strain_chain::deck::{DeckModel, read_model};
use crate::strain_chain::job_deck::read_deck;
use crate::strain_chain::named_results::{MissingResults, check_named};
use crate::strain_chain::{corrected_spec_of, not_laid};
use crate::units::{MICROSTRAIN, UnitSystem, number};
use serde::{Serialize, Serializer};
use std::path::Path;

/// One elastic mode.
#[derive(Clone, Debug, Serialize)]
pub struct ModeRow {
    /// Number of the mode, from 1 on.
    pub mode: usize,
    /// Frequency, cycles per unit of time.
    pub hz: f64,
    /// Generalised mass of the written shape: 1 except for rounding.
    pub generalised_mass: f64,
    /// Share of the modal equation that is not satisfied.
    pub residual: f64,
    /// Bound on the relative error of the frequency.
    pub frequency_error: f64,
    /// Distance to the nearest other mode, as a share of 1 / omega^2; null without another mode.
    #[serde(serialize_with = "or_null")]
    pub gap: f64,
    /// Modal effective mass along x, y, z and about axes through the centre of gravity.
    pub effective_mass: [f64; 6],
    /// Strain at each gauge of the job for a generalised coordinate of 1, microstrain. Null for a gauge without strain.
    pub gauge_microstrain: Vec<Option<f64>>,
}

fn or_null<S: Serializer>(x: &f64, s: S) -> Result<S::Ok, S::Error> {
    finite_or_none(*x).serialize(s)
}

/// Elastic modes of a structure.
#[derive(Serialize)]
pub struct Modes {
    /// Modes with ascending frequency.
    pub modes: Vec<ModeRow>,
    /// Description of the support of the structure.
    pub support: String,
    /// Number of unsupported rigid motions, which are not modes.
    pub rigid_motions: usize,
    /// Names of the gauges, as in `gauge_microstrain`.
    pub gauges: Vec<String>,
    /// Units of masses, from the job's system; null for a deck, which states no units.
    pub model_units: StatedUnits,
    /// Mass of the model, WTMASS applied.
    pub mass: Option<f64>,
    /// Number of unknowns.
    pub dofs: usize,
    /// Shapes and their strain.
    #[serde(skip)]
    pub solution: ModalSolution,
    /// The model.
    #[serde(skip)]
    pub model: Model,
    /// Title of the page.
    #[serde(skip)]
    pub title: String,
    /// The job's system of units.
    #[serde(skip)]
    pub system: Option<UnitSystem>,
}

impl Answer for Modes {
    const COMMAND: &'static str = "modes";
    const RESULT: &'static str = "The modes";

    fn verdict(&self) -> String {
        let n = count_of(self.modes.len(), "elastic mode");
        let (Some(first), Some(last)) = (self.modes.first(), self.modes.last()) else {
            return format!("{n}; the structure is {}.", self.support);
        };
        let error = self.modes.iter().map(|m| m.frequency_error);
        format!(
            "{n} from {} to {} Hz, frequencies exact to {:.0e}; the structure is {}.",
            number(first.hz),
            number(last.hz),
            error.fold(0.0, f64::max),
            self.support
        )
    }
}

/// Computes the lowest `count` elastic modes of the structure of a job, on the support of the job, with the strain of its gauges. Rigid
/// motions of a free structure are counted and left out.
///
/// # Errors
/// Returns every fault of the job and its deck, or the fault that stops the solver.
///
/// # Example
/// Elastic modes of a free structure do not move its centre of gravity, so their effective masses are zero:
/// ```
/// use strainbridge::{Context, Disk, Job, modes};
///
/// let job = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/frame/recover.toml");
/// let found = modes(&Job::read(job, &Disk)?, 2, &Context::new(&Disk))?;
/// assert_eq!(found.rigid_motions, 6);
/// assert!(found.modes[0].hz > 0.0 && found.modes[0].hz <= found.modes[1].hz);
/// for mode in &found.modes {
///     let largest = mode.effective_mass[..3].iter().copied().fold(0.0, f64::max);
///     assert!(largest < 1e-6 * found.mass.unwrap());
///     assert_eq!(mode.gauge_microstrain.len(), found.gauges.len());
/// }
/// # Ok::<(), strainbridge::Faults>(())
/// ```
pub fn modes(job: &Job, count: usize, cx: &Context) -> Result<Outcome<Modes>, Faults> {
    let mut work = Work::of_job(cx, job);
    let Some(files) = &job.model else {
        return Err(Faults::from(Fault::new(
            &*job.file,
            "model",
            "the job has no [model]",
            "name the deck: [model] deck = \"model.bdf\"",
        )));
    };
    check_named(&work, job, MissingResults::Refused)?;
    let read = work.stage("read model", |w| read_deck(w, job, files))?;
    let support = support_of_job(job, &read.model)?;
    let units = StatedUnits::from_units(job.units, &job.report_units);
    let answer = compute_modes(&mut work, read, support, (count, Some(job)))?;
    Ok(work.finish(units, answer))
}

/// Computes the lowest `count` elastic modes of the structure of a deck. The SPC set that case control selects supports it; without one it
/// is free. The deck may have any solution sequence.
///
/// # Errors
/// Returns every fault of the deck, or the fault that stops the solver.
///
/// # Example
/// A mass of 2 kg on a spring of 8000 N/m vibrates at `sqrt(k / m) / 2 pi`, about 10.07 Hz:
/// ```
/// use std::f64::consts::TAU;
/// use std::path::Path;
/// use strainbridge::host::context::InMemory;
/// use strainbridge::{Context, modes_of_deck};
///
/// const DECK: &str = "SOL 103\nCEND\nSPC = 1\nBEGIN BULK\nGRID,1,,0.,0.,0.,,23456\nGRID,2,,1.,0.,0.,,123456
/// CELAS2,1,8000.,1,1,2,1\nCONM2,2,1,,2.\nSPC1,1,123456,2\nENDDATA\n";
/// let files = InMemory::default().with_file("oscillator.bdf", DECK);
/// let found = modes_of_deck(Path::new("oscillator.bdf"), 1, &Context::new(&files))?;
/// let exact = (8000.0_f64 / 2.0).sqrt() / TAU;
/// assert!((found.modes[0].hz / exact - 1.0).abs() < 1e-9);
/// # Ok::<(), strainbridge::Faults>(())
/// ```
pub fn modes_of_deck(path: &Path, count: usize, cx: &Context) -> Result<Outcome<Modes>, Faults> {
    let mut work = Work::new(cx);
    let given = path.display().to_string();
    let read = work
        .stage("read model", |w| {
            read_model(&mut w.inputs, Path::new(""), &given)
        })
        .map_err(Faults::from)?;
    work.findings.extend(read.findings.iter().cloned());
    Faults::check(read.faults.clone())?;
    let support = support_of(&read.model, SupportChoice::Deck).map_err(|e| {
        Faults::from(Fault::new(
            &*given,
            "SPC",
            e.to_string(),
            "give a job with [model] support = the SPC set meant",
        ))
    })?;
    let answer = compute_modes(&mut work, read, support, (count, None))?;
    Ok(work.finish(StatedUnits::default(), answer))
}

fn compute_modes(
    work: &mut Work,
    read: DeckModel,
    support: Support,
    (count, job): (usize, Option<&Job>),
) -> Result<Modes, Faults> {
    let model = &read.model;
    let options = SolveOptions {
        stop: work.cx.progress.stop(),
        ..SolveOptions::default()
    };
    let solution = work
        .stage("modes", |_| {
            solve_modes(model, support.spc, model.mpc, count, &options)
        })
        .map_err(|e| faults_of(&e, &read))?;
    work.findings.extend(solution.findings.iter().cloned());
    let mut gauges = Vec::new();
    let of_job = job
        .iter()
        .flat_map(|j| j.gauges.iter().map(move |g| (j, g)));
    for (job, g) in of_job {
        let spec = corrected_spec_of(model, job, g).map_err(Faults::from)?;
        let laid = build(model, &spec, CornerRows::Present).map_err(|e| not_laid(g, &e));
        gauges.extend(laid.map_err(Faults::from)?.0);
    }
    let rows = (1..).zip(&solution.modes).zip(&solution.strain.cases);
    let modes = rows
        .map(|((mode, m), case)| ModeRow {
            mode,
            hz: m.frequency,
            generalised_mass: m.generalised_mass,
            residual: m.residual,
            frequency_error: m.frequency_error,
            gap: m.gap,
            effective_mass: m.effective_mass,
            gauge_microstrain: gauges
                .iter()
                .map(|g| gauge_reading(g, case).map(|e| e / MICROSTRAIN))
                .collect(),
        })
        .collect();
    let system = job.map(|j| j.units);
    let title = match job {
        Some(job) => job.title.clone(),
        None => read.given.clone(),
    };
    Ok(Modes {
        modes,
        support: match (support.spc, support.by_springs, support.is_held()) {
            (None, 0, false) => "free".to_owned(),
            (Some(set), ..) => format!("held by SPC set {set}"),
            (None, ..) => support.words(),
        },
        rigid_motions: solution.rigid_motions,
        gauges: gauges.into_iter().map(|g| g.name).collect(),
        mass: solution.mass.as_ref().map(|m| m.mass),
        dofs: solution.dofs,
        solution,
        title,
        model_units: system.map_or_else(StatedUnits::default, StatedUnits::of_model),
        system,
        model: read.model,
    })
}

impl Modes {
    /// Returns the modes as cases without loads, for pictures.
    pub fn cases(&self) -> Vec<LoadCase> {
        let all = self.solution.strain.cases.iter();
        all.map(|c| LoadCase {
            subcase: c.subcase,
            label: c.label.clone(),
            loads: Vec::new(),
            spc: None,
            mpc: None,
            relief: crate::fe::Relief::None,
        })
        .collect()
    }
}
