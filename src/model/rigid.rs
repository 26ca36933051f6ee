//! RBE1, RBE2, RBE3, RBAR; the dofs that all rigid elements make dependent.

use super::build::Builder;
use super::fault::FaultKind;
use super::types::*;
use crate::linalg::{Matrix6, SymmetricEigen, Vector6};
use nastran::cards::{Dofs, Rbe3};
use nastran::place::{Place, PlacedCard};
use std::collections::HashMap;

impl Builder<'_> {
    pub(super) fn rigids(&mut self) {
        let cards = self.cards;
        let mut out: Vec<RigidElement> = Vec::new();
        for r in &cards.rbe2s {
            if !self.element(r.id, "RBE2", r.at) {
                continue;
            }
            let name = format!("RBE2 {}", r.id);
            let independent = self.grid(r.independent, &name, "GN", r.at);
            let list: Vec<(u32, Dofs)> = r.dependent.iter().map(|g| (*g, r.dofs)).collect();
            let dependent = self.grid_dofs(&list, &name, "GM", r.at);
            let Some(g) = independent else { continue };
            let independent = vec![(g, Dofs::ALL)];
            out.push(body(("RBE2", r.id), independent, dependent, r.alpha, r.at));
        }
        for r in &cards.rbars {
            if !self.element(r.id, "RBAR", r.at) {
                continue;
            }
            let name = format!("RBAR {}", r.id);
            let pair = |d: [Dofs; 2]| {
                [(r.grids[0], d[0]), (r.grids[1], d[1])]
                    .into_iter()
                    .filter(|t| !t.1.is_empty())
                    .collect::<Vec<_>>()
            };
            let mut m = r.dependent;
            if m.iter().all(|d| d.is_empty()) {
                m = r.independent.map(|d| Dofs(Dofs::ALL.0 & !d.0));
            }
            let independent = self.grid_dofs(&pair(r.independent), &name, "CNA", r.at);
            let dependent = self.grid_dofs(&pair(m), &name, "CMA", r.at);
            self.six(&independent, &name, r.at);
            out.push(body(("RBAR", r.id), independent, dependent, r.alpha, r.at));
        }
        for r in &cards.rbe1s {
            if !self.element(r.id, "RBE1", r.at) {
                continue;
            }
            let name = format!("RBE1 {}", r.id);
            let independent = self.grid_dofs(&r.independent, &name, "GN", r.at);
            let dependent = self.grid_dofs(&r.dependent, &name, "GM", r.at);
            self.six(&independent, &name, r.at);
            out.push(body(("RBE1", r.id), independent, dependent, r.alpha, r.at));
        }
        for r in &cards.rbe3s {
            if self.element(r.id, "RBE3", r.at) {
                out.extend(self.rbe3(r));
            }
        }
        for r in &cards.rsplines {
            if self.element(r.id, "RSPLINE", r.at) {
                out.extend(self.rspline(r));
            }
        }
        out.sort_by_key(|r| r.id);
        self.model.rigids = out;
    }

    fn grid_dofs(
        &mut self,
        list: &[(u32, Dofs)],
        name: &str,
        field: &'static str,
        at: Place,
    ) -> Vec<(GridIx, Dofs)> {
        list.iter()
            .filter_map(|(g, d)| Some((self.grid(*g, name, field, at)?, *d)))
            .collect()
    }

    fn six(&mut self, independent: &[(GridIx, Dofs)], name: &str, at: Place) {
        let n = independent.iter().map(|t| t.1.len()).sum();
        if n != 6 {
            self.fault(
                name.to_owned(),
                "CNA",
                at,
                FaultKind::NotSixIndependent { n },
            );
        }
    }

    fn rbe3(&mut self, r: &PlacedCard<Rbe3>) -> Option<RigidElement> {
        let name = format!("RBE3 {}", r.id);
        let reference = self.grid(r.reference, &name, "REFGRID", r.at);
        let mut arms = Vec::new();
        for group in &r.groups {
            for g in &group.grids {
                if let Some(g) = self.grid(*g, &name, "G", r.at) {
                    arms.push((group.weight, group.dofs, g));
                }
            }
        }
        let um = self.grid_dofs(&r.um, &name, "UM", r.at);
        let reference = reference?;
        if self.has_free_rotation(&arms, reference, r.refc) {
            self.fault(name, "G", r.at, FaultKind::CollinearArms);
        }
        let kind = RigidKind::Mean {
            reference,
            refc: r.refc,
            arms,
            um,
            alpha: r.alpha,
        };
        Some(RigidElement {
            id: r.id,
            kind,
            at: r.at,
        })
    }

    /// Returns whether the arms do not determine a rotation that the reference grid has to follow. In this case the weighted sum of their rigid-body
    /// rows, scaled to lengths of about 1, is rank-deficient.
    fn has_free_rotation(
        &self,
        arms: &[(f64, Dofs, GridIx)],
        reference: GridIx,
        refc: Dofs,
    ) -> bool {
        let x0 = self.x(reference);
        let reach = arms
            .iter()
            .map(|a| (self.x(a.2) - x0).norm())
            .fold(0.0, f64::max);
        let scale = if reach > 0.0 { reach } else { 1.0 };
        let mut sum = Matrix6::<f64>::zeros();
        for (w, dofs, g) in arms {
            let r = (self.x(*g) - x0) / scale;
            let axes = self.cd_axes(*g);
            for i in dofs.iter0() {
                let a = axes.row(i % 3).transpose();
                let mut row = Vector6::zeros();
                if i < 3 {
                    row.fixed_rows_mut::<3>(0).copy_from(&a);
                    row.fixed_rows_mut::<3>(3).copy_from(&r.cross(&a));
                } else {
                    row.fixed_rows_mut::<3>(3).copy_from(&a);
                }
                sum += row * row.transpose() * *w;
            }
        }
        let eigen = SymmetricEigen::new(sum);
        let largest = eigen.eigenvalues.amax();
        if !(largest > 0.0) {
            return true;
        }
        // A direction without stiffness matters only if dependent dofs of the reference grid move along it.
        let axes = self.cd_axes(reference);
        (0..6)
            .filter(|k| eigen.eigenvalues[*k] < 1e-10 * largest)
            .any(|k| {
                let v = eigen.eigenvectors.column(k);
                refc.iter0().any(|i| {
                    let a = axes.row(i % 3);
                    let base = if i < 3 { 0 } else { 3 };
                    (0..3).map(|j| a[j] * v[base + j]).sum::<f64>().abs() > 1e-6
                })
            })
    }

    /// Checks that each dof is dependent at most once in all rigid elements, and not independent in the same element.
    pub(super) fn check_dependents(&mut self) {
        let mut first: HashMap<(GridIx, usize), Place> = HashMap::new();
        let mut found = Vec::new();
        for r in &self.model.rigids {
            let independent: &[(GridIx, Dofs)] = match &r.kind {
                RigidKind::Body { independent, .. } => independent,
                RigidKind::Mean { .. } | RigidKind::Equations { .. } => &[],
            };
            let name = || format!("{} {}", r.kind.card(), r.id);
            let mut note = |kind| found.push((name(), r.kind.field(), r.at, kind));
            for (g, dofs) in r.kind.dependent_dofs() {
                for i in dofs.iter0() {
                    let grid = self.model.grids.get(g.us()).map_or(0, |g| g.id);
                    let dof = i as u8 + 1;
                    if independent.iter().any(|(h, d)| *h == g && d.has(dof)) {
                        note(FaultKind::DependentAndIndependent { grid, dof });
                    }
                    match first.get(&(g, i)) {
                        Some(at) => note(FaultKind::DependentTwice {
                            grid,
                            dof,
                            first: *at,
                        }),
                        None => {
                            first.insert((g, i), r.at);
                        }
                    }
                }
            }
        }
        for (name, field, at, kind) in found {
            self.fault(name, field, at, kind);
        }
    }
}

fn body(
    (card, id): (&'static str, u32),
    independent: Vec<(GridIx, Dofs)>,
    dependent: Vec<(GridIx, Dofs)>,
    alpha: f64,
    at: Place,
) -> RigidElement {
    RigidElement {
        id,
        kind: RigidKind::Body {
            card,
            independent,
            dependent,
            alpha,
        },
        at,
    }
}
