//! `place`: gauges chosen from the candidates, with the certificate, beside the installed ones where the job has some.

use super::fault::{Fault, Faults};
use super::job::{self, AngleStep, Criterion, Job};
use super::strain::{Fields, LoadUnits, lay_gauges, load_units, read_fields, side};
use super::{JobArguments, Session};
use crate::finding::{Finding, Severity};
use crate::gauge::{CornerRows, Gauge, GaugeSpec, build};
use crate::model::{Model, ShellIx};
use crate::placement::candidates::{Angles, Candidates, Scatter};
use crate::placement::quality::{Quality, judge_rows};
use crate::placement::sites::{Site, candidates};
use crate::placement::{self, Layout, PlaceError, Spec, place};
use crate::report::strain::{
    PlacedGauge, gauges_csv, gluing_sheet_csv, gluing_sheet_md, place_page,
};
use crate::sensitivity::{LoadCaseOf, Sensitivity, check_separability, common_shells, from_cases};
use serde_json::json;

/// Strain in one microstrain.
const MICRO: f64 = 1e-6;
/// Strain, microstrain rms over the candidates, that a load without `expected` is taken to cause.
const ASSUMED_STRAIN: f64 = 100.0;

/// Reads, places, compares, writes `gauges.csv`, the gluing sheet and the report.
pub fn run(arguments: &JobArguments, session: &mut Session) -> Result<(), Faults> {
    let job = session.stage("read job", |s| job::read_job(&mut s.inputs, &arguments.job))?;
    session.put_units(job.units, &job.report_units);
    let fields = read_fields(session, &job)?;
    let cases = fields.load_cases(&job);
    let (common, findings) = common_shells(&cases);
    session.findings.extend(findings);
    let sites = allowed_sites(&job, fields.model(), &common)?;
    let k = cases.len();
    let scales = scales(session, &cases, &common);
    // Nuisance loads lead where the criterion is Ds.
    let order = column_order(&job);
    let (led, led_scales): (Vec<LoadCaseOf>, Vec<f64>) =
        order.iter().map(|&l| (cases[l].clone(), scales[l])).unzip();
    let c = session.stage("candidates", |_| {
        let scatter = Scatter {
            noise: job.placement.noise_microstrain,
            angle_sd: job.placement.angle_tolerance_deg.to_radians(),
            model_rel: job.placement.model_uncertainty_rel,
            extra: Vec::new(),
        };
        candidates(
            fields.model(),
            &sites,
            &led,
            &led_scales,
            angles(job.candidates.angles),
            scatter,
        )
    });
    let mut spec = spec_of(session, &job, k);
    let found = session.stage("place", |s| match place(&c, &spec) {
        Err(PlaceError::Singular { gauges, loads }) => {
            know_the_loads(s, &mut spec, gauges, loads);
            place(&c, &spec)
        }
        other => other,
    });
    let layout = found.map_err(|e| vec![refusal(&job, &e)])?;
    let gauges = gauges_of(fields.model(), &sites, &layout, job.candidates.grid_length);
    let s = from_cases(&gauges, &cases).map_err(|_| Vec::new())?;
    let rows: Vec<Vec<f64>> = layout.gauges.iter().map(|&g| c.row(g)).collect();
    let Some(quality) = judge_rows(&rows, &spec.prior, k).map(|q| in_job_order(q, &order)) else {
        return Err(vec![refusal(
            &job,
            &PlaceError::Singular {
                gauges: spec.gauges,
                loads: k,
            },
        )]);
    };
    let units = load_units(
        &job,
        &s.loads.iter().map(|l| l.name.clone()).collect::<Vec<_>>(),
    );
    let placed: Vec<PlacedGauge> = gauges
        .iter()
        .enumerate()
        .map(|(i, g)| PlacedGauge {
            gauge: g.clone(),
            leverage: quality.leverage[i],
            expected_microstrain: (0..k)
                .map(|l| (s.values[(i, l)] * scales[l]).abs())
                .sum::<f64>()
                / MICRO,
            reference: reference_of(&job, fields.model(), g),
        })
        .collect();
    let installed = installed(session, &job, &fields, &cases, &scales, &c, &spec)?;
    put_result(
        session, &job, &c, &layout, &s, &quality, &units, &scales, &placed,
    )?;
    session.put("installed", &installed)?;
    session.findings.extend(check_separability(&s));
    judge_layout(session, &layout, &quality, &spec, &placed, k);
    say(session, &layout, &s, &placed, installed.as_ref());
    let page = place_page(
        &job.title,
        fields.model(),
        &placed,
        &s,
        &session.findings,
        &session_numbers(&layout, &s, &installed),
    );
    let out = session.output_for(&arguments.job)?;
    let write = |f: Result<(), Fault>| f.map_err(|f| vec![f]);
    write(out.write("gauges.csv", |w| gauges_csv(w, &placed)))?;
    write(out.write("sensitivity.csv", |w| {
        crate::report::strain::sensitivity_csv(w, &s)
    }))?;
    write(out.write("gluing_sheet.csv", |w| {
        gluing_sheet_csv(w, &placed, fields.model())
    }))?;
    write(out.write_bytes(
        "gluing_sheet.md",
        gluing_sheet_md(&job.title, &placed, fields.model()).as_bytes(),
    ))?;
    write(out.write_bytes("report.html", page.as_bytes()))
}

