//! Known payload: the strain of a payload that `[runs]` states is subtracted from the readings. With a given S, the strain comes from
//! `[sensitivity] signatures.payload`. With a deck, it comes from the job's nuisance loads at `[payload] grid`.

use super::task::Task;
use crate::finding::{Finding, Severity, list_few};
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::work::Work;
use crate::job::payload_signature::{COLUMNS, note_unread};
use crate::job::table::read_table;
use crate::job::{Component, GivenSensitivity, Job, JobLoad, LoadActs, LoadRole};
use crate::measured::runs_file::{RunRow, read_runs};
use crate::recovery::Readings;
use crate::units::MICROSTRAIN;

/// Loads that are known, by run: number of the load, value in job units. The recovery determines the remainder of these loads.
pub(super) type KnownLoads = Vec<Vec<(usize, f64)>>;

/// Subtracts the strain of the known payload from the readings of every run. The remaining strain is the strain of the loads.
///
/// `strain = m (b0 + dx b_dx + dy b_dy + dx dy b_dxdy)`, `dx`, `dy` from the nominal place of `[payload]`.
///
/// # Errors
/// Unreadable tables, gauges without a row in the signature.
pub(super) fn take_out(
    work: &mut Work,
    task: &Task,
    readings: &mut [Readings],
) -> Result<KnownLoads, Faults> {
    let job = task.job;
    let mut loads: KnownLoads = vec![Vec::new(); readings.len()];
    let Some(runs) = &job.runs else {
        return Ok(loads);
    };
    if !job.payload.as_ref().is_none_or(|p| p.weight_in_model) {
        return Ok(loads);
    }
    let at_grid = at_grid(task);
    let signed = job.sensitivity.as_ref();
    let signed = signed.filter(|s| s.signatures.payload.is_some());
    if signed.is_none() && at_grid.is_none() {
        return Ok(loads);
    }
    let rows = read_runs(&mut work.inputs, job, runs)?;
    let signature = match signed {
        Some(given) => signature(work, task, given)?,
        None => Vec::new(),
    };
    let origin = match &at_grid {
        Some(a) if signed.is_none() => a.origin,
        _ => [0.0; 2],
    };
    let mut unknown: Vec<&str> = Vec::new();
    let mut known = 0;
    for (run, loads) in readings.iter_mut().zip(&mut loads) {
        let row = rows.iter().find(|r| r.run == run.run);
        let Some((kg, dx, dy)) = row.and_then(|r| payload_of(job, r, origin)) else {
            unknown.push(&run.run);
            continue;
        };
        known += 1;
        for (v, b) in run.strain.iter_mut().zip(&signature) {
            *v -= kg * (b[0] + dx * b[1] + dy * b[2] + dx * dy * b[3]);
        }
        if let (Some(at_grid), None) = (&at_grid, signed) {
            *loads = at_grid.loads_of(job, kg, dx, dy);
            let s = &task.prepared.sensitivity.values;
            for (g, v) in run.strain.iter_mut().enumerate() {
                *v -= loads
                    .iter()
                    .filter_map(|(l, f)| Some(s.get((g, *l))? * f))
                    .sum::<f64>();
            }
        }
    }
    if known == 0 {
        return Ok(loads);
    }
    work.findings.push(Finding::new(
        Severity::Info,
        "payload-known",
        "runs",
        "the strain of the payload in the runs file is subtracted from the readings: the loads do not include the payload",
        "",
    ));
    if !unknown.is_empty() {
        work.findings.push(Finding::new(
            Severity::Warning,
            "payload-unknown",
            list_few(&unknown),
            "the runs file states no payload for these runs: none is assumed",
            "state its mass (0 without a payload) and its place",
        ));
    }
    Ok(loads)
}

/// Nuisance loads of a deck's job at the grid of the payload.
struct AtGrid {
    /// Number of the load, what of the payload it is.
    loads: Vec<(usize, Component)>,
    /// Place of the grid, m.
    origin: [f64; 2],
}

