//! The stiffness of a constrained model, in blocks of a grid's free dofs.

use super::constraint::{Reduction, State};
use super::element::ElementMatrix;
use super::error::FeError;
use super::prepared_model::PreparedModel;
use crate::linalg::sparse::{BlockGraph, BlockMatrix, DenseTerm, Symbolic};
use crate::model::{ElementRef, GridIx, Mat3};
use rayon::prelude::*;

/// Numbering of the unknowns: groups are the grids with a free dof that an element touches.
#[derive(Clone, Debug, Default)]
pub(crate) struct Numbering {
    /// Group of each grid. `None` if the grid has no unknown.
    pub(crate) group: Vec<Option<u32>>,
    /// Grid of each group.
    pub(crate) grid: Vec<u32>,
    /// Free dofs (0 to 5) of each group, a bit each.
    pub(crate) free: Vec<u8>,
}

impl Numbering {
    /// Returns the unknowns in each group.
    pub(crate) fn sizes(&self) -> Vec<u8> {
        self.free.iter().map(|b| b.count_ones() as u8).collect()
    }

    /// Returns grid and dof (0 to 5) of an unknown. `start` is the first unknown of each group.
    pub(super) fn dof_of(&self, unknown: usize, start: &[usize]) -> (usize, usize) {
        let g = start.partition_point(|&s| s <= unknown) - 1;
        let dof = (0..6)
            .filter(|i| self.free[g] >> i & 1 == 1)
            .nth(unknown - start[g])
            .unwrap_or(0);
        (self.grid[g] as usize, dof)
    }

    /// Writes the values of a field over all dofs at the unknowns to `out`.
    pub(crate) fn pack(&self, field: &[[f64; 6]], out: &mut [f64]) {
        let mut at = 0;
        for (g, free) in self.grid.iter().zip(&self.free) {
            for i in (0..6).filter(|i| free >> i & 1 == 1) {
                out[at] = field[*g as usize][i];
                at += 1;
            }
        }
    }

    /// Returns a field over all dofs, with zeros at dofs without an unknown.
    pub(crate) fn unpack(&self, values: &[f64]) -> Vec<[f64; 6]> {
        let mut field = vec![[0.0; 6]; self.group.len()];
        let mut at = 0;
        for (g, free) in self.grid.iter().zip(&self.free) {
            for i in (0..6).filter(|i| free >> i & 1 == 1) {
                field[*g as usize][i] = values[at];
                at += 1;
            }
        }
        field
    }
}

/// Stiffness of the free dofs and its symbolic factor.
#[derive(Debug)]
pub(crate) struct AssembledStiffness {
    pub(crate) numbering: Numbering,
    pub(crate) graph: BlockGraph,
    pub(crate) symbolic: Symbolic,
    pub(crate) stiffness: BlockMatrix,
}

/// Returns the grids at whose free dofs an element's stiffness acts, and these dofs as bits.
///
/// `dofs` are the degrees of freedom that the element gives stiffness to. The rotations of a grid with solids alone are not unknowns.
fn find_reached_dofs(reduction: &Reduction, grids: &[GridIx], dofs: u8) -> Vec<(u32, u8)> {
    let mut list: Vec<(u32, u8)> = Vec::with_capacity(grids.len());
    for g in grids {
        for i in (0..6).filter(|i| dofs >> i & 1 == 1) {
            match reduction.state[6 * g.us() + i] {
                State::Free => match list.last_mut() {
                    Some(last) if last.0 == g.0 => last.1 |= 1 << i,
                    _ => list.push((g.0, 1 << i)),
                },
                State::Held => {}
                State::Dependent(r) => list.extend(
                    reduction.rows[r as usize]
                        .free
                        .iter()
                        .map(|t| (t.0 / 6, 1 << (t.0 % 6))),
                ),
            }
        }
    }
    list.sort_unstable_by_key(|t| t.0);
    list.dedup_by(|later, first| {
        let same = later.0 == first.0;
        if same {
            first.1 |= later.1;
        }
        same
    });
    list
}

