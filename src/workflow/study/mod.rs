//! `study`: recovery repeated under stated errors, for a range of gauge counts and layouts.

mod gauges;
mod layouts;
mod pool;

pub use gauges::{LayoutGauge, LayoutGauges, LayoutPlace};

use crate::finding::{Finding, Severity};
use crate::host::context::Context;
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::outcome::{Answer, Outcome, StatedUnits, finite_or_none};
use crate::host::words::count_of;
use crate::host::work::Work;
use crate::job::{Job, Study};
use crate::measured::runs_file::{RunRow, read_runs};
use crate::sensitivity::{Load, check_separability};
use crate::strain_chain::named_results::check_tables;
use crate::strain_chain::{Conditioning, LoadUnits, load_units};
use crate::study::{ErrorKind, StudyError, StudyRow, StudySpec, TrueLoad, study_layout};
use crate::units::{MICROSTRAIN, Quantity, number};
use serde::Serialize;

/// One line of the answer.
struct Line {
    layout: String,
    gauges: usize,
    names: Vec<String>,
    error: String,
    row: StudyRow,
}

/// Recovery repeated under stated errors.
#[derive(Serialize)]
pub struct LayoutStudy {
    /// A row for each layout, number of gauges and error.
    pub study: Vec<StudiedLayout>,
    /// Gauges of each layout. Random layouts have no list.
    pub layouts: Vec<LayoutGauges>,
    /// Rank and condition numbers of the gauges that the job has.
    #[serde(flatten)]
    pub conditioning: Option<Conditioning>,
    /// The job.
    #[serde(skip)]
    pub job: Job,
}

impl Answer for LayoutStudy {
    const COMMAND: &'static str = "study";
    const RESULT: &'static str = "The study";

    fn verdict(&self) -> String {
        let rows = || {
            let all = self.study.iter();
            all.filter_map(|r| Some((r.mean_relative_rms?, r)))
        };
        let best = rows().min_by(|a, b| a.0.total_cmp(&b.0));
        let worst = rows().max_by(|a, b| a.0.total_cmp(&b.0));
        let of = |(error, row): (f64, &StudiedLayout)| {
            format!(
                "{} % ({} {}, {})",
                number(100.0 * error),
                row.layout,
                count_of(row.gauges, "gauge"),
                row.error
            )
        };
        match (best, worst) {
            (Some(best), Some(worst)) if !std::ptr::eq(best.1, worst.1) => format!(
                "Mean error of the loads from {} to {}.",
                of(best),
                of(worst)
            ),
            (Some(one), _) => format!("Mean error of the loads {}.", of(one)),
            _ => "No layout determines the loads.".to_owned(),
        }
    }
}

/// A layout under one error.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StudiedLayout {
    /// Layout that was studied.
    pub layout: String,
    /// Number of gauges.
    pub gauges: usize,
    /// Names of the gauges; empty for random layouts.
    pub names: Vec<String>,
    /// Kind and size of the error.
    pub error: String,
    /// Condition number of S in strain per job unit.
    pub condition_number: Option<f64>,
    /// Mean over the wanted loads of `relative_rms`.
    pub mean_relative_rms: Option<f64>,
    /// Result for each load.
    pub loads: Vec<StudiedLoad>,
}

/// A load under one error.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StudiedLoad {
    /// Load.
    pub name: String,
    /// Mean error, report units.
    pub bias: Option<f64>,
    /// Standard deviation of the error, report units.
    pub sigma: Option<f64>,
    /// Root mean square error over the true size.
    pub relative_rms: Option<f64>,
    /// Share of the trials whose 95 % interval held the truth.
    pub coverage: Option<f64>,
    /// Report unit.
    pub unit: String,
    /// Whether the load is wanted as a result.
    #[serde(skip)]
    pub wanted: bool,
}

