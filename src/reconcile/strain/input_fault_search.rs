//! Recorded loads of a frame, in the form that the search for wrong inputs needs.

use super::frame::StrainFrame;
use super::state::StrainState;
use crate::finding::Finding;
use crate::input_faults::{
    AlternativeRows, FaultTreatment, Inputs, KnownLoads, RecordedRuns, Rules,
    findings_of_recorded_loads, recorded_mass_contradicted, search_faults,
};
use crate::linalg::Matrix;
use crate::units::{KILO, Quantity, STANDARD_GRAVITY_M_S2};

/// Name of the payload among the loads.
const PAYLOAD: &str = "payload";

/// Returns the findings on recorded loads and payloads with a reversed sign, in another unit, or exchanged. The list is empty if the search for
/// effects of the model may continue.
pub(super) fn wrong_records(frame: &StrainFrame) -> Vec<Finding> {
    let state = StrainState::from_nominal_model(frame);
    let [n_gauges, n_runs, n_columns] = state.shape;
    let n_loads = frame.n_loads();
    let strain_of = |g: usize, r: usize, load: usize, from: usize| -> f64 {
        let row = &state.influence[g * n_columns..(g + 1) * n_columns];
        let acts = &state.columns[r * n_columns..(r + 1) * n_columns];
        match load < n_loads {
            true => row[load] * acts[from],
            false => (row.iter().zip(acts).skip(n_loads))
                .map(|(a, f)| a * f)
                .sum(),
        }
    };
    let readings = (0..n_runs).map(|r| {
        let channels = 0..n_gauges;
        channels.map(|g| frame.observations.value(r, g)).collect()
    });
    let quantity = |l: usize| match frame.moments.get(l) {
        Some(true) => Quantity::Moment,
        _ => Quantity::Force,
    };
    let names = frame.load_names.iter().map(String::as_str);
    let runs = RecordedRuns {
        loads: names.chain([PAYLOAD]).collect(),
        readings: readings.collect(),
        strain_of: Box::new(strain_of),
        quantities: (0..n_loads)
            .map(|l| Some(quantity(l)))
            .chain([None])
            .collect(),
        known: vec![true; n_runs],
        excluded: Vec::new(),
        noise: frame.noise,
        model_rel: frame.model_rel,
    };
    let found = findings_of_recorded_loads(&runs, "the runs file");
    if !found.is_empty() {
        return found;
    }
    let weight = |p: &[f64; 3]| p[0] * STANDARD_GRAVITY_M_S2 / KILO;
    let weights: Vec<f64> = frame.payload.iter().map(weight).collect();
    let is_vertical = |l: &usize| {
        let name = frame.load_names[*l].to_uppercase();
        quantity(*l) == Quantity::Force && !name.contains("FX") && !name.contains("FY")
    };
    let vertical: Vec<usize> = (0..n_loads).filter(is_vertical).collect();
    let sum = |r: usize| vertical.iter().map(|l| frame.loads[r * n_loads + l]).sum();
    let sums: Vec<f64> = (0..n_runs).map(sum).collect();
    let sum_sd = frame.load_noise * (vertical.len() as f64).sqrt();
    recorded_mass_contradicted(&runs, n_loads, (&weights, &sums), sum_sd)
        .into_iter()
        .collect()
}

/// Smallest unexplained share of the readings (root mean squares) if gauges are installed differently from the statement. Effects of a structure have
/// a smaller share.
const FAR_OFF: f64 = 0.25;

/// Returns the finding on gauges that are all on the other surface, or all have angles in radians. `alternatives` is only called if the recorded
/// loads leave a share of at least `FAR_OFF` unexplained; its rows are rows of [`StrainFrame::influence`].
pub fn gauges_installed_otherwise(
    frame: &StrainFrame,
    alternatives: &mut dyn FnMut() -> Vec<AlternativeRows>,
) -> Vec<Finding> {
    let state = StrainState::from_nominal_model(frame);
    let [n_gauges, n_runs, n_columns] = state.shape;
    let readings = (0..n_runs).map(|r| {
        let channels = 0..n_gauges;
        channels.map(|g| frame.observations.value(r, g)).collect()
    });
    let runs = state.columns.chunks_exact(n_columns);
    let misfit = KnownLoads {
        inputs: Inputs {
            strain: readings.collect(),
            rows: Matrix::from_fn(n_gauges, n_columns, |g, c| {
                state.influence[g * n_columns + c]
            }),
        },
        loads: runs.map(<[f64]>::to_vec).collect(),
        noise: frame.noise,
        load_noise: (0..n_columns)
            .map(|c| {
                if c < frame.n_loads() {
                    frame.load_noise
                } else {
                    0.0
                }
            })
            .collect(),
        model_rel: frame.model_rel,
    };
    if misfit.unexplained_share() < FAR_OFF {
        return Vec::new();
    }
    let names: Vec<String> = frame.gauges.iter().map(|g| g.name.clone()).collect();
    let found = search_faults(&misfit, alternatives, &Rules::STATED);
    let installed = found
        .iter()
        .filter(|f| f.fault.is_of_installation() && f.fault.gauges().is_empty());
    installed
        .map(|f| f.finding(&names, FaultTreatment::AsMeasured))
        .collect()
}
