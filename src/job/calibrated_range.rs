//! Range of the loads of a calibration, as a job states it.

use super::quantity::quantity_of_name;
use super::types::{Job, JobLoad};
use crate::units::factor;

/// Returns the smallest and the largest known load of the calibration of a load, job units; `None` if the job states none.
pub fn calibrated_range(job: &Job, load: &str) -> Option<[f64; 2]> {
    let given = job.sensitivity.as_ref()?;
    let range = given.range.get(load)?;
    let stated = job.loads.iter().find(|l| l.name == load);
    let quantity = stated.and_then(JobLoad::quantity);
    let per = given
        .per
        .unit(quantity.unwrap_or_else(|| quantity_of_name(load)));
    let unit = factor(job.units, per);
    Some(range.map(|v| v / unit))
}
