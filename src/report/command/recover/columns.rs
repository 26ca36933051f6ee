//! Columns that several files share.

use crate::strain_chain::LoadUnits;
use crate::workflow::recover::GaugeResidual;

/// Returns the columns of `loads.csv`: `key`, then each load with the ends of its 95 % interval.
pub(super) fn columns(key: &str, names: &[String]) -> Vec<String> {
    let ends = |name: &String| [name.clone(), format!("{name}.low"), format!("{name}.high")];
    let loads = names.iter().flat_map(ends);
    std::iter::once(key.to_owned()).chain(loads).collect()
}

/// Returns the columns of `loads.csv` ([`columns`]) with their units. `key` is the name and unit of the first column.
pub(super) fn columns_with_units(
    key: [&str; 2],
    names: &[String],
    units: &[LoadUnits],
) -> Vec<(String, String)> {
    let of_loads = units.iter().flat_map(|u| vec![u.name.clone(); 3]);
    let units = std::iter::once(key[1].to_owned()).chain(of_loads);
    columns(key[0], names).into_iter().zip(units).collect()
}

/// Returns name, residual in microstrain, and leverage of each gauge.
pub(super) fn by_gauge(gauges: &[GaugeResidual]) -> Vec<(String, f64, f64)> {
    let row = |g: &GaugeResidual| (g.name.clone(), g.residual_rms_microstrain, g.leverage);
    gauges.iter().map(row).collect()
}
