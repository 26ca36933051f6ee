//! The answer of `ballast`: findings, result, tables, page.

use super::completed::MassCards;
use super::{DECK, Task, force, length, mass};
use crate::app::fault::Faults;
use crate::app::{JobArguments, Session};
use crate::finding::{Finding, Severity};
use crate::payload::{BallastFit, BallastSpec};
use crate::report::page::{Page, number, table_section};
use serde_json::json;

/// Misfit of a reaction above which the masses do not explain it, of the measured value.
const MATCHED: f64 = 0.02;

pub(super) fn findings(
    session: &mut Session,
    task: &Task,
    run: &str,
    measured: &[f64],
    after: &[f64],
    fit: &BallastFit,
    spec: &BallastSpec,
) {
    let job = task.job;
    session.findings.push(Finding::new(
        Severity::Info,
        "flat-floor",
        "reactions",
        "the model stands on a flat, level, frictionless floor; its own springs decide how the wheels share the weight, tyres are rigid",
        "",
    ));
    let (mut worst, mut name) = (0.0_f64, "");
    for ((l, m), a) in task.wheels.loads.iter().zip(measured).zip(after) {
        let off = ((a - m) / m).abs();
        if off > worst {
            (worst, name) = (off, &job.loads[*l].name);
        }
        if *a < 0.0 {
            session.findings.push(Finding::new(
                Severity::Error,
                "wheel-lifts-off",
                &job.loads[*l].name,
                "the completed model pulls at the floor here: the wheel would lift off, and the reactions do not hold",
                "check masses and stations, or the measured reactions",
            ));
        }
    }
    if worst > MATCHED {
        let explained = fit.chi2 <= 2.0 * measured.len() as f64;
        session.findings.push(
            Finding::new(
                if explained { Severity::Info } else { Severity::Warning },
                "reactions-not-matched",
                name,
                format!(
                    "no {} masses in the region bring every reaction of run `{run}` closer: spring rates, the ground or friction share the \
                     weight otherwise than the model does",
                    spec.masses
                ),
                "measure on level ground after rolling; check how the suspension shares load between axles and sides",
            )
            .with_numbers(worst, MATCHED),
        );
    }
    let numbers = 3 * spec.masses;
    if fit.fixed < numbers {
        let ranges: Vec<String> = fit
            .masses
            .iter()
            .enumerate()
            .map(|(k, b)| {
                format!(
                    "mass {} {} to {} {}, {} to {} and {} to {} {}",
                    k + 1,
                    number(b.weight_range[0] / task.gravity * mass(job)),
                    number(b.weight_range[1] / task.gravity * mass(job)),
                    job.report_units.mass.name,
                    number(b.at_range[0][0] * length(job)),
                    number(b.at_range[0][1] * length(job)),
                    number(b.at_range[1][0] * length(job)),
                    number(b.at_range[1][1] * length(job)),
                    job.report_units.length.name,
                )
            })
            .collect();
        session.findings.push(
            Finding::new(
                Severity::Warning,
                "masses-not-separable",
                "ballast",
                format!(
                    "the reactions fix {} of the {numbers} numbers: the total and where its centre lies, not how it is split. With the others \
                     adjusted, equally good are {}",
                    fit.fixed,
                    ranges.join("; ")
                ),
                "state where the heavy parts are (a smaller `region`, a `max_mass`), or ask for fewer masses",
            )
            .with_numbers(fit.fixed as f64, numbers as f64),
        );
    }
}

#[allow(clippy::too_many_arguments)]
pub(super) fn put(
    session: &mut Session,
    task: &Task,
    run: &str,
    measured: &[f64],
    sigma: &[f64],
    before: &[f64],
    after: &[f64],
    fit: &BallastFit,
    cards: &[MassCards],
) -> Result<(), Faults> {
    let (job, g) = (task.job, task.gravity);
    let (f, l, m) = (force(job), length(job), mass(job));
    let masses: Vec<serde_json::Value> = fit
        .masses
        .iter()
        .zip(cards)
        .map(|(b, c)| {
            json!({
                "mass": b.weight / g * m,
                "mass_range": b.weight_range.map(|v| v / g * m),
                "position": b.at.map(|v| v * l),
                "position_range": b.at_range.map(|r| r.map(|v| v * l)),
                "grid": c.grid,
                "rbe3": c.rbe3,
                "conm2": c.conm2,
            })
        })
        .collect();
    session.put("masses", masses)?;
    let rows: Vec<serde_json::Value> = task
        .wheels
        .loads
        .iter()
        .enumerate()
        .map(|(i, w)| {
            json!({
                "name": job.loads[*w].name,
                "measured": measured[i] * f,
                "sigma": sigma[i] * f,
                "before": before[i] * f,
                "after": after[i] * f,
            })
        })
        .collect();
    session.put("reactions", rows)?;
    session.put("run", run)?;
    session.put("numbers_fixed", fit.fixed)?;
    session.put("numbers_asked", 3 * fit.masses.len())?;
    // Statics alone: the reactions' resultant less the model's own.
    let lacking: Vec<f64> = measured.iter().zip(before).map(|(m, b)| m - b).collect();
    let total: f64 = lacking.iter().sum();
    let spread = sigma.iter().map(|s| s * s).sum::<f64>().sqrt();
    let (b, c) = ((task.wheels.axis + 1) % 3, (task.wheels.axis + 2) % 3);
    let centre = [b, c].map(|axis| {
        let x = task.standing.floor.positions().iter().map(|x| x[axis]);
        let at = x.clone().zip(&lacking).map(|(x, r)| x * r).sum::<f64>() / total;
        let var: f64 = x.zip(sigma).map(|(x, s)| ((x - at) * s).powi(2)).sum();
        [at * l, var.sqrt() / total.abs() * l]
    });
    session.put(
        "together",
        json!({
            "mass": total / g * m,
            "mass_sigma": spread / g * m,
            "position": [centre[0][0], centre[1][0]],
            "position_sigma": [centre[0][1], centre[1][1]],
        }),
    )?;
    session.put("completed_deck", format!("{DECK}.bdf"))
}