impl AtGrid {
    /// Returns the loads of a payload, job units. They are its weight downward, and the moments of a place off the grid (W dx about y, -W dy about
    /// x).
    fn loads_of(&self, job: &Job, kg: f64, dx: f64, dy: f64) -> Vec<(usize, f64)> {
        let weight = kg * job.gravity_m_s2();
        let of = |c: Component| match c {
            Component::FZ => -weight,
            Component::MY => weight * dx,
            Component::MX => -weight * dy,
            _ => 0.0,
        };
        let units = &job.units;
        self.loads
            .iter()
            .map(|(l, c)| (*l, of(*c) / units.si(c.quantity())))
            .collect()
    }
}

/// Returns the load at a grid; `None` if no weight acts there.
fn at_grid(task: &Task) -> Option<AtGrid> {
    let job = task.job;
    let model = task.prepared.fields.as_ref()?.model();
    let id = job.payload_grid()?;
    let place = model.grids.get(model.grid_ix(id)?.us())?.x;
    let length = job.units.length_m();
    let here = |l: &JobLoad| match l.acts {
        LoadActs::AtGrid {
            grid,
            component,
            cid: 0,
        } if grid == id && l.role == LoadRole::Nuisance => Some(component),
        _ => None,
    };
    let loads: Vec<(usize, Component)> = job
        .loads
        .iter()
        .enumerate()
        .filter_map(|(i, l)| Some((i, here(l)?)))
        .collect();
    let weighs = loads.iter().any(|l| l.1 == Component::FZ);
    weighs.then(|| AtGrid {
        loads,
        origin: [place[0] * length, place[1] * length],
    })
}

/// Returns the mass, kg, and the distance from the nominal place, m. If the job states no nominal place, it is `origin`.
fn payload_of(job: &Job, row: &RunRow, origin: [f64; 2]) -> Option<(f64, f64, f64)> {
    let length = job.units.length_m();
    let payload = job.payload.as_ref();
    let kg = row
        .payload_mass_kg
        .or(row.payload_force_n.map(|n| n / job.gravity_m_s2()))?;
    let from = |at: Option<f64>, nominal: Option<f64>, origin: f64| {
        at.map_or(0.0, |x| x - nominal.map_or(origin, |n| n * length))
    };
    let [x, y] = origin;
    Some((
        kg,
        from(row.payload_x_m, payload.and_then(|p| p.nominal_x), x),
        from(row.payload_y_m, payload.and_then(|p| p.nominal_y), y),
    ))
}

/// Returns strain per kg, per kg m along x and y, and per kg m^2, for each gauge of S.
fn signature(
    work: &mut Work,
    task: &Task,
    given: &GivenSensitivity,
) -> Result<Vec<[f64; 4]>, Faults> {
    let Some(file) = &given.signatures.payload else {
        return Ok(Vec::new());
    };
    let text = work
        .inputs
        .read_named_text(task.job, file)
        .map_err(Faults::from)?;
    let table = read_table(&file.given, &text)?;
    let key = table.column(&["gauge", "name"]).unwrap_or(0);
    note_unread(&mut work.inputs, &table, key);
    let (kg, m) = (given.per.mass.si, given.per.length.si);
    let scale = [1.0, 1.0 / m, 1.0 / m, 1.0 / (m * m)].map(|per_m| MICROSTRAIN * per_m / kg);
    let mut faults: FaultList = table.rows_named_twice(key, "gauge");
    let mut out = Vec::new();
    for gauge in &task.prepared.sensitivity.gauges {
        let mut b = [0.0; 4];
        match table.rows.iter().position(|r| r.1.get(key) == Some(gauge)) {
            None => faults.push(Fault::new(
                &*file.given,
                "gauge",
                format!("no row for gauge `{gauge}`"),
                "add a row for every gauge",
            )),
            Some(row) => {
                for ((b, column), scale) in b.iter_mut().zip(COLUMNS).zip(scale) {
                    let Some(c) = table.column(&column) else {
                        continue;
                    };
                    match table.number(row, c) {
                        Ok(v) => *b = v.unwrap_or(0.0) * scale,
                        Err(f) => faults.push(f),
                    }
                }
            }
        }
        out.push(b);
    }
    Faults::check(faults)?;
    Ok(out)
}
