//! Findings on a layout.

use super::chosen_layout::{Channel, ChosenLayout};
use super::outcome::PlacedGauge;
use super::task::Task;
use crate::finding::{Finding, Severity};
use crate::host::words::format_number;
use crate::host::work::Work;
use crate::job::{Job, LoadRole};
use crate::linalg::spd;
use crate::placement::quality::Quality;
use crate::placement::{Loss, Spec};
use crate::strain_chain::{LoadSigma, LoadUnits};
use crate::units::{Quantity, Unit, is_unit_load};
use crate::workflow::recover::ListedLoads;

/// Puts the standard deviations and the covariance into job order.
pub(super) fn in_job_order(mut q: Quality, order: &[usize]) -> Quality {
    let ordered = q.sigma.clone();
    for (i, &l) in order.iter().enumerate() {
        q.sigma[l] = ordered[i];
    }
    q.covariance = covariance_in_job_order(&q.covariance, order);
    q
}

/// Returns a covariance in job order.
fn covariance_in_job_order(covariance: &[f64], order: &[usize]) -> Vec<f64> {
    let k = order.len();
    let mut out = vec![0.0; k * k];
    for (i, &l) in order.iter().enumerate() {
        for (j, &m) in order.iter().enumerate() {
            out[l * k + m] = covariance[i * k + j];
        }
    }
    out
}

/// Returns the covariance that `recover` states for loads of their expected size `e`, before any widening: `(P + A' W^-1 A)^-1 + u^2 I`. It is in
/// shares of `e` and job order, `k x k` by rows. `A` is the strain of the gauges under the loads of size `e`. `W` is the covariance of their readings
/// (`noise^2 + u^2 a_g'a_g` for gauge `g` of the model), `u` the model uncertainty, `P` the prior precision of the loads. Tolerances of gluing are
/// not included. `prior` is `P`; `rows` are the rows of `W^-1/2 A` in the candidates' order; `u` is 0 if no gauge is the model's. Returns `None` if
/// the gauges do not determine the loads.
pub(super) fn as_recovered(
    task: &Task,
    prior: &[f64],
    rows: &[Vec<f64>],
    u: f64,
) -> Option<Vec<f64>> {
    let k = task.cases.len();
    let mut m = prior.to_vec();
    for row in rows {
        spd::add_outer(&mut m, row, 1.0);
    }
    let inverse = spd::gram_of_lower(&spd::inverse_lower(&spd::cholesky(&m, k)?, k), k);
    let mut out = covariance_in_job_order(&inverse, &task.order);
    out.iter_mut().step_by(k + 1).for_each(|v| *v += u * u);
    Some(out)
}

/// Returns the standard deviation, job units, of a load or of a sum of loads (their numbers and factors): `c' C c`. `covariance` is in shares of
/// `scales`.
pub(super) fn sigma_of(covariance: &[f64], scales: &[f64], terms: &[(usize, f64)]) -> f64 {
    let k = scales.len();
    let pairs = terms.iter().flat_map(|a| terms.iter().map(move |b| (a, b)));
    let each =
        pairs.map(|((l, c), (m, d))| c * d * scales[*l] * scales[*m] * covariance[l * k + m]);
    each.sum::<f64>().max(0.0).sqrt()
}

/// Returns the terms of each load, then of each combination.
pub(super) fn terms_listed(listed: &ListedLoads, k: usize) -> Vec<Vec<(usize, f64)>> {
    let own = (0..k).map(|l| vec![(l, 1.0)]);
    own.chain(listed.sums.iter().cloned()).collect()
}

/// Returns [`as_recovered`] for the chosen channels together with the gauges that stay.
pub(super) fn chosen_as_recovered(
    task: &Task,
    spec: &Spec,
    channels: &[Channel],
) -> Option<Vec<f64>> {
    let p = &task.job.placement;
    if task.spots.is_some() {
        // Spots may have rows of a given S, and errors in common.
        let gauges = channels.iter().map(|c| c.gauge.clone());
        let gauges: Vec<_> = gauges.chain(task.kept.clone()).collect();
        let s = task.s_of(&gauges).ok()?;
        let rows = task.rows_of(&gauges, &s, p.model_uncertainty_rel, &[]);
        let u = match task.all_calibrated(&gauges) {
            true => 0.0,
            false => p.model_uncertainty_rel,
        };
        return as_recovered(task, &task.without_kept(spec), &rows.over_sd, u);
    }
    let chosen = channels.iter().map(|c| {
        let own = p.noise_by_bridge.iter().find(|(b, _)| b.name() == c.bridge);
        let strain: Vec<f64> = c.row.iter().map(|v| v * c.sd).collect();
        let noise = own.map_or(p.noise_microstrain, |n| n.1);
        let noise = task.with_mesh_error(&c.gauge, noise);
        let sd = noise.hypot(p.model_uncertainty_rel * spd::dot(&strain, &strain).sqrt());
        strain.iter().map(|v| v / sd).collect()
    });
    let kept = task.kept_recovered.iter().cloned();
    let rows: Vec<Vec<f64>> = chosen.chain(kept).collect();
    as_recovered(
        task,
        &task.without_kept(spec),
        &rows,
        p.model_uncertainty_rel,
    )
}