/// Repeats the recovery of loads under stated errors, for several gauge counts and layouts. The seed of the job fixes all random numbers.
///
/// # Errors
/// Returns every fault of the job and of the files that it names, or loads of unknown size.
///
/// # Example
/// A gauge for each load: noise of 1 microstrain at 0.1 microstrain per newton scatters a load by 10 N.
/// ```
/// use strainbridge::host::context::InMemory;
/// use strainbridge::{Context, Job, study};
///
/// const JOB: &str = r#"
/// units = "m-kg-s"
/// load = [{ name = "left", expected = 100.0 }, { name = "right", expected = 100.0 }]
/// sensitivity = { file = "s.csv" }
/// measured = { strain = "strain.csv", noise_microstrain = 1.0 }
/// study = { layouts = ["given"], trials = 400, errors = [{ kind = "absolute-normal", size = 1.0 }] }
/// "#;
/// let files = InMemory::default()
///     .with_file("job.toml", JOB)
///     .with_file("s.csv", "gauge,left,right\nG1,0.1,0.0\nG2,0.0,0.1\n")
///     .with_file("strain.csv", "run,G1,G2\nR1,10,10\n");
/// let found = study(&Job::read("job.toml", &files)?, &Context::new(&files))?;
/// for load in &found.study[0].loads {
///     // The standard deviation of 400 trials errs by 3.5 %, one standard deviation.
///     assert!((load.sigma.unwrap() / 10.0 - 1.0).abs() < 0.14);
/// }
/// # Ok::<(), strainbridge::Faults>(())
/// ```
pub fn study(job: &Job, cx: &Context) -> Result<Outcome<LayoutStudy>, Faults> {
    let mut work = Work::of_job(cx, job);
    let job = &job.without_validation_gauges()?;
    let Some(study) = &job.study else {
        return Err(Faults::from(Fault::new(
            &*job.file,
            "study",
            "the job has no [study]",
            "state it: [study] layouts = [\"given\", \"D\"], gauges = [8, 10], errors = [{ kind = \"relative-uniform\", size = 0.1 }]",
        )));
    };
    let errors = errors(job, study)?;
    check_tables(&work, job)?;
    let prepared = pool::prepare(&mut work, job)?;
    let loads = &prepared.loads;
    let names: Vec<String> = loads.iter().map(|l| l.name.clone()).collect();
    let units = load_units(job, &names);
    let truth = truth(&mut work, job, study, loads)?;
    let spec = StudySpec {
        truth: truth.clone(),
        prior: loads
            .iter()
            .map(|l| if l.wanted { None } else { l.expected })
            .collect(),
        sizes: loads.iter().map(|l| l.expected).collect(),
        noise: MICROSTRAIN
            * job
                .measured
                .as_ref()
                .map_or(job.placement.noise_microstrain, |m| m.noise_microstrain),
        trials: study.trials,
        seed: study.seed,
    };
    if let Some(l) = loads.iter().find(|l| !l.wanted && l.expected.is_none()) {
        return Err(Faults::from(Fault::new(
            &*job.file,
            "load.expected",
            format!("nuisance load `{}` has no size", l.name),
            "state `expected`, its standard deviation: every trial draws a random value",
        )));
    }
    let layouts = layouts::build_layouts(&mut work, job, study, &prepared)?;
    let mut lines: Vec<Line> = Vec::new();
    work.stage("repeat", |w| -> Result<(), Faults> {
        w.cx.progress.parts(layouts.len() * errors.len());
        for l in &layouts {
            for (error, word) in &errors {
                w.go_on()?;
                lines.push(Line {
                    layout: l.name.clone(),
                    gauges: l.gauges,
                    names: l.chosen_gauges().into_iter().map(|g| g.name).collect(),
                    error: word.clone(),
                    row: study_layout(&l.pool.gauges, &l.members, *error, &spec),
                });
                w.cx.progress.advance(1);
            }
        }
        Ok(())
    })?;
    if let Some(s) = &prepared.installed {
        work.findings
            .extend(check_separability(&s.without_prior_loads()));
    }
    findings(&mut work, &lines, loads);
    let rows = lines
        .iter()
        .map(|line| summarise_layout(line, loads, &units, &truth));
    let answer = LayoutStudy {
        study: rows.collect(),
        layouts: layouts
            .iter()
            .filter(|l| l.name != "random")
            .map(|l| LayoutGauges {
                layout: l.name.clone(),
                gauges: l.gauges,
                chosen: l.chosen_gauges(),
            })
            .collect(),
        conditioning: prepared
            .installed
            .as_ref()
            .map(Conditioning::from_sensitivity),
        job: job.clone(),
    };
    Ok(work.finish(
        StatedUnits::from_units(job.units, &job.report_units),
        answer,
    ))
}

fn errors(job: &Job, study: &Study) -> Result<Vec<(StudyError, String)>, Faults> {
    if study.errors.is_empty() {
        let size = job.placement.noise_microstrain;
        let error = StudyError {
            kind: ErrorKind::AbsoluteNormal,
            size,
        };
        return Ok(vec![(error, format!("absolute-normal {size}"))]);
    }
    let known: Vec<&str> = ErrorKind::ALL.iter().map(|k| k.word()).collect();
    let mut faults = FaultList::new();
    let mut out = Vec::new();
    for (word, size) in &study.errors {
        match ErrorKind::from_word(word) {
            Some(kind) => out.push((
                StudyError { kind, size: *size },
                format!("{} {size}", kind.word()),
            )),
            None => faults.push(Fault::with_line(
                &*job.file,
                study.line,
                "study.errors.kind",
                format!("`{word}` is not a kind of error"),
                format!("write one of {}", known.join(", ")),
            )),
        }
    }
    Faults::check(faults)?;
    Ok(out)
}

