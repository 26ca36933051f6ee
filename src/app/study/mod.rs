//! `study`: recovery repeated under stated errors, for a range of gauge counts and layouts.

mod layouts;
mod pool;

use super::fault::{Fault, FaultList, Faults};
use super::job::runs::read_runs;
use super::job::{self, Job, Role, Study};
use super::strain::{LoadUnits, load_units};
use super::{JobArguments, Session};
use crate::finding::{Finding, Severity};
use crate::report::csv_cell;
use crate::report::page::{Page, number, table_section};
use crate::sensitivity::Load;
use crate::study::{ErrorKind, StudyError, StudyRow, StudySpec, study_layout};
use crate::units::Quantity;
use serde_json::{Value, json};

/// Strain in one microstrain.
const MICRO: f64 = 1e-6;
/// Random layouts that the trials are dealt over.
const RANDOM_LAYOUTS: usize = 50;

/// One line of the answer.
struct Line {
    layout: String,
    gauges: usize,
    error: String,
    row: StudyRow,
}

/// Reads, repeats, writes.
pub fn run(arguments: &JobArguments, session: &mut Session) -> Result<(), Faults> {
    let job = session.stage("read job", |s| job::read_job(&mut s.inputs, &arguments.job))?;
    session.put_units(job.units, &job.report_units);
    let Some(study) = &job.study else {
        return Err(Faults::from(Fault::of(
            &*job.file,
            "study",
            "the job has no [study]",
            "state it: [study] layouts = [\"given\", \"D\"], gauges = [8, 10], errors = [{ kind = \"relative-uniform\", size = 0.1 }]",
        )));
    };
    let errors = errors(&job, study)?;
    let prepared = pool::prepare(session, &job, study)?;
    let loads = &prepared.loads;
    let names: Vec<String> = loads.iter().map(|l| l.name.clone()).collect();
    let units = load_units(&job, &names);
    let truth = truth(session, &job, study, loads)?;
    let spec = StudySpec {
        truth: truth.clone(),
        prior: loads
            .iter()
            .map(|l| if l.wanted { None } else { l.expected })
            .collect(),
        noise: MICRO
            * job
                .measured
                .as_ref()
                .map_or(job.placement.noise_microstrain, |m| m.noise_microstrain),
        trials: study.trials,
        seed: study.seed,
    };
    if let Some(l) = loads.iter().find(|l| !l.wanted && l.expected.is_none()) {
        return Err(Faults::from(Fault::of(
            &*job.file,
            "load.expected",
            format!("nuisance load `{}` has no size", l.name),
            "state `expected`, its standard deviation: it is drawn in every trial",
        )));
    }
    let layouts = layouts::of(session, &job, study, &prepared)?;
    let mut lines: Vec<Line> = Vec::new();
    session.stage("repeat", |_| {
        for l in &layouts {
            for (error, word) in &errors {
                lines.push(Line {
                    layout: l.name.clone(),
                    gauges: l.gauges,
                    error: word.clone(),
                    row: study_layout(&l.pool, &l.members, *error, &spec),
                });
            }
        }
    });
    if let Some(s) = &prepared.installed {
        session.put_conditioning(s)?;
    }
    findings(session, &lines, loads);
    put(session, &lines, loads, &units, &truth)?;
    write(
        session, arguments, &job, study, &lines, loads, &units, &truth,
    )
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
            None => faults.push(Fault::at(
                &*job.file,
                study.line,
                "study.errors.kind",
                format!("`{word}` is no kind of error"),
                format!("write one of {}", known.join(", ")),
            )),
        }
    }
    Faults::check(faults)?;
    Ok(out)
}

/// True loads: those of the first run of the runs file that has all wanted ones, else their expected sizes.
fn truth(
    session: &mut Session,
    job: &Job,
    study: &Study,
    loads: &[Load],
) -> Result<Vec<f64>, Faults> {
    if let Some(runs) = &job.runs {
        let rows = read_runs(&mut session.inputs, job, runs)?;
        let (n, nm) = (
            job.units.si(Quantity::Force),
            job.units.si(Quantity::Moment),
        );
        let of = |row: &job::runs::RunRow| -> Option<Vec<f64>> {
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
            session.findings.push(Finding::new(
                Severity::Info,
                "true-loads",
                &run,
                format!("the loads of run `{run}` are taken as true"),
                "",
            ));
            return Ok(values);
        }
    }
    let without: Vec<&str> = loads
        .iter()
        .filter(|l| l.wanted && l.expected.is_none())
        .map(|l| l.name.as_str())
        .collect();
    if without.is_empty() {
        return Ok(loads.iter().map(|l| l.expected.unwrap_or(0.0)).collect());
    }
    Err(Faults::from(Fault::at(
        &*job.file,
        study.line,
        "load.expected",
        format!("nothing says how large {} are", without.join(", ")),
        "state `expected` of every load, or a runs file with them",
    )))
}

/// Root mean square error of a load over its true size.
fn relative(row: &StudyRow, truth: &[f64], l: usize) -> f64 {
    row.bias[l].hypot(row.sigma[l]) / truth[l].abs()
}

