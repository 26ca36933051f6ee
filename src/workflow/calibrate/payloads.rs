//! Payloads of known weight as known loads. Mass and place in the runs file give the columns of the payload loads.

use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::work::Work;
use crate::job::payload_loads::part_of;
use crate::job::table::Table;
use crate::job::{Job, Runs};
use crate::measured::runs_columns::{column_called, known_column};
use crate::measured::runs_file::{RunRow, read_runs};
use crate::sensitivity::Load;
use crate::series::record::{Column, name_and_unit};
use crate::units::Quantity;

/// Names of the columns that state how heavy a payload is, and what they measure.
const STATES: [(&str, Quantity); 2] = [
    ("payload_mass", Quantity::Mass),
    ("payload_force", Quantity::Force),
];

/// Payloads of the runs file.
pub(super) struct Payloads {
    /// Weight (N) and line of the file, for each row of the table.
    weights: Vec<(f64, u32)>,
    /// Column of the runs file that states the payloads.
    column: &'static str,
    /// Whether the job has loads of the payload.
    taught: bool,
    /// Loads that are made of the weight and its place.
    made: Vec<WeightLoad>,
}

/// A load that is the weight times an arm.
struct WeightLoad {
    /// Number of the load.
    load: usize,
    /// Arm of each row of the table, if the standard deviation of the weight is stated.
    arms: Vec<Option<f64>>,
}

/// Adds a column for each payload load that has no column. The columns are `W = m g`, and `W dx` and `W dy` with the distance from the nominal place.
/// If the job states no nominal place, it is `origin` (m). A blank place is the nominal place.
///
/// # Errors
/// Fields that are not numbers, or not a mass, force or place.
pub(super) fn add_columns(
    work: &mut Work,
    (job, runs): (&Job, &Runs),
    table: &mut Table,
    headers: &mut Vec<Column>,
    loads: &[Load],
    origin: [f64; 2],
) -> Result<Option<Payloads>, Faults> {
    let has = |t: &Table, h: &[Column], name: &str| {
        runs.columns.contains_key(name) || !matches!(column_called(job, t, h, name), Ok(None))
    };
    let Some(states) = STATES.iter().find(|s| has(table, headers, s.0)) else {
        return Ok(None);
    };
    let rows = read_runs(&mut work.inputs, job, runs)?;
    let weight = |r: &RunRow| {
        let of_mass = r.payload_mass_kg.map(|m| m * job.gravity_m_s2());
        r.payload_force_n.or(of_mass)
    };
    let mut faults = FaultList::new();
    let sd = weight_sd(job, runs, (table, headers), *states, &mut faults);
    Faults::check(faults)?;
    let nominal = job.payload.as_ref().map(|p| [p.nominal_x, p.nominal_y]);
    let metre = job.units.length_m();
    let arm = |at: Option<f64>, axis: usize| {
        let stated = nominal.and_then(|n| n[axis]).map(|n| n * metre);
        at.map_or(0.0, |x| x - stated.unwrap_or(origin[axis]))
    };
    let mut taught = false;
    let mut made = Vec::new();
    for (number, load) in loads.iter().enumerate() {
        let Some(part) = part_of(job, &load.name) else {
            continue;
        };
        taught = true;
        if has(table, headers, &load.name) {
            continue;
        }
        let is_weight = part[0] != 0.0;
        let quantity = if is_weight {
            Quantity::Force
        } else {
            Quantity::Moment
        };
        let si = runs.units.unit(quantity).si;
        let of = |r: &RunRow| -> f64 {
            part[0] + part[1] * arm(r.payload_x_m, 0) + part[2] * arm(r.payload_y_m, 1)
        };
        let value = |(_, r): (usize, &RunRow)| weight(r).map(|w| w * of(r) / si);
        push(
            table,
            headers,
            &load.name,
            rows.iter().enumerate().map(value),
        );
        let spread = |(i, r): (usize, &RunRow)| Some(sd.get(i).copied()?? * of(r).abs() / si);
        let name = format!("{}_sd", load.name);
        push(table, headers, &name, rows.iter().enumerate().map(spread));
        let stated = rows.iter().zip(&sd);
        made.push(WeightLoad {
            load: number,
            arms: stated.map(|(r, sd)| sd.map(|_| of(r))).collect(),
        });
    }
    let weights = rows.iter().map(|r| (weight(r).unwrap_or(0.0), r.line));
    Ok(Some(Payloads {
        weights: weights.collect(),
        column: states.0,
        taught,
        made,
    }))
}