/// Returns the true loads. They are the loads of the first run in the runs file that has all wanted loads. Without such a run, they are drawn in
/// every trial with `expected` as standard deviation. Nuisance loads are always drawn.
fn truth(
    work: &mut Work,
    job: &Job,
    study: &Study,
    loads: &[Load],
) -> Result<Vec<TrueLoad>, Faults> {
    let drawn = |l: &Load| TrueLoad::Drawn(l.expected.unwrap_or(0.0));
    if let Some(runs) = &job.runs {
        let rows = read_runs(&mut work.inputs, job, runs)?;
        let (n, nm) = (
            job.units.si(Quantity::Force),
            job.units.si(Quantity::Moment),
        );
        let of = |row: &RunRow| -> Option<Vec<f64>> {
            loads
                .iter()
                .map(|l| {
                    let si = row.loads_si.get(&l.name).copied();
                    let stated = job.loads.iter().find(|j| j.name == l.name);
                    let moment = stated
                        .and_then(|j| j.report_unit(&job.report_units))
                        .is_some_and(|u| u.quantity == Quantity::Moment);
                    match (si, l.wanted) {
                        (Some(v), _) => Some(v / if moment { nm } else { n }),
                        (None, false) => Some(0.0),
                        (None, true) => None,
                    }
                })
                .collect()
        };
        if let Some((run, values)) = rows.iter().find_map(|r| of(r).map(|v| (r.run.clone(), v))) {
            work.findings.push(Finding::new(
                Severity::Info,
                "true-loads",
                &run,
                format!("the loads of run `{run}` are used as true loads"),
                "",
            ));
            let known = loads.iter().zip(values).map(|(l, f)| match l.wanted {
                true => TrueLoad::Known(f),
                false => drawn(l),
            });
            return Ok(known.collect());
        }
    }
    let without: Vec<&str> = loads
        .iter()
        .filter(|l| l.wanted && l.expected.is_none())
        .map(|l| l.name.as_str())
        .collect();
    if without.is_empty() {
        work.findings.push(Finding::new(
            Severity::Info,
            "true-loads",
            "load.expected",
            "no run states all loads: in every trial each load is drawn, normal with mean 0 and standard deviation `expected`",
            "",
        ));
        return Ok(loads.iter().map(drawn).collect());
    }
    Err(Faults::from(Fault::with_line(
        &*job.file,
        study.line,
        "load.expected",
        format!("the sizes of {} are not stated", without.join(", ")),
        "state `expected` of every load, or a runs file with them",
    )))
}

/// Returns the root mean square error of a load over its true size.
fn relative_rms(row: &StudyRow, truth: &[TrueLoad], l: usize) -> f64 {
    row.bias[l].hypot(row.sigma[l]) / truth[l].size()
}

fn mean_relative(row: &StudyRow, truth: &[TrueLoad], loads: &[Load]) -> f64 {
    let all: Vec<f64> = (0..loads.len())
        .filter(|l| loads[*l].wanted && truth[*l].size() != 0.0)
        .map(|l| relative_rms(row, truth, l))
        .collect();
    all.iter().sum::<f64>() / all.len().max(1) as f64
}

fn findings(work: &mut Work, lines: &[Line], loads: &[Load]) {
    for line in lines {
        if line.row.sigma.iter().all(|s| s.is_nan()) {
            work.findings.push(Finding::new(
                Severity::Warning,
                "layout-singular",
                format!("{} {}", line.layout, line.gauges),
                format!(
                    "none of these layouts separates the {} loads: the study has no result",
                    loads.len()
                ),
                "ask for more gauges than loads",
            ));
        } else if line.row.singular > 0 {
            work.findings.push(
                Finding::new(
                    Severity::Info,
                    "layouts-singular",
                    format!("{} {}", line.layout, line.gauges),
                    "some layouts do not separate the loads and are left out",
                    "ask for more gauges than loads",
                )
                .with_numbers(line.row.singular as f64, 0.0),
            );
        }
    }
    let bars: Vec<&Line> = lines
        .iter()
        .filter(|l| l.error.starts_with("position") && l.row.sigma.iter().all(|s| *s == 0.0))
        .collect();
    if !bars.is_empty() {
        work.findings.push(Finding::new(
            Severity::Warning,
            "place-without-effect",
            "position",
            "the job gives S, or the gauges are on bars. The gradient of the strain is unknown, and position errors have no effect here",
            "give a [model] with shells",
        ));
    }
}

fn summarise_layout(
    line: &Line,
    loads: &[Load],
    units: &[LoadUnits],
    truth: &[TrueLoad],
) -> StudiedLayout {
    let by_load = (0..loads.len()).map(|l| StudiedLoad {
        name: loads[l].name.clone(),
        bias: finite_or_none(line.row.bias[l] * units[l].factor),
        sigma: finite_or_none(line.row.sigma[l] * units[l].factor),
        relative_rms: finite_or_none(relative_rms(&line.row, truth, l)),
        coverage: finite_or_none(line.row.coverage[l]),
        unit: units[l].name.clone(),
        wanted: loads[l].wanted,
    });
    StudiedLayout {
        layout: line.layout.clone(),
        gauges: line.gauges,
        names: line.names.clone(),
        error: line.error.clone(),
        condition_number: finite_or_none(line.row.condition_number),
        mean_relative_rms: finite_or_none(mean_relative(&line.row, truth, loads)),
        loads: by_load.collect(),
    }
}
