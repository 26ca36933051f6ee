//! State of each gauge from its readings of a day.

use super::day::GaugeDay;
use crate::units::MICROSTRAIN;

/// Every how many samples the residual is looked at: enough of a day for a gain to a thousandth, few enough to cost little.
const THINNED: usize = 16;

/// Vectors of gauges whose sums are in registers at a time.
const TOGETHER: usize = 2;
/// Most gauges of so many vectors.
const WIDEST: usize = 8 * TOGETHER;

/// Sums over the readings of one gauge, strain.
#[derive(Clone, Debug, Default)]
struct Sums {
    n: u64,
    missing: u64,
    sum: f64,
    squares: f64,
    /// Second differences, `y0 - 2 y1 + y2`: for white noise six times its variance.
    seconds: f64,
    n_seconds: u64,
    /// Readings, residuals, and their products, thinned.
    thinned: [f64; 6],
}

/// Sums over the readings of all gauges.
#[derive(Clone, Debug)]
pub struct Health {
    sums: Vec<Sums>,
    /// `n_gauges x n_loads`, strain per load as `loads` of [`Health::add`] count it; by columns.
    s: Vec<f64>,
}

impl Health {
    /// Creates empty sums for S by rows.
    pub fn new(s: &[Vec<f64>]) -> Self {
        let k = s.first().map_or(0, Vec::len);
        let column = |l: usize| s.iter().filter_map(move |row| row.get(l).copied());
        Self {
            sums: vec![Sums::default(); s.len()],
            s: (0..k).flat_map(column).collect(),
        }
    }

    /// Adds samples: strain minus zero (`n_gauges` for each row), and the loads recovered from it (`n_loads` for each row).
    pub fn add(&mut self, strain: &[f64], loads: &[f64]) {
        pulp::Arch::new().dispatch(Add {
            to: self,
            strain,
            loads,
        });
    }

    #[inline(always)]
    fn add_rows<S: pulp::Simd>(&mut self, simd: S, strain: &[f64], loads: &[f64]) {
        let n = self.sums.len().max(1);
        let together = TOGETHER * S::F64_LANES;
        for (sums, first) in self.sums.chunks_mut(together).zip((0..).step_by(together)) {
            // The last block starts earlier, so that the remaining gauges fill whole vectors.
            let begin = n.checked_sub(together).map(|last| first.min(last));
            let all = begin.and_then(|begin| Some((begin, sum_readings(simd, strain, n, begin)?)));
            let Some((begin, [sum, squares, seconds])) = all else {
                for (own, g) in sums.iter_mut().zip(first..) {
                    own.add(strain.iter().skip(g).step_by(n));
                }
                continue;
            };
            let samples = strain.len() / n;
            let lanes = sum.iter().zip(&squares).zip(&seconds);
            for (own, ((sum, squares), seconds)) in sums.iter_mut().zip(lanes.skip(first - begin)) {
                own.sum += sum;
                own.squares += squares;
                own.seconds += seconds;
                own.n += samples as u64;
                own.n_seconds += samples.saturating_sub(2) as u64;
            }
        }
        let k = (self.s.len() / n).max(1);
        let mut residual = vec![0.0; n];
        let rows = strain.chunks_exact(n).zip(loads.chunks_exact(k));
        for (row, f) in rows.step_by(THINNED) {
            if !f.iter().all(|v| v.is_finite()) {
                continue;
            }
            residual.fill(0.0);
            for (s, f) in self.s.chunks_exact(n).zip(f) {
                for (r, s) in residual.iter_mut().zip(s) {
                    *r += s * f;
                }
            }
            for ((y, r), sums) in row.iter().zip(&residual).zip(&mut self.sums) {
                let r = y - r;
                if r.is_finite() {
                    let more = [1.0, *y, r, y * y, y * r, r * r];
                    for (sum, v) in sums.thinned.iter_mut().zip(more) {
                        *sum += v;
                    }
                }
            }
        }
    }

    /// Adds what another part of the record gave.
    pub fn merge(&mut self, other: &Self) {
        for (a, b) in self.sums.iter_mut().zip(&other.sums) {
            a.n += b.n;
            a.missing += b.missing;
            a.sum += b.sum;
            a.squares += b.squares;
            a.seconds += b.seconds;
            a.n_seconds += b.n_seconds;
            for (x, y) in a.thinned.iter_mut().zip(b.thinned) {
                *x += y;
            }
        }
    }

    /// Returns the noise of each gauge from second differences, microstrain.
    pub fn noise(&self) -> Vec<f64> {
        self.sums.iter().map(Sums::noise).collect()
    }

    /// Returns the result of each gauge for storing. `leverage` is by gauge.
    pub fn days(&self, names: &[String], leverage: &[f64]) -> Vec<GaugeDay> {
        let gauges = names.iter().zip(&self.sums).zip(leverage);
        gauges.map(|((name, s), h)| s.day(name, *h)).collect()
    }
}

/// Samples on their way into the sums.
struct Add<'a> {
    to: &'a mut Health,
    strain: &'a [f64],
    loads: &'a [f64],
}

impl pulp::WithSimd for Add<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, simd: S) {
        self.to.add_rows(simd, self.strain, self.loads);
    }
}

