//! Inputs of payload weighing: the response of gauges and wheels to a payload, and their readings.

use crate::linalg::Matrix;
use crate::sensitivity::{GaugeNoise, Uncertainty};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

/// Response of gauges and wheels to a unit of weight (model units), and to weight times the shift from the nominal position.
///
/// Let `F` be the weight of a payload, `(dx, dy)` its shift in plan, `p = (F, F dx, F dy)`, and `R` the changes of the wheel forces, positive up.
/// Then `strain = wheels R + payload p`, and on a flat floor `R = floor p`. Equilibrium is `sum R = F` and `sum R arm = F (dx, dy)`.
#[derive(Clone, Debug, PartialEq)]
pub struct PayloadModel {
    /// Gauge names.
    pub gauges: Vec<String>,
    /// `n_gauges x n_wheels`, strain per unit force up.
    pub wheels: Matrix,
    /// `n_gauges x 3`, strain per unit of `p` with the wheels unloaded.
    pub payload: Matrix,
    /// Reactions on a flat floor per unit of `p`, `n_wheels x 3`; `None` without a model.
    pub floor: Option<Matrix>,
    /// Positions of the wheels from the nominal place, in plan; `None` if unknown.
    pub arms: Option<Vec<[f64; 2]>>,
    /// Uncertainty of `payload` from calibration runs, with its three columns as loads. `None` if a model or a table gives them.
    pub calibrated: Option<Uncertainty>,
    /// Noise of the gauges, which gives the correlation of a run's errors; `None` if the gauges are independent of each other.
    pub noise: Option<GaugeNoise>,
}

/// Readings of one run.
#[derive(Clone, Debug, PartialEq)]
pub struct PayloadRun {
    /// Name.
    pub run: String,
    /// Net strain by gauge. NaN for a gauge without a reading, empty without strain.
    pub strain: Vec<f64>,
    /// Standard deviation of the readings by gauge.
    pub sigma: Vec<f64>,
    /// Changes of the wheel forces, upwards. NaN if not measured, empty if none is measured.
    pub reactions: Vec<f64>,
    /// Shift of the payload if its place is known.
    pub shift: [f64; 2],
}

/// Whether the place is requested.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// [`PayloadRun::shift`].
    Known,
    /// To be found.
    Free,
}

/// Settings.
#[derive(Clone, Debug, PartialEq)]
pub struct WeighSpec {
    /// Place.
    pub place: Place,
    /// Model uncertainty of each influence coefficient, and of all coefficients together, 1 sd, a fraction.
    pub model_rel: f64,
    /// Standard deviation of a measured wheel force.
    pub reaction_sigma: f64,
    /// Largest weight that is searched: far above the weight that the readings show, so that it does not change the answer.
    pub largest: f64,
    /// Region of the payload as shifts. `None` means anywhere between the wheels.
    pub region: Option<[[f64; 2]; 2]>,
}

/// Reason why an answer is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// The payload would have to pull the structure up.
    Negative {
        /// Weight found.
        force: f64,
    },
    /// The payload is outside the region by this many standard deviations.
    OutsideRegion {
        /// Distance from the region divided by sigma.
        sigmas: f64,
    },
    /// Strain and wheel forces give different weights.
    OutOfBalance {
        /// From strain with the wheel forces as measured.
        strain: f64,
        /// Sum of the wheel forces.
        wheels: f64,
        /// Their difference over sigma.
        sigmas: f64,
    },
    /// The readings do not determine the weight.
    Undetermined,
}

/// The payload of one run.
#[derive(Clone, Debug, PartialEq)]
pub struct WeighedRun {
    /// Name.
    pub run: String,
    /// Weight, as computed. It is kept even if the result is refused.
    pub force: f64,
    /// Standard deviation of the weight.
    pub sigma: f64,
    /// Degrees of freedom of the standard deviation; infinite if it was not estimated.
    pub dof: f64,
    /// 95 % interval of the weight.
    pub interval: [f64; 2],
    /// Shift from the nominal place: known or found.
    pub shift: [f64; 2],
    /// Covariance of the shift by rows. It is zero if the shift is known.
    pub shift_covariance: [f64; 4],
    /// Reason why the result is not usable.
    pub refused: Option<Refusal>,
    /// Payload estimate of each gauge alone; NaN if the gauge gives none.
    pub estimates: Vec<f64>,
    /// Standard deviations of these estimates.
    pub estimate_sigma: Vec<f64>,
}

impl WeighedRun {
    /// Returns the half axes (long, short) of the 95 % region of the place, and the angle of the long axis. The angle is from the first plan axis,
    /// radians.
    pub fn ellipse(&self) -> ([f64; 2], f64) {
        /// 95 % point of chi-square with two degrees of freedom.
        const CHI2_95: f64 = 5.991;
        let square = match self.dof.is_finite() {
            true => FisherSnedecor::new(2.0, self.dof.max(1.0))
                .map_or(CHI2_95, |d| 2.0 * d.inverse_cdf(0.95)),
            false => CHI2_95,
        };
        let [a, b, _, d] = self.shift_covariance;
        let (mean, half) = ((a + d) / 2.0, ((a - d) / 2.0).hypot(b));
        let axes = [mean + half, (mean - half).max(0.0)].map(|v| (square * v).sqrt());
        (axes, 0.5 * (2.0 * b).atan2(a - d))
    }
}

impl PayloadModel {
    /// Returns the strain by gauge per unit weight at a shift, on the floor (`true` answer of the standing structure) or by the payload alone.
    pub fn unit_strain(&self, shift: [f64; 2], support: Support) -> Vec<f64> {
        let p = [1.0, shift[0], shift[1]];
        let direct = |g: usize| (0..3).map(|k| self.payload[(g, k)] * p[k]).sum::<f64>();
        match (support, &self.floor) {
            (Support::Floor, Some(floor)) => {
                let r: Vec<f64> = (0..floor.nrows())
                    .map(|w| (0..3).map(|k| floor[(w, k)] * p[k]).sum())
                    .collect();
                (0..self.gauges.len())
                    .map(|g| {
                        direct(g)
                            + r.iter()
                                .enumerate()
                                .map(|(w, r)| self.wheels[(g, w)] * r)
                                .sum::<f64>()
                    })
                    .collect()
            }
            _ => (0..self.gauges.len()).map(direct).collect(),
        }
    }
}

/// Support that carries the payload in a unit response.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Support {
    /// The wheels on a flat floor.
    Floor,
    /// Nothing: wheel forces are accounted for apart.
    Free,
}
