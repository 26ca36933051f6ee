//! Static strain problem as numbers: influence of every load on every gauge, loads and readings of every run.
//!
//! Units throughout this module: microstrain, kN, kN m, kg, m, degrees Celsius, degrees of angle, percent of stiffness.

use crate::reconcile::Observations;
use crate::reconcile::rules::StrainRules;
use crate::sensitivity::{GaugeNoise, Uncertainty};
use crate::stop::Stop;

/// Wiring of a gauge, as far as it affects an angle error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wiring {
    /// One active arm.
    Quarter,
    /// Arms on both sides: bending doubles, in-plane shear cancels.
    Bending,
    /// Arms at plus and minus 45 degrees.
    Shear,
}

/// Known properties of a gauge.
#[derive(Clone, Debug, PartialEq)]
pub struct GaugeFacts {
    /// Name of the channel.
    pub name: String,
    /// Wiring.
    pub wiring: Wiring,
    /// Angle from the direction to which `tensor` refers, degrees.
    pub angle_deg: f64,
    /// Place, metres, if known. Gauges at one place form a rosette.
    pub position: Option<[f64; 3]>,
}

/// In-plane strain at a gauge per unit of every column, in the frame that `angle_deg` counts from: exx, eyy, gxy (engineering shear).
pub type PlaneStrainRow = Vec<[f64; 3]>;

/// Kind of a change of stiffness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StiffnessOf {
    /// Thickness of a zone, in percent.
    Zone,
    /// Joint: natural log of its stiffness times 100.
    Joint,
    /// Small region (a crack, a missing patch): natural log of its stiffness times 100.
    Local,
    /// Change that the user described; the described change has size one.
    Described,
}

/// Change of stiffness at a place, with its effect on the influence matrix.
#[derive(Clone, Debug, PartialEq)]
pub struct StiffnessSignature {
    /// Kind of the change.
    pub of: StiffnessOf,
    /// Zone, joint or element. For a described change it is the id of the change.
    pub place: String,
    /// Sizes in ascending order, without zero, and the change of the influence matrix (`n_gauges x n_columns`) at each.
    pub at_percent: Vec<(f64, Vec<f64>)>,
    /// Prior standard deviation of the size.
    pub prior_percent: f64,
}

/// Additional mass at a place.
#[derive(Clone, Debug, PartialEq)]
pub struct MassSignature {
    /// Place.
    pub place: String,
    /// Microstrain per kg, by gauge.
    pub per_kg: Vec<f64>,
}

/// Source of the wheel forces of the runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WheelForces {
    /// Measured, with the stated noise.
    Measured,
    /// Computed for flat ground: the ground itself may differ.
    FlatGroundModel,
}

/// Whether the analyst's model applies the payload's weight at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PayloadWeight {
    /// Weight applied as a point load.
    InModel,
    /// Weight missing (gravity as a body force cancels under inertia relief).
    Missing,
}

/// Error of every gauge's influence, one standard deviation, `n_gauges x n_columns`.
#[derive(Clone, Debug, PartialEq)]
pub enum Scatter {
    /// Errors common to all columns of a gauge, from its angle or its place.
    Together(Vec<f64>),
    /// Independent error of each coefficient, from the mesh.
    Single(Vec<f64>),
}

/// Nuisance load of the job: present in every run, never recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct NuisanceLoad {
    /// Name.
    pub name: String,
    /// Microstrain per unit, by gauge.
    pub per_unit: Vec<f64>,
    /// Usual size of the load, one standard deviation.
    pub size: f64,
}

/// Number of payload columns that follow the load columns: weight, weight times dx, times dy, times dx dy.
pub const N_PAYLOAD_COLUMNS: usize = 4;

