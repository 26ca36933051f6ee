//! Inputs of placing: the job resolved on its model.

use super::pool::column_order;
use super::region::StrictRule;
use super::spots::LaidSpot;
use crate::finding::{Finding, Severity};
use crate::gauge::{Bridge, Gauge, gauge_reading};
use crate::host::fault::{Fault, Faults};
use crate::host::work::Work;
use crate::job::{Job, Keep, LoadRole, Optimality};
use crate::linalg::spd;
use crate::model::Vec3;
use crate::placement::region::clear_of;
use crate::placement::sites::{Site, bridge_strain};
use crate::placement::{Criterion, PlaceError, Spec};
use crate::sensitivity::{LoadCaseOf, Sensitivity};
use crate::strain_chain::{Fields, lay_gauges, left_in_reading, without_strain};
use crate::units::MICROSTRAIN;

/// Task of `place`: the job with its model and its candidates.
pub(super) struct Task<'a> {
    pub job: &'a Job,
    pub fields: &'a Fields,
    /// Loads in job order.
    pub cases: Vec<LoadCaseOf<'a>>,
    /// Mesh errors of the loads. Empty if they are not known.
    pub errors: Vec<LoadCaseOf<'a>>,
    /// Column scales in job order.
    pub scales: Vec<f64>,
    /// Job index of each column of the candidates.
    pub order: Vec<usize>,
    /// Sites where gauges can go.
    pub sites: Vec<Site>,
    /// Named spots to choose from, if the job states a table of them. `sites` are then the sites of spots on shells.
    pub spots: Option<Vec<LaidSpot>>,
    /// Rule of `[candidates]` that excludes the most shells.
    pub strict: Option<StrictRule>,
    /// Gauges that stay.
    pub kept: Vec<Gauge>,
    /// Rows of these gauges, columns in the candidates' order, made independent and of unit variance.
    pub kept_rows: Vec<Vec<f64>>,
    /// Rows of these gauges with the weights of `recover`: without the gauge factor's tolerance.
    pub kept_recovered: Vec<Vec<f64>>,
    /// The S of `[sensitivity]`.
    pub given: Option<Sensitivity>,
}

impl<'a> Task<'a> {
    /// Returns the loads in the order of the candidates, with their scales.
    pub fn nuisance_first(&self) -> (Vec<LoadCaseOf<'a>>, Vec<f64>) {
        self.order
            .iter()
            .map(|&l| (self.cases[l].clone(), self.scales[l]))
            .unzip()
    }