/// Surfaces where the job lets gauges go, among shells with strain in every case.
///
/// # Errors
/// None is left.
pub fn allowed_sites(job: &Job, model: &Model, common: &[ShellIx]) -> Result<Vec<Site>, Faults> {
    let rule = &job.candidates;
    let mut sites = Vec::new();
    for &ix in common {
        let Some(shell) = model.shells.get(ix.us()) else {
            continue;
        };
        let property = model
            .shell_properties
            .get(shell.property.us())
            .map_or(0, |p| p.id);
        let allowed = rule
            .properties
            .as_ref()
            .is_none_or(|p| p.contains(property))
            && rule.elements.as_ref().is_none_or(|e| e.contains(shell.id));
        if allowed {
            sites.extend(rule.surfaces.iter().map(|s| (ix, side(*s))));
        }
    }
    if sites.is_empty() {
        let wrong =
            "no shell with strain in every load's subcase is among the candidates".to_owned();
        return Err(vec![Fault::at(
            &*job.file,
            rule.line,
            "candidates",
            wrong,
            "widen `properties` or `elements`, or ask for STRAIN of them",
        )]);
    }
    Ok(sites)
}

/// The angles of a job.
pub(super) fn angles(step: AngleStep) -> Angles {
    match step {
        AngleStep::Continuous => Angles::Continuous,
        AngleStep::Degrees(d) => {
            let n = (180.0 / d - 1e-9).ceil().max(1.0) as usize;
            Angles::Grid((0..n).map(|i| (d * i as f64).to_radians()).collect())
        }
    }
}

/// Column scales: `expected`; where a load states none, the size that strains the candidates by [`ASSUMED_STRAIN`] rms.
pub(super) fn scales(session: &mut Session, cases: &[LoadCaseOf], common: &[ShellIx]) -> Vec<f64> {
    let mut assumed = Vec::new();
    let scales = cases
        .iter()
        .map(|l| {
            if let Some(e) = l.load.expected.filter(|e| *e > 0.0) {
                return e;
            }
            assumed.push(l.load.name.clone());
            let rows = common
                .iter()
                .filter_map(|ix| l.case.shells.elements.binary_search(ix).ok());
            let (mut sum, mut n) = (0.0, 0.0);
            for r in rows {
                for v in l.case.shells.centre.get(r).into_iter().flatten().flatten() {
                    sum += (v / l.applied).powi(2);
                    n += 1.0;
                }
            }
            let rms: f64 = if n > 0.0 { f64::sqrt(sum / n) } else { 0.0 };
            if rms > 0.0 {
                ASSUMED_STRAIN * MICRO / rms
            } else {
                1.0
            }
        })
        .collect();
    if !assumed.is_empty() {
        session.findings.push(Finding::new(
            Severity::Info,
            "expected-assumed",
            assumed.join(", "),
            format!("loads without `expected` are taken as large as strains the candidates by {ASSUMED_STRAIN} microstrain rms"),
            "state `expected`: it weighs the angle tolerance and the scaled condition number",
        ));
    }
    scales
}

