//! The arithmetic of a streamed record with the vector instructions that the processor has: `f = G y`, residual `y - S f`.

use super::reading_plausibility::LARGEST_STRAIN;
use super::sums::Sums;
use pulp::Simd;

/// Samples processed together. Their readings are contiguous by gauge, so that a coefficient is loaded once for all of them.
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
    /// Zero reading to subtract, strain by gauge.
    pub zero: &'a [f64],
    /// Readings, `n` for each sample.
    pub samples: &'a [f64],
    /// Factor from readings to strain.
    pub to_strain: f64,
    /// Buffer to which loads are appended, `k` for each sample. NaN if a reading is missing or too large to be strain.
    pub out: &'a mut Vec<f64>,
    /// Buffer to which the numbers of samples with NaN are appended. The sums exclude these samples.
    pub gaps: &'a mut Vec<usize>,
    /// Sums to add to, if wanted.
    pub sums: Option<&'a mut Sums>,
}

impl pulp::WithSimd for Samples<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let n = self.zero.len();
        let k = self.gain.len() / n.max(1);
        if k == 0 {
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
            self.by_gauge(block, &mut y);
            product(simd, self.gain, &y, &mut f);
            for lane in 0..count {
                self.out.extend(f.chunks_exact(LANES).map(|f| f[lane]));
            }
            if count < LANES || !all_finite(simd, &f) {
                self.set_apart(number * LANES, count, &mut y, &mut f);
            } else if let Some(sums) = &mut self.sums {
                extremes(sums, simd, &f);
            }
            if let Some(sums) = &mut self.sums {
                squares(sums, self.s, simd, &y, &f);
            }
        }
    }
}

impl Samples<'_> {
    /// Converts the readings of a block to strain minus zero, contiguous by gauge; NaN for a value that is too large to be strain.
    #[inline(always)]
    fn by_gauge(&self, block: &[f64], y: &mut [f64]) {
        /// Samples taken together.
        const FOUR: usize = 4;
        let n = self.zero.len();
        let strain = |raw: f64, z: f64| {
            let strain = raw * self.to_strain - z;
            if strain.abs() <= LARGEST_STRAIN {
                strain
            } else {
                f64::NAN
            }
        };
        for (at, samples) in (0..).step_by(FOUR).zip(block.chunks(FOUR * n)) {
            let mut rows = samples.chunks_exact(n);
            let places = y.chunks_exact_mut(LANES).zip(self.zero);
            if let [Some(a), Some(b), Some(c), Some(d)] = [(); FOUR].map(|()| rows.next()) {
                let rows = a.iter().zip(b).zip(c).zip(d);
                for ((v, z), (((a, b), c), d)) in places.zip(rows) {
                    let four = [a, b, c, d].map(|raw| strain(*raw, *z));
                    if let Some(v) = v.get_mut(at..at + FOUR) {
                        v.copy_from_slice(&four);
                    }
                }
            } else {
                for (g, (v, z)) in places.enumerate() {
                    let raw = samples.iter().skip(g).step_by(n);
                    for (v, raw) in v.iter_mut().skip(at).zip(raw) {
                        *v = strain(*raw, *z);
                    }
                }
            }
        }
    }

    /// Counts the samples of a block that is not whole: those with a gap, and lanes without a sample, are zero from here on.
    fn set_apart(&mut self, first: usize, count: usize, y: &mut [f64], f: &mut [f64]) {
        let k = f.len() / LANES;
        for lane in 0..LANES {
            let whole = lane < count && f.chunks_exact(LANES).all(|f| f[lane].is_finite());
            if whole {
                let Some(sums) = &mut self.sums else { continue };
                for (l, f) in f.chunks_exact(LANES).enumerate() {
                    sums.min[l] = sums.min[l].min(f[lane]);
                    sums.max[l] = sums.max[l].max(f[lane]);
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
}

/// Widens the extremes by the loads of a block.
#[inline(always)]
fn extremes<S: Simd>(all: &mut Sums, simd: S, f: &[f64]) {
    for (l, f) in f.chunks_exact(LANES).enumerate() {
        let (f, _) = S::as_simd_f64s(f);
        let (mut low, mut high) = (f[0], f[0]);
        for &v in &f[1..] {
            low = simd.min_f64s(low, v);
            high = simd.max_f64s(high, v);
        }
        all.min[l] = all.min[l].min(simd.reduce_min_f64s(low));
        all.max[l] = all.max[l].max(simd.reduce_max_f64s(high));
    }
}

/// Adds loads and their squares, squared readings and squared residuals.
#[inline(always)]
fn squares<S: Simd>(all: &mut Sums, s: &[f64], simd: S, y: &[f64], f: &[f64]) {
    let (n, k) = (y.len() / LANES, f.len() / LANES);
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
        all.sum[l] += simd.reduce_sum_f64s(sum);
        all.sum_of_squares[l] += simd.reduce_sum_f64s(squares);
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
                    let c = simd.splat_f64s(-s[pair[p] * k + l]);
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
        // An odd last gauge is in both places of the pair and counts once.
        for p in 0..if pair[1] > g { 2 } else { 1 } {
            all.reading[pair[p]] += simd.reduce_sum_f64s(reading[p]);
            all.residual[pair[p]] += simd.reduce_sum_f64s(residual[p]);
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

/// Returns whether every number is finite: zero times any other number is not zero.
#[inline(always)]
fn all_finite<S: Simd>(simd: S, f: &[f64]) -> bool {
    let zero = simd.splat_f64s(0.0);
    let mut sum = zero;
    for &v in S::as_simd_f64s(f).0 {
        sum = simd.mul_add_f64s(zero, v, sum);
    }
    simd.reduce_sum_f64s(sum) == 0.0
}