/// Static problem with all its data.
#[derive(Clone, Debug)]
pub struct StrainFrame {
    /// Readings, microstrain.
    pub observations: Observations,
    /// Gauges, in channel order.
    pub gauges: Vec<GaugeFacts>,
    /// Names of the wheel loads, which are the first columns of `influence`.
    pub load_names: Vec<String>,
    /// Whether each wheel load is a moment (kN m) or a force (kN). If empty, all are forces.
    pub moments: Vec<bool>,
    /// Plan position (x forward or back, y left), metres, of each wheel load, where known.
    pub load_positions: Option<Vec<[f64; 2]>>,
    /// Microstrain per kN of each wheel load, then per kg of payload: 1, dx, dy, dx dy; `n_gauges x (n_loads + 4)` by rows.
    pub influence: Vec<f64>,
    /// In-plane strain for each row of `influence`. If the strain of a gauge is unknown, its row is empty and its angle error cannot be identified.
    pub tensors: Vec<PlaneStrainRow>,
    /// Change of `influence` per mm along the gauge axis, where known.
    pub per_mm: Option<Vec<f64>>,
    /// Wheel loads by run, kN, `n_runs x n_loads`.
    pub loads: Vec<f64>,
    /// Payload by run: mass in kg, distance in x and in y (left) from its nominal place in m.
    pub payload: Vec<[f64; 3]>,
    /// Nominal place of the payload, x and y, m, in the coordinates of the job.
    pub payload_origin: [f64; 2],
    /// Whether the analyst's model contains the payload's weight.
    pub payload_weight: PayloadWeight,
    /// Source of the wheel forces.
    pub wheel_forces: WheelForces,
    /// Forces and moments at the wheels that the model does not contain: (name `FY_LF`, microstrain per kN or kN m by gauge).
    pub other_loads: Vec<(String, Vec<f64>)>,
    /// Nuisance loads of the model. They are estimated separately in every run, for the gap before, the gap after and the noise floor.
    pub nuisance: Vec<NuisanceLoad>,
    /// Usual change of a wheel force by ground that is not flat; zero if the job has no such ground. The change is estimated separately in every run,
    /// like a nuisance load.
    pub ground: f64,
    /// Microstrain per degree of a uniform temperature change, by gauge.
    pub thermal_uniform: Option<Vec<f64>>,
    /// Microstrain per degree of a temperature gradient, by gauge.
    pub thermal_gradient: Option<Vec<f64>>,
    /// Places where a mass may have been left out.
    pub masses: Vec<MassSignature>,
    /// Zones and joints whose stiffness may be wrong.
    pub stiffness: Vec<StiffnessSignature>,
    /// Strain noise of a mean, microstrain, 1 sd; by gauge its root mean square.
    pub noise: f64,
    /// Noise that differs between gauges or is correlated, in units of `noise`; `None` if all gauges have equal, independent noise.
    pub gauge_noise: Option<GaugeNoise>,
    /// Noise of a measured wheel load, kN, 1 sd.
    pub load_noise: f64,
    /// Model uncertainty, 1 sd, relative to the predicted strain of a gauge and common to all its runs.
    pub model_rel: f64,
    /// Model uncertainty, 1 sd, relative to each influence coefficient, independent between coefficients and common to all runs.
    pub coefficient_rel: f64,
    /// Influence on the analyst's own mesh, if `influence` is from a finer mesh. The gap is tested on the analyst's mesh, and effects are tested on
    /// the finer mesh.
    pub as_modelled: Option<Vec<f64>>,
    /// Further errors of each gauge's influence: an angle, a place, an influence coefficient on the mesh. Each has one standard deviation
    /// (`n_gauges x n_columns`), is independent from gauge to gauge and common to all runs.
    pub scatter: Vec<Scatter>,
    /// Uncertainty of a calibrated S, microstrain per kN of the wheel loads, with the scatter between repeats of one loading.
    pub learnt: Option<Uncertainty>,
    /// Thresholds for identified effects.
    pub rules: StrainRules,
    /// Request to stop the search. Its results must then not be used.
    pub stop: Stop,
}

