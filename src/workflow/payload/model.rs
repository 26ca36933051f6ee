//! How gauges and wheels answer to the payload: from the deck, or from the tables of `[sensitivity]`.

use super::task::Task;
use crate::fe::floor::solve_standing;
use crate::fe::{CaseResult, Support, UnitLoad};
use crate::finding::{Finding, Severity};
use crate::gauge::gauge_reading;
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::work::Work;
use crate::job::payload_loads::part_of;
use crate::job::payload_signature::{COLUMNS, note_unread};
use crate::job::table::read_table;
use crate::job::{GivenSensitivity, Job, LoadActs, NamedFile};
use crate::linalg::Matrix;
use crate::measured::noise::prepare_with_noise;
use crate::measured::wheels::{basic_dof, floor_fault, wheels_of};
use crate::model::{GridIx, Model, Vec3};
use crate::payload::PayloadModel;
use crate::sensitivity::{Sensitivity, Uncertainty, check_separability};
use crate::strain_chain::built_in_solver::{stands_on_wheels, support_of_job, unit_loads_kept};
use crate::strain_chain::job_deck::read_deck;
use crate::strain_chain::{Fields, JobSensitivity, has_covariance, subtract_from_additional_loads};
use crate::units::MICROSTRAIN;

/// The payload model, together with the data that the report plots.
pub(super) struct Parts {
    /// Model in report units of force and length.
    pub model: PayloadModel,
    /// S and gauges. `None` if strain is not used.
    pub prepared: Option<JobSensitivity>,
}

/// Returns the model in report units. It also sets the nominal place, the wheels and their reactions to the empty structure.
///
/// # Errors
/// Faults of deck, gauges and tables, or a payload without a grid.
pub(super) fn model_of(
    work: &mut Work,
    task: &mut Task,
    use_strain: bool,
) -> Result<Parts, Faults> {
    // A calibrated S can be used together with the model, which contains the signature of the payload.
    let calibrated_with_model = has_covariance(task.job) && task.job.model.is_some();
    if task.job.sensitivity.is_some() && !calibrated_with_model {
        return read_model_tables(work, task, use_strain);
    }
    let prepared = if use_strain {
        Some(prepare_with_noise(work, task.job)?)
    } else {
        None
    };
    if let Some(p) = &prepared {
        work.findings.extend(check_separability(&p.sensitivity));
    }
    match prepared.as_ref().and_then(|p| p.fields.as_ref()) {
        Some(fields) => {
            let support = support_of_job(task.job, fields.model())?;
            let model = match (support.is_held(), &prepared) {
                (true, Some(p)) => build_supported_model(work, task, p, fields, support)?,
                _ => build_model_on_wheels(work, task, fields.model(), prepared.as_ref())?,
            };
            Ok(Parts { model, prepared })
        }
        None => {
            let Some(files) = &task.job.model else {
                return Err(Faults::from(Fault::new(
                    &*task.job.file,
                    "model",
                    "the job has neither [model] nor [sensitivity]",
                    "name the deck: [model] deck = \"model.bdf\"",
                )));
            };
            let read = work.stage("read model", |s| read_deck(s, task.job, files))?;
            let model = build_model_on_wheels(work, task, &read.model, None)?;
            Ok(Parts {
                model,
                prepared: None,
            })
        }
    }
}

/// Returns the grid of the payload, which the deck must have.
fn payload_grid(task: &Task, model: &Model) -> Result<(GridIx, u32), Faults> {
    let fault = |wrong: String| {
        Faults::from(Fault::with_line(
            &*task.job.file,
            task.payload.line,
            "payload.grid",
            wrong,
            "name the grid where the payload acts, such as the reference grid of its RBE3",
        ))
    };
    let id = task
        .job
        .payload_grid()
        .ok_or_else(|| fault("the key is missing".into()))?;
    model
        .grid_ix(id)
        .map(|ix| (ix, id))
        .ok_or_else(|| fault(format!("the deck has no grid {id}")))
}

