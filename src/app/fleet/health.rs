//! What the readings of a day say of each gauge.

use super::day::GaugeDay;
use crate::units::MICROSTRAIN;

/// Every how many samples the residual is looked at: enough of a day for a gain to a thousandth, few enough to cost little.
const THINNED: usize = 16;

/// Gauges whose sums stand in registers at a time: two vectors of four, a line of the cache.
const TOGETHER: usize = 8;

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
    /// Nothing yet, for S by rows.
    pub fn new(s: &[Vec<f64>]) -> Self {
        let k = s.first().map_or(0, Vec::len);
        let column = |l: usize| s.iter().filter_map(move |row| row.get(l).copied());
        Self {
            sums: vec![Sums::default(); s.len()],
            s: (0..k).flat_map(column).collect(),
        }
    }

    /// Adds samples: strain less zero (`n_gauges` a row) and the loads recovered from it (`n_loads` a row).
    pub fn add(&mut self, strain: &[f64], loads: &[f64]) {
        pulp::Arch::new().dispatch(Add {
            to: self,
            strain,
            loads,
        });
    }

    #[inline(always)]
    fn add_rows(&mut self, strain: &[f64], loads: &[f64]) {
        let n = self.sums.len().max(1);
        // Squares of larger ones would not be finite; they are no strain.
        const LARGE: f64 = 1e100;
        if strain.iter().fold(true, |all, y| all & (y.abs() < LARGE)) {
            let mut first = 0;
            for sums in self.sums.chunks_mut(TOGETHER) {
                match <&mut [Sums; TOGETHER]>::try_from(&mut *sums) {
                    Ok(all) => added(all, strain, n, first),
                    Err(_) => {
                        for (own, g) in sums.iter_mut().zip(first..) {
                            added(std::array::from_mut(own), strain, n, g);
                        }
                    }
                }
                first += sums.len();
            }
        } else {
            for (g, sums) in self.sums.iter_mut().enumerate() {
                sums.add(strain.iter().skip(g).step_by(n));
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

    /// What is kept, `leverage` by gauge.
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
    fn with_simd<S: pulp::Simd>(self, _: S) {
        self.to.add_rows(self.strain, self.loads);
    }
}

/// Adds the readings of `W` gauges from number `first` on, of `n` in a row, all of them known.
#[inline(always)]
fn added<const W: usize>(sums: &mut [Sums; W], strain: &[f64], n: usize, first: usize) {
    let [mut sum, mut squares, mut seconds] = [[0.0; W]; 3];
    for (i, s) in sums.iter().enumerate() {
        (sum[i], squares[i], seconds[i]) = (s.sum, s.squares, s.seconds);
    }
    let [mut a, mut b] = [[0.0; W]; 2];
    let mut samples = 0;
    for row in strain.chunks_exact(n) {
        let Some(y) = row.get(first..).and_then(|r| r.first_chunk::<W>()) else {
            continue;
        };
        for i in 0..W {
            sum[i] += y[i];
            squares[i] += y[i] * y[i];
        }
        if samples > 1 {
            for i in 0..W {
                let second = b[i] - 2.0 * a[i] + y[i];
                seconds[i] += second * second;
            }
        }
        samples += 1;
        (b, a) = (a, *y);
    }
    for (i, s) in sums.iter_mut().enumerate() {
        (s.sum, s.squares, s.seconds) = (sum[i], squares[i], seconds[i]);
        s.n += samples;
        s.n_seconds += samples.saturating_sub(2);
    }
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

    fn day(&self, name: &str, leverage: f64) -> GaugeDay {
        let n = self.n as f64;
        let mean = self.sum / n;
        let variance = (self.squares / n - mean * mean).max(0.0);
        let [m, y, r, yy, yr, rr] = self.thinned;
        let (yy, yr, rr0) = (yy - y * y / m, yr - y * r / m, rr - r * r / m);
        // Without this gauge its residual is larger by 1 / (1 - h), and its prediction what is left.
        let out = 1.0 / (1.0 - leverage).max(1e-3);
        let (with, own) = (yy - out * yr, yy - 2.0 * out * yr + out * out * rr0);
        GaugeDay {
            name: name.to_owned(),
            mean: mean / MICROSTRAIN,
            sd: variance.sqrt() / MICROSTRAIN,
            noise: (self.seconds / self.n_seconds as f64 / 6.0).sqrt() / MICROSTRAIN,
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
        // Eleven gauges: eight together and three apart. Gauge g reads g, plus g + 1 up and down in turn.
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
                // Second differences of a swing of one up and down are four.
                close(day.noise, 4.0 * (g + 1) as f64 / 6.0_f64.sqrt());
            }
        }
    }
}
