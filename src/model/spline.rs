//! RSPLINE: grids that follow an elastic tube through independent grids.

use super::build::Builder;
use super::fault::FaultKind;
use super::types::*;
use crate::linalg::{DMatrix, Matrix6};
use nastran::cards::{Dofs, Rspline};
use nastran::place::PlacedCard;

/// Grids between two independent ones beyond which a spline is refused: its equations are dense.
const MOST_BETWEEN: usize = 200;

impl Builder<'_> {
    /// Returns the equations of an RSPLINE. The spline is a thin tube with the diameter d = D/L times the length of all segments. It has EI = GJ and
    /// EA = 8 EI / d^2 and is rigid in shear. The tube is clamped at the independent grids and free of load between them. The stated dofs of the
    /// other grids follow it.
    ///
    /// A segment is six springs at its middle with rigid arms to its ends. The stiffnesses are 8 / (d^2 L), 12 / L^3 twice and 1 / L three times. A
    /// segment needs no orientation.
    ///
    /// # Reference
    /// NASTRAN Theoretical Manual (CRSPLINE); MSC Nastran Quick Reference Guide, RSPLINE.
    pub(super) fn rspline(&mut self, r: &PlacedCard<Rspline>) -> Option<RigidElement> {
        let name = format!("RSPLINE {}", r.id);
        let mut line = Vec::with_capacity(r.grids.len());
        for (g, dofs) in &r.grids {
            line.push((self.grid(*g, &name, "G", r.at)?, *dofs));
        }
        let carries = |at: Option<&(GridIx, Dofs)>| at.is_some_and(|(_, d)| d.is_empty());
        if line.len() < 3 || !carries(line.first()) || !carries(line.last()) {
            let kind = FaultKind::Word {
                found: format!("{} grids, the last dependent or alone", line.len()),
                expected: "an independent grid first and last, and dependent ones between",
            };
            self.fault(name, "G1", r.at, kind);
            return None;
        }
        let x: Vec<Vec3> = line.iter().map(|(g, _)| self.x(*g)).collect();
        let segments = x.iter().zip(x.iter().skip(1));
        let lengths: Vec<f64> = segments.map(|(a, b)| (b - a).norm()).collect();
        if let Some(length) = lengths.iter().copied().find(|l| !(*l > 0.0)) {
            self.fault(name, "G", r.at, FaultKind::ZeroLength { length });
            return None;
        }
        let diameter = r.diameter * lengths.iter().sum::<f64>();
        if !(diameter > 0.0) {
            let kind = FaultKind::NotPositive {
                what: "ratio D/L",
                value: r.diameter,
            };
            self.fault(name, "D/L", r.at, kind);
            return None;
        }
        let mut equations = Vec::new();
        let mut first = 0;
        for last in 1..line.len() {
            if line.get(last).is_none_or(|(_, d)| !d.is_empty()) {
                continue;
            }
            if last - first > MOST_BETWEEN {
                let kind = FaultKind::Unsupported {
                    what: format!("{} grids between two independent ones", last - first - 1),
                    remedy: "make some of the grids between independent",
                };
                self.fault(name, "G", r.at, kind);
                return None;
            }
            let piece = line.get(first..=last)?;
            equations.extend(self.piece_of_spline(piece, diameter)?);
            first = last;
        }
        Some(RigidElement {
            id: r.id,
            kind: RigidKind::Equations {
                card: "RSPLINE",
                equations,
            },
            at: r.at,
        })
    }

    /// Returns the equations between two independent grids, u_d = - K_dd^-1 K_di u_i. Lengths are in units of the piece, so that the conditioning
    /// does not depend on the unit of length.
    fn piece_of_spline(
        &self,
        piece: &[(GridIx, Dofs)],
        diameter: f64,
    ) -> Option<Vec<Vec<(GridIx, u8, f64)>>> {
        let n = piece.len();
        let x: Vec<Vec3> = piece.iter().map(|(g, _)| self.x(*g)).collect();
        let unit = x
            .iter()
            .zip(x.iter().skip(1))
            .map(|(a, b)| (b - a).norm())
            .sum::<f64>();
        let mut k = DMatrix::zeros(6 * n, 6 * n);
        for (i, (a, b)) in x.iter().zip(x.iter().skip(1)).enumerate() {
            let (ka, kab, kb) = segment((b - a) / unit, diameter / unit)?;
            let mut add = |r: usize, c: usize, m: &Matrix6<f64>| {
                let mut view = k.view_mut((6 * r, 6 * c), (6, 6));
                view += m;
            };
            add(i, i, &ka);
            add(i, i + 1, &kab);
            add(i + 1, i, &kab.transpose());
            add(i + 1, i + 1, &kb);
        }
        let m = 6 * (n - 2);
        let inner = k.view((6, 6), (m, m)).into_owned();
        let mut outer = DMatrix::zeros(m, 12);
        outer
            .view_mut((0, 0), (m, 6))
            .copy_from(&k.view((6, 0), (m, 6)));
        outer
            .view_mut((0, 6), (m, 6))
            .copy_from(&k.view((6, 6 * (n - 1)), (m, 6)));
        let follows = inner.cholesky()?.solve(&-outer);
        let ends = [piece.first()?.0, piece.last()?.0];
        let mut out = Vec::new();
        for (row, (g, dofs)) in piece.iter().skip(1).take(n - 2).enumerate() {
            // Convert to true lengths and to displacement frames.
            let own = self.cd_axes(*g);
            let blocks = [0, 1].map(|e| {
                let mut b: Matrix6<f64> = follows.fixed_view::<6, 6>(6 * row, 6 * e).into_owned();
                b.fixed_view_mut::<3, 3>(0, 3).scale_mut(unit);
                b.fixed_view_mut::<3, 3>(3, 0).scale_mut(1.0 / unit);
                b
            });
            for i in dofs.iter0() {
                let mut terms = vec![(*g, i as u8, 1.0)];
                for (end, b) in ends.iter().zip(&blocks) {
                    let frame = self.cd_axes(*end);
                    let half = 3 * (i / 3);
                    for part in [0, 3] {
                        let row =
                            own.row(i % 3) * b.fixed_view::<3, 3>(half, part) * frame.transpose();
                        for (j, v) in row.iter().enumerate() {
                            let scale = match (half, part) {
                                (0, 3) => unit,
                                (3, 0) => 1.0 / unit,
                                _ => 1.0,
                            };
                            if v.abs() > 1e-13 * scale {
                                terms.push((*end, (part + j) as u8, -v));
                            }
                        }
                    }
                }
                out.push(terms);
            }
        }
        Some(out)
    }
}

/// Stiffness of a segment along `line`: of its first end, between, and of its second.
fn segment(line: Vec3, diameter: f64) -> Option<(Matrix6<f64>, Matrix6<f64>, Matrix6<f64>)> {
    let length = line.norm();
    let along = line.try_normalize(0.0)?;
    let across = 12.0 / length.powi(3);
    let axial = 8.0 / (diameter * diameter * length);
    let mut springs = Matrix6::zeros();
    let outer = along * along.transpose();
    springs
        .fixed_view_mut::<3, 3>(0, 0)
        .copy_from(&(Mat3::identity() * across + outer * (axial - across)));
    springs
        .fixed_view_mut::<3, 3>(3, 3)
        .copy_from(&(Mat3::identity() / length));
    // Motion of the middle due to the motion of an end with a rigid arm.
    let arm = |r: Vec3| {
        let mut m = Matrix6::identity();
        m.fixed_view_mut::<3, 3>(0, 3).copy_from(&-r.cross_matrix());
        m
    };
    let (a, b) = (-arm(line / 2.0), arm(-line / 2.0));
    Some((
        a.transpose() * springs * a,
        a.transpose() * springs * b,
        b.transpose() * springs * b,
    ))
}