fn spec_of(session: &mut Session, job: &Job, k: usize) -> Spec {
    let gauges = job.placement.gauges.unwrap_or_else(|| {
        session.findings.push(Finding::new(
            Severity::Info,
            "gauges-assumed",
            "placement.gauges",
            format!(
                "the job does not say how many gauges: twice the number of loads are placed, {}",
                2 * k
            ),
            "state [placement] gauges",
        ));
        2 * k
    });
    let mut spec = Spec::new(gauges, k);
    spec.spacing = job.placement.spacing;
    spec.effort.seed = job.placement.seed;
    let order = column_order(job);
    for (l, &from) in order.iter().enumerate() {
        // What is known of a nuisance load: its expected size, 1 in these columns.
        if job.loads[from].role == job::Role::Nuisance && job.loads[from].expected.is_some() {
            spec.prior[l * k + l] = 1.0;
        }
    }
    if job.placement.criterion == Criterion::Ds {
        let nuisance = job
            .loads
            .iter()
            .filter(|l| l.role == job::Role::Nuisance)
            .count();
        spec.criterion = placement::Criterion::Ds(nuisance);
    }
    spec
}

/// Where no layout separates the loads, the best one for loads that are each known to their expected size (1 in these columns), with
/// the finding that the measurement alone does not give them.
fn know_the_loads(session: &mut Session, spec: &mut Spec, gauges: usize, loads: usize) {
    for l in 0..loads {
        if let Some(p) = spec.prior.get_mut(l * loads + l) {
            *p = p.max(1.0);
        }
    }
    session.findings.push(
        Finding::new(
            Severity::Error,
            "loads-not-separable",
            "placement",
            format!(
                "no {gauges} gauges among these candidates separate the {loads} loads: the layout is the best for loads known \
                 beforehand to their expected size, and so are its sigmas"
            ),
            format!("ask for at least {loads} gauges, drop loads that act alike, or widen [candidates]"),
        )
        .with_numbers(gauges as f64, loads as f64),
    );
}

/// Loads in the order of the candidates' columns: nuisance loads first.
pub(super) fn column_order(job: &Job) -> Vec<usize> {
    let mut order: Vec<usize> = (0..job.loads.len()).collect();
    order.sort_by_key(|&l| job.loads[l].role == job::Role::Wanted);
    order
}

/// The standard deviations in job order.
fn in_job_order(mut q: Quality, order: &[usize]) -> Quality {
    let led = q.sigma.clone();
    for (i, &l) in order.iter().enumerate() {
        q.sigma[l] = led[i];
    }
    q
}

fn refusal(job: &Job, e: &PlaceError) -> Fault {
    Fault::at(
        &*job.file,
        job.placement.line,
        "placement",
        e.to_string(),
        "change [placement] or [candidates]",
    )
}

fn gauges_of(model: &Model, sites: &[Site], layout: &Layout, grid_length: f64) -> Vec<Gauge> {
    let digits = layout.gauges.len().to_string().len().max(2);
    layout
        .gauges
        .iter()
        .enumerate()
        .filter_map(|(i, g)| {
            let (shell, surface) = sites[g.place as usize];
            let spec = GaugeSpec {
                surface: Some(surface),
                angle_rad: g.angle,
                grid_length,
                ..GaugeSpec::on(format!("P{:0digits$}", i + 1), shell)
            };
            build(model, &spec, CornerRows::Absent)
                .ok()
                .and_then(|b| b.0.into_iter().next())
        })
        .collect()
}

/// The load grid nearest to a gauge, and the way from there.
fn reference_of(job: &Job, model: &Model, g: &Gauge) -> Option<(u32, [f64; 3])> {
    job.loads
        .iter()
        .filter_map(|l| match l.acts {
            job::LoadActs::AtGrid { grid, .. } => {
                let x = model.grids.get(model.grid_ix(grid)?.us())?.x;
                let d = g.position - x;
                Some((grid, [d.x, d.y, d.z]))
            }
            job::LoadActs::Set(_) => None,
        })
        .min_by(|a, b| {
            let n = |v: &[f64; 3]| v.iter().map(|x| x * x).sum::<f64>();
            n(&a.1).total_cmp(&n(&b.1))
        })
}

