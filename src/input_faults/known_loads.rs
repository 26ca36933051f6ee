//! How well readings fit loads that are known.

use super::fault::Inputs;
use super::search::{InputFit, Misfit};

/// Readings of runs whose loads are known.
pub struct KnownLoads {
    /// Readings, and strain per unit of each load.
    pub inputs: Inputs,
    /// Loads by run.
    pub loads: Vec<Vec<f64>>,
    /// Noise of a reading, 1 sd, in the unit of the readings.
    pub noise: f64,
    /// Error of each load, 1 sd.
    pub load_noise: Vec<f64>,
    /// Relative error of each coefficient, 1 sd.
    pub model_rel: f64,
}

impl Misfit for KnownLoads {
    fn inputs(&self) -> Inputs {
        self.inputs.clone()
    }

    fn noise(&self) -> f64 {
        self.noise
    }

    fn knows_loads(&self) -> bool {
        true
    }

    fn fit(&self, inputs: &Inputs) -> InputFit {
        let mut out = InputFit::default();
        for (strain, loads) in inputs.strain.iter().zip(&self.loads) {
            let rows = inputs.rows.row_iter();
            let predicted: Vec<f64> = rows
                .clone()
                .map(|row| row.iter().zip(loads).map(|(s, f)| s * f).sum())
                .collect();
            for ((y, p), row) in strain.iter().zip(&predicted).zip(rows) {
                let of_load = |((s, f), sd): ((&f64, &f64), &f64)| {
                    (s * sd).powi(2) + (self.model_rel * s * f).powi(2)
                };
                let each = row.iter().zip(loads).zip(&self.load_noise);
                let known = each.map(of_load).sum::<f64>();
                let variance = self.noise * self.noise + known;
                if y.is_finite() && p.is_finite() && variance > 0.0 {
                    out.chi2 += (y - p).powi(2) / variance;
                    out.dof += 1;
                }
            }
            out.predicted.push(predicted);
        }
        out
    }
}

impl KnownLoads {
    /// Returns the share of the readings that the loads do not explain, as a ratio of root mean squares.
    pub fn unexplained_share(&self) -> f64 {
        let fit = self.fit(&self.inputs);
        let pairs = self.inputs.strain.iter().zip(&fit.predicted);
        let pairs = pairs.flat_map(|(y, p)| y.iter().zip(p));
        let known = pairs.filter(|(y, p)| y.is_finite() && p.is_finite());
        let (rest, all) = known.fold((0.0, 0.0), |(rest, all), (y, p)| {
            (rest + (y - p).powi(2), all + y * y)
        });
        (rest / all).sqrt()
    }
}