    /// Returns the mesh errors in the candidates' order.
    pub fn errors_nuisance_first(&self) -> Vec<LoadCaseOf<'a>> {
        let order = self.order.iter();
        order.filter_map(|&l| self.errors.get(l).cloned()).collect()
    }

    /// Returns the noise of a gauge including its possible remaining mesh error, microstrain, 1 sd.
    pub fn with_mesh_error(&self, gauge: &Gauge, noise: f64) -> f64 {
        let strain = (self.cases.as_slice(), self.errors.as_slice());
        noise.hypot(left_in_reading(gauge, strain, &self.scales) / MICROSTRAIN)
    }

    /// Places the gauges that stay installed, and removes the sites that are too close to them.
    ///
    /// # Errors
    /// Names that are no gauge's, gauges that can't be laid, gauges without strain.
    pub fn keep(&mut self, work: &mut Work) -> Result<(), Faults> {
        let p = &self.job.placement;
        if p.keep == Keep::None {
            return Ok(());
        }
        let mut laid = lay_gauges(work, self.job, self.fields)?;
        if let Keep::Named(names) = &p.keep {
            let own = |g: &Gauge, n: &String| g.name == *n || g.name.starts_with(&format!("{n}."));
            for n in names {
                if !laid.iter().any(|g| own(g, n)) {
                    return Err(Faults::from(Fault::with_line(
                        &*self.job.file,
                        p.line,
                        "placement.keep",
                        format!("the job has no gauge `{n}`"),
                        "name gauges of the job, or write \"all\"",
                    )));
                }
            }
            laid.retain(|g| names.iter().any(|n| own(g, n)));
        }
        let rel = p.model_uncertainty_rel.hypot(p.gauge_factor_rel);
        let s = self
            .s_of(&laid)
            .map_err(|missing| without_strain(self.job, &missing))?;
        self.kept_rows = self.rows_of(&laid, &s, rel, &[]).over_sd;
        self.kept_recovered = self
            .rows_of(&laid, &s, p.model_uncertainty_rel, &[])
            .over_sd;
        let points: Vec<_> = laid.iter().map(|g| [g.position, g.position]).collect();
        let here: Vec<Vec3> = self
            .sites
            .iter()
            .map(|&s| position(self.fields, s).unwrap_or_default())
            .collect();
        let mut flags = clear_of(&here, &points, p.spacing).into_iter();
        self.sites.retain(|_| flags.next().unwrap_or(false));
        if let Some(spots) = &mut self.spots {
            spots.retain(|s| s.is_clear_of(&points, p.spacing));
        }
        self.kept = laid;
        Ok(())
    }

    /// Returns the specification: number of gauges, criterion, and prior information on the loads.
    pub fn spec(&self, work: &mut Work) -> Spec {
        let (job, k) = (self.job, self.cases.len());
        let gauges = job.placement.gauges.unwrap_or_else(|| {
            if job.placement.budget.is_some() {
                return 2 * k;
            }
            work.findings.push(Finding::new(
                Severity::Info,
                "gauges-assumed",
                "placement.gauges",
                format!(
                    "the job does not state the number of gauges: twice the number of loads are placed, {}",
                    2 * k
                ),
                "state [placement] gauges",
            ));
            2 * k
        });
        let mut spec = Spec::new(gauges, k);
        spec.spacing = job.placement.spacing;
        spec.effort.seed = job.placement.seed;
        spec.loss = job.placement.loss;
        spec.stop = work.cx.progress.stop();
        spec.proof = if job.placement.proof { PROOF } else { 0.0 };
        spec.criterion = self.criterion();
        for (l, &from) in self.order.iter().enumerate() {
            // The prior information on a load is its expected size, which is 1 in these columns.
            let load = &job.loads[from];
            let nuisance = load.role == LoadRole::Nuisance && load.expected.is_some();
            if nuisance || job.placement.criterion == Optimality::BayesianD {
                spec.prior[l * k + l] = 1.0;
            }
        }
        for row in &self.kept_rows {
            spd::add_outer(&mut spec.prior, row, 1.0);
        }
        spec
    }

    /// Returns the prior information on the loads without the gauges that stay.
    pub fn without_kept(&self, spec: &Spec) -> Vec<f64> {
        let mut prior = spec.prior.clone();
        for row in &self.kept_rows {
            spd::add_outer(&mut prior, row, -1.0);
        }
        prior
    }

    fn criterion(&self) -> Criterion {
        let k = self.cases.len();
        let loads = &self.job.loads;
        match self.job.placement.criterion {
            Optimality::D | Optimality::BayesianD | Optimality::Condition => Criterion::D,
            Optimality::Ds => Criterion::Ds(
                loads
                    .iter()
                    .filter(|l| l.role == LoadRole::Nuisance)
                    .count(),
            ),
            Optimality::A => {
                let mut l = vec![0.0; k * k];
                for (c, &from) in self.order.iter().enumerate() {
                    if loads[from].role == LoadRole::Wanted {
                        l[c * k + c] = loads[from].weight;
                    }
                }
                Criterion::Linear(l)
            }
            Optimality::I => Criterion::Linear(self.mean_strain()),
        }
    }

    /// Returns the mean over the sites of the product of strain tensors by pairs of loads, microstrain squared. Criterion I weights the variances
    /// with it.
    fn mean_strain(&self) -> Vec<f64> {
        let (ordered, scales) = self.nuisance_first();
        let k = ordered.len();
        let mut l = vec![0.0; k * k];
        for &site in &self.sites {
            let tensors: Vec<[f64; 3]> = ordered
                .iter()
                .zip(&scales)
                .map(|(c, f)| {
                    let t = bridge_strain(Bridge::Quarter, c.case, site).unwrap_or_default();
                    // The square of the tensor contains 2 (g/2)^2 of the engineering shear g.
                    [t[0], t[1], t[2] / std::f64::consts::SQRT_2]
                        .map(|v| v * f / c.applied / MICROSTRAIN)
                })
                .collect();
            for c in 0..3 {
                let row: Vec<f64> = tensors.iter().map(|t| t[c]).collect();
                spd::add_outer(&mut l, &row, 1.0 / self.sites.len() as f64);
            }
        }
        l
    }

    /// Returns the refusal of a placement as a fault of the job.
    pub fn refusal(&self, e: &PlaceError) -> Fault {
        let (mut wrong, mut remedy) = e.parts();
        let too_few = !matches!(e, PlaceError::Singular { .. });
        if let Some(strict) = self.strict.as_ref().filter(|c| too_few && c.takes_most()) {
            wrong = format!("{wrong}: {}", strict.words());
            remedy = format!("widen or delete {} first; else {remedy}", strict.rule);
        }
        if let (PlaceError::TooFewPlaces { .. }, Some(file)) = (e, &self.job.candidates.file)
            && self.spots.is_some()
        {
            remedy = format!("ask for fewer, or add spots to `{}`", file.given);
        }
        let line = self.job.placement.line;
        Fault::with_line(&*self.job.file, line, "placement", wrong, remedy)
    }
}

