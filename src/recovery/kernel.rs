//! The arithmetic of a streamed record with the vector instructions that the processor has: `f = G y`, residual `y - S f`.

use super::plausible::LARGEST_STRAIN;
use super::sums::Sums;
use pulp::Simd;

/// Samples handled together: their readings lie beside each other by gauge, so that a coefficient is loaded once for all of them.
/// A multiple of [`UNROLL`] vectors for every width of vector, eight numbers included.
const LANES: usize = 32;
/// Vectors in registers for each of two rows.
const UNROLL: usize = 4;

/// Samples to recover loads from.
pub(super) struct Samples<'a> {
    /// `k x n`, by rows.
    pub gain: &'a [f64],
    /// `n x k`, by rows.
    pub s: &'a [f64],
    /// Subtracted, strain by gauge.
    pub zero: &'a [f64],
    /// Readings, `n` a sample.
    pub samples: &'a [f64],
    /// Strain of one unit of them.
    pub to_strain: f64,
    /// Loads are appended, `k` a sample; NaN where a reading is missing or too large to be strain.
    pub out: &'a mut Vec<f64>,
    /// Those samples are appended by number; the sums leave them out.
    pub gaps: &'a mut Vec<usize>,
    /// Sums to add to.
    pub sums: &'a mut Sums,
}

impl pulp::WithSimd for Samples<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let (n, k) = (self.zero.len(), self.sums.sum.len());
        if n == 0 || k == 0 {
            return;
        }
        let mut y = vec![0.0; n * LANES];
        let mut f = vec![0.0; k * LANES];
        let samples = self.samples;
        for (number, block) in samples.chunks(n * LANES).enumerate() {
            let count = block.len() / n;
            if count < LANES {
                y.fill(0.0);
            }
            for (lane, sample) in block.chunks_exact(n).enumerate() {
                for ((v, &raw), z) in y.chunks_exact_mut(LANES).zip(sample).zip(self.zero) {
                    let strain = raw * self.to_strain - z;
                    v[lane] = if strain.abs() <= LARGEST_STRAIN {
                        strain
                    } else {
                        f64::NAN
                    };
                }
            }
            product(simd, self.gain, &y, &mut f);
            for lane in 0..count {
                self.out.extend(f.chunks_exact(LANES).map(|f| f[lane]));
            }
            if count < LANES || !all_finite(simd, &f) {
                self.set_apart(number * LANES, count, &mut y, &mut f);
            } else {
                self.sums.samples += LANES as u64;
                self.extremes(simd, &f);
            }
            self.squares(simd, &y, &f);
        }
    }
}