/// Place of the payload: its grid and the axis of its weight.
#[derive(Clone, Copy)]
struct Place {
    grid: GridIx,
    id: u32,
    axis: usize,
}

/// Weight down; its shift along b turns about c, along c against b.
const SIGNS: [f64; 3] = [-1.0, -1.0, 1.0];
/// Part of `p = (F, F dx, F dy)` of each of [`Place::parts`].
const SHIFT_OF: [usize; 3] = [0, 2, 1];

impl Place {
    fn axes(self) -> [usize; 3] {
        [self.axis, (self.axis + 1) % 3, (self.axis + 2) % 3]
    }

    /// Returns force and moment of three unit loads: a force along the axis, and a moment about each other axis.
    fn parts(self) -> [(Vec3, Vec3); 3] {
        let [a, b, c] = self.axes();
        let unit = |axis: usize| {
            let mut v = Vec3::zeros();
            v[axis] = 1.0;
            v
        };
        [
            (unit(a), Vec3::zeros()),
            (Vec3::zeros(), unit(b)),
            (Vec3::zeros(), unit(c)),
        ]
    }

    fn unit_loads(self) -> Vec<UnitLoad> {
        let parts = self.parts();
        let at_grid = parts.iter().map(|(force, moment)| UnitLoad::AtGrid {
            grid: self.grid,
            force: *force,
            moment: *moment,
        });
        at_grid.collect()
    }
}

/// Returns the job's own loads at the payload's grid, by part.
fn own_columns(job: &Job, model: &Model, place: Place) -> [Option<usize>; 3] {
    let [a, b, c] = place.axes();
    [a, 3 + b, 3 + c].map(|component| {
        job.loads.iter().position(|l| {
            matches!(l.acts, LoadActs::AtGrid { grid, component: d, cid } if grid == place.id && basic_dof(model, grid, d.dof(), cid) == Some(component))
        })
    })
}

/// Returns the strain of the payload's parts by gauge: the job's own column, or the solution in `others` if the job has no column.
fn payload_strain(
    (job, model): (&Job, &Model),
    p: &JobSensitivity,
    place: Place,
    others: &[CaseResult],
) -> Matrix {
    let mut out = Matrix::zeros(p.gauges.len(), 3);
    for (k, own) in own_columns(job, model, place).into_iter().enumerate() {
        for (g, gauge) in p.gauges.iter().enumerate() {
            let v = match own {
                Some(l) => p.sensitivity.values[(g, l)],
                None => gauge_reading(gauge, &others[k]).unwrap_or(0.0),
            };
            out[(g, SHIFT_OF[k])] = SIGNS[k] * v;
        }
    }
    out
}

/// Returns the strain per report force, and per report force and length of shift.
fn in_report_units(task: &Task, columns: &Matrix) -> Matrix {
    let per = report_units(task);
    Matrix::from_fn(columns.nrows(), 3, |g, k| columns[(g, k)] * per[k])
}

/// Returns the number of job units in one report unit, for weight and for weight times shift.
fn report_units(task: &Task) -> [f64; 3] {
    let shift = 1.0 / (task.force * task.length);
    [1.0 / task.force, shift, shift]
}

/// Returns the uncertainty of the columns of `p` from a calibrated S. `columns`: for each column its load of S, with its sign.
fn calibrated_uncertainty(
    task: &Task,
    s: &Sensitivity,
    columns: [Option<(usize, f64)>; 3],
) -> Option<Uncertainty> {
    let known = s
        .uncertainty
        .as_ref()
        .filter(|_| has_covariance(task.job))?;
    let per = report_units(task);
    // A missing column has no strain and no uncertainty.
    let one = |k: usize| columns[k].map_or((0, 0.0), |(l, sign)| (l, sign * per[k]));
    Some(known.of_loads(&[one(0), one(1), one(2)]))
}

