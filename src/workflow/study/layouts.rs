//! Layouts of a study: the gauges given, random ones, the best ones.

use super::gauges::LayoutGauge;
use super::pool::{Pool, StudyInputs, on_model};
use crate::finding::{Finding, Severity, list_few};
use crate::gauge::GaugeSpec;
use crate::host::fault::{Fault, Faults};
use crate::host::work::Work;
use crate::job::{Job, LoadRole, Optimality, Study};
use crate::placement::candidates::{Angles, Candidates, Choice, Scatter};
use crate::placement::sites::{Site, candidates};
use crate::placement::{self, PlaceError, Spec, place};
use crate::sensitivity::{LoadCaseOf, common_shells};
use crate::study::PoolGauge;
use crate::workflow::place::{allowed_sites, angles, column_order, placed_name, scales, scatter};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Random layouts that the trials are dealt over.
const RANDOM_LAYOUTS: usize = 50;

/// Gauges of one kind and count.
pub(super) struct LayoutOf {
    /// `given`, `random`, `D`, `Ds`.
    pub name: String,
    /// Number of gauges.
    pub gauges: usize,
    /// Pool of gauges, to which the indices in `members` refer.
    pub pool: Pool,
    /// One layout, or many random ones.
    pub members: Vec<Vec<usize>>,
}

/// Returns every layout and count that the job asks for and the pool allows.
///
/// # Errors
/// No pool at all, candidates that can't be used.
pub(super) fn build_layouts(
    work: &mut Work,
    job: &Job,
    study: &Study,
    prepared: &StudyInputs,
) -> Result<Vec<LayoutOf>, Faults> {
    // Named spots are the pool for every layout except the given layout.
    let pool = prepared.spots.as_ref().unwrap_or(&prepared.pool);
    let counts = if study.gauges.is_empty() {
        let all = pool.len();
        vec![if all > 0 {
            all
        } else {
            2 * prepared.loads.len()
        }]
    } else {
        study.gauges.clone()
    };
    // The job's gauges are the pool, unless the job states candidates for other places.
    let from_model = prepared.fields.is_some()
        && prepared.spots.is_none()
        && (job.candidates.line > 0 || prepared.pool.is_empty());
    let mut out = Vec::new();
    let mut skipped: Vec<String> = Vec::new();
    let wide = if from_model {
        Some(ModelCandidates::new(work, job, prepared)?)
    } else {
        None
    };
    for name in &study.layouts {
        for &n in &counts {
            work.go_on()?;
            let layout = match (name.as_str(), &wide) {
                ("given", _) => (n <= prepared.pool.len()).then(|| LayoutOf {
                    name: name.clone(),
                    gauges: n,
                    pool: prepared.pool.clone(),
                    members: vec![(0..n).collect()],
                }),
                ("random", _) if n <= pool.len() => Some(LayoutOf {
                    name: name.clone(),
                    gauges: n,
                    pool: pool.clone(),
                    members: random_subsets(pool.len(), n, study.seed),
                }),
                ("random", Some(w)) => w.random_layout(job, prepared, n, study.seed),
                ("random", None) => None,
                (_, Some(w)) => Some(w.best_layout(job, prepared, name, n)?),
                (_, None) if n <= pool.len() => Some(best_of_pool(job, prepared, pool, name, n)?),
                _ => None,
            };
            match layout {
                Some(l) => out.push(l),
                None => skipped.push(format!("{name} {n}")),
            }
        }
    }
    if !skipped.is_empty() {
        work.findings.push(Finding::new(
            Severity::Warning,
            "layouts-skipped",
            list_few(&skipped),
            format!("the job has {} gauges: these layouts need more", pool.len()),
            "name more gauges, or a [candidates] section",
        ));
    }
    if out.is_empty() {
        return Err(Faults::from(Fault::with_line(
            &*job.file,
            study.line,
            "study.layouts",
            "no layout can be formed",
            "name gauges, or a [candidates] section on a [model]",
        )));
    }
    Ok(out)
}

/// Subsets of `n` out of `all`, the same for a seed every time.
fn random_subsets(all: usize, n: usize, seed: u64) -> Vec<Vec<usize>> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    (0..RANDOM_LAYOUTS)
        .map(|_| {
            let mut left: Vec<usize> = (0..all).collect();
            (0..n)
                .map(|_| left.swap_remove(random.random_range(0..left.len())))
                .collect()
        })
        .collect()
}

impl LayoutOf {
    /// Returns the gauges of the layout. The list is empty for random layouts, of which there are many.
    pub fn chosen_gauges(&self) -> Vec<LayoutGauge> {
        match self.members.as_slice() {
            [one] if self.name != "random" => {
                let places = one.iter().filter_map(|&i| self.pool.places.get(i));
                places.cloned().collect()
            }
            _ => Vec::new(),
        }
    }
}

fn spec_of(job: &Job, name: &str, n: usize, k: usize, order: &[usize]) -> Spec {
    let mut spec = Spec::new(n, k);
    spec.spacing = job.placement.spacing;
    spec.effort.seed = job.placement.seed;
    for (l, &from) in order.iter().enumerate() {
        let load = job.loads.get(from);
        if load.is_some_and(|j| j.role == LoadRole::Nuisance && j.expected.is_some()) {
            spec.prior[l * k + l] = 1.0;
        }
    }
    if name == "Ds" || job.placement.criterion == Optimality::Ds {
        let nuisance = job
            .loads
            .iter()
            .filter(|l| l.role == LoadRole::Nuisance)
            .count();
        spec.criterion = placement::Criterion::Ds(nuisance);
    }
    spec
}

