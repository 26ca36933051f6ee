//! Torsion with warping: a bar of open section whose warping is held or passed on at its ends.

use crate::fe::element::ElementMatrix;
use crate::linalg::{Matrix4, SMatrix, Vector4};
use crate::model::GridIx;

/// lambda L under which hyperbolic functions lose figures to cancellation and the first terms of their series are as good.
const SHORT: f64 = 0.05;
/// lambda L above which exp(-lambda L) is negligible against 1.
const LONG: f64 = 40.0;

/// Returns the exact stiffness of E Cw theta'''' - G J theta'' = 0 over (theta_A, theta'_A, theta_B, theta'_B).
///
/// With psi = L sqrt(GJ / E Cw), s = sinh psi, c = cosh psi and D = 2 - 2 c + psi s: k11 = psi^3 s, k12 = psi^2 (c - 1) L, k22 = psi (psi c - s) L^2,
/// k24 = psi (s - psi) L^2, all times E Cw / (L^3 D).
///
/// # Reference
/// V. Z. Vlasov, Thin-Walled Elastic Beams (1961), chapter I; the same equation as a beam under tension.
pub(super) fn warping_torsion(gj: f64, ecw: f64, length: f64) -> Matrix4<f64> {
    let psi = length * (gj / ecw).max(0.0).sqrt();
    let [k11, k12, k22, k24] = if psi < SHORT {
        // Cubic shape: the sum of flange bending and Saint-Venant torsion.
        let p = psi * psi;
        [
            12.0 + 1.2 * p,
            6.0 + 0.1 * p,
            4.0 + 2.0 / 15.0 * p,
            2.0 - p / 30.0,
        ]
    } else {
        // Numerators and denominator are divided by cosh psi, so that they do not overflow.
        let (s, one) = if psi > LONG {
            (1.0, 0.0)
        } else {
            (psi.tanh(), 1.0 / psi.cosh())
        };
        let d = 2.0 * one - 2.0 + psi * s;
        [
            psi.powi(3) * s / d,
            psi * psi * (1.0 - one) / d,
            psi * (psi - s) / d,
            psi * (s - psi * one) / d,
        ]
    };
    let unit = ecw / length.powi(3);
    let l = length;
    Matrix4::new(
        k11,
        k12 * l,
        -k11,
        k12 * l, //
        k12 * l,
        k22 * l * l,
        -k12 * l,
        k24 * l * l, //
        -k11,
        -k12 * l,
        k11,
        -k12 * l, //
        k12 * l,
        k24 * l * l,
        -k12 * l,
        k22 * l * l,
    ) * unit
}

/// Returns the rows of twist and its rate at the share `xi` of the length, over theta_A, theta'_A, theta_B, theta'_B. The rows are exact: the two
/// pieces of the beam are solved for their common point.
fn interpolate_twist(gj: f64, ecw: f64, length: f64, xi: f64) -> SMatrix<f64, 2, 4> {
    let mut rows = SMatrix::<f64, 2, 4>::zeros();
    if !(xi > 0.0 && xi < 1.0) {
        let end = if xi > 0.0 { 2 } else { 0 };
        rows[(0, end)] = 1.0;
        rows[(1, end + 1)] = 1.0;
        return rows;
    }
    let a = warping_torsion(gj, ecw, length * xi);
    let b = warping_torsion(gj, ecw, length * (1.0 - xi));
    let own = a.fixed_view::<2, 2>(2, 2) + b.fixed_view::<2, 2>(0, 0);
    let det = own[(0, 0)] * own[(1, 1)] - own[(0, 1)] * own[(1, 0)];
    let inverse =
        SMatrix::<f64, 2, 2>::new(own[(1, 1)], -own[(0, 1)], -own[(1, 0)], own[(0, 0)]) / det;
    rows.fixed_view_mut::<2, 2>(0, 0)
        .copy_from(&(-inverse * a.fixed_view::<2, 2>(2, 0)));
    rows.fixed_view_mut::<2, 2>(0, 2)
        .copy_from(&(-inverse * b.fixed_view::<2, 2>(0, 2)));
    rows
}