/// The installed layout by the same measures, noise alone; `None` without gauges in the job.
fn installed(
    session: &mut Session,
    job: &Job,
    fields: &Fields,
    cases: &[LoadCaseOf],
    scales: &[f64],
    c: &Candidates,
    spec: &Spec,
) -> Result<Option<serde_json::Value>, Faults> {
    if job.gauges.is_empty() {
        return Ok(None);
    }
    let gauges = lay_gauges(session, job, fields)?;
    let s = match from_cases(&gauges, cases) {
        Ok(s) => s,
        Err(missing) => {
            session.findings.push(Finding::new(
                Severity::Warning,
                "installed-gauges-without-strain",
                missing.iter().map(|m| m.gauge.as_str()).collect::<Vec<_>>().join(", "),
                "installed gauges sit where some subcase has no strain: the installed layout is not judged",
                "ask for STRAIN of their elements in every subcase",
            ));
            return Ok(None);
        }
    };
    let k = cases.len();
    let noise = job.placement.noise_microstrain * MICRO;
    let order = column_order(job);
    let rows: Vec<Vec<f64>> = (0..gauges.len())
        .map(|g| {
            (0..k)
                .map(|l| s.values[(g, order[l])] * scales[order[l]] / noise)
                .collect()
        })
        .collect();
    let Some(q) = judge_rows(&rows, &spec.prior, k).map(|q| in_job_order(q, &order)) else {
        return Ok(Some(json!({ "gauges": gauges.len(), "rank": s.rank() })));
    };
    let bound = if gauges.len() == spec.gauges && !c.has_slopes() {
        None
    } else {
        let plain = Candidates::clone(c).with_noise_only();
        let other = Spec {
            gauges: gauges.len(),
            effort: crate::placement::exchange::Effort {
                starts: 2,
                kicks: 0,
                seed: 1,
            },
            ..spec.clone()
        };
        place(&plain, &other).ok().map(|l| l.upper_bound)
    };
    let log_det = crate::placement::quality::value(&rows, &spec.prior, k, &spec.criterion);
    Ok(Some(json!({
        "gauges": gauges.len(),
        "log_det": log_det,
        "upper_bound": bound,
        "condition_number": finite(s.condition_number()),
        "condition_number_scaled": finite(s.condition_number_scaled()),
        "load_sigma": sigma_rows(job, &s, &q, scales),
        "worst_loss": { "gauge": s.gauges[q.worst], "efficiency_left": q.worst_loss, "leverage": q.leverage[q.worst] },
    })))
}

fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

fn sigma_rows(job: &Job, s: &Sensitivity, q: &Quality, scales: &[f64]) -> Vec<serde_json::Value> {
    let names: Vec<String> = s.loads.iter().map(|l| l.name.clone()).collect();
    load_units(job, &names)
        .iter()
        .enumerate()
        .map(|(l, u)| json!({ "name": names[l], "sigma": q.sigma[l] * scales[l] * u.factor, "unit": u.name }))
        .collect()
}

#[allow(clippy::too_many_arguments)]
fn put_result(
    session: &mut Session,
    job: &Job,
    c: &Candidates,
    layout: &Layout,
    s: &Sensitivity,
    q: &Quality,
    units: &[LoadUnits],
    scales: &[f64],
    placed: &[PlacedGauge],
) -> Result<(), Faults> {
    let gauges: Vec<serde_json::Value> = placed
        .iter()
        .map(|p| {
            let g = &p.gauge;
            json!({
                "name": g.name,
                "element": g.element,
                "surface": g.surface.word(),
                "position": [g.position.x, g.position.y, g.position.z],
                "direction": [g.direction.x, g.direction.y, g.direction.z],
                "angle_deg": g.angle_rad.to_degrees(),
                "angle_seen_deg": p.angle_seen_deg(),
                "leverage": p.leverage,
                "expected_microstrain": p.expected_microstrain,
            })
        })
        .collect();
    session.put("gauges", gauges)?;
    session.put(
        "candidates",
        json!({ "places": c.n_places(), "rows": c.n_rows() }),
    )?;
    session.put(
        "criterion",
        if job.placement.criterion == Criterion::Ds {
            "Ds"
        } else {
            "D"
        },
    )?;
    session.put("log_det", layout.log_det)?;
    session.put("upper_bound", layout.upper_bound)?;
    session.put("efficiency_bound", layout.efficiency_bound)?;
    session.put("proved", layout.proved)?;
    session.put("rank", s.rank())?;
    session.put("condition_number", finite(s.condition_number()))?;
    session.put(
        "condition_number_scaled",
        finite(s.condition_number_scaled()),
    )?;
    let sigma: Vec<serde_json::Value> = units
        .iter()
        .enumerate()
        .map(|(l, u)| json!({ "name": s.loads[l].name, "sigma": q.sigma[l] * scales[l] * u.factor, "unit": u.name }))
        .collect();
    session.put("load_sigma", sigma)?;
    session.put(
        "worst_loss",
        json!({ "gauge": s.gauges[q.worst], "leverage": q.leverage[q.worst], "efficiency_left": q.worst_loss }),
    )
}

