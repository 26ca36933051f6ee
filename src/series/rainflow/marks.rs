//! What tells one sample from another wherever a record is cut: its loads.

use super::counter::mixed;

/// Parts of the noise of a load in which samples are told apart: what rounding makes of loads moves none into another part, and samples that noise
/// itself tells apart stand in parts of their own.
const FINE: f64 = 1024.0;

/// A number for each sample by its loads, by which the noise that is added to it is drawn.
pub struct Marks {
    per_noise: Vec<f64>,
    /// An odd factor for each load.
    keys: Vec<u64>,
}

/// Rows whose marks are wanted.
struct Put<'a> {
    marks: &'a Marks,
    rows: &'a [f64],
    out: &'a mut Vec<u64>,
}

impl Marks {
    /// Of samples whose loads carry noise of these standard deviations; a load without noise tells none apart.
    pub fn new(noise: &[f64]) -> Self {
        let per_noise = noise.iter().map(|n| if *n > 0.0 { FINE / n } else { 0.0 });
        Self {
            per_noise: per_noise.collect(),
            keys: (0..noise.len() as u64).map(|l| mixed(!l) | 1).collect(),
        }
    }

    /// Appends the marks of rows, all loads of a sample each.
    pub fn put(&self, rows: &[f64], out: &mut Vec<u64>) {
        pulp::Arch::new().dispatch(Put {
            marks: self,
            rows,
            out,
        });
    }
}

impl pulp::WithSimd for Put<'_> {
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
