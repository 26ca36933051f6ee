//! The job's S as a frame counts it: microstrain per kN or kN m, channels in the order of the strain file.

use crate::host::fault::{Fault, FaultList, Faults};
use crate::job::Job;
use crate::job::quantity::quantity_of_name;
use crate::reconcile::strain::NuisanceLoad;
use crate::sensitivity::{GaugeNoise, Load, Sensitivity, Uncertainty};
use crate::strain_chain::stated_noise;
use crate::units::{KILO, MICROSTRAIN};

/// S with the row of each channel and the scale of each load.
pub(super) struct FrameColumns {
    sensitivity: Sensitivity,
    rows: Vec<usize>,
    /// Scale of each load: kN or kN m in a job unit, divided by microstrain.
    scales: Vec<f64>,
}

impl FrameColumns {
    /// Reads the rows of the channels from `sensitivity`, the S of the job.
    ///
    /// # Errors
    /// Channels that have no row in S.
    pub(super) fn from_sensitivity(
        job: &Job,
        sensitivity: Sensitivity,
        channels: &[String],
    ) -> Result<Self, Faults> {
        let (mut rows, mut faults) = (Vec::new(), FaultList::new());
        for name in channels {
            match sensitivity.gauges.iter().position(|g| g == name) {
                Some(row) => rows.push(row),
                None => {
                    let wrong = format!(
                        "the strain file has a column `{name}`, and S has no row of this name"
                    );
                    let remedy = "name the gauges as the columns, or leave the column out";
                    faults.push(Fault::new(&*job.file, "gauge", wrong, remedy));
                }
            }
        }
        Faults::check(faults)?;
        let scale = |l: &Load| {
            let quantity = l.quantity.unwrap_or_else(|| quantity_of_name(&l.name));
            KILO / job.units.si(quantity) / MICROSTRAIN
        };
        let scales = sensitivity.loads.iter().map(scale).collect();
        Ok(Self {
            sensitivity,
            rows,
            scales,
        })
    }

    /// Numbers of the wanted loads.
    fn wanted_loads(&self) -> impl Iterator<Item = usize> {
        let loads = self.sensitivity.loads.iter().enumerate();
        loads.filter(|(_, l)| l.wanted).map(|(k, _)| k)
    }

    /// Returns the name and column of each wanted load, in the order of S.
    pub(super) fn wanted_columns(&self) -> Vec<(String, Vec<f64>)> {
        let one = |k: usize| (self.sensitivity.loads[k].name.clone(), self.column(k));
        self.wanted_loads().map(one).collect()
    }

    /// Returns the loads of S that are not wanted, with the size that the job expects.
    pub(super) fn nuisance(&self) -> Vec<NuisanceLoad> {
        let loads = self.sensitivity.loads.iter().enumerate();
        let one = |(k, l): (usize, &Load)| NuisanceLoad {
            name: l.name.clone(),
            per_unit: self.column(k),
            size: l.expected.unwrap_or(0.0) / (self.scales[k] * MICROSTRAIN),
        };
        loads.filter(|l| !l.1.wanted).map(one).collect()
    }

    /// Returns the error of a calibrated S in the wanted loads.
    pub(super) fn calibrated_uncertainty(&self) -> Option<Uncertainty> {
        let of_channels = self.sensitivity.uncertainty.as_ref()?.of_gauges(&self.rows);
        let loads: Vec<(usize, f64)> = self.wanted_loads().map(|k| (k, self.scales[k])).collect();
        Some(of_channels.of_loads(&loads))
    }

    /// Returns the noise of the channels as the job states it. `None` if all channels have equal, independent noise.
    ///
    /// # Errors
    /// Returns the faults of [`stated_noise`].
    pub(super) fn gauge_noise(&self, job: &Job) -> Result<Option<GaugeNoise>, Faults> {
        let stated = stated_noise(job, &self.sensitivity.gauges)?;
        Ok(stated.map(|noise| noise.of_gauges(&self.rows)))
    }

    fn column(&self, load: usize) -> Vec<f64> {
        let value = |&row: &usize| self.sensitivity.values[(row, load)] * self.scales[load];
        self.rows.iter().map(value).collect()
    }
}
