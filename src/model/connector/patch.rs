//! Shells that a connector may pierce, and the foot of a point on them.

use crate::model::frame::unit;
use crate::model::types::*;
use nastran::cards::ShellShape;
use std::collections::HashMap;

/// Share of a patch by which a foot may lie outside (PROJTOL of SWLDPRM).
const OUTSIDE: f64 = 0.02;

/// A flat or doubly ruled patch: three or four corners.
#[derive(Clone, Debug)]
pub(super) struct Patch {
    pub(super) grids: Vec<GridIx>,
    pub(super) x: Vec<Vec3>,
    /// Thickness of the shell; 0 if grids define the patch.
    pub(super) thickness: f64,
}

/// Projection of a point onto a patch.
#[derive(Clone, Debug)]
pub(super) struct Foot {
    pub(super) x: Vec3,
    pub(super) normal: Vec3,
    /// Shape functions of the corners and their slopes along r and s.
    pub(super) functions: Vec<[f64; 3]>,
}

impl Patch {
    /// Returns the patch of the shell's corners; `None` for shells with mid-side grids.
    pub(super) fn of_shell(model: &Model, shell: &Shell) -> Option<Self> {
        if matches!(shell.shape, ShellShape::Quad8 | ShellShape::Tria6) {
            return None;
        }
        let n = shell.shape.n_corners();
        let grids = shell.grids.get(..n)?.to_vec();
        let x = grids
            .iter()
            .map(|g| model.grids.get(g.us()).map(|g| g.x))
            .collect::<Option<Vec<_>>>()?;
        let thickness = shell.thickness.iter().take(n).sum::<f64>() / n as f64;
        Some(Self {
            grids,
            x,
            thickness,
        })
    }

    fn functions(&self, r: f64, s: f64) -> Vec<[f64; 3]> {
        if self.x.len() == 3 {
            return vec![[1.0 - r - s, -1.0, -1.0], [r, 1.0, 0.0], [s, 0.0, 1.0]];
        }
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .iter()
            .map(|(a, b)| {
                let (u, v) = (1.0 + a * r, 1.0 + b * s);
                [u * v / 4.0, a * v / 4.0, b * u / 4.0]
            })
            .collect()
    }

    fn sums(&self, functions: &[[f64; 3]]) -> [Vec3; 3] {
        let sum = |k: usize| {
            self.x
                .iter()
                .zip(functions)
                .map(|(x, f)| x * f[k])
                .sum::<Vec3>()
        };
        [sum(0), sum(1), sum(2)]
    }

    /// Returns the foot of `p`: the point of the patch whose normal passes through `p`. `None` if the foot is outside the patch by more than
    /// [`OUTSIDE`].
    pub(super) fn foot(&self, p: Vec3) -> Option<Foot> {
        let (mut r, mut s) = if self.x.len() == 3 {
            (1.0 / 3.0, 1.0 / 3.0)
        } else {
            (0.0, 0.0)
        };
        for _ in 0..30 {
            let [x, a, b] = self.sums(&self.functions(r, s));
            let d = p - x;
            let (aa, ab, bb) = (a.dot(&a), a.dot(&b), b.dot(&b));
            let det = aa * bb - ab * ab;
            if !(det > 0.0) {
                return None;
            }
            let (da, db) = (d.dot(&a), d.dot(&b));
            let (dr, ds) = ((da * bb - db * ab) / det, (db * aa - da * ab) / det);
            (r, s) = ((r + dr).clamp(-3.0, 3.0), (s + ds).clamp(-3.0, 3.0));
            if dr.abs().max(ds.abs()) < 1e-13 {
                break;
            }
        }
        let (r, s) = if self.x.len() == 3 {
            if r < -OUTSIDE || s < -OUTSIDE || r + s > 1.0 + OUTSIDE {
                return None;
            }
            let (r, s) = (r.max(0.0), s.max(0.0));
            let over = (r + s).max(1.0);
            (r / over, s / over)
        } else {
            // r and s run over a length of 2.
            if r.abs().max(s.abs()) > 1.0 + 2.0 * OUTSIDE {
                return None;
            }
            (r.clamp(-1.0, 1.0), s.clamp(-1.0, 1.0))
        };
        let functions = self.functions(r, s);
        let [x, a, b] = self.sums(&functions);
        Some(Foot {
            x,
            normal: unit(a.cross(&b))?,
            functions,
        })
    }
}

