//! The numeric factor: faer's supernodal Cholesky of the matrix scaled to a unit diagonal.

use super::block_matrix::BlockMatrix;
use super::error::FactorError;
use super::symbolic::Symbolic;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, LltParams, LltRegularization};
use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef;
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Auto, Par, Side, Spec};
use rayon::prelude::*;

/// Pivots of the matrix scaled to a unit diagonal below this are lost to rounding: the unknown is held by nothing.
const TINY_PIVOT: f64 = 1e-13;
/// Lost pivots that are looked for, each by one more factorisation.
const MOST_LOST: usize = 12;

/// L L' of the matrix scaled to a unit diagonal.
#[derive(Debug)]
pub struct Factor<'a> {
    pub(super) symbolic: &'a Symbolic,
    pub(super) values: Vec<f64>,
    /// Scale by unknown, elimination order.
    pub(super) scale: Vec<f64>,
    /// Unknowns (caller's numbering) whose pivot was lost: held by nothing, kept at zero.
    pub lost: Vec<usize>,
    /// Smallest pivot that was not lost, of the scaled matrix: how near the structure is to a mechanism.
    pub smallest_pivot: f64,
    pub(super) matrix: ScaledMatrix,
}

/// Lower triangle of the scaled matrix by columns, elimination order: what the residual of a solution is formed with.
#[derive(Debug)]
pub(super) struct ScaledMatrix {
    columns: Vec<u32>,
    rows: Vec<u32>,
    entries: Vec<f64>,
}

impl ScaledMatrix {
    /// r -= A y, where `r` holds `M` columns row by row, and `y` holds those, from the one numbered `c`, among `k`.
    pub(super) fn subtract_product<const M: usize>(
        &self,
        y: &[f64],
        (k, c): (usize, usize),
        r: &mut [[f64; M]],
    ) {
        let row = |i: usize| -> [f64; M] { std::array::from_fn(|m| y[i * k + c + m]) };
        for (j, range) in self.columns.windows(2).enumerate() {
            let range = range[0] as usize..range[1] as usize;
            let (mut own, yj) = ([0.0; M], row(j));
            for (&i, &a) in self.rows[range.clone()].iter().zip(&self.entries[range]) {
                let i = i as usize;
                let yi = row(i);
                (0..M).for_each(|m| own[m] += a * yi[m]);
                if i != j {
                    (0..M).for_each(|m| r[i][m] -= a * yj[m]);
                }
            }
            (0..M).for_each(|m| r[j][m] -= own[m]);
        }
    }
}

impl<'a> Factor<'a> {
    /// The factor of a symmetric positive (semi)definite matrix, which is used up: only its scaled lower triangle is kept.
    ///
    /// # Errors
    /// An entry that is not a number, or a factor that memory doesn't hold.
    pub fn new(symbolic: &'a Symbolic, matrix: BlockMatrix) -> Result<Self, FactorError> {
        let diagonal = matrix.diagonal(symbolic);
        if let Some(new) = diagonal.iter().position(|d| !d.is_finite()) {
            return Err(FactorError::NotANumber {
                unknown: symbolic.old_unknown(new),
            });
        }
        let scale: Vec<f64> = diagonal
            .iter()
            .map(|&d| if d > 0.0 { 1.0 / d.sqrt() } else { 1.0 })
            .collect();
        let cholesky = &symbolic.cholesky;
        let (columns, rows, mut entries) = matrix.lower_columns(symbolic, &scale);
        drop(matrix);
        let mut values = zeros(cholesky.len_val())?;
        let n = symbolic.n_unknowns();
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &columns, None, &rows);
        let (par, parameters) = (
            Par::rayon(0),
            Spec::<LltParams, f64>::new(<LltParams as Auto<f64>>::auto()),
        );
        let scratch = cholesky.factorize_numeric_llt_scratch::<f64>(par, parameters);
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| FactorError::TooLarge)?;
        let (mut lost, mut smallest_pivot) = (Vec::new(), f64::INFINITY);
        // A lost pivot is held by a spring and the factorisation repeated: only for structures that are refused anyway. (faer's own
        // regularisation leaves the unregularised diagonal in L.)
        while lost.len() < MOST_LOST {
            let done = cholesky
                .factorize_numeric_llt(
                    &mut values,
                    SparseColMatRef::new(pattern, &entries),
                    Side::Lower,
                    LltRegularization::default(),
                    par,
                    MemStack::new(&mut memory),
                    parameters,
                )
                .map(|_| ());
            let bad = match done {
                Ok(_) => {
                    let pivots = pivots(cholesky.raw(), &values);
                    smallest_pivot = pivots.iter().fold(f64::INFINITY, |a, p| a.min(*p));
                    pivots.iter().position(|p| !(*p > TINY_PIVOT))
                }
                Err(LltError::NonPositivePivot { index }) => Some(index),
            };
            let Some(bad) = bad else { break };
            let unknown = symbolic.old_unknown(bad);
            let column = columns[bad] as usize..columns[bad + 1] as usize;
            let Some(at) = column.into_iter().find(|&i| rows[i] as usize == bad) else {
                break;
            };
            if lost.contains(&unknown) || !entries[at].is_finite() {
                return Err(FactorError::NotANumber { unknown });
            }
            entries[at] += 1.0;
            lost.push(unknown);
        }
        lost.sort_unstable();
        Ok(Self {
            symbolic,
            values,
            scale,
            lost,
            smallest_pivot,
            matrix: ScaledMatrix {
                columns,
                rows,
                entries,
            },
        })
    }
}

/// Zeros that every thread writes its share of: the system hands out gigabytes page by page, and faer would ask for them with one thread.
fn zeros(n: usize) -> Result<Vec<f64>, FactorError> {
    let mut probe: Vec<f64> = Vec::new();
    probe
        .try_reserve_exact(n)
        .map_err(|_| FactorError::TooLarge)?;
    drop(probe);
    let mut values = vec![0.0; n];
    values
        .par_chunks_mut(1 << 18)
        .for_each(|chunk| chunk.fill(0.0));
    Ok(values)
}

/// Squares of the diagonal of L, elimination order.
fn pivots(raw: &SymbolicCholeskyRaw<u32>, values: &[f64]) -> Vec<f64> {
    let SymbolicCholeskyRaw::Supernodal(supernodes) = raw else {
        return Vec::new();
    };
    let factor = SupernodalLltRef::new(supernodes, values);
    let mut all = Vec::with_capacity(supernodes.nrows());
    for s in 0..supernodes.n_supernodes() {
        let node = factor.supernode(s);
        all.extend((0..node.val().ncols()).map(|j| node.val()[(j, j)].powi(2)));
    }
    all
}