/// Returns the covariance of the loads of a chosen layout, with the tolerances of installation in its rows and the error of the model.
pub(super) fn installed_covariance(job: &Job, q: &Quality, k: usize) -> Vec<f64> {
    let mut out = q.covariance.clone();
    let model = job.placement.model_uncertainty_rel.powi(2);
    out.iter_mut().step_by(k + 1).for_each(|v| *v += model);
    out
}

/// Returns the standard deviations of the loads and of the job's combinations, report units. They are given as recovered, and as installed if the job
/// states tolerances.
pub(super) fn sigma_rows(
    job: &Job,
    listed: &ListedLoads,
    recovered: Option<&[f64]>,
    as_glued: &[f64],
    scales: &[f64],
) -> Vec<LoadSigma> {
    let p = &job.placement;
    let tolerances =
        p.angle_tolerance_deg > 0.0 || p.position_tolerance > 0.0 || p.gauge_factor_rel > 0.0;
    let k = scales.len();
    let one = |(terms, (u, name)): (Vec<(usize, f64)>, (&LoadUnits, &String))| {
        let glued = sigma_of(as_glued, scales, &terms) * u.factor;
        LoadSigma {
            name: name.clone(),
            sigma: recovered.map_or(glued, |r| sigma_of(r, scales, &terms) * u.factor),
            sigma_as_glued: tolerances.then_some(glued),
            unit: u.name.clone(),
        }
    };
    let named = listed.units.iter().zip(&listed.names);
    terms_listed(listed, k)
        .into_iter()
        .zip(named)
        .map(one)
        .collect()
}

/// Returns the finding on loads that gauges will not determine. If `expected` is the size of a unit load of the deck, the finding states this cause.
pub(super) fn with_unit_loads(job: &Job, mut finding: Finding) -> Finding {
    let unit_load = job.loads.iter().find_map(|l| {
        let (size, quantity) = (l.expected?, l.quantity()?);
        let unit = job.units.unit(quantity);
        let is_unit = l.role == LoadRole::Wanted && is_unit_load(job.units, quantity, size);
        is_unit.then(|| (&l.name, format!("{} {}", format_number(size), unit.name)))
    });
    if let Some((name, size)) = unit_load {
        finding.message = format!(
            "`expected` of `{name}` is {size}, the size of a unit load, and the gauges do not resolve a load of this size."
        );
        finding.remedy = "State how large it gets (`expected` in [[load]]).".to_owned();
    }
    finding
}

/// Strain, microstrain, beyond which foil gauges tire within a test (makers rate their fatigue life at 1,500 to 2,000) and steel yields.
const STRAIN: f64 = 2000.0;
/// Tolerance of a place that a technician can keep with a rule, mm.
const PLACE: f64 = 1.0;

/// Adds the findings on the requirements for the installation.
fn report_installation_findings(work: &mut Work, job: &Job, placed: &[PlacedGauge]) {
    let strained = placed
        .iter()
        .filter(|g| g.expected_microstrain > STRAIN)
        .max_by(|a, b| a.expected_microstrain.total_cmp(&b.expected_microstrain));
    if let Some(g) = strained {
        let n = placed
            .iter()
            .filter(|g| g.expected_microstrain > STRAIN)
            .count();
        work.findings.push(
            Finding::new(
                Severity::Warning,
                "expected-strain-high",
                &g.name,
                format!(
                    "{n} gauges exceed {STRAIN:.0} microstrain under the sum of all expected loads, `{}` reaches {:.0} microstrain: foil \
                     gauges fatigue and mild steel yields",
                    g.name, g.expected_microstrain
                ),
                "state smaller `expected` loads if they are too large, or exclude these elements in [candidates]",
            )
            .with_numbers(g.expected_microstrain, STRAIN),
        );
    }
    let unit = job.units.unit(Quantity::Length);
    let budgets = placed.iter().map(|g| (&*g.name, g.position_budget));
    work.findings.extend(check_budgets(
        budgets,
        job.placement.position_tolerance,
        unit,
    ));
    if job.placement.model_uncertainty_rel == 0.0 {
        work.findings.push(Finding::new(
            Severity::Info,
            "model-uncertainty-unstated",
            "placement.model_uncertainty_rel",
            "no model uncertainty is stated: gauges and sigmas are computed for an exact model",
            "state model_uncertainty_rel in [placement] or [measured] (0.02 is a good model away from welds)",
        ));
    }
}

