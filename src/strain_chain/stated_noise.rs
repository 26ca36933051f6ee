//! Noise of gauges as the job states it.

use crate::host::fault::{Fault, FaultList, Faults};
use crate::job::{Job, suggest};
use crate::sensitivity::GaugeNoise;

/// Returns the noise of these gauges, in units of the root mean square that the job states. `None` if the noise of all gauges is equal and
/// independent.
///
/// # Errors
/// Gauges without stated noise if other gauges have it; names that are not gauges.
pub fn stated_noise(job: &Job, gauges: &[String]) -> Result<Option<GaugeNoise>, Faults> {
    let Some(measured) = &job.measured else {
        return Ok(None);
    };
    let correlation = measured.noise_correlation;
    if measured.noise_by_gauge.is_empty() {
        let alike = vec![1.0; gauges.len()];
        return Ok((correlation > 0.0).then(|| GaugeNoise::with_correlation(&alike, correlation)));
    }
    let of = |name: &String| {
        let mut stated = measured.noise_by_gauge.iter();
        stated.find(|(n, _)| n == name).map(|(_, sd)| *sd)
    };
    let missing: FaultList = (gauges.iter().filter(|g| of(g).is_none()))
        .map(|g| {
            Fault::with_line(
                &*job.file,
                measured.line,
                "measured.noise_microstrain",
                format!("the noise of gauge `{g}` is not stated, but the noise of other gauges is"),
                "state the noise of every gauge, or one number for all",
            )
        })
        .collect();
    Faults::check(missing)?;
    let of_job = |name: &String| {
        let ignored = job.corrections.iter().any(|c| c.gauge == *name);
        ignored || gauges.contains(name) || job.gauges.iter().any(|g| g.name == *name)
    };
    let unknown: FaultList = (measured.noise_by_gauge.iter().map(|n| &n.0))
        .filter(|name| !of_job(name))
        .map(|name| {
            Fault::with_line(
                &*job.file,
                measured.line,
                "measured.noise_microstrain",
                format!("`{name}` is not a gauge of the job"),
                suggest::remedy(name, gauges.iter().map(String::as_str)),
            )
        })
        .collect();
    Faults::check(unknown)?;
    let unit = measured.noise_microstrain;
    let sd: Vec<f64> = gauges.iter().filter_map(of).map(|sd| sd / unit).collect();
    Ok(Some(GaugeNoise::with_correlation(&sd, correlation)))
}