fn judge_layout(
    session: &mut Session,
    layout: &Layout,
    q: &Quality,
    spec: &Spec,
    placed: &[PlacedGauge],
    k: usize,
) {
    if spec.gauges <= k && q.worst_loss == 0.0 {
        session.findings.push(Finding::new(
            Severity::Warning,
            "no-gauge-may-fail",
            "placement.gauges",
            format!("{} gauges for {k} loads: the loss of any one leaves loads that can't be separated, and no residual shows a fault", spec.gauges),
            "place a few gauges more than loads",
        ));
    } else if q.worst_loss < 0.5 {
        session.findings.push(
            Finding::new(
                Severity::Info,
                "worst-loss",
                &placed[q.worst].gauge.name,
                format!(
                    "losing gauge `{}` leaves {:.0} % of the efficiency",
                    placed[q.worst].gauge.name,
                    100.0 * q.worst_loss
                ),
                "protect it, or place more gauges",
            )
            .with_numbers(q.worst_loss, 0.5),
        );
    }
    if spec.spacing <= 0.0 {
        session.findings.push(Finding::new(
            Severity::Info,
            "no-spacing",
            "placement.spacing",
            "no spacing is stated: gauges may be asked for side by side, or at several angles on one element",
            "state [placement] spacing, as much as a technician needs",
        ));
    }
    if layout.efficiency_bound < 0.9 {
        session.findings.push(
            Finding::new(
                Severity::Info,
                "certificate-loose",
                "efficiency_bound",
                "the bound leaves room between this layout and the best possible: it is loose where gauges are few or kept apart",
                "",
            )
            .with_numbers(layout.efficiency_bound, 0.9),
        );
    }
}

fn session_numbers(
    layout: &Layout,
    s: &Sensitivity,
    installed: &Option<serde_json::Value>,
) -> Vec<(String, String)> {
    let mut out = vec![
        (
            "Efficiency, certified at least".to_owned(),
            format!("{:.4}", layout.efficiency_bound),
        ),
        ("log det".to_owned(), format!("{:.4}", layout.log_det)),
        (
            "Condition number, scaled".to_owned(),
            format!("{:.2}", s.condition_number_scaled()),
        ),
    ];
    if let Some(v) = installed {
        if let Some(c) = v
            .get("condition_number_scaled")
            .and_then(serde_json::Value::as_f64)
        {
            out.push((
                "Installed: condition number, scaled".to_owned(),
                format!("{c:.2}"),
            ));
        }
        if let Some(d) = v.get("log_det").and_then(serde_json::Value::as_f64) {
            out.push((
                "Installed: log det (noise alone)".to_owned(),
                format!("{d:.4}"),
            ));
        }
    }
    out
}

fn say(
    session: &mut Session,
    layout: &Layout,
    s: &Sensitivity,
    placed: &[PlacedGauge],
    installed: Option<&serde_json::Value>,
) {
    session.say(format!(
        "{} gauges, at least {:.2} % of the best possible (log det {:.3}), condition number {:.2} scaled",
        placed.len(),
        100.0 * layout.efficiency_bound,
        layout.log_det,
        s.condition_number_scaled()
    ));
    if let Some(d) = installed
        .and_then(|v| v.get("log_det"))
        .and_then(serde_json::Value::as_f64)
    {
        session.say(format!("installed gauges: log det {d:.3} with noise alone"));
    }
    for p in placed {
        session.say(format!(
            "  {} element {} {} at {:.1} deg",
            p.gauge.name,
            p.gauge.element,
            p.gauge.surface.word(),
            p.gauge.angle_rad.to_degrees()
        ));
    }
}