impl Samples<'_> {
    /// Counts the samples of a block that is not whole: those with a gap, and lanes without a sample, are zero from here on.
    fn set_apart(&mut self, first: usize, count: usize, y: &mut [f64], f: &mut [f64]) {
        let k = self.sums.sum.len();
        for lane in 0..LANES {
            let whole = lane < count && f.chunks_exact(LANES).all(|f| f[lane].is_finite());
            if whole {
                self.sums.samples += 1;
                for (l, f) in f.chunks_exact(LANES).enumerate() {
                    self.sums.min[l] = self.sums.min[l].min(f[lane]);
                    self.sums.max[l] = self.sums.max[l].max(f[lane]);
                }
                continue;
            }
            for v in y.chunks_exact_mut(LANES).chain(f.chunks_exact_mut(LANES)) {
                v[lane] = 0.0;
            }
            if lane < count {
                self.gaps.push(first + lane);
                let at = self.out.len() - (count - lane) * k;
                self.out[at..at + k].fill(f64::NAN);
            }
        }
    }

    #[inline(always)]
    fn extremes<S: Simd>(&mut self, simd: S, f: &[f64]) {
        for (l, f) in f.chunks_exact(LANES).enumerate() {
            let (f, _) = S::as_simd_f64s(f);
            let (mut low, mut high) = (f[0], f[0]);
            for &v in &f[1..] {
                low = simd.min_f64s(low, v);
                high = simd.max_f64s(high, v);
            }
            self.sums.min[l] = self.sums.min[l].min(simd.reduce_min_f64s(low));
            self.sums.max[l] = self.sums.max[l].max(simd.reduce_max_f64s(high));
        }
    }

    /// Adds loads and their squares, squared readings and squared residuals.
    #[inline(always)]
    fn squares<S: Simd>(&mut self, simd: S, y: &[f64], f: &[f64]) {
        let (n, k) = (self.zero.len(), self.sums.sum.len());
        let zero = simd.splat_f64s(0.0);
        let per = LANES / S::F64_LANES;
        let (y, _) = S::as_simd_f64s(y);
        let (f, _) = S::as_simd_f64s(f);
        for (l, f) in f.chunks_exact(per).enumerate() {
            let (mut sum, mut squares) = (zero, zero);
            for &v in f {
                sum = simd.add_f64s(sum, v);
                squares = simd.mul_add_f64s(v, v, squares);
            }
            self.sums.sum[l] += simd.reduce_sum_f64s(sum);
            self.sums.sum_of_squares[l] += simd.reduce_sum_f64s(squares);
        }
        for g in (0..n).step_by(2) {
            let pair = [g, (g + 1).min(n - 1)];
            let mut reading = [zero; 2];
            let mut residual = [zero; 2];
            for v in (0..per).step_by(UNROLL) {
                let mut left = [[zero; UNROLL]; 2];
                for (p, left) in left.iter_mut().enumerate() {
                    let y = &y[pair[p] * per + v..][..UNROLL];
                    for (a, &b) in left.iter_mut().zip(y) {
                        *a = b;
                        reading[p] = simd.mul_add_f64s(b, b, reading[p]);
                    }
                }
                for l in 0..k {
                    let f = &f[l * per + v..][..UNROLL];
                    for (p, left) in left.iter_mut().enumerate() {
                        let c = simd.splat_f64s(-self.s[pair[p] * k + l]);
                        for (a, &b) in left.iter_mut().zip(f) {
                            *a = simd.mul_add_f64s(c, b, *a);
                        }
                    }
                }
                for (p, left) in left.iter().enumerate() {
                    for &a in left {
                        residual[p] = simd.mul_add_f64s(a, a, residual[p]);
                    }
                }
            }
            // An odd last gauge stands in both places and counts once.
            for p in 0..if pair[1] > g { 2 } else { 1 } {
                self.sums.reading[pair[p]] += simd.reduce_sum_f64s(reading[p]);
                self.sums.residual[pair[p]] += simd.reduce_sum_f64s(residual[p]);
            }
        }
    }
}

/// `f = G y` of a block: `gain` is `k x n` by rows, `y` has `n` and `f` gets `k` rows of lanes.
#[inline(always)]
fn product<S: Simd>(simd: S, gain: &[f64], y: &[f64], f: &mut [f64]) {
    let (n, k) = (y.len() / LANES, f.len() / LANES);
    let per = LANES / S::F64_LANES;
    let (y, _) = S::as_simd_f64s(y);
    let (f, _) = S::as_mut_simd_f64s(f);
    for l in (0..k).step_by(2) {
        let pair = [l, (l + 1).min(k - 1)];
        let rows = pair.map(|l| &gain[l * n..(l + 1) * n]);
        for v in (0..per).step_by(UNROLL) {
            let mut sums = [[simd.splat_f64s(0.0); UNROLL]; 2];
            for g in 0..n {
                let y = &y[g * per + v..][..UNROLL];
                for (row, sums) in rows.iter().zip(&mut sums) {
                    let c = simd.splat_f64s(row[g]);
                    for (a, &b) in sums.iter_mut().zip(y) {
                        *a = simd.mul_add_f64s(c, b, *a);
                    }
                }
            }
            for (l, sums) in pair.iter().zip(&sums) {
                f[l * per + v..][..UNROLL].copy_from_slice(sums);
            }
        }
    }
}

/// Whether every number is finite: zero times any other number is not zero.
#[inline(always)]
fn all_finite<S: Simd>(simd: S, f: &[f64]) -> bool {
    let zero = simd.splat_f64s(0.0);
    let mut sum = zero;
    for &v in S::as_simd_f64s(f).0 {
        sum = simd.mul_add_f64s(zero, v, sum);
    }
    simd.reduce_sum_f64s(sum) == 0.0
}
