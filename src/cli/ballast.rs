//! `ballast`: lumped masses that bring the model's reactions to the measured ones, and the deck with them in it.

use super::deck::{DeckModel, model_of_deck, read_model};
use super::fault::{Fault, Faults};
use super::job::runs::read_runs;
use super::job::{self, Ballast, Job};
use super::wheels::{Wheels, floor_fault, wheels_of};
use super::{JobArguments, Session};
use crate::fe::floor::{Standing, solve_standing};
use crate::finding::{Finding, Severity};
use crate::model::{GridIx, Vec3};
use crate::payload::{BallastFit, BallastSpec, Carriers, size_ballast, spread};
use crate::report::strain::{number, page, table_section};
use crate::units::{Quantity, factor};
use nastran::bdf::{Edits, Field, format_card, write_edited};
use serde_json::json;

/// The completed deck.
const DECK: &str = "completed";
/// Noise of a measured reaction where the job states none, of the mean reaction.
const ASSUMED_NOISE: f64 = 0.01;
/// Misfit of a reaction above which the masses do not explain it, of the measured value.
const MATCHED: f64 = 0.02;

struct Task<'a> {
    job: &'a Job,
    ballast: &'a Ballast,
    read: &'a DeckModel,
    wheels: Wheels,
    standing: Standing,
    gravity: f64,
}

/// Reads, sizes, writes the completed deck, solves it and reports.
pub fn run(arguments: &JobArguments, session: &mut Session) -> Result<(), Faults> {
    let job = session.stage("read job", |s| job::read_job(&mut s.inputs, &arguments.job))?;
    session.put_units(job.units, &job.report_units);
    let missing = |field: &str, example: &str| {
        vec![Fault::of(
            &*job.file,
            field,
            format!("the job has no [{field}]"),
            example,
        )]
    };
    let ballast = job.ballast.as_ref().ok_or_else(|| {
        missing(
            "ballast",
            "state what is looked for: [ballast] masses = 2, region = [[x0, x1], [y0, y1]]",
        )
    })?;
    let files = job
        .model
        .as_ref()
        .ok_or_else(|| missing("model", "name the deck: [model] deck = \"model.bdf\""))?;
    let read = session
        .stage("read model", |s| {
            read_model(&mut s.inputs, &job.folder, &files.deck.given)
        })
        .map_err(|f| vec![f])?;
    if !read.faults.is_empty() {
        return Err(read.faults);
    }
    if read.deck.sources.is_empty() {
        return Err(vec![Fault::of(
            &*job.file,
            "model.deck",
            "an OP2 is no deck that could be completed",
            "name the deck",
        )]);
    }
    session.findings.extend(read.findings.iter().cloned());
    let wheels = wheels_of(&job, &read.model)?;
    let standing = session
        .stage("solve", |_| {
            solve_standing(&read.model, wheels.axis, &wheels.grids, &[], None)
        })
        .map_err(|e| floor_fault(&job, &e))?;
    let task = Task {
        job: &job,
        ballast,
        read: &read,
        wheels,
        standing,
        gravity: ballast
            .gravity_m_s2
            .map_or(job.units.standard_gravity(), |g| g / job.units.length_m()),
    };
    let (run, measured, sigma) = measured(session, &task)?;
    let carriers = Carriers::of(&read.model, task.wheels.axis, |p| {
        ballast
            .properties
            .as_ref()
            .is_none_or(|ids| ids.contains(p))
    });
    let (region, height) = region(&task, &carriers)?;
    let before = task.standing.under_weight(&read.model, task.gravity);
    let lacking: f64 = measured.iter().sum::<f64>() - before.iter().sum::<f64>();
    let largest = ballast
        .max_mass
        .map_or(lacking.max(0.0), |m| m * task.gravity);
    if !(largest > 0.0) {
        return Err(vec![Fault::at(
            &*job.file,
            ballast.line,
            "ballast",
            format!(
                "the model already weighs {} {} more than run `{run}` measured",
                number(-lacking * force(&job)),
                job.report_units.force.name
            ),
            "take masses out of the deck, or check the units of the runs file",
        )]);
    }
    let mut on_a_line = false;
    let spec = BallastSpec {
        masses: ballast.masses,
        region,
        largest,
        sigma: sigma.clone(),
    };
    let fit = session.stage("size", |_| {
        let n = measured.len();
        let table_failed = std::cell::Cell::new(false);
        let fit = size_ballast(
            &before,
            &measured,
            |place| match hung(&task, &carriers, place, height, 1.0) {
                Some(forces) => task.standing.under_forces(&read.model, &forces),
                None => {
                    table_failed.set(true);
                    vec![0.0; n]
                }
            },
            &spec,
        );
        on_a_line = table_failed.get();
        fit
    });
    if on_a_line {
        return Err(vec![Fault::at(
            &*job.file,
            ballast.line,
            "ballast.region",
            "the grids near part of the region lie on a line and can't hold a mass",
            "name properties of both rails in `properties`, or narrow the region",
        )]);
    }
    let (cards, text) = cards(&task, &carriers, &fit, height);
    let mut edits = Edits::default();
    edits.insert_cards(&read.deck, &text);
    let edited = write_edited(&read.deck, &edits);
    let after = session.stage("solve completed deck", |s| after(s, &task, &edited))?;
    findings(session, &task, &run, &measured, &sigma, &after, &fit, &spec);
    put(
        session, &task, &run, &measured, &sigma, &before, &after, &fit, &cards,
    )?;
    write(
        session, arguments, &task, &measured, &before, &after, &fit, height,
    )?;
    let folder = session.output_for(&arguments.job)?.folder().to_owned();
    let files = super::cases::relocated(&read.deck, edited, &folder, DECK);
    let out = session.output_for(&arguments.job)?;
    for (name, bytes) in files {
        out.write_bytes(&name, &bytes).map_err(|f| vec![f])?;
    }
    Ok(())
}