/// Adds a column of numbers, blank for a missing value.
fn push(
    table: &mut Table,
    headers: &mut Vec<Column>,
    name: &str,
    values: impl Iterator<Item = Option<f64>>,
) {
    let width = table.header.len();
    table.header.push(name.to_owned());
    headers.push(name_and_unit(name));
    for ((_, fields), value) in table.rows.iter_mut().zip(values) {
        fields.resize(width, String::new());
        fields.push(value.map_or_else(String::new, |v| format!("{v:e}")));
    }
}

/// Returns the standard deviation of the weight (N) of each row: from `payload_mass_sd` or `payload_force_sd`, else from the noise in the job.
fn weight_sd(
    job: &Job,
    runs: &Runs,
    (table, headers): (&Table, &[Column]),
    (name, quantity): (&str, Quantity),
    faults: &mut FaultList,
) -> Vec<Option<f64>> {
    let newtons = match quantity {
        Quantity::Mass => job.gravity_m_s2(),
        _ => 1.0,
    };
    let value = known_column(job, runs, table, headers, name, Some(quantity), faults);
    let given = runs.columns.get(name).map_or(name, String::as_str);
    let own = [name, given].map(|n| format!("{n}_sd"));
    let named = own
        .iter()
        .find(|n| !matches!(column_called(job, table, headers, n), Ok(None)));
    let column = named.and_then(|n| {
        let sd = known_column(job, runs, table, headers, n, Some(quantity), faults)?;
        let unit = match sd.is_stated {
            true => sd.unit,
            false => value.and_then(|v| v.unit),
        };
        Some((sd.at, unit.map_or(1.0, |u| u.si)))
    });
    let noise = match quantity {
        Quantity::Mass => runs.noise.mass,
        _ => runs.noise.force,
    };
    let noise = noise.map(|n| n * runs.units.unit(quantity).si * newtons);
    let mut one = |row: usize| {
        let stated = column.and_then(|(at, si)| {
            let read = table.sd(row, at, (Some(quantity), si));
            read.map_err(|f| faults.push(f)).ok()?.map(|v| v * si)
        });
        stated.map(|v| v * newtons).or(noise)
    };
    (0..table.rows.len()).map(&mut one).collect()
}

impl Payloads {
    /// Adds the common error to the covariance of the `k` known loads of a row, which are independent before. Loads that are computed from one weight
    /// share its error: `Cov(W a, W b) = sd_W^2 a b`.
    pub fn share_error(&self, row: usize, covariance: &mut [f64], k: usize) {
        let arm = |m: &WeightLoad| Some((m.load, m.arms.get(row).copied()??));
        let made: Vec<(usize, f64)> = self.made.iter().filter_map(arm).collect();
        for (l, a) in &made {
            for (m, b) in made.iter().filter(|m| m.0 != *l) {
                let size = (covariance[l * k + l] * covariance[m * k + m]).sqrt();
                covariance[l * k + m] = size * a.signum() * b.signum();
            }
        }
    }

    /// Returns a fault if a calibration run carries a payload and the job has no load for it. The strain of the payload would be attributed to the
    /// other loads.
    pub fn find_unaccounted_payload(
        &self,
        job: &Job,
        table: &Table,
        teaching: &[usize],
    ) -> Option<Fault> {
        let in_readings = job.payload.as_ref().is_none_or(|p| p.weight_in_model);
        let heavy = |row: &&usize| self.weights.get(**row).is_some_and(|w| w.0 != 0.0);
        let row = teaching
            .iter()
            .find(heavy)
            .filter(|_| !self.taught && in_readings)?;
        let line = self.weights.get(*row).map_or(0, |w| w.1);
        Some(Fault::with_line(
            &*table.file,
            line,
            self.column,
            "a run of known loads carries a payload, and the job has no load for it",
            "add its weight as a load: [[load]] name = \"payload\". If its place varies, add \"payload.MY\" (weight times x) and \
             \"payload.MX\" (minus weight times y). With a model, the loads act at `[payload] grid`. Known mass and place give the columns",
        ))
    }
}