fn mean_relative(row: &StudyRow, truth: &[f64], loads: &[Load]) -> f64 {
    let all: Vec<f64> = (0..loads.len())
        .filter(|l| loads[*l].wanted && truth[*l] != 0.0)
        .map(|l| relative(row, truth, l))
        .collect();
    all.iter().sum::<f64>() / all.len().max(1) as f64
}

fn findings(session: &mut Session, lines: &[Line], loads: &[Load]) {
    for line in lines {
        if line.row.sigma.iter().all(|s| s.is_nan()) {
            session.findings.push(Finding::new(
                Severity::Warning,
                "layout-singular",
                format!("{} {}", line.layout, line.gauges),
                format!(
                    "none of these layouts separates the {} loads: there is no answer to study",
                    loads.len()
                ),
                "ask for more gauges than loads",
            ));
        } else if line.row.singular > 0 {
            session.findings.push(
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
        session.findings.push(Finding::new(
            Severity::Warning,
            "place-without-effect",
            "position",
            "S is given, or the gauges sit on bars: nothing tells how strain changes with place, and errors of place do nothing here",
            "give a [model] with shells",
        ));
    }
}

fn finite(v: f64) -> Option<f64> {
    v.is_finite().then_some(v)
}

fn put(
    session: &mut Session,
    lines: &[Line],
    loads: &[Load],
    units: &[LoadUnits],
    truth: &[f64],
) -> Result<(), Faults> {
    let rows: Vec<Value> = lines
        .iter()
        .map(|line| {
            let by_load: Vec<Value> = (0..loads.len())
                .map(|l| {
                    json!({
                        "name": loads[l].name,
                        "bias": finite(line.row.bias[l] * units[l].factor),
                        "sigma": finite(line.row.sigma[l] * units[l].factor),
                        "relative_rms": finite(relative(&line.row, truth, l)),
                        "coverage": finite(line.row.coverage[l]),
                        "unit": units[l].name,
                    })
                })
                .collect();
            json!({
                "layout": line.layout,
                "gauges": line.gauges,
                "error": line.error,
                "condition_number": finite(line.row.condition_number),
                "mean_relative_rms": finite(mean_relative(&line.row, truth, loads)),
                "loads": by_load,
            })
        })
        .collect();
    session.put("study", rows)
}

#[allow(clippy::too_many_arguments)]
fn write(
    session: &mut Session,
    arguments: &JobArguments,
    job: &Job,
    study: &Study,
    lines: &[Line],
    loads: &[Load],
    units: &[LoadUnits],
    truth: &[f64],
) -> Result<(), Faults> {
    let wanted: Vec<usize> = (0..loads.len())
        .filter(|l| {
            job.loads
                .iter()
                .all(|j| j.name != loads[*l].name || j.role == Role::Wanted)
        })
        .collect();
    let shown: Vec<Vec<String>> = lines
        .iter()
        .map(|line| {
            let mut cells = vec![
                line.layout.clone(),
                line.gauges.to_string(),
                line.error.clone(),
                number(line.row.condition_number),
                format!(
                    "{} %",
                    number(100.0 * mean_relative(&line.row, truth, loads))
                ),
            ];
            cells.extend(wanted.iter().map(|l| {
                format!(
                    "{} ± {}",
                    number(line.row.bias[*l] * units[*l].factor),
                    number(line.row.sigma[*l] * units[*l].factor)
                )
            }));
            cells
        })
        .collect();
    for line in lines {
        session.say(format!(
            "{} {} gauges, {}: mean rms error {:.2} %, condition number {}",
            line.layout,
            line.gauges,
            line.error,
            100.0 * mean_relative(&line.row, truth, loads),
            number(line.row.condition_number)
        ));
    }
    let mut header = vec!["layout", "gauges", "error", "condition", "mean rms"];
    let heads: Vec<String> = wanted
        .iter()
        .map(|l| format!("{}, {}", loads[*l].name, units[*l].name))
        .collect();
    header.extend(heads.iter().map(String::as_str));
    let page = Page::new(
        &job.title,
        "What errors do to recovered loads",
        &session.findings,
        vec![table_section(
            &format!(
                "{} trials each, seed {}: bias ± 1 sd",
                study.trials, study.seed
            ),
            &header,
            &shown,
            "The same seed gives the same numbers on any machine and any number of threads. Layout `random`: the trials are dealt over 50 of them.",
        )],
    );
    let out = session.output_for(&arguments.job)?;
    out.write("study.csv", |w| {
        write!(w, "layout,gauges,error,condition_number,mean_relative_rms")?;
        for l in loads {
            for what in ["bias", "sigma", "coverage"] {
                write!(w, ",{}", csv_cell(&format!("{}.{what}", l.name)))?;
            }
        }
        writeln!(w)?;
        for line in lines {
            write!(
                w,
                "{},{},{},{},{}",
                line.layout,
                line.gauges,
                line.error,
                line.row.condition_number,
                mean_relative(&line.row, truth, loads)
            )?;
            for (l, u) in units.iter().enumerate() {
                write!(
                    w,
                    ",{},{},{}",
                    line.row.bias[l] * u.factor,
                    line.row.sigma[l] * u.factor,
                    line.row.coverage[l]
                )?;
            }
            writeln!(w)?;
        }
        Ok(())
    })
    .map_err(Faults::from)?;
    session.write_page(&arguments.job, page)
}