/// Returns the assembled stiffness T' K T.
///
/// # Errors
/// Elements that can't be formed; nothing to solve.
pub(crate) fn assemble(
    prepared: &PreparedModel<'_>,
    reduction: &Reduction,
) -> Result<AssembledStiffness, FeError> {
    let model = prepared.model;
    let elements: Vec<ElementRef> = model.elements().collect();
    let cliques: Vec<Vec<(u32, u8)>> = elements
        .par_iter()
        .map(|e| find_reached_dofs(reduction, &model.element_grids(*e), prepared.dofs(*e)))
        .collect();
    let mut free = vec![0_u8; model.grids.len()];
    for &(g, bits) in cliques.iter().flatten() {
        free[g as usize] |= bits;
    }
    let mut numbering = Numbering {
        group: vec![None; model.grids.len()],
        ..Numbering::default()
    };
    for (g, bits) in free.into_iter().enumerate().filter(|f| f.1 != 0) {
        numbering.group[g] = Some(numbering.grid.len() as u32);
        numbering.grid.push(g as u32);
        numbering.free.push(bits);
    }
    if elements.is_empty() {
        return Err(FeError::Empty);
    }
    let groups: Vec<Vec<u32>> = cliques
        .into_par_iter()
        .map(|c| {
            c.into_iter()
                .filter_map(|(g, _)| numbering.group[g as usize])
                .collect()
        })
        .collect();
    let graph = BlockGraph::from_cliques(numbering.grid.len(), || groups.iter().map(Vec::as_slice));
    let sizes = numbering.sizes();
    let symbolic = Symbolic::analyse(&graph, &sizes).map_err(|_| FeError::TooLarge {
        unknowns: sizes.iter().map(|s| usize::from(*s)).sum(),
    })?;
    let stiffness = BlockMatrix::assemble_terms(&symbolic, &graph, &groups, |i| {
        let k = prepared.stiffness(elements[i])?;
        Ok(reduce_stiffness(
            prepared, reduction, &numbering, k, &groups[i],
        ))
    })
    .map_err(FeError::Refused)?;
    Ok(AssembledStiffness {
        numbering,
        graph,
        symbolic,
        stiffness,
    })
}

/// Transforms an element's matrix to the displacement frames of its grids.
pub(super) fn to_displacement_frames(axes: &[Option<Mat3>], k: &mut ElementMatrix) {
    let n = k.n();
    for (b, g) in k.grids.iter().enumerate() {
        let Some(r) = &axes[g.us()] else { continue };
        for half in 0..2 {
            let at = 6 * b + 3 * half;
            for j in 0..n {
                let v = r * crate::model::Vec3::new(
                    k.values[at * n + j],
                    k.values[(at + 1) * n + j],
                    k.values[(at + 2) * n + j],
                );
                (0..3).for_each(|i| k.values[(at + i) * n + j] = v[i]);
            }
            for row in k.values.chunks_exact_mut(n) {
                let v = r * crate::model::Vec3::new(row[at], row[at + 1], row[at + 2]);
                (0..3).for_each(|i| row[at + i] = v[i]);
            }
        }
    }
}

/// T' K T of one element over its groups.
fn reduce_stiffness(
    prepared: &PreparedModel<'_>,
    reduction: &Reduction,
    numbering: &Numbering,
    mut k: ElementMatrix,
    groups: &[u32],
) -> DenseTerm {
    to_displacement_frames(&prepared.axes, &mut k);
    if let Some(groups) = all_free(reduction, numbering, &k.grids) {
        return DenseTerm {
            offsets: (0..=groups.len()).map(|i| 6 * i).collect(),
            groups,
            matrix: k.values,
        };
    }
    let mut offsets = vec![0];
    let mut n = 0;
    for &g in groups {
        n += numbering.free[g as usize].count_ones() as usize;
        offsets.push(n);
    }
    let column = |dof: usize| {
        let group = numbering.group[dof / 6]?;
        if numbering.free[group as usize] >> (dof % 6) & 1 == 0 {
            return None;
        }
        let at = groups.iter().position(|&g| g == group)?;
        let below = numbering.free[group as usize] & ((1_u8 << (dof % 6)) - 1);
        Some(offsets[at] + below.count_ones() as usize)
    };
    let rows: Vec<Vec<(usize, f64)>> = k
        .grids
        .iter()
        .flat_map(|g| 6 * g.us()..6 * g.us() + 6)
        .map(|dof| match reduction.state[dof] {
            State::Free => column(dof).map(|c| (c, 1.0)).into_iter().collect(),
            State::Held => Vec::new(),
            State::Dependent(r) => reduction.rows[r as usize]
                .free
                .iter()
                .filter_map(|(d, c)| Some((column(*d as usize)?, *c)))
                .collect(),
        })
        .collect();
    let size = k.n();
    let mut half = vec![0.0; size * n];
    for (i, values) in k.values.chunks_exact(size).enumerate() {
        for (v, row) in values.iter().zip(&rows) {
            for (c, t) in row {
                half[i * n + c] += v * t;
            }
        }
    }
    let mut matrix = vec![0.0; n * n];
    for (i, row) in rows.iter().enumerate() {
        for (r, t) in row {
            for j in 0..n {
                matrix[r * n + j] += t * half[i * n + j];
            }
        }
    }
    DenseTerm {
        groups: groups.to_vec(),
        offsets,
        matrix,
    }
}

/// The groups of an element's grids where each grid is there once and all its six dofs are unknowns: its matrix is the term.
fn all_free(reduction: &Reduction, numbering: &Numbering, grids: &[GridIx]) -> Option<Vec<u32>> {
    let group = |(i, g): (usize, &GridIx)| {
        let group = numbering.group[g.us()]?;
        let states = &reduction.state[6 * g.us()..6 * g.us() + 6];
        let free = numbering.free[group as usize] == 0b11_1111
            && states.iter().all(|s| *s == State::Free)
            && !grids[..i].contains(g);
        free.then_some(group)
    };
    grids.iter().enumerate().map(group).collect()
}
