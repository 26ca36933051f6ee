//! The lowest elastic modes from a factor of the stiffness: a block Lanczos method.

use super::error::FeError;
use super::mass::Mass;
use super::prepared_model::PreparedModel;
use super::system::System;
use crate::linalg::DMatrix;
use crate::linalg::sparse::Factor;
use crate::stop::Stop;
use rayon::prelude::*;

/// Vectors a block: more than any multiplicity that symmetric structures have.
const BLOCK: usize = 8;
/// Grids handled at a time: the vectors of a block over so many stay in the cache.
const CHUNK: usize = 512;
/// Vectors at most, for each mode wanted: bounds memory and time.
const VECTORS_A_MODE: usize = 8;

/// Six components by grid.
pub(super) type Field = Vec<[f64; 6]>;

/// Smallest bound on the relative error of a frequency: the rounding error of the factor.
const ROUNDING: f64 = 1e-12;

/// Limits below which modes count as found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Accuracy {
    /// Bound on the relative error of a frequency.
    pub(super) frequency: f64,
    /// Bound on the residual of a pair, divided by its value. The error of a shape is this bound divided by the distance to the next value.
    pub(super) residual: f64,
}

/// Number, accuracy and content of the modes to compute.
#[derive(Clone, Copy)]
pub(super) struct ModeRequest<'a> {
    /// Number of modes.
    pub(super) count: usize,
    /// Required accuracy.
    pub(super) accuracy: Accuracy,
    /// Whether to compute shapes; if not, they are empty.
    pub(super) shapes: bool,
    /// Cancellation, tested between blocks.
    pub(super) stop: &'a Stop,
}

/// A Ritz pair of (K, M).
#[derive(Clone, Debug)]
pub(super) struct Pair {
    /// Cycles per unit of time.
    pub(super) frequency: f64,
    /// Shape with unit generalised mass, basic frame.
    pub(super) shape: Field,
    /// |K^-1 M q - theta q| over theta = 1 / omega^2, in the norm of M.
    pub(super) residual: f64,
    /// Distance to the nearest other value, divided by the value of this mode. Values are 1 / omega^2.
    pub(super) gap: f64,
}

impl Pair {
    /// Returns a bound on the relative error of the frequency, half the relative error of theta. The bound on theta is the residual, or the squared
    /// residual over the gap if that is smaller (Kato and Temple).
    pub(super) fn frequency_error(&self) -> f64 {
        frequency_error(self.residual, self.gap)
    }
}

fn frequency_error(residual: f64, gap: f64) -> f64 {
    let quadratic = if gap > 0.0 {
        residual * residual / gap
    } else {
        f64::INFINITY
    };
    (0.5 * residual.min(quadratic)).max(ROUNDING)
}

/// Residual over value, and gap over value, of the first `count` Ritz pairs.
fn residuals(
    values: &[f64],
    vectors: &DMatrix<f64>,
    kept: &DMatrix<f64>,
    count: usize,
) -> Vec<(f64, f64)> {
    let size = vectors.nrows();
    let first = size.saturating_sub(kept.ncols());
    (0..count.min(values.len()))
        .map(|c| {
            let tail = vectors.column(c).rows(first, size - first).into_owned();
            let neighbours = [c.checked_sub(1), Some(c + 1)];
            let gap = neighbours
                .into_iter()
                .flatten()
                .filter_map(|i| values.get(i))
                .map(|v| (v - values[c]).abs())
                .fold(f64::INFINITY, f64::min);
            ((kept * tail).norm() / values[c], gap / values[c])
        })
        .collect()
}