/// Operations that a proof may take: a second or two.
const PROOF: f64 = 1e10;

/// Returns the position of a site.
pub(super) fn position(fields: &Fields, (shell, side): Site) -> Option<Vec3> {
    use crate::fe::shell_frame::{ShellPlace, shell_axes};
    let model = fields.model();
    let s = model.shells.get(shell.us())?;
    let z = shell_axes(model, s, ShellPlace::Centre)?.row(2).transpose();
    Some(crate::gauge::centre(model, s)? + z * crate::gauge::to_side(model, s, side))
}

/// Adds prior information if no layout separates the loads: each load has its expected size (1 in these columns). Adds the finding that the
/// measurement alone does not determine the loads.
pub(super) fn know_the_loads(work: &mut Work, spec: &mut Spec, gauges: usize, loads: usize) {
    for l in 0..loads {
        if let Some(p) = spec.prior.get_mut(l * loads + l) {
            *p = p.max(1.0);
        }
    }
    work.findings.push(
        Finding::new(
            Severity::Error,
            "loads-not-separable",
            "placement",
            format!(
                "no {gauges} gauges among these candidates separate the {loads} loads: layout and sigmas assume that loads are known \
                 beforehand to their expected size"
            ),
            format!("ask for at least {loads} gauges, drop loads with the same effect, or widen [candidates]"),
        )
        .with_numbers(gauges as f64, loads as f64),
    );
}

/// Builds the task. Scales and cases are in the order of the columns, nuisance loads first.
pub(super) fn task<'a>(
    job: &'a Job,
    fields: &'a Fields,
    cases: Vec<LoadCaseOf<'a>>,
    scales: Vec<f64>,
    sites: Vec<Site>,
    given: Option<Sensitivity>,
) -> Task<'a> {
    Task {
        job,
        fields,
        cases,
        errors: fields.mesh_cases(job),
        scales,
        order: column_order(job),
        sites,
        spots: None,
        strict: None,
        kept: Vec::new(),
        kept_rows: Vec::new(),
        kept_recovered: Vec::new(),
        given,
    }
}

/// Returns the reading of a gauge under each load of its expected size, microstrain, job order.
pub(super) fn by_load(task: &Task, gauge: &Gauge) -> Vec<f64> {
    task.cases
        .iter()
        .zip(&task.scales)
        .map(|(c, f)| gauge_reading(gauge, c.case).unwrap_or(0.0) * f / c.applied / MICROSTRAIN)
        .collect()
}