/// Builds the payload model from the deck of a structure on supports. The supports carry the payload, so only strain measures its weight.
fn build_supported_model(
    work: &mut Work,
    task: &mut Task,
    prepared: &JobSensitivity,
    fields: &Fields,
    support: Support,
) -> Result<PayloadModel, Faults> {
    let job = task.job;
    let (grid, id) = payload_grid(task, fields.model())?;
    // The weight acts along the job's own force at that grid, or along z if there is no such force.
    let own = job.loads.iter().find_map(|l| match l.acts {
        LoadActs::AtGrid {
            grid,
            component,
            cid,
        } if grid == id && component.is_force() => {
            basic_dof(fields.model(), grid, component.dof(), cid)
        }
        _ => None,
    });
    let place = Place {
        grid,
        id,
        axis: own.unwrap_or(2),
    };
    let loads = place.unit_loads();
    let mut solution = work.stage("solve on the supports", |w| {
        let made = (&fields.deck, "payload on supports");
        unit_loads_kept(w, made, (fields.model(), support), &loads)
    })?;
    let known = (&fields.deck, fields.mesh_error.as_ref());
    subtract_from_additional_loads(work, job, known, (&loads, &mut solution.cases))?;
    let [_, b, c] = place.axes();
    let at = fields.model().grids.get(grid.us());
    let at = at.map_or_else(Vec3::zeros, |g| g.x);
    task.nominal = [at[b] * task.length, at[c] * task.length];
    work.findings.push(Finding::new(
        Severity::Info,
        "payload-on-supports",
        "payload",
        format!(
            "the structure is {}: its supports carry the payload, and only strain determines it",
            support.words()
        ),
        "write support = \"free\" if wheels carry it",
    ));
    let columns = payload_strain((job, fields.model()), prepared, place, &solution.cases);
    let own = own_columns(job, fields.model(), place);
    let mut calibrated_columns = [None; 3];
    for (k, l) in own.iter().enumerate() {
        calibrated_columns[SHIFT_OF[k]] = l.map(|l| (l, SIGNS[k]));
    }
    // If a column comes from the model, the calibrated covariance does not cover all columns.
    let all_own = own.iter().all(Option::is_some);
    Ok(PayloadModel {
        calibrated: calibrated_uncertainty(task, &prepared.sensitivity, calibrated_columns)
            .filter(|_| all_own),
        noise: prepared.sensitivity.noise.clone(),
        gauges: prepared.sensitivity.gauges.clone(),
        wheels: Matrix::zeros(columns.nrows(), 0),
        payload: in_report_units(task, &columns),
        floor: Some(Matrix::zeros(0, 3)),
        arms: None,
    })
}

