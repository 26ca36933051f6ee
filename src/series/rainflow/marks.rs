//! Marks that identify a sample by its loads, wherever a record is cut.

use super::counter::mix_bits;

/// Parts of a load's noise that distinguish samples. Rounding of loads moves no sample into another part. Samples whose loads differ by
/// noise are in different parts.
const FINE: f64 = 1024.0;

/// Function that computes a number for each sample from its loads. The number is the seed of the noise that is added to the sample.
pub struct Marks {
    per_noise: Vec<f64>,
    /// An odd factor for each load.
    keys: Vec<u64>,
}

/// Rows whose marks are wanted.
struct MarkKernel<'a> {
    marks: &'a Marks,
    rows: &'a [f64],
    out: &'a mut Vec<u64>,
}

impl Marks {
    /// Returns the marks for loads with noise of these standard deviations. A load without noise has no effect on the marks.
    pub fn new(noise: &[f64]) -> Self {
        let per_noise = noise.iter().map(|n| if *n > 0.0 { FINE / n } else { 0.0 });
        Self {
            per_noise: per_noise.collect(),
            keys: (0..noise.len() as u64).map(|l| mix_bits(!l) | 1).collect(),
        }
    }

    /// Appends the marks of rows; each row is all loads of a sample.
    pub fn append_marks(&self, rows: &[f64], out: &mut Vec<u64>) {
        pulp::Arch::new().dispatch(MarkKernel {
            marks: self,
            rows,
            out,
        });
    }
}

impl pulp::WithSimd for MarkKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        /// Added, it leaves whole numbers in the last digits.
        const WHOLE: f64 = 6_755_399_441_055_744.0;
        let Marks { per_noise, keys } = self.marks;
        let rows = self.rows.chunks_exact(keys.len().max(1));
        self.out.extend(rows.map(|row| {
            let loads = row.iter().zip(per_noise).zip(keys);
            let part = |((v, per_noise), key): ((&f64, &f64), &u64)| {
                let bits = (v * per_noise + WHOLE).to_bits().wrapping_mul(*key);
                if v.is_finite() { bits } else { 0 }
            };
            loads.map(part).fold(0, u64::wrapping_add)
        }));
    }
}
