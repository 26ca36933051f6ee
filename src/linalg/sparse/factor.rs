//! The numeric factor: faer's supernodal Cholesky of the matrix scaled to a unit diagonal.

use super::block_matrix::BlockMatrix;
use super::symbolic::Symbolic;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltParams, LltRegularization};
use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef;
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Auto, Par, Side, Spec};

/// Pivots of the matrix scaled to a unit diagonal below this are lost to rounding: the unknown is held by nothing.
const TINY_PIVOT: f64 = 1e-13;
/// What a lost pivot is replaced by, so that its unknown stays at zero and the factorisation goes on.
const HUGE_PIVOT: f64 = 1e30;

/// Why a factor could not be made.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FactorError {
    /// A pivot is not a number: an entry of the matrix is infinite or not a number.
    #[error("pivot of unknown {unknown} is not a number")]
    NotANumber {
        /// Caller's numbering.
        unknown: usize,
    },
    /// More entries than indices count or memory holds.
    #[error("the factor is too large for this machine's memory or for 32-bit indices")]
    TooLarge,
}

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
}

impl<'a> Factor<'a> {
    /// The factor of a symmetric positive (semi)definite matrix.
    ///
    /// # Errors
    /// An entry that is not a number, or a factor that memory doesn't hold.
    pub fn new(symbolic: &'a Symbolic, matrix: &BlockMatrix) -> Result<Self, FactorError> {
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
        let mut values = Vec::new();
        values
            .try_reserve_exact(cholesky.len_val())
            .map_err(|_| FactorError::TooLarge)?;
        values.resize(cholesky.len_val(), 0.0);
        {
            let (columns, rows, entries) = matrix.lower_columns(symbolic, &scale);
            let n = symbolic.n_unknowns();
            let lower = SparseColMatRef::new(
                SymbolicSparseColMatRef::new_checked(n, n, &columns, None, &rows),
                &entries,
            );
            let (par, parameters) = (
                Par::rayon(0),
                Spec::<LltParams, f64>::new(<LltParams as Auto<f64>>::auto()),
            );
            let scratch = cholesky.factorize_numeric_llt_scratch::<f64>(par, parameters);
            let mut memory = MemBuffer::try_new(scratch).map_err(|_| FactorError::TooLarge)?;
            let regularisation = LltRegularization {
                dynamic_regularization_delta: HUGE_PIVOT,
                dynamic_regularization_epsilon: TINY_PIVOT,
            };
            cholesky
                .factorize_numeric_llt(
                    &mut values,
                    lower,
                    Side::Lower,
                    regularisation,
                    par,
                    MemStack::new(&mut memory),
                    parameters,
                )
                .map_err(|_| FactorError::NotANumber { unknown: 0 })?;
        }
        let (mut lost, mut smallest_pivot) = (Vec::new(), f64::INFINITY);
        if let SymbolicCholeskyRaw::Supernodal(supernodes) = cholesky.raw() {
            let factor = SupernodalLltRef::new(supernodes, &values);
            for s in 0..supernodes.n_supernodes() {
                let node = factor.supernode(s);
                for j in 0..node.val().ncols() {
                    let pivot = node.val()[(j, j)].powi(2);
                    let unknown = node.start() + j;
                    if pivot.is_nan() {
                        return Err(FactorError::NotANumber {
                            unknown: symbolic.old_unknown(unknown),
                        });
                    } else if pivot >= 0.5 * HUGE_PIVOT {
                        lost.push(symbolic.old_unknown(unknown));
                    } else {
                        smallest_pivot = smallest_pivot.min(pivot);
                    }
                }
            }
        }
        lost.sort_unstable();
        Ok(Self {
            symbolic,
            values,
            scale,
            lost,
            smallest_pivot,
        })
    }
}
