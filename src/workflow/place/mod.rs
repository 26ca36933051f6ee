//! `place`: gauges chosen from the candidates, in addition to the installed gauges of the job, with the certificate.

mod choose;
mod chosen_layout;
mod curve;
mod installed_gauges;
mod job_gauge_rows;
mod kept_candidates;
mod layout_findings;
mod misfits;
mod outcome;
mod plan;
mod pool;
mod region;
mod sheet;
mod spot_layout;
mod spots;
mod stated_layout;
mod task;
mod wanted_elements;

pub(super) use choose::name as placed_name;
pub use outcome::*;
pub use plan::Plan;
pub(super) use pool::{angles, column_order, scales, scatter};
pub(super) use region::allowed_sites;

use crate::finding::{Finding, Severity};
use crate::host::context::Context;
use crate::host::fault::{Fault, Faults};
use crate::host::outcome::{Outcome, finite_or_none};
use crate::host::work::Work;
use crate::job::Job;
use crate::placement::Spec;
use crate::placement::quality::{evaluate_rows, reserve};
use crate::recovery::check_planned;
use crate::sensitivity::{Sensitivity, check_separability, common_shells};
use crate::strain_chain::{
    Conditioning, Fields, GaugeMeshError, LoadSigma, coarse_at_gauges, mesh_errors, without_strain,
};
use crate::workflow::recover::list_load_columns;
use kept_candidates::KeptCandidates;
use std::sync::Arc;

/// Chooses gauges for the loads of a job from its candidates, with a certificate. If the job has installed gauges, it evaluates them as well.
///
/// # Errors
/// Returns every fault of the job and of the files that it names, or candidates that allow no layout.
///
/// # Example
/// ```
/// use strainbridge::{Context, Disk, Job, place};
///
/// let job = Job::read(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/frame/place.toml"), &Disk)?;
/// let plan = place(&job, &Context::new(&Disk))?;
/// assert_eq!(plan.gauges.len(), 12);
/// // The certificate: no layout of these candidates is better than the bound.
/// assert!(plan.log_det <= plan.upper_bound && plan.efficiency_bound <= 1.0);
/// assert!(plan.efficiency_bound > 0.8);
/// // Twelve gauges determine all six loads.
/// assert_eq!(plan.conditioning.rank, job.loads.len());
/// # Ok::<(), strainbridge::Faults>(())
/// ```
pub fn place(job: &Job, cx: &Context) -> Result<Outcome<CertifiedLayout>, Faults> {
    let mut work = Work::of_job(cx, job);
    Plan::read_into(&mut work, job)?.lay_out(work, job)
}

/// Largest number of layouts until every grid fits. Each layout leaves out the places of the previous layout where a grid does not fit.
const ROUNDS: usize = 20;

/// Resolves a job on its model: loads, places for gauges, gauges that stay.
///
/// # Errors
/// Candidates that allow no place, spots and gauges that can't be laid.
fn task_of<'a>(
    work: &mut Work,
    job: &'a Job,
    fields: &'a Fields,
) -> Result<task::Task<'a>, Faults> {
    let cases = fields.load_cases(job);
    let (common, findings) = common_shells(&cases);
    work.findings.extend(findings);
    let (sites, strict) = match &job.candidates.spots {
        Some(_) => (Vec::new(), None),
        None => region::allowed_sites_and_rule(job, fields, &common)?,
    };
    let scales = scales(work, &cases, &common);
    let given = job_gauge_rows::read_given_sensitivity(work, job)?;
    let mut task = task::task(job, fields, cases, scales, sites, given);
    task.strict = strict;
    task.lay_spots(work)?;
    task.keep(work)?;
    Ok(task)
}