fn force(job: &Job) -> f64 {
    factor(job.units, job.report_units.force)
}

fn length(job: &Job) -> f64 {
    factor(job.units, job.report_units.length)
}

fn mass(job: &Job) -> f64 {
    factor(job.units, job.report_units.mass)
}

/// Name, reactions and their sd in job units of the run asked for, in the order of the wheels.
fn measured(session: &mut Session, task: &Task) -> Result<(String, Vec<f64>, Vec<f64>), Faults> {
    let job = task.job;
    let Some(runs) = &job.runs else {
        return Err(vec![Fault::of(
            &*job.file,
            "runs",
            "the job has no [runs]",
            "name the measured reactions: [runs] file = \"runs.csv\"",
        )]);
    };
    let rows = read_runs(&mut session.inputs, job, runs)?;
    let row = match &task.ballast.run {
        Some(name) => rows.iter().find(|r| r.run == *name),
        None => rows.first(),
    };
    let Some(row) = row else {
        return Err(vec![Fault::at(
            &*job.file,
            task.ballast.line,
            "ballast.run",
            format!("`{}` has no such run", runs.file.given),
            "name a run of the runs file",
        )]);
    };
    let newton = job.units.si(Quantity::Force);
    let mut faults = Faults::new();
    let mut values = Vec::new();
    for l in &task.wheels.loads {
        let name = &job.loads[*l].name;
        match row.loads_si.get(name) {
            Some(v) => values.push(v / newton),
            None => faults.push(Fault::at(
                &*runs.file.given,
                row.line,
                name.clone(),
                format!("run `{}` has no reaction of `{name}`", row.run),
                "measure every wheel, or take its load out of the job",
            )),
        }
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    let mean = values.iter().sum::<f64>().abs() / values.len() as f64;
    let sigma = match runs.noise.force.filter(|s| *s > 0.0) {
        Some(s) => s * runs.units.force.si / newton,
        None => {
            session.findings.push(
                Finding::new(
                    Severity::Info,
                    "reaction-noise-assumed",
                    "runs.noise.force",
                    "the job does not say how well the reactions are measured: 1 % of their mean is taken",
                    "state [runs] noise = { force = 0.06 }",
                )
                .with_numbers(ASSUMED_NOISE * mean * force(job), 0.0),
            );
            ASSUMED_NOISE * mean
        }
    };
    let n = values.len();
    Ok((row.run.clone(), values, vec![sigma; n]))
}

/// Where masses may sit in plan, and their height.
fn region(task: &Task, carriers: &Carriers) -> Result<([[f64; 2]; 2], f64), Faults> {
    let Some([b, c, up]) = carriers.extent() else {
        return Err(vec![Fault::at(
            &*task.job.file,
            task.ballast.line,
            "ballast.properties",
            "no shell, bar or beam has such a property",
            "name properties that can carry a mass",
        )]);
    };
    Ok(match task.ballast.region.as_deref() {
        Some([x, y]) => ([*x, *y], up[1]),
        Some([x, y, z, ..]) => ([*x, *y], (z[0] + z[1]) / 2.0),
        _ => ([b, c], up[1]),
    })
}

/// Forces of a unit weight times `weight` at a place on the grids that carry it.
fn hung(
    task: &Task,
    carriers: &Carriers,
    place: [f64; 2],
    height: f64,
    weight: f64,
) -> Option<Vec<(GridIx, Vec3)>> {
    let mut down = Vec3::zeros();
    down[task.wheels.axis] = -weight;
    spread(
        &task.read.model,
        &carriers.arms(place),
        carriers.point(place, height),
        down,
    )
}

/// Ids of one mass in the completed deck.
struct MassCards {
    grid: u32,
    rbe3: u32,
    conm2: u32,
}

/// Cards of the masses: a grid, an RBE3 that ties it to the carriers, a CONM2.
fn cards(
    task: &Task,
    carriers: &Carriers,
    fit: &BallastFit,
    height: f64,
) -> (Vec<MassCards>, String) {
    let m = &task.read.model;
    let mut grid = m.grids.iter().map(|g| g.id).max().unwrap_or(0);
    let elements = [
        m.shells.iter().map(|e| e.id).max(),
        m.beams.iter().map(|e| e.id).max(),
        m.rods.iter().map(|e| e.id).max(),
        m.bushes.iter().map(|e| e.id).max(),
        m.springs.iter().map(|e| e.id).max(),
        m.solids.iter().map(|e| e.id).max(),
        m.shear_panels.iter().map(|e| e.id).max(),
        m.masses.iter().map(|e| e.id).max(),
        m.rigids.iter().map(|e| e.id).max(),
    ];
    let mut element = elements.into_iter().flatten().max().unwrap_or(0);
    let (mut ids, mut text) = (Vec::new(), String::new());
    for (k, b) in fit.masses.iter().enumerate() {
        let own = MassCards {
            grid: grid + 1,
            rbe3: element + 1,
            conm2: element + 2,
        };
        (grid, element) = (own.grid, own.conm2);
        let x = carriers.point(b.at, height);
        text += &format!("$ Ballast {} of {}\n", k + 1, fit.masses.len());
        text += &format_card(
            "GRID",
            &[
                own.grid.into(),
                0_u32.into(),
                x.x.into(),
                x.y.into(),
                x.z.into(),
                0_u32.into(),
            ],
        );
        let mut fields: Vec<Field> = vec![
            own.rbe3.into(),
            Field::Blank,
            own.grid.into(),
            123_456_u32.into(),
            1.0.into(),
            123_u32.into(),
        ];
        fields.extend(
            carriers
                .arms(b.at)
                .iter()
                .filter_map(|g| m.grids.get(g.us()))
                .map(|g| Field::from(g.id)),
        );
        text += &format_card("RBE3", &fields);
        let mass = b.weight / task.gravity / m.params.wtmass;
        text += &format_card(
            "CONM2",
            &[own.conm2.into(), own.grid.into(), Field::Blank, mass.into()],
        );
        ids.push(own);
    }
    (ids, text)
}

/// Reactions of the completed deck, read back and solved anew.
fn after(
    session: &mut Session,
    task: &Task,
    edited: &[(String, Vec<u8>)],
) -> Result<Vec<f64>, Faults> {
    let program = |wrong: String| {
        vec![Fault::of(
            format!("{DECK}.bdf"),
            "deck",
            wrong,
            "report this as an error of the program",
        )]
    };
    let bytes = edited
        .first()
        .map(|f| f.1.clone())
        .ok_or_else(|| program("no file".into()))?;
    let completed = model_of_deck(
        &mut session.inputs,
        &task.job.folder,
        &task.read.given,
        &bytes,
    );
    if let Some(f) = completed.faults.first() {
        return Err(program(f.to_string()));
    }
    let grids: Option<Vec<GridIx>> = task
        .wheels
        .grids
        .iter()
        .map(|g| {
            completed
                .model
                .grid_ix(task.read.model.grids.get(g.us())?.id)
        })
        .collect();
    let grids = grids.ok_or_else(|| program("a wheel is gone".into()))?;
    let standing = solve_standing(&completed.model, task.wheels.axis, &grids, &[], None)
        .map_err(|e| floor_fault(task.job, &e))?;
    Ok(standing.under_weight(&completed.model, task.gravity))
}

#[allow(clippy::too_many_arguments)]
fn findings(
    session: &mut Session,
    task: &Task,
    run: &str,
    measured: &[f64],
    sigma: &[f64],
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
    let _ = sigma;
}

#[allow(clippy::too_many_arguments)]
fn put(
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
    let height = |c: &MassCards| c.grid;
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
                "grid": height(c),
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
fn write(
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
    let html = page(
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
    .map_err(|f| vec![f])?;
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
    .map_err(|f| vec![f])?;
    out.write_bytes("report.html", html.as_bytes())
        .map_err(|f| vec![f])
}