/// Computes the lowest elastic modes from a factor of the stiffness; fewer if the structure has fewer. Free structures are held statically
/// determinate.
///
/// The method is block Lanczos with full reorthogonalization on P K^-1 P' M in the inner product of M. P removes the rigid motions (R'M u = 0), so
/// that a balanced load needs only the stiffness that statics use.
///
/// # Reference
/// R. G. Grimes, J. G. Lewis and H. D. Simon, SIAM J. Matrix Anal. Appl. 15 (1994) 228; T. Kato, J. Phys. Soc. Japan 4 (1949) 334
/// (bounds).
///
/// # Errors
/// See [`FeError`].
pub(super) fn find_lowest_modes(
    prepared: &PreparedModel<'_>,
    mass: &Mass,
    system: &System,
    factor: &Factor<'_>,
    wanted: ModeRequest<'_>,
) -> Result<Vec<Pair>, FeError> {
    let ModeRequest {
        count,
        accuracy,
        shapes,
        ..
    } = wanted;
    let n = system.symbolic.n_unknowns();
    let most = (VECTORS_A_MODE * count).max(4 * BLOCK).min(n);
    // Returns P u for values at the unknowns.
    let field = |values: &[f64]| {
        let mut u = system.unpack(prepared, values);
        if let Some(body) = &system.body {
            body.take_out(mass, &mut u);
        }
        u
    };
    let apply = |forces: Vec<Field>| -> Result<Vec<Field>, FeError> {
        let mut columns = vec![0.0; n * forces.len()];
        columns
            .par_chunks_exact_mut(n.max(1))
            .zip(forces)
            .try_for_each(|(column, f)| system.pack(prepared, f, column))?;
        factor.solve(&mut columns);
        Ok(columns.par_chunks_exact(n.max(1)).map(field).collect())
    };
    let start: Vec<Field> = (0..BLOCK.min(n))
        .into_par_iter()
        .map(|c| field(&start_values(n, c)))
        .collect();
    // One step on random values removes the components without mass.
    let mut block = apply(mass_times(mass, &start))?;
    drop(start);
    let mut basis: Vec<Field> = Vec::new();
    let mut masses = mass_times(mass, &block);
    // `projected` is Q' M A Q over the basis vectors. `along` contains the columns of Q' M A Q for the last block.
    let mut projected = DMatrix::<f64>::zeros(0, 0);
    let mut along = DMatrix::zeros(0, block.len());
    let found = loop {
        let (q, f, kept) = orthonormalize_block(mass, &basis, block, (masses, &along));
        let before = basis.len();
        let size = before + q.len();
        // `kept` couples the new vectors to the last block. The orthogonalization of the new vectors gives it.
        let pairs = ritz(&projected);
        let last = q.is_empty() || (size > most && before > 0);
        if let Some((values, vectors)) = pairs {
            let found = residuals(&values, &vectors, &kept, count);
            let enough = values.len() > count || last;
            let good = |r: &(f64, f64)| {
                frequency_error(r.0, r.1) <= accuracy.frequency && r.0 <= accuracy.residual
            };
            if last || (enough && found.iter().all(good)) {
                break Some((values, vectors, found));
            }
        } else if last {
            break None;
        }
        if wanted.stop.is_asked() {
            return Err(FeError::Stopped);
        }
        block = apply(f)?;
        basis.extend(q);
        // <q_i, A q_j> for all i and the new j.
        masses = mass_times(mass, &block);
        along = gram(&basis, &masses);
        let mut grown = DMatrix::zeros(size, size);
        grown
            .view_mut((0, 0), (before, before))
            .copy_from(&projected);
        for i in 0..size {
            for j in before..size {
                grown[(i, j)] = along[(i, j - before)];
                grown[(j, i)] = along[(i, j - before)];
            }
        }
        projected = grown;
    };
    let Some((values, vectors, found)) = found else {
        return Ok(Vec::new());
    };
    let floor = 1e-12 * values.first().copied().unwrap_or(0.0);
    let good = values.iter().take_while(|v| **v > floor).count();
    Ok((0..count.min(good))
        .into_par_iter()
        .map(|c| Pair {
            frequency: 1.0 / values[c].sqrt() / std::f64::consts::TAU,
            shape: match shapes {
                true => combine(&basis, |r| vectors[(r, c)]),
                false => Field::new(),
            },
            residual: found[c].0,
            gap: found[c].1,
        })
        .collect())
}

/// Ritz values 1 / omega^2, descending, and vectors.
fn ritz(projected: &DMatrix<f64>) -> Option<(Vec<f64>, DMatrix<f64>)> {
    if projected.nrows() == 0 {
        return None;
    }
    let symmetric = (projected + projected.transpose()) * 0.5;
    let eigen = symmetric.symmetric_eigen();
    let mut order: Vec<usize> = (0..projected.nrows()).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let values = order.iter().map(|&i| eigen.eigenvalues[i]).collect();
    let vectors = DMatrix::from_fn(projected.nrows(), order.len(), |r, c| {
        eigen.eigenvectors[(r, order[c])]
    });
    Some((values, vectors))
}

fn mass_times(mass: &Mass, fields: &[Field]) -> Vec<Field> {
    fields.par_iter().map(|u| mass.times(u)).collect()
}