/// Returns the finding on gauges whose position budget is smaller than the expected position error. The expected error is the stated tolerance if it
/// is finer than a ruler, else the error with a ruler. Budgets and tolerance are in `unit`. The remedy depends on whether a tolerance is stated.
fn check_budgets<'a>(
    budgets: impl Iterator<Item = (&'a str, Option<f64>)>,
    tolerance: f64,
    unit: Unit,
) -> Option<Finding> {
    let mm = unit.si * 1000.0;
    let kept = match tolerance > 0.0 {
        true => PLACE.min(tolerance * mm),
        false => PLACE,
    };
    let tight: Vec<(&str, f64)> = budgets
        .filter_map(|(name, b)| Some((name, b? * mm)))
        .filter(|(_, b)| *b < kept)
        .collect();
    let (name, least) = tight.iter().min_by(|a, b| a.1.total_cmp(&b.1)).copied()?;
    let gauges = match tight.len() {
        1 => "1 gauge has".to_owned(),
        n => format!("{n} gauges have"),
    };
    let message = format!(
        "{gauges} to be glued within {} mm, `{name}` within {least:.2} mm: a larger error changes a load by more than 5 % of its expected size",
        format_number(kept)
    );
    let remedy = match tolerance > 0.0 {
        true => "place more gauges, so that each has less weight, or state a larger position_tolerance, so that places with large strain gradients \
         have less weight. `sigma_as_glued` contains the effect of the stated tolerance. If you use a template, state its tolerance"
            .to_owned(),
        false => format!(
            "state [placement] position_tolerance, {} {} for gauges positioned with a ruler, so that places with large strain gradients are avoided",
            format_number(2.0 * PLACE / mm),
            unit.name
        ),
    };
    let finding = Finding::new(
        Severity::Warning,
        "position-budget-small",
        name,
        message,
        remedy,
    );
    Some(finding.with_numbers(least, kept))
}

/// Adds the findings on the layout.
pub(super) fn report_layout_findings(
    work: &mut Work,
    job: &Job,
    layout: &ChosenLayout,
    q: &Quality,
    spec: &Spec,
    placed: &[PlacedGauge],
    k: usize,
) {
    report_installation_findings(work, job, placed);
    if q.worst_loss == 0.0 {
        work.findings.push(Finding::new(
            Severity::Warning,
            "no-spare-gauge",
            "placement.gauges",
            format!("{} gauges for {k} loads have no redundancy: if one gauge fails, the loads cannot be separated, and no residual shows a fault", placed.len()),
            "place several gauges more than loads",
        ));
    } else if q.worst_loss < 0.5 {
        work.findings.push(
            Finding::new(
                Severity::Info,
                "worst-loss",
                &placed[q.worst].gauge.name,
                format!(
                    "without gauge `{}`, {:.0} % of the efficiency remains",
                    placed[q.worst].gauge.name,
                    100.0 * q.worst_loss
                ),
                "protect it, or place more gauges",
            )
            .with_numbers(q.worst_loss, 0.5),
        );
    }
    if spec.spacing <= 0.0 {
        work.findings.push(Finding::new(
            Severity::Info,
            "no-spacing",
            "placement.spacing",
            "no spacing is stated: gauges may be next to each other, or at several angles on one element",
            "state [placement] spacing, as much as the installation needs",
        ));
    }
    if layout.efficiency_bound < 0.9
        && spec.loss == Loss::Judged
        && layout.least_condition.is_none()
    {
        work.findings.push(
            Finding::new(
                Severity::Info,
                "certificate-loose",
                "efficiency_bound",
                "the bound is far above this layout. With few gauges or a wide spacing it is often too high, and the layout may be the best one",
                "",
            )
            .with_numbers(layout.efficiency_bound, 0.9),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::UnitSystem;

    #[test]
    fn the_remedy_of_a_small_budget_asks_for_a_new_step_and_accepts_a_finer_tolerance() {
        // Metres: budgets of 0.4 and 3 mm.
        let unit = UnitSystem::MKgS.unit(Quantity::Length);
        let found = |tolerance: f64| {
            let budgets = [("P01", Some(4e-4)), ("P02", Some(3e-3)), ("P03", None)];
            check_budgets(budgets.into_iter(), tolerance, unit)
        };
        let unstated = found(0.0).unwrap();
        assert_eq!(unstated.subject, "P01");
        assert!(
            unstated
                .message
                .starts_with("1 gauge has to be glued within 1 mm")
        );
        assert!(
            unstated
                .remedy
                .contains("State [placement] position_tolerance, 0.002 m"),
            "{}",
            unstated.remedy
        );
        let stated = found(2e-3).unwrap();
        assert!(
            !stated
                .remedy
                .contains("State [placement] position_tolerance"),
            "{}",
            stated.remedy
        );
        assert!(
            stated.remedy.starts_with("Place more gauges"),
            "{}",
            stated.remedy
        );
        // A stated tolerance within the smallest budget needs no finding.
        assert!(found(4e-4).is_none());
    }
}