impl StrainFrame {
    /// Returns the number of gauges.
    pub fn n_gauges(&self) -> usize {
        self.gauges.len()
    }

    /// Returns the number of runs.
    pub fn n_runs(&self) -> usize {
        self.observations.runs.len()
    }

    /// Returns the number of wheel loads.
    pub fn n_loads(&self) -> usize {
        self.load_names.len()
    }

    /// Returns whether a load is a moment.
    pub fn is_moment(&self, load: usize) -> bool {
        self.moments.get(load).copied().unwrap_or(false)
    }

    /// Returns the number of columns of `influence`.
    pub fn n_columns(&self) -> usize {
        self.load_names.len() + N_PAYLOAD_COLUMNS
    }

    /// Returns the standard deviation of the noise of a gauge, microstrain.
    pub fn noise_of(&self, gauge: usize) -> f64 {
        self.noise_between(gauge, gauge).sqrt()
    }

    /// Returns the covariance of the noise of two gauges in a run, microstrain^2.
    pub fn noise_between(&self, g: usize, h: usize) -> f64 {
        let relative = match &self.gauge_noise {
            Some(noise) => noise.covariance_between(g, h),
            None => f64::from(u8::from(g == h)),
        };
        self.noise * self.noise * relative
    }

    /// Returns the root mean square of the wheel loads over all runs, kN; one if all are zero or missing.
    pub fn usual_load(&self) -> f64 {
        let power = self.loads.iter().map(|f| f * f).sum::<f64>() / self.loads.len().max(1) as f64;
        if power > 0.0 { power.sqrt() } else { 1.0 }
    }

    /// Returns the relative error by gauge, 1 sd, of the strain from an effect with amplitudes. It combines the stated uncertainty, `scatter` and the
    /// uncertainty of a calibrated S, over the wheel loads.
    pub fn relative_uncertainty(&self) -> Vec<f64> {
        let (n_c, n_l) = (self.n_columns(), self.n_loads());
        let power = |m: &[f64], g: usize| -> f64 {
            let row = m.iter().skip(g * n_c).take(n_l);
            row.map(|v| v * v).sum()
        };
        let uncertainty_of_gauge = |g: usize| {
            let own = power(&self.influence, g);
            let scatter = self.scatter.iter().map(|s| match s {
                Scatter::Together(m) | Scatter::Single(m) => power(m, g),
            });
            let learnt = self.learnt.as_ref().map_or(0.0, |u| u.power(g, n_l));
            let relative = if own > 0.0 {
                (scatter.sum::<f64>() + learnt) / own
            } else {
                0.0
            };
            (self.model_rel.powi(2) + self.coefficient_rel.powi(2) + relative).sqrt()
        };
        (0..self.n_gauges()).map(uncertainty_of_gauge).collect()
    }

    /// Returns the problem with the influence on the analyst's own mesh.
    pub fn as_modelled(&self) -> Self {
        let mut own = self.clone();
        if let Some(influence) = own.as_modelled.take() {
            own.influence = influence;
        }
        own
    }

    /// Returns the gauges with the place and wiring of `gauge`: the legs of its rosette, itself included, in file order.
    pub fn rosette(&self, gauge: usize) -> Vec<usize> {
        /// Largest distance, along each axis, of the legs of one rosette. Their nominal places agree; the two sides of a plate are further apart.
        const SAME_PLACE_M: f64 = 0.0025;
        let Some(here) = self.gauges.get(gauge).and_then(|g| g.position) else {
            return vec![gauge];
        };
        let near = |p: [f64; 3]| {
            p.iter()
                .zip(&here)
                .all(|(a, b)| (a - b).abs() < SAME_PLACE_M)
        };
        let wiring = self.gauges.get(gauge).map(|g| g.wiring);
        (0..self.gauges.len())
            .filter(|&g| {
                self.gauges
                    .get(g)
                    .is_some_and(|f| Some(f.wiring) == wiring && f.position.is_some_and(near))
            })
            .collect()
    }
}