/// Returns the layout on the model.
fn lay_out_gauges(
    work: &mut Work,
    job: &Job,
    fields: &Fields,
    kept: &mut KeptCandidates,
) -> Result<LayoutOf, Faults> {
    let mut task = task_of(work, job, fields)?;
    let mut spec = task.spec(work);
    let places = task.n_places();
    let (mut misfit, mut rounds): (Option<Fault>, usize) = (None, 0);
    let (kinds, chosen) = loop {
        let kinds = work.stage("candidates", |_| kinds_of(&task, kept));
        let chosen = work.stage("place", |w| choose::choose(w, &task, &kinds, &mut spec));
        work.go_on()?;
        let chosen = match (chosen, misfit.take()) {
            (Ok(chosen), _) => chosen,
            // Too few places remain.
            (Err(_), Some(misfit)) => return Err(misfit.into()),
            (Err(refused), None) => return Err(refused),
        };
        let each = chosen.channels.iter();
        let each = each.map(|c| (c.site, c.gauge.element, c.misfit.as_ref()));
        misfit = misfits::leave_out(&mut task, each, rounds < ROUNDS)?;
        if misfit.is_none() {
            break (kinds, chosen);
        }
        rounds += 1;
    };
    if task.n_places() < places {
        work.notes.push(format!(
            "{} places were chosen and left out: a grid of {} does not fit on the part there",
            places - task.n_places(),
            job.candidates.grid_length
        ));
    }
    describe_layout(work, &task, &spec, &kinds, chosen)
}

/// Returns a layout with all its reported numbers; `kinds` are the candidates that it was chosen from, empty for a stated layout.
fn describe_layout(
    work: &mut Work,
    task: &task::Task,
    spec: &Spec,
    kinds: &[pool::Kind],
    chosen: chosen_layout::ChosenLayout,
) -> Result<LayoutOf, Faults> {
    let (job, fields, k) = (task.job, task.fields, task.cases.len());
    let rows: Vec<Vec<f64>> = chosen.channels.iter().map(|c| c.row.clone()).collect();
    let Some(quality) =
        evaluate_rows(&rows, &spec.prior, k).map(|q| layout_findings::in_job_order(q, &task.order))
    else {
        let singular = crate::placement::PlaceError::Singular {
            gauges: spec.gauges,
            loads: k,
        };
        return Err(task.refusal(&singular).into());
    };
    let validation = reserve_gauges(work, task, &rows, &spec.prior)?;
    let chosen_gauges = chosen.channels.iter().map(|c| c.gauge.clone());
    let all: Vec<_> = chosen_gauges.chain(task.kept.clone()).collect();
    let s = task
        .s_of(&all)
        .map_err(|missing| without_strain(job, &missing))?;
    let mesh_error = mesh_errors(&all, &s, &task.errors);
    work.findings
        .extend(coarse_at_gauges(&all, &mesh_error, fields.mesh_left()));
    let listed = list_load_columns(job, &s)?;
    let units = &listed.units[..k];
    let gauges = sheet::list_placed_gauges(task, &chosen, &spec.prior, &quality, &validation);
    let installed = match kinds.first().filter(|_| choose::is_plain(task)) {
        Some(kind) => installed_gauges::evaluate_installed(work, task, &kind.candidates, spec)?,
        None => None,
    };
    work.findings
        .extend(check_separability(&s.without_prior_loads()));
    layout_findings::report_layout_findings(work, job, &chosen, &quality, spec, &gauges, k);
    let recovered = layout_findings::chosen_as_recovered(task, spec, &chosen.channels);
    let as_glued = layout_findings::installed_covariance(job, &quality, k);
    let load_sigma =
        layout_findings::sigma_rows(job, &listed, recovered.as_deref(), &as_glued, &task.scales);
    let in_job_units = load_sigma.iter().zip(units);
    let planned: Vec<f64> = in_job_units.map(|(l, u)| l.sigma / u.factor).collect();
    let planned = check_planned(&s, &planned);
    work.findings
        .extend(planned.map(|f| layout_findings::with_unit_loads(job, f)));
    let how_many = if job.placement.curve.is_empty() {
        Vec::new()
    } else {
        let (points, left_out) = work.stage("curve", |_| curve::curve(task, kinds, spec, &listed));
        work.go_on()?;
        work.findings
            .extend(curve::incomplete_curve_finding(&left_out));
        points
    };
    let reserved = validation.iter().map(|(i, inflation)| {
        let c = &chosen.channels[*i];
        ReservedGauge {
            name: c.gauge.name.clone(),
            prediction_sd_microstrain: c.sd * inflation,
        }
    });
    Ok(LayoutOf {
        reserved: reserved.collect(),
        candidates: Candidates {
            places: task.n_places(),
            rows: kinds.iter().map(|k| k.candidates.n_rows()).sum(),
        },
        load_sigma,
        worst_loss: WorstLoss {
            gauge: gauges[quality.worst].gauge.name.clone(),
            leverage: quality.leverage[quality.worst],
            efficiency_left: quality.worst_loss,
        },
        kept: task.kept.iter().map(|g| g.name.clone()).collect(),
        mesh_error,
        sensitivity: s,
        gauges,
        chosen,
        installed,
        how_many,
    })
}

