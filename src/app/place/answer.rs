//! What `place` says: numbers of the layout, findings, words.

use super::choose::Chosen;
use super::curve::Point;
use super::task::Task;
use crate::app::Session;
use crate::app::fault::Faults;
use crate::app::job::Job;
use crate::app::strain::{LoadUnits, load_units};
use crate::finding::{Finding, Severity};
use crate::placement::quality::Quality;
use crate::placement::{Loss, Spec};
use crate::report::page::number;
use crate::report::strain::{PlacedGauge, Role};
use crate::sensitivity::Sensitivity;
use serde_json::json;

/// The standard deviations in job order.
pub(super) fn in_job_order(mut q: Quality, order: &[usize]) -> Quality {
    let led = q.sigma.clone();
    for (i, &l) in order.iter().enumerate() {
        q.sigma[l] = led[i];
    }
    q
}

/// For JSON: infinite has no form there.
pub(super) fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

/// Standard deviations of the loads in report units.
pub(super) fn sigma_rows(
    job: &Job,
    s: &Sensitivity,
    q: &Quality,
    scales: &[f64],
) -> Vec<serde_json::Value> {
    let names: Vec<String> = s.loads.iter().map(|l| l.name.clone()).collect();
    load_units(job, &names)
        .iter()
        .enumerate()
        .map(|(l, u)| json!({ "name": names[l], "sigma": q.sigma[l] * scales[l] * u.factor, "unit": u.name }))
        .collect()
}

/// The layout for `result.json`; the worst loss is that of a placed gauge.
pub(super) fn put_result(
    session: &mut Session,
    task: &Task,
    [places, rows]: [usize; 2],
    layout: &Chosen,
    s: &Sensitivity,
    q: &Quality,
    units: &[LoadUnits],
    placed: &[PlacedGauge],
) -> Result<(), Faults> {
    let gauges: Vec<serde_json::Value> = placed
        .iter()
        .zip(&layout.channels)
        .map(|(p, channel)| {
            let g = &p.gauge;
            let by_load: Vec<serde_json::Value> = p
                .by_load
                .iter()
                .map(|(name, strain)| json!({ "name": name, "microstrain": strain }))
                .collect();
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
                "bridge": p.bridge,
                "role": p.role.word(),
                "sd_microstrain": channel.sd,
                "angle_budget_deg": p.angle_budget_deg,
                "position_budget": p.position_budget,
                "strain_by_load": by_load,
            })
        })
        .collect();
    session.put("gauges", gauges)?;
    session.put("candidates", json!({ "places": places, "rows": rows }))?;
    session.put("criterion", task.job.placement.criterion.name())?;
    session.put("log_det", layout.log_det)?;
    session.put("upper_bound", layout.upper_bound)?;
    session.put("efficiency_bound", layout.efficiency_bound)?;
    session.put("proved", layout.proved)?;
    session.put("nodes", layout.nodes)?;
    if let Some(cost) = layout.cost {
        session.put("cost", cost)?;
    }
    let kept: Vec<&str> = task.kept.iter().map(|g| g.name.as_str()).collect();
    session.put("kept", kept)?;
    session.put("rank", s.rank())?;
    session.put("condition_number", finite(s.condition_number()))?;
    session.put(
        "condition_number_scaled",
        finite(s.condition_number_scaled()),
    )?;
    if let Some(least) = layout.least_condition {
        session.put("least_condition_number_scaled", finite(least))?;
    }
    let sigma: Vec<serde_json::Value> = units
        .iter()
        .enumerate()
        .map(|(l, u)| json!({ "name": s.loads[l].name, "sigma": q.sigma[l] * task.scales[l] * u.factor, "unit": u.name }))
        .collect();
    session.put("load_sigma", sigma)?;
    session.put(
        "worst_loss",
        json!({ "gauge": placed[q.worst].gauge.name, "leverage": q.leverage[q.worst], "efficiency_left": q.worst_loss }),
    )
}

/// Findings on the layout.
pub(super) fn judge_layout(
    session: &mut Session,
    layout: &Chosen,
    q: &Quality,
    spec: &Spec,
    placed: &[PlacedGauge],
    k: usize,
) {
    if q.worst_loss == 0.0 {
        session.findings.push(Finding::new(
            Severity::Warning,
            "no-gauge-may-fail",
            "placement.gauges",
            format!("{} gauges for {k} loads, and nothing may fail: the loss of one leaves loads that can't be separated, and no residual shows a fault", placed.len()),
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
    if layout.efficiency_bound < 0.9
        && spec.loss == Loss::Judged
        && layout.least_condition.is_none()
    {
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

/// Rows of the report's first table.
pub(super) fn session_numbers(
    layout: &Chosen,
    s: &Sensitivity,
    installed: &Option<serde_json::Value>,
) -> Vec<(String, String)> {
    let mut out = vec![
        (
            "Efficiency, certified at least".to_owned(),
            if layout.proved {
                "1, proved the best".to_owned()
            } else {
                format!("{:.4}", layout.efficiency_bound)
            },
        ),
        ("log det".to_owned(), format!("{:.4}", layout.log_det)),
        (
            "Condition number, scaled".to_owned(),
            format!("{:.2}", s.condition_number_scaled()),
        ),
    ];
    if let Some(least) = layout.least_condition {
        out.push((
            "Least condition number found, scaled".to_owned(),
            format!("{least:.2}"),
        ));
    }
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

/// The layout in words.
pub(super) fn say(
    session: &mut Session,
    layout: &Chosen,
    s: &Sensitivity,
    placed: &[PlacedGauge],
    installed: Option<&serde_json::Value>,
) {
    session.say(format!(
        "{} gauges, {} (log det {:.3}), condition number {:.2} scaled",
        placed.len(),
        if layout.proved {
            "proved the best possible".to_owned()
        } else {
            format!(
                "at least {:.2} % of the best possible",
                100.0 * layout.efficiency_bound
            )
        },
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
            "  {} element {} {} at {:.1} deg{}{}",
            p.gauge.name,
            p.gauge.element,
            p.gauge.surface.word(),
            p.gauge.angle_rad.to_degrees(),
            if p.bridge == "quarter" {
                String::new()
            } else {
                format!(", {}", p.bridge)
            },
            match p.role {
                Role::Estimate => "",
                Role::Validation => ", for validation",
            }
        ));
    }
}

/// The curve in words, a line a number of gauges.
pub(super) fn say_curve(
    session: &mut Session,
    points: &[Point],
    names: &[String],
    units: &[LoadUnits],
) {
    for p in points {
        let sigma: Vec<String> = (0..names.len())
            .map(|l| format!("{} {} {}", names[l], number(p.sigma[l]), units[l].name))
            .collect();
        session.say(format!(
            "{} gauges: {:.2} % of the best, condition {:.2}, after the worst loss {:.0} %; sigma {}",
            p.gauges,
            100.0 * p.efficiency_bound,
            p.condition_number_scaled,
            100.0 * p.worst_loss,
            sigma.join(", ")
        ));
    }
}