/// A block made orthonormal in M to the basis and in itself: vectors, M times them, and the factor R of `block = basis part + Q R`.
/// Directions that are left with nothing are dropped. `masses` is M times the block and `along` the basis's dots with that.
fn orthonormalize_block(
    mass: &Mass,
    basis: &[Field],
    mut block: Vec<Field>,
    (masses, along): (Vec<Field>, &DMatrix<f64>),
) -> (Vec<Field>, Vec<Field>, DMatrix<f64>) {
    let square = |(u, m): (&Field, &Field)| dot(u, m).max(0.0);
    let scale = block.iter().zip(&masses).map(square).fold(0.0, f64::max);
    drop(masses);
    if !basis.is_empty() {
        // A Lanczos step couples a block only to the last two blocks. Components along these blocks are removed first, then the rounding
        // errors along all vectors.
        let first = basis.len().saturating_sub(2 * BLOCK);
        let tied = along.rows(first, basis.len() - first).into_owned();
        subtract(&mut block, &basis[first..], &tied);
        let left = gram(basis, &mass_times(mass, &block));
        subtract(&mut block, basis, &left);
    }
    let mut factor = DMatrix::identity(block.len(), block.len());
    // The second pass removes the rounding error of the first pass.
    for _ in 0..2 {
        let weight = gram(&block, &mass_times(mass, &block));
        let n = block.len();
        if n == 0 {
            break;
        }
        let eigen = weight.symmetric_eigen();
        let kept: Vec<usize> = (0..n)
            .filter(|&i| eigen.eigenvalues[i] > 1e-24 * scale.max(f64::MIN_POSITIVE))
            .collect();
        let step = DMatrix::from_fn(kept.len(), n, |r, c| {
            eigen.eigenvalues[kept[r]].sqrt() * eigen.eigenvectors[(c, kept[r])]
        });
        block = (0..kept.len())
            .into_par_iter()
            .map(|c| {
                let root = eigen.eigenvalues[kept[c]].sqrt();
                combine(&block, |r| eigen.eigenvectors[(r, kept[c])] / root)
            })
            .collect();
        factor = step * factor;
    }
    let f = mass_times(mass, &block);
    (block, f, factor)
}

/// Repeatable values between -1 and 1 (splitmix64).
fn start_values(n: usize, column: usize) -> Vec<f64> {
    let mut state = 0x9E37_79B9_7F4A_7C15_u64.wrapping_mul(column as u64 + 1);
    (0..n)
        .map(|_| {
            state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let mut z = state;
            z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        })
        .collect()
}

/// Dots of all of `a` with all of `b`, chunk by chunk so that each is read once; the chunks are summed in their order.
fn gram(a: &[Field], b: &[Field]) -> DMatrix<f64> {
    let grids = a.first().map_or(0, Vec::len);
    let parts: Vec<DMatrix<f64>> = (0..grids.div_ceil(CHUNK))
        .into_par_iter()
        .map(|c| {
            let range = c * CHUNK..grids.min((c + 1) * CHUNK);
            DMatrix::from_fn(a.len(), b.len(), |i, j| {
                dot(&a[i][range.clone()], &b[j][range.clone()])
            })
        })
        .collect();
    parts
        .iter()
        .fold(DMatrix::zeros(a.len(), b.len()), |sum, p| sum + p)
}

fn dot(a: &[[f64; 6]], b: &[[f64; 6]]) -> f64 {
    // Six separate sums, which the processor computes in parallel.
    let mut sums = [0.0; 6];
    for (a, b) in a.iter().zip(b) {
        for i in 0..6 {
            sums[i] += a[i] * b[i];
        }
    }
    sums.iter().sum()
}

/// Takes `basis` times a column of `amounts` from each field of the block.
fn subtract(block: &mut [Field], basis: &[Field], amounts: &DMatrix<f64>) {
    let grids = block.first().map_or(0, Vec::len);
    let mut pieces: Vec<Vec<&mut [[f64; 6]]>> = (0..grids.div_ceil(CHUNK))
        .map(|_| Vec::with_capacity(block.len()))
        .collect();
    for field in block {
        for (piece, list) in field.chunks_mut(CHUNK).zip(&mut pieces) {
            list.push(piece);
        }
    }
    pieces.into_par_iter().enumerate().for_each(|(c, list)| {
        let range = c * CHUNK..grids.min((c + 1) * CHUNK);
        for (j, piece) in list.into_iter().enumerate() {
            for (i, q) in basis.iter().enumerate() {
                add(piece, &q[range.clone()], -amounts[(i, j)]);
            }
        }
    });
}

fn add(to: &mut [[f64; 6]], v: &[[f64; 6]], c: f64) {
    for (o, v) in to.iter_mut().zip(v) {
        o.iter_mut().zip(v).for_each(|(o, v)| *o += c * v);
    }
}

fn combine(fields: &[Field], amount: impl Fn(usize) -> f64) -> Field {
    let mut out = vec![[0.0; 6]; fields.first().map_or(0, Vec::len)];
    for (r, field) in fields.iter().enumerate() {
        add(&mut out, field, amount(r));
    }
    out
}