/// Returns the torques and bimoments at both ends equivalent to a torque per length. Its mean is c, and it changes by 2 d from end to end.
///
/// The torques are (c / 2 -+ d (1/6 + 2 gamma)) L, the bimoments (+-c beta - d gamma) L^2.
///
/// With beta = (psi / 2 coth(psi / 2) - 1) / psi^2, gamma = (1 / (12 beta) - 1) / psi^2. Without GJ, beta is 1/12 and gamma 1/60, as for a clamped
/// beam.
fn of_linear_torque(gj: f64, ecw: f64, length: f64, torque: [f64; 2]) -> Vector4<f64> {
    let psi = length * (gj / ecw).max(0.0).sqrt();
    let p = psi * psi;
    let (beta, gamma) = if psi < SHORT {
        (
            1.0 / 12.0 - p / 720.0 + p * p / 30_240.0,
            1.0 / 60.0 - p / 8400.0,
        )
    } else {
        let half = psi / 2.0;
        let beta = (half / half.tanh() - 1.0) / p;
        (beta, (1.0 / (12.0 * beta) - 1.0) / p)
    };
    let [at_a, at_b] = torque;
    let (c, d) = ((at_a + at_b) / 2.0, (at_b - at_a) / 2.0);
    let slope = d * (1.0 / 6.0 + 2.0 * gamma);
    Vector4::new(
        c / 2.0 - slope,
        (c * beta - d * gamma) * length,
        c / 2.0 + slope,
        (-c * beta - d * gamma) * length,
    ) * length
}

/// Returns the torques and bimoments equivalent to torques along the beam, over (theta_A, theta'_A, theta_B, theta'_B).
///
/// Each torque has a span in shares of the length, and a value per length at both ends of the span. A torque with equal span ends is concentrated;
/// its first value counts.
pub(super) fn torque_at_ends(
    (gj, ecw, length): (f64, f64, f64),
    torques: impl Iterator<Item = ([f64; 2], [f64; 2])>,
) -> Vector4<f64> {
    let mut f = Vector4::zeros();
    for ([from, to], torque) in torques {
        let here = interpolate_twist(gj, ecw, length, from);
        if from == to {
            f += here.row(0).transpose() * torque[0];
            continue;
        }
        let piece = of_linear_torque(gj, ecw, length * (to - from), torque);
        f += here.transpose() * piece.fixed_rows::<2>(0);
        f += interpolate_twist(gj, ecw, length, to).transpose() * piece.fixed_rows::<2>(2);
    }
    f
}

/// Returns the stiffness of a beam over its two grids and its two warping points, basic frame. It is `k` (element frame) without torsion, plus
/// `torsion`. The first dof of a warping point is theta'.
/// `torsion` instead. The first dof of a warping point is theta'.
pub(super) fn assemble_with_warping(
    grids: &[GridIx],
    mut k: SMatrix<f64, 12, 12>,
    t: &SMatrix<f64, 12, 12>,
    torsion: &Matrix4<f64>,
) -> ElementMatrix {
    for i in [3, 9] {
        k.row_mut(i).fill(0.0);
        k.column_mut(i).fill(0.0);
    }
    let mut all = SMatrix::<f64, 24, 24>::zeros();
    all.fixed_view_mut::<12, 12>(0, 0).copy_from(&k);
    let at = [3, 12, 9, 18];
    for (i, r) in at.iter().enumerate() {
        for (j, c) in at.iter().enumerate() {
            all[(*r, *c)] += torsion[(i, j)];
        }
    }
    let mut turn = SMatrix::<f64, 24, 24>::identity();
    turn.fixed_view_mut::<12, 12>(0, 0).copy_from(t);
    let all = turn.transpose() * all * turn;
    ElementMatrix {
        grids: grids.to_vec(),
        values: all.transpose().as_slice().to_vec(),
    }
}
