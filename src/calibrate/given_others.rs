//! Reading of each gauge in a run with uncertain loads, conditional on the readings of the other gauges.

use super::posterior::Equation;
use crate::linalg::precision::Precision;
use crate::linalg::spd;

/// Loads of one run, with the reading of each gauge and its variance.
#[derive(Clone, Debug)]
pub(super) struct ByGauge {
    /// Loads of unit size.
    pub phi: Vec<f64>,
    /// Reading by gauge at these loads; NaN without a reading.
    pub y: Vec<f64>,
    /// Variance of the reading by gauge, without the uncertainty of S.
    pub variance: Vec<f64>,
}

/// Returns a run's readings by gauge. `spread` is the part of the covariance of `e` from the error of the loads, which is common to the gauges. If
/// only the sum of a lorry's loads is known, the readings of one gauge alone hardly determine its row. The other gauges determine how the load is
/// distributed. With them, the row is determined nearly as well as by known loads:
///
/// `y_g + sum_h P_gh (y_h - s_h phi) / P_gg` over the other gauges, with variance `1 / P_gg`. `P` is the inverse of the matrix with `spread` off the
/// diagonal and the variances of `e` on it.
///
/// `s` contains the current rows of S by gauge, `n` of them.
///
/// # Reference
/// J. Besag, J. R. Stat. Soc. B 36 (1974) 192, section 4 (conditional distributions of a normal scheme, and their product as a likelihood).
pub(super) fn by_gauge(e: &Equation, spread: &[f64], s: &[Vec<f64>]) -> ByGauge {
    let (n, m) = (s.len(), e.gauges.len());
    let mut out = ByGauge {
        phi: e.phi.clone(),
        y: vec![f64::NAN; n],
        variance: vec![f64::INFINITY; n],
    };
    for (i, &g) in e.gauges.iter().enumerate() {
        out.y[g] = e.y[i];
        out.variance[g] = e.covariance[i * m + i];
    }
    if spread.iter().all(|v| *v == 0.0) {
        return out;
    }
    let on_diagonal = |at: usize| at / m.max(1) == at % m.max(1);
    let both: Vec<f64> = (0..m * m)
        .map(|at| match on_diagonal(at) {
            true => e.covariance[at],
            false => spread[at],
        })
        .collect();
    let Some(inverse) = Precision::from_covariance(&both, m) else {
        return out;
    };
    let left: Vec<f64> = (e.gauges.iter().zip(&e.y))
        .map(|(g, y)| y - spd::dot(&s[*g], &e.phi))
        .collect();
    for (i, &g) in e.gauges.iter().enumerate() {
        let own = inverse.entry(i, i);
        let others = (0..m).filter(|j| *j != i);
        let others: f64 = others.map(|j| inverse.entry(i, j) * left[j]).sum();
        out.y[g] += others / own;
        out.variance[g] = 1.0 / own;
    }
    out
}
