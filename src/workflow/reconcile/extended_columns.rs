//! The columns of S in the tables of the extended job. They have the names and units of the job's own tables, so that every other table of the job
//! remains valid.

use super::extended_loads::component_word;
use super::extended_model::ExtendedS;
use super::matrix_frame::{payload_scale, quantity_of_load};
use crate::job::{Component, Job};
use crate::reconcile::strain::{N_PAYLOAD_COLUMNS, StrainFrame};
use crate::units::{KILO, Quantity, ReportUnits};

/// A column of S.
pub struct ExtendedColumn {
    /// Name of the load.
    pub load: String,
    /// Name of the column.
    pub column: String,
    /// Microstrain per unit of the job's `per`, by gauge.
    pub values: Vec<f64>,
}

/// Returns the columns of S: the wanted loads, the other loads of the job, and the loads that were left out.
pub fn sensitivity_columns(job: &Job, frame: &StrainFrame, s: &ExtendedS) -> Vec<ExtendedColumn> {
    let Some(given) = &job.sensitivity else {
        return Vec::new();
    };
    let of_load = |load: &String, quantity: Quantity, values: &mut dyn Iterator<Item = f64>| {
        let stated = given.columns.iter().find(|c| c.0 == *load);
        let factor = per_kilo(&given.per, quantity);
        ExtendedColumn {
            load: load.clone(),
            column: stated.map_or_else(|| load.clone(), |c| c.1.clone()),
            values: values.map(|v| v / factor).collect(),
        }
    };
    let n_c = frame.n_columns().max(1);
    let wanted = frame.load_names.iter().enumerate().map(|(k, load)| {
        let rows = s.influence.chunks_exact(n_c);
        let mut values = rows.filter_map(|row| row.get(k).copied());
        of_load(load, quantity_of_load(job, load), &mut values)
    });
    let known = s.known.iter().map(|(load, values)| {
        let quantity = quantity_of_load(job, load);
        of_load(load, quantity, &mut values.iter().copied())
    });
    let left_out = s.left_out.iter().map(|(load, values, _)| {
        let quantity = quantity_left_out(load);
        of_load(load, quantity, &mut values.iter().copied())
    });
    wanted.chain(known).chain(left_out).collect()
}

/// Returns the quantity (force or moment) of the component that the job gives to a load that was left out.
fn quantity_left_out(load: &str) -> Quantity {
    let word = component_word(load);
    let component = Component::ALL.into_iter().find(|c| c.name() == word);
    component.map_or(Quantity::Force, Component::quantity)
}

/// Returns the size of a load that was left out, kN or kN m, in the units of the job.
pub(super) fn typical_size(job: &Job, load: &str, kilo: f64) -> f64 {
    kilo * KILO / job.units.si(quantity_left_out(load))
}

/// Returns the factors on the columns of the payload, from the units of the job's tables to the units of the frame.
pub fn payload_factors(job: &Job) -> [f64; N_PAYLOAD_COLUMNS] {
    job.sensitivity.as_ref().map_or([1.0; 4], |given| {
        payload_scale(1.0 / given.per.mass.si, 1.0 / given.per.length.si)
    })
}

fn per_kilo(per: &ReportUnits, quantity: Quantity) -> f64 {
    KILO / per.unit(quantity).si
}