/// Shells by property and by grid. The lists are computed on the first request.
#[derive(Default)]
pub(super) struct Patches {
    by_property: HashMap<u32, Vec<(usize, Vec3, f64)>>,
    by_grid: Option<HashMap<GridIx, Vec<usize>>>,
}

impl Patches {
    /// Shells of a property: index, middle, and the radius about it that holds them.
    fn of_property(&mut self, model: &Model, pid: u32) -> &[(usize, Vec3, f64)] {
        self.by_property.entry(pid).or_insert_with(|| {
            let of = |s: &Shell| {
                let p = model.shell_properties.get(s.property.us());
                p.is_some_and(|p| p.id == pid)
            };
            let shells = model.shells.iter().enumerate().filter(|(_, s)| of(s));
            shells
                .filter_map(|(i, s)| ball(model, s).map(|(c, r)| (i, c, r)))
                .collect()
        })
    }

    /// Returns the foot of `p` on the nearest shell of a property.
    pub(super) fn on_property(
        &mut self,
        model: &Model,
        pid: u32,
        p: Vec3,
    ) -> Option<(Patch, Foot)> {
        let list = self.of_property(model, pid);
        let nearest = list
            .iter()
            .map(|(_, c, _)| (p - c).norm())
            .fold(f64::INFINITY, f64::min);
        let near = list
            .iter()
            .filter(|(_, c, r)| (p - c).norm() <= nearest + r)
            .map(|l| l.0);
        find_nearest_foot(model, near, p)
    }

    /// Returns the foot of `p` on shell `i` or on a shell that shares a grid with `i`.
    pub(super) fn find_foot_near_shell(
        &mut self,
        model: &Model,
        i: usize,
        p: Vec3,
    ) -> Option<(Patch, Foot)> {
        let of_grid = self.by_grid.get_or_insert_with(|| {
            let mut all: HashMap<GridIx, Vec<usize>> = HashMap::new();
            for (i, s) in model.shells.iter().enumerate() {
                for g in s.grids.iter().take(s.shape.n_corners()) {
                    all.entry(*g).or_default().push(i);
                }
            }
            all
        });
        let shell = model.shells.get(i)?;
        let corners = shell.grids.iter().take(shell.shape.n_corners());
        let mut near: Vec<usize> = corners
            .filter_map(|g| of_grid.get(g))
            .flatten()
            .copied()
            .collect();
        near.sort_unstable();
        near.dedup();
        find_nearest_foot(model, near.into_iter(), p)
    }
}

/// The nearest foot of `p` on one of the shells.
fn find_nearest_foot(
    model: &Model,
    shells: impl Iterator<Item = usize>,
    p: Vec3,
) -> Option<(Patch, Foot)> {
    let mut found: Option<(f64, Patch, Foot)> = None;
    for shell in shells.filter_map(|i| model.shells.get(i)) {
        let Some(patch) = Patch::of_shell(model, shell) else {
            continue;
        };
        let Some(foot) = patch.foot(p) else { continue };
        let distance = (foot.x - p).norm();
        if found.as_ref().is_none_or(|f| distance < f.0) {
            found = Some((distance, patch, foot));
        }
    }
    found.map(|(_, patch, foot)| (patch, foot))
}

fn ball(model: &Model, shell: &Shell) -> Option<(Vec3, f64)> {
    let corners = shell.grids.get(..shell.shape.n_corners())?;
    let x: Vec<Vec3> = corners
        .iter()
        .filter_map(|g| model.grids.get(g.us()).map(|g| g.x))
        .collect();
    let middle = x.iter().sum::<Vec3>() / x.len().max(1) as f64;
    let radius = x.iter().map(|x| (x - middle).norm()).fold(0.0, f64::max);
    Some((middle, radius))
}