/// Returns sums, sums of squares and sums of squared second differences of gauges in rows of `n`. The gauges start at number `first` and fill the
/// vectors. Returns `None` if a reading is missing or too large for strain.
#[inline(always)]
fn sum_readings<S: pulp::Simd>(
    simd: S,
    strain: &[f64],
    n: usize,
    first: usize,
) -> Option<[[f64; WIDEST]; 3]> {
    /// Squares of larger readings would not be finite.
    const LARGE: f64 = 1e200;
    let vectors = |row: &[f64]| -> Option<[S::f64s; TOGETHER]> {
        let own = row.get(first..first + TOGETHER * S::F64_LANES)?;
        S::as_simd_f64s(own).0.first_chunk().copied()
    };
    let zero = [simd.splat_f64s(0.0); TOGETHER];
    let (mut sum, mut squares, mut seconds) = (zero, zero, zero);
    // The previous reading, and its increase over the reading before it.
    let (mut before, mut rise) = (zero, zero);
    for (i, row) in strain.chunks_exact(n).enumerate() {
        let y = vectors(row)?;
        for v in 0..TOGETHER {
            sum[v] = simd.add_f64s(sum[v], y[v]);
            squares[v] = simd.mul_add_f64s(y[v], y[v], squares[v]);
            let more = simd.sub_f64s(y[v], before[v]);
            if i > 1 {
                let second = simd.sub_f64s(more, rise[v]);
                seconds[v] = simd.mul_add_f64s(second, second, seconds[v]);
            }
            (before[v], rise[v]) = (y[v], more);
        }
    }
    let mut out = [[0.0; WIDEST]; 3];
    for (out, sums) in out.iter_mut().zip([sum, squares, seconds]) {
        let slots = S::as_mut_simd_f64s(out).0.iter_mut();
        slots.zip(sums).for_each(|(slot, v)| *slot = v);
    }
    let known = out[1].iter().all(|q| *q < LARGE);
    known.then_some(out)
}

impl Sums {
    /// Adds readings, some of them missing.
    fn add<'a>(&mut self, readings: impl Iterator<Item = &'a f64>) {
        let mut before = [f64::NAN; 2];
        for y in readings {
            if y.is_finite() {
                self.n += 1;
                self.sum += y;
                self.squares += y * y;
            } else {
                self.missing += 1;
            }
            let [b, a] = before;
            let second = b - 2.0 * a + y;
            if second.is_finite() {
                self.seconds += second * second;
                self.n_seconds += 1;
            }
            before = [a, *y];
        }
    }

    /// Returns the noise from second differences, microstrain.
    fn noise(&self) -> f64 {
        (self.seconds / self.n_seconds as f64 / 6.0).sqrt() / MICROSTRAIN
    }

    fn day(&self, name: &str, leverage: f64) -> GaugeDay {
        let n = self.n as f64;
        let mean = self.sum / n;
        let variance = (self.squares / n - mean * mean).max(0.0);
        let [m, y, r, yy, yr, rr] = self.thinned;
        let (yy, yr, rr0) = (yy - y * y / m, yr - y * r / m, rr - r * r / m);
        // If the fit leaves this gauge out, its residual is larger by the factor 1 / (1 - h), with leverage h. The prediction is the reading minus
        // this residual.
        let out = 1.0 / (1.0 - leverage).max(1e-3);
        let (with, own) = (yy - out * yr, yy - 2.0 * out * yr + out * out * rr0);
        GaugeDay {
            name: name.to_owned(),
            mean: mean / MICROSTRAIN,
            sd: variance.sqrt() / MICROSTRAIN,
            noise: self.noise(),
            residual: (rr / m).sqrt() / MICROSTRAIN,
            gain: with / own,
            offset: out * r / m / MICROSTRAIN,
            leverage,
            missing: self.missing,
            dead: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_scatter_noise_and_missing_readings_are_those_of_each_gauge() {
        // Eleven gauges: eight in vectors and three separate. Gauge g reads g plus and minus (g + 1), alternately.
        let (n, rows) = (11, 96);
        let swing =
            |g: usize, i: usize| (g + 1) as f64 * if i.is_multiple_of(2) { 1.0 } else { -1.0 };
        let block: Vec<f64> = (0..rows)
            .flat_map(|i| (0..n).map(move |g| MICROSTRAIN * (g as f64 + swing(g, i))))
            .collect();
        let loads = vec![0.0; rows];
        let s = vec![vec![1.0]; n];
        let names: Vec<String> = (0..n).map(|g| g.to_string()).collect();
        for gap in [None, Some(3)] {
            let mut health = Health::new(&s);
            let mut strain = block.clone();
            if let Some(g) = gap {
                strain[g] = f64::NAN;
                strain[n + g] = f64::INFINITY;
            }
            health.add(&strain, &loads);
            health.add(&block, &loads);
            for (g, day) in health.days(&names, &vec![0.1; n]).iter().enumerate() {
                let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-9 * (1.0 + b), "{a} {b}");
                assert_eq!(day.missing, if gap == Some(g) { 2 } else { 0 });
                close(day.mean, g as f64);
                close(day.sd, (g + 1) as f64);
                // The second differences of an alternating reading of +1 and -1 are 4 in size.
                close(day.noise, 4.0 * (g + 1) as f64 / 6.0_f64.sqrt());
            }
        }
    }
}
