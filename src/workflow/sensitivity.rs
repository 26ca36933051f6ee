//! `sensitivity`: S of the job's gauges, or of its candidates where it has none.

use crate::gauge::{Gauge, GaugeSpec, build};
use crate::host::context::Context;
use crate::host::fault::Faults;
use crate::host::outcome::{Answer, Outcome, StatedUnits};
use crate::host::words::count_of;
use crate::host::work::Work;
use crate::job::{AngleStep, Job};
use crate::sensitivity::{check_separability, common_shells, from_cases};
use crate::strain_chain::named_results::check_tables;
use crate::strain_chain::{
    Conditioning, GaugeMeshError, JobSensitivity, WantedAt, lay_gauges, load_units, mesh_errors,
    prepare, read_fields, without_strain,
};
use crate::units::number;
use crate::workflow::place::allowed_sites;
use serde::Serialize;

/// S of a job's gauges or candidates.
#[derive(Serialize)]
pub struct ComputedSensitivity {
    /// Rank and condition numbers.
    #[serde(flatten)]
    pub conditioning: Conditioning,
    /// Number of gauges.
    pub gauges: usize,
    /// Names of the loads, one for each column.
    pub loads: Vec<String>,
    /// Report unit of each load.
    pub report_units_of_loads: Vec<String>,
    /// Mesh error by gauge, if the job asks for it; S is corrected for it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_error: Vec<GaugeMeshError>,
    /// S itself, with the model and the gauges from which it was computed.
    #[serde(skip)]
    pub prepared: JobSensitivity,
    /// The job.
    #[serde(skip)]
    pub job: Job,
}

impl Answer for ComputedSensitivity {
    const COMMAND: &'static str = "sensitivity";
    const RESULT: &'static str = "The sensitivities";

    fn verdict(&self) -> String {
        let c = &self.conditioning;
        let scaled = c.condition_number_scaled.map_or_else(
            || "the loads are not separable".to_owned(),
            |n| format!("scaled condition number {}", number(n)),
        );
        format!(
            "Sensitivities of {} to {}: rank {}, {scaled}.",
            count_of(self.gauges, "gauge"),
            count_of(self.loads.len(), "load"),
            c.rank
        )
    }
}

/// Computes S of the gauges of a job. Without gauges it computes S of its candidates: each allowed surface at each angle step.
///
/// # Errors
/// Returns every fault of the job and of the files that it names.
///
/// # Example
/// A gauge at the root of a cantilever, at the distance `c` above its axis, reads `-F L c / (E I)` under a tip load `F` upward:
/// ```
/// use strainbridge::host::context::InMemory;
/// use strainbridge::{Context, Job, sensitivity};
///
/// # const DECK: &str = "SOL 101\nCEND\nSPC = 1\nBEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,1000.,0.,0.\nCBAR,1,1,1,2,0.,0.,1.
/// # PBAR,1,1,600.,2.+4,8.+4,1.+4\n,10.,0.\nMAT1,1,210000.,,.3,7.85-9\nSPC1,1,123456,1\nENDDATA\n";
/// const JOB: &str = r#"
/// units = "mm-t-s"
/// model = { deck = "cantilever.bdf" }
/// load = [{ name = "tip", grid = 2, component = "FZ" }]
/// gauge = [{ name = "root", element = 1, point = "C", station = 0.0 }]
/// "#;
/// let files = InMemory::default().with_file("cantilever.bdf", DECK).with_file("job.toml", JOB);
/// let found = sensitivity(&Job::read("job.toml", &files)?, &Context::new(&files))?;
/// let s = found.prepared.sensitivity.values[(0, 0)]; // strain per newton
/// let (l, c, e, i) = (1000.0, 10.0, 210_000.0, 20_000.0);
/// assert!((s / (-l * c / (e * i)) - 1.0).abs() < 1e-9);
/// # Ok::<(), strainbridge::Faults>(())
/// ```
pub fn sensitivity(job: &Job, cx: &Context) -> Result<Outcome<ComputedSensitivity>, Faults> {
    let mut work = Work::of_job(cx, job);
    check_tables(&work, job)?;
    let prepared = prepare_sensitivity(&mut work, job)?;
    let s = &prepared.sensitivity;
    let loads: Vec<String> = s.loads.iter().map(|l| l.name.clone()).collect();
    let units = load_units(job, &loads).into_iter().map(|u| u.name);
    let answer = ComputedSensitivity {
        conditioning: Conditioning::from_sensitivity(s),
        gauges: s.gauges.len(),
        report_units_of_loads: units.collect(),
        loads,
        mesh_error: prepared.mesh_error.clone(),
        prepared,
        job: job.clone(),
    };
    Ok(work.finish(
        StatedUnits::from_units(job.units, &job.report_units),
        answer,
    ))
}

/// Returns S of a job's gauges, or of its candidates if it has neither gauges nor a given S. Adds findings on the separability of the loads to the
/// work.
///
/// # Errors
/// Every fault of the job and of the files it names.
pub(crate) fn prepare_sensitivity(work: &mut Work, job: &Job) -> Result<JobSensitivity, Faults> {
    let prepared = if job.gauges.is_empty() && job.sensitivity.is_none() {
        match job.with_spots_as_gauges() {
            Some(as_gauges) => prepare(work, &as_gauges)?,
            None => work.stage("candidates", |w| of_candidates(w, job))?,
        }
    } else {
        prepare(work, job)?
    };
    work.findings.extend(check_separability(
        &prepared.sensitivity.without_prior_loads(),
    ));
    Ok(prepared)
}

/// Returns S of every candidate: each allowed surface at each angle of the grid (every 15 degrees if the job asks for continuous angles).
fn of_candidates(work: &mut Work, job: &Job) -> Result<JobSensitivity, Faults> {
    let fields = read_fields(work, job, WantedAt::Anywhere)?;
    let job = &job.with_property_ids(&fields.model().property_names)?;
    let cases = fields.load_cases(job);
    let (common, findings) = common_shells(&cases);
    work.findings.extend(findings);
    let step = match job.candidates.angles {
        AngleStep::Degrees(d) => d,
        AngleStep::Continuous => 15.0,
    };
    let steps = (180.0 / step).ceil() as usize;
    let corners = fields.corner_rows(job);
    let (mut gauges, mut left_out): (Vec<Gauge>, usize) = (Vec::new(), 0);
    for (shell, surface) in allowed_sites(job, &fields, &common)? {
        for i in 0..steps {
            let angle = step * i as f64;
            let id = fields.model().shells.get(shell.us()).map_or(0, |s| s.id);
            let spec = GaugeSpec {
                surface: Some(surface),
                angle_rad: angle.to_radians(),
                grid_length: job.candidates.grid_length,
                ..GaugeSpec::place_on_shell(format!("{id}.{}.{angle}", surface.word()), shell)
            };
            match build(fields.model(), &spec, corners) {
                Ok((g, _)) => gauges.extend(g),
                Err(_) => left_out += 1,
            }
        }
    }
    if left_out > 0 {
        work.notes.push(format!(
            "{left_out} candidates are left out: the part is shorter than `grid_length` there, or the element has no area"
        ));
    }
    gauges.extend(lay_gauges(work, job, &fields)?);
    let sensitivity =
        from_cases(&gauges, &cases).map_err(|missing| without_strain(job, &missing))?;
    let mesh_error = mesh_errors(&gauges, &sensitivity, &fields.mesh_cases(job));
    Ok(JobSensitivity {
        sensitivity,
        fields: Some(fields),
        gauges: Vec::new(),
        mesh_error,
    })
}