#[allow(clippy::too_many_arguments)]
pub(super) fn write(
    session: &mut Session,
    arguments: &JobArguments,
    task: &Task,
    measured: &[f64],
    before: &[f64],
    after: &[f64],
    fit: &BallastFit,
    height: f64,
) -> Result<(), Faults> {
    let job = task.job;
    let (f, l, m) = (force(job), length(job), mass(job));
    let units = &job.report_units;
    let reactions: Vec<[f64; 3]> = (0..measured.len())
        .map(|i| [measured[i] * f, before[i] * f, after[i] * f])
        .collect();
    let names: Vec<&str> = task
        .wheels
        .loads
        .iter()
        .map(|w| job.loads[*w].name.as_str())
        .collect();
    let shown: Vec<Vec<String>> = names
        .iter()
        .zip(&reactions)
        .map(|(n, r)| {
            vec![
                (*n).to_owned(),
                number(r[0]),
                number(r[1]),
                number(r[2]),
                format!("{:+.2} %", 100.0 * (r[2] / r[0] - 1.0)),
            ]
        })
        .collect();
    let masses: Vec<Vec<String>> = fit
        .masses
        .iter()
        .enumerate()
        .map(|(k, b)| {
            let range =
                |r: [f64; 2], u: f64| format!("{} to {}", number(r[0] * u), number(r[1] * u));
            vec![
                (k + 1).to_string(),
                number(b.weight / task.gravity * m),
                range(b.weight_range, m / task.gravity),
                number(b.at[0] * l),
                range(b.at_range[0], l),
                number(b.at[1] * l),
                range(b.at_range[1], l),
            ]
        })
        .collect();
    for (n, r) in names.iter().zip(&reactions) {
        session.say(format!(
            "{n}: measured {:.3}, before {:.3}, after {:.3} {}",
            r[0], r[1], r[2], units.force.name
        ));
    }
    for b in &fit.masses {
        session.say(format!(
            "mass {:.4} {} at {:.4}, {:.4} {}",
            b.weight / task.gravity * m,
            units.mass.name,
            b.at[0] * l,
            b.at[1] * l,
            units.length.name
        ));
    }
    let sections = vec![
        table_section(
            &format!("Reactions, {}", units.force.name),
            &["wheel", "measured", "before", "after", "off"],
            &shown,
            "After: the completed deck, read back and solved.",
        ),
        table_section(
            &format!("Masses, {} and {}", units.mass.name, units.length.name),
            &["mass", "size", "95 %", "along", "95 %", "across", "95 %"],
            &masses,
            &format!(
                "Ranges: what the data leave one number when the others are adjusted. Height {} (no influence on a level floor).",
                number(height * l)
            ),
        ),
    ];
    let page = Page::new(
        &job.title,
        "Masses that complete the model",
        &session.findings,
        sections,
    );
    let out = session.output_for(&arguments.job)?;
    out.write("reactions.csv", |w| {
        writeln!(w, "name,measured,before,after")?;
        for (n, r) in names.iter().zip(&reactions) {
            writeln!(w, "{n},{},{},{}", r[0], r[1], r[2])?;
        }
        Ok(())
    })
    .map_err(Faults::from)?;
    out.write("masses.csv", |w| {
        writeln!(
            w,
            "mass,mass.low,mass.high,along,along.low,along.high,across,across.low,across.high"
        )?;
        for b in &fit.masses {
            let g = task.gravity;
            let line: Vec<String> = [b.weight, b.weight_range[0], b.weight_range[1]]
                .map(|v| v / g * m)
                .into_iter()
                .chain(
                    (0..2)
                        .flat_map(|k| [b.at[k], b.at_range[k][0], b.at_range[k][1]].map(|v| v * l)),
                )
                .map(|v| v.to_string())
                .collect();
            writeln!(w, "{}", line.join(","))?;
        }
        Ok(())
    })
    .map_err(Faults::from)?;
    session.write_page(&arguments.job, page)
}