/// Returns the candidates of every wiring, or the named spots. Candidates of an earlier layout of the same job are used again.
fn kinds_of(task: &task::Task, kept: &mut KeptCandidates) -> Arc<Vec<pool::Kind>> {
    if let Some(spots) = &task.spots {
        return Arc::new(vec![spot_layout::kind(task, spots)]);
    }
    if let Some(kinds) = kept.find_kinds(task.job, &task.sites) {
        return kinds;
    }
    let (ordered, scales) = task.nuisance_first();
    let errors = task.errors_nuisance_first();
    let angles = angles(task.job.candidates.angles);
    let strain = (ordered.as_slice(), errors.as_slice());
    let model = task.fields.model();
    let kinds = pool::kinds(task.job, model, &task.sites, strain, &scales, &angles);
    kept.store(task.job, &task.sites, kinds)
}

/// A layout before model and job are handed to the outcome.
struct LayoutOf {
    gauges: Vec<PlacedGauge>,
    candidates: Candidates,
    chosen: chosen_layout::ChosenLayout,
    kept: Vec<String>,
    mesh_error: Vec<GaugeMeshError>,
    sensitivity: Sensitivity,
    load_sigma: Vec<LoadSigma>,
    worst_loss: WorstLoss,
    reserved: Vec<ReservedGauge>,
    installed: Option<InstalledLayout>,
    how_many: Vec<CurvePoint>,
}

impl LayoutOf {
    fn into_placed(self, fields: Arc<Fields>, job: &Job) -> CertifiedLayout {
        CertifiedLayout {
            gauges: self.gauges,
            files: outcome::FILES,
            candidates: self.candidates,
            criterion: job.placement.criterion.name(),
            log_det: self.chosen.log_det,
            upper_bound: self.chosen.upper_bound,
            efficiency_bound: self.chosen.efficiency_bound,
            proved: self.chosen.proved,
            nodes: self.chosen.nodes,
            cost: self.chosen.cost,
            kept: self.kept,
            mesh_error: self.mesh_error,
            conditioning: Conditioning::from_sensitivity(&self.sensitivity),
            least_condition_number_scaled: self.chosen.least_condition.and_then(finite_or_none),
            load_sigma: self.load_sigma,
            worst_loss: self.worst_loss,
            reserved: self.reserved,
            installed: self.installed,
            how_many: self.how_many,
            sensitivity: self.sensitivity,
            fields,
            job: job.clone(),
        }
    }
}

/// Reserves gauges for validation. Returns the index of each gauge, and the standard deviation of its prediction over the standard deviation of its
/// reading.
///
/// # Errors
/// A fault if the remaining gauges would not separate the loads.
fn reserve_gauges(
    work: &mut Work,
    task: &task::Task,
    rows: &[Vec<f64>],
    prior: &[f64],
) -> Result<Vec<(usize, f64)>, Faults> {
    let n = task.job.placement.reserve;
    if n == 0 {
        return Ok(Vec::new());
    }
    let Some(found) = reserve(rows, prior, task.cases.len(), n) else {
        return Err(Faults::from(Fault::with_line(
            &*task.job.file,
            task.job.placement.line,
            "placement.reserve",
            format!(
                "{} gauges without {n} validation gauges do not separate the loads",
                rows.len()
            ),
            "reserve fewer, or place more",
        )));
    };
    work.findings.push(Finding::new(
        Severity::Info,
        "gauges-reserved",
        "placement.reserve",
        format!("{n} gauges are marked for validation: load sigmas and condition number count all gauges"),
        "keep the column `role` of gauges.csv: `recover` compares these gauges with its prediction",
    ));
    Ok(found)
}