/// Builds the payload model from the deck: unit loads at wheels and payload on the free structure, and the floor.
fn build_model_on_wheels(
    work: &mut Work,
    task: &mut Task,
    model: &Model,
    prepared: Option<&JobSensitivity>,
) -> Result<PayloadModel, Faults> {
    let job = task.job;
    stands_on_wheels(job, model, "a payload over wheel forces")?;
    let wheels = wheels_of(job, model)?;
    let (grid, id) = payload_grid(task, model)?;
    let (a, b, c) = (wheels.axis, (wheels.axis + 1) % 3, (wheels.axis + 2) % 3);
    let place = Place { grid, id, axis: a };
    let others = place.parts();
    let loads = place.unit_loads();
    let mut standing = work
        .stage("solve on the floor", |_| {
            solve_standing(model, a, &wheels.grids, &loads, None)
        })
        .map_err(|e| floor_fault(job, &e))?;
    if let Some(fields) = prepared.and_then(|p| p.fields.as_ref()) {
        let known = (&fields.deck, fields.mesh_error.as_ref());
        subtract_from_additional_loads(work, job, known, (&loads, &mut standing.others))?;
    }
    let at = model.grids.get(grid.us()).map_or_else(Vec3::zeros, |g| g.x);
    let n = wheels.grids.len();
    let mut floor = Matrix::zeros(n, 3);
    for (k, (force, moment)) in others.iter().enumerate() {
        let lift = standing.lift(&standing.others[k]);
        let r = standing
            .floor
            .reactions(&standing.floor.load(at, *force, *moment, lift));
        for (w, r) in r.iter().enumerate() {
            floor[(w, SHIFT_OF[k])] = SIGNS[k] * r;
        }
    }
    task.empty = standing
        .under_weight(model, job.gravity())
        .iter()
        .map(|r| r * task.force)
        .collect();
    task.wheels = wheels
        .loads
        .iter()
        .map(|l| job.loads[*l].name.clone())
        .collect();
    task.nominal = [at[b] * task.length, at[c] * task.length];
    work.findings.push(Finding::new(
        Severity::Info,
        "flat-floor-assumed",
        "payload",
        "without measured wheel forces, the structure is assumed on a flat, level, frictionless floor; its springs determine how the wheels share the payload, and tyres are rigid",
        "",
    ));
    let (gauges, wheel_columns, payload_columns) = match prepared {
        None => (Vec::new(), Matrix::zeros(0, n), Matrix::zeros(0, 3)),
        Some(p) => {
            let s = &p.sensitivity;
            let rows = s.gauges.len();
            let columns =
                Matrix::from_fn(rows, n, |g, w| s.values[(g, wheels.loads[w])] / task.force);
            let direct = payload_strain((job, model), p, place, &standing.others);
            (s.gauges.clone(), columns, direct)
        }
    };
    let payload = in_report_units(task, &payload_columns);
    let floor = Matrix::from_fn(n, 3, |w, k| {
        floor[(w, k)] / if k == 0 { 1.0 } else { task.length }
    });
    let arms = standing
        .floor
        .positions()
        .iter()
        .map(|x| [(x[b] - at[b]) * task.length, (x[c] - at[c]) * task.length])
        .collect();
    Ok(PayloadModel {
        gauges,
        wheels: wheel_columns,
        payload,
        floor: Some(floor),
        arms: Some(arms),
        calibrated: None,
        noise: prepared.and_then(|p| p.sensitivity.noise.clone()),
    })
}

/// Reads the model from tables: S, and the payload's signature `b0, b_dx, b_dy` per mass.
fn read_model_tables(work: &mut Work, task: &mut Task, use_strain: bool) -> Result<Parts, Faults> {
    let job = task.job;
    let Some(tables) = &job.sensitivity else {
        return Err(Fault::new(
            &*job.file,
            "sensitivity",
            "the job has no [sensitivity]",
            "name the table of S: [sensitivity] file = \"S.csv\"",
        )
        .into());
    };
    let prepared = prepare_with_noise(work, job)?;
    let s = &prepared.sensitivity;
    let vertical: Vec<usize> = (0..s.loads.len())
        .filter(|l| {
            let name = &s.loads[*l].name;
            s.loads[*l].wanted && name.split(['.', '_', ' ']).any(|p| p == "FZ")
        })
        .collect();
    task.wheels = vertical.iter().map(|l| s.loads[*l].name.clone()).collect();
    let to_si = |x: Option<f64>| x.unwrap_or(0.0) * task.length;
    task.nominal = [to_si(task.payload.nominal_x), to_si(task.payload.nominal_y)];
    let n = s.gauges.len();
    let mut payload = Matrix::zeros(n, 3);
    let mut on_wheels = true;
    let mut known = None;
    if use_strain {
        let own = calibrated_columns(task, s);
        match (&tables.signatures.payload, own) {
            (Some(file), _) => payload = signature(work, task, tables, file, s)?,
            (None, Some(own)) => {
                payload = in_report_units(task, &columns_of(s, own));
                known = calibrated_uncertainty(task, s, own);
                // A calibration with known payload includes all effects of the payload on the structure, also through the wheels.
                on_wheels = !vertical.is_empty();
            }
            (None, None) => {
                return Err(Faults::from(Fault::with_line(
                    &*job.file,
                    tables.line,
                    "sensitivity.signatures.payload",
                    "the job gives S, and not the payload's signature",
                    "name its table: signatures = { payload = \"B_payload.csv\" } with columns gauge, b0, b_dx, b_dy; or calibrate with payloads of \
                     known mass and a [[load]] name = \"payload\"",
                )));
            }
        }
    }
    let model = PayloadModel {
        gauges: if use_strain {
            s.gauges.clone()
        } else {
            Vec::new()
        },
        wheels: Matrix::from_fn(if use_strain { n } else { 0 }, vertical.len(), |g, w| {
            s.values[(g, vertical[w])] / task.force
        }),
        payload: if use_strain {
            payload
        } else {
            Matrix::zeros(0, 3)
        },
        floor: (!on_wheels).then(|| Matrix::zeros(0, 3)),
        arms: None,
        calibrated: known,
        noise: s.noise.clone().filter(|_| use_strain),
    };
    Ok(Parts {
        model,
        prepared: Some(prepared),
    })
}

