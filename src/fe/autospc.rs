//! Dofs without stiffness at single grids (PARAM,AUTOSPC), and the loads along them.

use super::assembly::{AssembledStiffness, Numbering};
use crate::finding::{Finding, Severity, list_few};
use crate::linalg::{DMatrix, sparse::BlockMatrix};
use crate::model::Model;
use rayon::prelude::*;

/// Share of the largest stiffness at a grid, below which a direction counts as without stiffness.
pub(super) const EPZERO: f64 = 1e-8;
/// With AUTOSPC off: only rounding counts as no stiffness.
const NOTHING: f64 = 1e-13;
/// A load acts along a direction if it has more than this share of its size along it. Grids of a nearly flat shell lean by less; the loads that
/// they lose are tested after the solution.
const AIMED: f64 = 1e-3;
/// Number of grids in one task of a thread.
const MIN_GRIDS: usize = 256;
/// Share of the loads that held directions may take: the share in a solution whose equations are satisfied to six digits.
const LOST: f64 = 1e-6;

/// A direction at a grid without other stiffness, which gets a spring.
#[derive(Clone, Debug)]
pub(crate) struct Weak {
    /// Unknown at which the spring acts: the unknown that moves most along the direction.
    pub(crate) unknown: usize,
    /// Stiffness of this spring.
    pub(crate) k: f64,
    /// Whether the direction has any stiffness beyond rounding.
    pub(crate) some: bool,
    /// First unknown of the translations, or rotations, of the grid.
    first: usize,
    /// Displacement of these unknowns along the direction, length 1.
    direction: Vec<f64>,
}

impl Weak {
    /// Returns the part of a load along the direction; 0 if the load does not act along the direction. Load and result are at the unknowns.
    pub(super) fn load_along(&self, packed: &[f64]) -> f64 {
        let pairs = packed.iter().skip(self.first).zip(&self.direction);
        let (along, square) = pairs.fold((0.0, 0.0), |(a, s), (f, d)| (a + f * d, s + f * f));
        let along = f64::abs(along);
        if along > AIMED * f64::sqrt(square) {
            along
        } else {
            0.0
        }
    }
}

/// Returns the springs to add so that no direction at a single grid is without stiffness.
///
/// With AUTOSPC off, a spring is added only to directions without any stiffness: no force acts on them, and a solver removes its null columns. A
/// direction of negative stiffness gets no spring, because its stiffness changes the displacements. The factor shows whether the remaining stiffness
/// exceeds the negative stiffness.
pub(super) fn weak_unknowns(assembled: &AssembledStiffness, autospc: bool) -> Vec<Weak> {
    let limit = if autospc { EPZERO } else { NOTHING };
    let diagonal = assembled.stiffness.diagonal_values(&assembled.symbolic);
    let typical = diagonal.iter().fold(0.0_f64, |a, v| a.max(*v));
    let start = assembled.symbolic.unknown_start();
    let of_grid = |(g, free): (usize, &u8)| -> Vec<Weak> {
        let mut weak = Vec::new();
        let block = BlockMatrix::diagonal_block(&assembled.stiffness, &assembled.symbolic, g);
        let n = free.count_ones() as usize;
        let translations = (free & 0b111).count_ones() as usize;
        for part in [0..translations, translations..n] {
            let m = part.len();
            if m == 0 {
                continue;
            }
            let k = DMatrix::from_fn(m, m, |i, j| block[(part.start + i) * n + part.start + j]);
            let largest = k.diagonal().max();
            // This cheap test is sufficient for most grids: their diagonals are strictly dominant and of similar size.
            if well_held(&k, largest) {
                continue;
            }
            // Factoring reports the grid of a stiffness that is not a number.
            if k.iter().any(|v| !v.is_finite()) {
                continue;
            }
            let eigen = k.symmetric_eigen();
            let stiffest = eigen.eigenvalues.amax();
            let mut taken = vec![false; m];
            for (value, vector) in eigen
                .eigenvalues
                .iter()
                .zip(eigen.eigenvectors.column_iter())
            {
                if !(value.abs() > limit * stiffest) {
                    let pick = (0..m)
                        .filter(|&i| !taken[i])
                        .max_by(|&a, &b| vector[a].abs().total_cmp(&vector[b].abs()));
                    if let Some(i) = pick {
                        taken[i] = true;
                        weak.push(Weak {
                            unknown: start[g] + part.start + i,
                            k: if stiffest > 0.0 { stiffest } else { typical },
                            some: value.abs() > NOTHING * stiffest,
                            first: start[g] + part.start,
                            direction: vector.iter().copied().collect(),
                        });
                    }
                }
            }
        }
        weak
    };
    let grids = assembled.numbering.free.par_iter().enumerate();
    grids
        .with_min_len(MIN_GRIDS)
        .flat_map_iter(of_grid)
        .collect()
}

