//! A payload by a calibrated S that has its columns: as `recover` takes the loads of a run, with the whole covariance of S.

use super::evidence::{PayloadModel, PayloadRun, Place};
use crate::finding::Finding;
use crate::linalg::Matrix;
use crate::recovery::calibrated_loads::estimate;
use crate::recovery::uncalibrated_strain::{check, estimate_loosely, is_unlike};
use crate::recovery::{ErrorModel, Readings};
use crate::sensitivity::{Load, Sensitivity, Uncertainty};

/// Payload of one run from a calibrated S.
pub(super) struct CalibratedPayload {
    /// Components of `p = (F, F dx, F dy)` with a column in the calibration: number and value.
    pub p: Vec<(usize, f64)>,
    /// Covariance of these components, by rows.
    pub covariance: Vec<f64>,
    /// Degrees of freedom of the covariance.
    pub dof: f64,
    /// Factor on sigma of a 95 % interval.
    pub coverage_factor: f64,
    /// Finding if no payload explains this strain.
    pub unlike: Option<Finding>,
}

/// Estimates the payload of a run from the gauges `used`. `known` is the covariance of the three columns of [`PayloadModel::payload`]. If the place
/// is known, the only column is `b0 + dx b_dx + dy b_dy`, with its covariance. `None` if the gauges don't determine the payload.
pub(super) fn estimate_payload(
    model: &PayloadModel,
    known: &Uncertainty,
    run: &PayloadRun,
    place: Place,
    used: impl Fn(usize) -> bool,
) -> Option<CalibratedPayload> {
    let n = model.gauges.len();
    let present = |k: &usize| model.payload.column(*k).iter().any(|v| *v != 0.0);
    let columns: Vec<usize> = match place {
        Place::Free => (0..3).filter(present).collect(),
        Place::Known => vec![0],
    };
    let p = [1.0, run.shift[0], run.shift[1]];
    let (values, known) = match place {
        Place::Free => {
            let values = Matrix::from_fn(n, columns.len(), |g, k| model.payload[(g, columns[k])]);
            let same: Vec<(usize, f64)> = columns.iter().map(|k| (*k, 1.0)).collect();
            (values, known.of_loads(&same))
        }
        Place::Known => {
            let entry = |g: usize, _| (0..3).map(|k| model.payload[(g, k)] * p[k]).sum::<f64>();
            (Matrix::from_fn(n, 1, entry), known.combine_loads(&p))
        }
    };
    let s = Sensitivity {
        values,
        gauges: model.gauges.clone(),
        loads: (columns.iter())
            .map(|k| Load::from_name(["F", "F dx", "F dy"][*k]))
            .collect(),
        uncertainty: None,
        noise: model.noise.clone(),
    };
    let reads = |(g, e): (usize, &f64)| if used(g) { *e } else { f64::NAN };
    let readings = Readings {
        run: run.run.clone(),
        strain: run.strain.iter().enumerate().map(reads).collect(),
        noise_factor: 1.0,
    };
    // The noise of the gauges in a run is equal or proportional to the noise in the model. If a zero or a gap changes this ratio, the largest ratio
    // applies.
    let own = |g: usize| model.noise.as_ref().map_or(1.0, |n| n.variance(g).sqrt());
    let noise = run.sigma.iter().enumerate().map(|(g, v)| v / own(g));
    let noise = noise.filter(|v| v.is_finite());
    let errors = ErrorModel {
        noise: noise.fold(0.0, f64::max),
        model_rel: 0.0,
    };
    let mut run = estimate(&s, &readings, errors, &known);
    let unlike = check(&s.gauges, std::slice::from_ref(&run), &known).pop();
    if is_unlike(&run, &known) {
        run = estimate_loosely(&s, &readings, errors, &known);
    }
    (run.rank == columns.len()).then(|| CalibratedPayload {
        p: columns.into_iter().zip(run.estimate.values).collect(),
        covariance: run.estimate.covariance,
        dof: known.dof,
        coverage_factor: run.estimate.coverage_factor,
        unlike,
    })
}
