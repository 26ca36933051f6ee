//! Model part of a static frame, from a deck or from tables.

use crate::gauge::Bridge;
use crate::job::Job;
use crate::reconcile::strain::{
    GaugeFacts, MassSignature, NuisanceLoad, PlaneStrainRow, Scatter, StiffnessSignature, Wiring,
};
use crate::sensitivity::{GaugeNoise, Uncertainty};

/// Part of a frame that depends on the model and not on the runs, from a deck or from tables.
#[derive(Clone, Debug, Default)]
pub(super) struct ModelPart {
    pub(super) gauges: Vec<GaugeFacts>,
    pub(super) load_names: Vec<String>,
    pub(super) load_positions: Option<Vec<[f64; 2]>>,
    pub(super) influence: Vec<f64>,
    pub(super) tensors: Vec<PlaneStrainRow>,
    pub(super) per_mm: Option<Vec<f64>>,
    pub(super) other_loads: Vec<(String, Vec<f64>)>,
    pub(super) nuisance: Vec<NuisanceLoad>,
    pub(super) thermal_uniform: Option<Vec<f64>>,
    pub(super) thermal_gradient: Option<Vec<f64>>,
    pub(super) masses: Vec<MassSignature>,
    pub(super) stiffness: Vec<StiffnessSignature>,
    /// Influence on the analyst's own mesh, if `influence` is from a finer mesh.
    pub(super) as_modelled: Option<Vec<f64>>,
    /// Errors that every gauge may have.
    pub(super) scatter: Vec<Scatter>,
    /// Error of a calibrated S.
    pub(super) learnt: Option<Uncertainty>,
    /// Noise of the channels, if it differs or is correlated.
    pub(super) gauge_noise: Option<GaugeNoise>,
    /// Nominal place of the payload, m.
    pub(super) payload_origin: [f64; 2],
}

/// Returns the wiring of a bridge, as far as angles depend on it.
pub(super) fn wiring(bridge: Bridge) -> Wiring {
    match bridge {
        Bridge::Quarter => Wiring::Quarter,
        Bridge::HalfBending | Bridge::FullBending => Wiring::Bending,
        Bridge::Shear => Wiring::Shear,
    }
}

/// Returns the nominal x of the payload, m, if the job states it.
pub(super) fn nominal_x_m(job: &Job) -> Option<f64> {
    Some(job.payload.as_ref()?.nominal_x? * job.units.length_m())
}

/// Returns the nominal y of the payload, m, if the job states it.
pub(super) fn nominal_y_m(job: &Job) -> Option<f64> {
    Some(job.payload.as_ref()?.nominal_y? * job.units.length_m())
}

/// Returns the properties of a gauge from the job: wiring, angle, position in m.
pub(super) fn facts(job: &Job, name: &str) -> GaugeFacts {
    let known = job.gauges.iter().find(|g| g.name == name);
    let metres = |x: [f64; 3]| x.map(|v| v * job.units.length_m());
    GaugeFacts {
        name: name.to_owned(),
        wiring: known.map_or(Wiring::Quarter, |g| wiring(g.bridge)),
        angle_deg: known.map_or(0.0, |g| g.angle_deg),
        position: known.and_then(|g| g.position).map(metres),
    }
}