/// Loads of a calibrated S, with their signs, that are `p = (F, F dx, F dy)`; `None` without the weight.
fn calibrated_columns(task: &Task, s: &Sensitivity) -> Option<[Option<(usize, f64)>; 3]> {
    let job = task.job;
    let part = |l: usize| part_of(job, &s.loads[l].name).filter(|_| has_covariance(job));
    let mut out = [None; 3];
    for l in 0..s.loads.len() {
        let Some(parts) = part(l) else { continue };
        for (k, sign) in parts.into_iter().enumerate().filter(|p| p.1 != 0.0) {
            out[k] = Some((l, sign));
        }
    }
    out[0].map(|_| out)
}

/// Returns the columns of the payload's loads, strain per job unit.
fn columns_of(s: &Sensitivity, loads: [Option<(usize, f64)>; 3]) -> Matrix {
    Matrix::from_fn(s.gauges.len(), 3, |g, k| {
        loads[k].map_or(0.0, |(l, sign)| sign * s.values[(g, l)])
    })
}

/// Returns the payload's signature from its table: strain per report force, and per report force and length of shift.
fn signature(
    work: &mut Work,
    task: &Task,
    tables: &GivenSensitivity,
    file: &NamedFile,
    s: &Sensitivity,
) -> Result<Matrix, Faults> {
    let job = task.job;
    let mut payload = Matrix::zeros(s.gauges.len(), 3);
    let text = work
        .inputs
        .read_named_text(job, file)
        .map_err(Faults::from)?;
    let table = read_table(&file.given, &text)?;
    let key = table.column(&["gauge", "name"]).unwrap_or(0);
    note_unread(&mut work.inputs, &table, key);
    let mut faults: FaultList = table.rows_named_twice(key, "gauge");
    // The factors convert microstrain per mass (and length) of the table to strain per report force (and length).
    let mass = job.report_units.mass.si / tables.per.mass.si;
    let length = job.report_units.length.si / tables.per.length.si;
    for (g, name) in s.gauges.iter().enumerate() {
        let Some(row) = table.rows.iter().position(|r| r.1.get(key) == Some(name)) else {
            faults.push(Fault::new(
                &*file.given,
                "gauge",
                format!("no row for gauge `{name}`"),
                "add a row for every gauge",
            ));
            continue;
        };
        for (k, column) in COLUMNS.into_iter().take(3).enumerate() {
            let Some(c) = table.column(&column) else {
                continue;
            };
            match table.number(row, c) {
                Ok(v) => {
                    let per = MICROSTRAIN * mass / task.weight_of_mass;
                    payload[(g, k)] = v.unwrap_or(0.0) * per * if k == 0 { 1.0 } else { length };
                }
                Err(f) => faults.push(f),
            }
        }
    }
    Faults::check(faults)?;
    Ok(payload)
}