fn placement_fault(job: &Job, study: &str, e: &PlaceError) -> Faults {
    let line = job.study.as_ref().map_or(0, |s| s.line);
    let (wrong, remedy) = e.parts();
    let field = format!("study.layouts {study}");
    Faults::from(Fault::with_line(&*job.file, line, field, wrong, remedy))
}

/// Returns the D-optimal subset of the job's own gauges.
fn best_of_pool(
    job: &Job,
    prepared: &StudyInputs,
    pool: &Pool,
    name: &str,
    n: usize,
) -> Result<LayoutOf, Faults> {
    let k = prepared.loads.len();
    let mut order: Vec<usize> = (0..k).collect();
    order.sort_by_key(|&l| prepared.loads[l].wanted);
    let noise = job.placement.noise_microstrain * 1e-6;
    let scale: Vec<f64> = prepared
        .loads
        .iter()
        .enumerate()
        .map(|(l, load)| {
            let norm = pool
                .gauges
                .iter()
                .map(|g| g.row[l].powi(2))
                .sum::<f64>()
                .sqrt();
            load.expected
                .filter(|e| *e > 0.0)
                .unwrap_or(if norm > 0.0 { 1.0 / norm } else { 1.0 })
        })
        .collect();
    let c = Candidates::from_rows(
        k,
        pool.len(),
        Scatter::with_uniform_noise(noise),
        |g, out| {
            for (o, &l) in out.iter_mut().zip(&order) {
                *o = pool.gauges[g].row[l] * scale[l];
            }
        },
    );
    let mut spec = spec_of(job, name, n, k, &order);
    spec.spacing = 0.0;
    let layout = place(&c, &spec).map_err(|e| placement_fault(job, name, &e))?;
    Ok(LayoutOf {
        name: name.to_owned(),
        gauges: n,
        pool: pool.clone(),
        members: vec![layout.gauges.iter().map(|g| g.place as usize).collect()],
    })
}

/// Candidates on the model.
struct ModelCandidates {
    sites: Vec<Site>,
    candidates: Candidates,
    order: Vec<usize>,
}

impl ModelCandidates {
    fn new(work: &mut Work, job: &Job, prepared: &StudyInputs) -> Result<Self, Faults> {
        let Some(fields) = &prepared.fields else {
            return Err(Fault::new(
                &*job.file,
                "model",
                "the job has no [model]",
                "name the deck: [model] deck = \"model.bdf\"",
            )
            .into());
        };
        let cases = fields.load_cases(job);
        let (common, _) = common_shells(&cases);
        let sites = allowed_sites(job, fields, &common)?;
        let sizes = scales(work, &cases, &common);
        let order = column_order(job);
        let (led, led_scales): (Vec<LoadCaseOf>, Vec<f64>) =
            order.iter().map(|&l| (cases[l].clone(), sizes[l])).unzip();
        let quarter = crate::gauge::Bridge::Quarter;
        let scatter = scatter(job, fields.model(), &sites, quarter, &led, &led_scales);
        let candidates = candidates(
            fields.model(),
            &sites,
            &led,
            &led_scales,
            angles(job.candidates.angles),
            scatter,
        );
        Ok(Self {
            sites,
            candidates,
            order,
        })
    }

    fn gauge(
        &self,
        job: &Job,
        prepared: &StudyInputs,
        choice: &Choice,
    ) -> Option<(PoolGauge, LayoutGauge)> {
        let fields = prepared.fields.as_ref()?;
        let (shell, surface) = *self.sites.get(choice.place as usize)?;
        let spec = GaugeSpec {
            surface: Some(surface),
            angle_rad: choice.angle,
            grid_length: job.candidates.grid_length,
            ..GaugeSpec::place_on_shell("candidate", shell)
        };
        on_model(fields, job, &fields.load_cases(job), &spec)
    }

    fn best_layout(
        &self,
        job: &Job,
        prepared: &StudyInputs,
        name: &str,
        n: usize,
    ) -> Result<LayoutOf, Faults> {
        let spec = spec_of(job, name, n, prepared.loads.len(), &self.order);
        let layout = place(&self.candidates, &spec).map_err(|e| placement_fault(job, name, &e))?;
        let mut pool = Pool::default();
        for (i, choice) in layout.gauges.iter().enumerate() {
            if let Some((gauge, place)) = self.gauge(job, prepared, choice) {
                pool.gauges.push(gauge);
                pool.places.push(LayoutGauge {
                    name: placed_name(i, layout.gauges.len()),
                    ..place
                });
            }
        }
        Ok(LayoutOf {
            name: name.to_owned(),
            gauges: n,
            members: vec![(0..pool.len()).collect()],
            pool,
        })
    }

    /// Draws random places and angles from the candidates.
    fn random_layout(
        &self,
        job: &Job,
        prepared: &StudyInputs,
        n: usize,
        seed: u64,
    ) -> Option<LayoutOf> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let gauges: Vec<PoolGauge> = (0..n * RANDOM_LAYOUTS)
            .filter_map(|_| {
                let angle = match self.candidates.angles() {
                    Angles::Grid(a) => a[random.random_range(0..a.len())],
                    _ => random.random_range(0.0..std::f64::consts::PI),
                };
                let choice = Choice {
                    place: random.random_range(0..self.sites.len()) as u32,
                    step: 0,
                    angle,
                };
                Some(self.gauge(job, prepared, &choice)?.0)
            })
            .collect();
        let pool = Pool {
            gauges,
            places: Vec::new(),
        };
        let all: Vec<usize> = (0..pool.len()).collect();
        Some(LayoutOf {
            name: "random".into(),
            gauges: n,
            members: all.chunks_exact(n).map(<[usize]>::to_vec).collect(),
            pool,
        })
    }
}