/// Gershgorin: every eigenvalue is above 1e-4 of the largest diagonal entry.
fn well_held(k: &DMatrix<f64>, largest: f64) -> bool {
    (0..k.nrows()).all(|i| {
        let off_diagonal: f64 = (0..k.ncols())
            .filter(|&j| j != i)
            .map(|j| k[(i, j)].abs())
            .sum();
        k[(i, i)] - off_diagonal > 1e-4 * largest
    })
}

/// Grid and dof of the first of some unknowns, for messages.
fn describe_unknowns(
    model: &Model,
    numbering: &Numbering,
    start: &[usize],
    unknowns: &[usize],
) -> String {
    let names: Vec<String> = unknowns
        .iter()
        .map(|unknown| {
            let (g, dof) = numbering.dof_of(*unknown, start);
            format!("{}/{}", model.grids[g].id, dof + 1)
        })
        .collect();
    format!("grid/dof {}", list_few(&names))
}

/// Returns the finding that springs hold directions without stiffness.
pub(super) fn autospc_finding(
    model: &Model,
    assembled: &AssembledStiffness,
    weak: &[Weak],
) -> Option<Finding> {
    let unknowns: Vec<usize> = weak.iter().map(|w| w.unknown).collect();
    let start = assembled.symbolic.unknown_start();
    (!weak.is_empty()).then(|| {
        Finding::new(
            Severity::Info,
            "autospc",
            describe_unknowns(model, &assembled.numbering, start, &unknowns),
            format!(
                "{} dofs without stiffness, or with nearly none compared with the stiffest dof of their grid, were held (AUTOSPC)",
                weak.len()
            ),
            "nothing, if no load acts there",
        )
    })
}

/// Returns the sizes of the forces and of the moments at the unknowns, the reference for held loads. They are sums, because a load that is spread
/// over a million grids is small at each grid. `reach`, the size of the model, converts forces to moments.
pub(super) fn load_sizes(numbering: &Numbering, acting: &[f64], reach: f64) -> [f64; 2] {
    let mut sizes = [0.0; 2];
    let mut values = acting.iter();
    for free in &numbering.free {
        for i in (0..6).filter(|i| free >> i & 1 == 1) {
            sizes[i / 3] += values.next().map_or(0.0, |v| v.abs());
        }
    }
    sizes[1] += reach * sizes[0];
    sizes
}

/// Returns a finding if the springs in the weak directions take loads of a solved case instead of the structure.
///
/// `sizes`: sizes of the loads, forces and moments; `moved`: displacements at the unknowns.
pub(super) fn held_loads(
    model: &Model,
    (numbering, start): (&Numbering, &[usize]),
    weak: &[Weak],
    subcase: u32,
    sizes: [f64; 2],
    moved: &[f64],
) -> Option<Finding> {
    let mut all: Vec<(f64, usize)> = weak
        .iter()
        .map(|w| {
            let (_, dof) = numbering.dof_of(w.unknown, start);
            let force = (w.k * moved[w.unknown]).abs();
            let size = sizes[dof / 3];
            (if force > 0.0 { force / size } else { 0.0 }, w.unknown)
        })
        .filter(|(share, _)| *share > LOST)
        .collect();
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    let largest = all.first()?.0;
    let unknowns: Vec<usize> = all.iter().map(|a| a.1).collect();
    Some(
        Finding::new(
            Severity::Error,
            "autospc-holds-load",
            format!(
                "subcase {subcase}, {}",
                describe_unknowns(model, numbering, start, &unknowns)
            ),
            format!(
                "AUTOSPC holds {} dofs with load: up to {:.1e} of the load goes into them instead of into the structure",
                all.len(),
                largest
            ),
            "replace parts that are stiffer by eight powers of ten by a rigid element (RBE2, MPC), or give PARAM,AUTOSPC,NO; connect or \
             hold the free dofs",
        )
        .with_numbers(largest, LOST),
    )
}
