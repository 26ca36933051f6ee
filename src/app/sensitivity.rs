//! `sensitivity`: S of the job's gauges, or of its candidates where it has none.

use super::fault::Faults;
use super::job::{self, AngleStep, Job};
use super::place::allowed_sites;
use super::scene::scene_of_job;
use super::strain::{Prepared, lay_gauges, load_units, prepare, read_fields};
use super::{JobArguments, Session};
use crate::gauge::{Gauge, GaugeSpec, build};
use crate::report::strain::{sensitivity_csv, sensitivity_page};
use crate::sensitivity::{common_shells, from_cases};

/// Reads, computes, writes `sensitivity.csv` and the report.
pub fn run(arguments: &JobArguments, session: &mut Session) -> Result<(), Faults> {
    let job = session.stage("read job", |s| job::read_job(&mut s.inputs, &arguments.job))?;
    session.put_units(job.units, &job.report_units);
    let prepared = if job.gauges.is_empty() && job.sensitivity.is_none() {
        session.stage("candidates", |s| of_candidates(s, &job))?
    } else {
        prepare(session, &job)?
    };
    let s = &prepared.sensitivity;
    session.put_conditioning(s)?;
    session.put("gauges", s.gauges.len())?;
    session.put("loads", s.loads.iter().map(|l| &l.name).collect::<Vec<_>>())?;
    session.say(format!(
        "S: {} gauges x {} loads, rank {}, condition number {:.4} in job units, {:.4} scaled",
        s.gauges.len(),
        s.loads.len(),
        s.rank(),
        s.condition_number(),
        s.condition_number_scaled()
    ));
    let scene = scene_of_job(&job, &prepared);
    let page = sensitivity_page(&job.title, s, scene.as_ref(), &session.findings);
    let units: Vec<String> = load_units(
        &job,
        &s.loads.iter().map(|l| l.name.clone()).collect::<Vec<_>>(),
    )
    .into_iter()
    .map(|u| u.name)
    .collect();
    session.put("report_units_of_loads", units)?;
    let out = session.output_for(&arguments.job)?;
    out.write("sensitivity.csv", |w| sensitivity_csv(w, s))
        .map_err(Faults::from)?;
    session.write_page(&arguments.job, page)
}

/// S of every candidate: each allowed surface at each angle of the grid (every 15 degrees where the job says continuous).
fn of_candidates(session: &mut Session, job: &Job) -> Result<Prepared, Faults> {
    let fields = read_fields(session, job)?;
    let cases = fields.load_cases(job);
    let (common, findings) = common_shells(&cases);
    session.findings.extend(findings);
    let step = match job.candidates.angles {
        AngleStep::Degrees(d) => d,
        AngleStep::Continuous => 15.0,
    };
    let steps = (180.0 / step).ceil() as usize;
    let mut gauges: Vec<Gauge> = Vec::new();
    for (shell, surface) in allowed_sites(job, &fields, &common)? {
        for i in 0..steps {
            let angle = step * i as f64;
            let id = fields.model().shells.get(shell.us()).map_or(0, |s| s.id);
            let spec = GaugeSpec {
                surface: Some(surface),
                angle_rad: angle.to_radians(),
                ..GaugeSpec::on(format!("{id}.{}.{angle}", surface.word()), shell)
            };
            if let Ok((g, _)) = build(fields.model(), &spec, crate::gauge::CornerRows::Absent) {
                gauges.extend(g);
            }
        }
    }
    gauges.extend(lay_gauges(session, job, &fields)?);
    let sensitivity = from_cases(&gauges, &cases).map_err(|_| Vec::new())?;
    Ok(Prepared {
        sensitivity,
        fields: Some(fields),
        gauges: Vec::new(),
    })
}
