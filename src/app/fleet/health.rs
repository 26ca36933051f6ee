//! What the readings of a day say of each gauge.

use super::day::GaugeDay;

/// Every how many samples the residual is looked at: enough of a day for a gain to a thousandth, few enough to cost little.
const THINNED: usize = 16;
/// Strain in a microstrain.
const MICRO: f64 = 1e-6;

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
    /// `n_gauges x n_loads`, strain per load as `loads` of [`Health::add`] count it.
    s: Vec<Vec<f64>>,
}

impl Health {
    /// Nothing yet, for S by rows.
    pub fn new(s: Vec<Vec<f64>>) -> Self {
        Self {
            sums: vec![Sums::default(); s.len()],
            s,
        }
    }

    /// Adds samples: strain less zero (`n_gauges` a row) and the loads recovered from it (`n_loads` a row).
    pub fn add(&mut self, strain: &[f64], loads: &[f64]) {
        let n = self.s.len().max(1);
        let k = self.s.first().map_or(1, Vec::len).max(1);
        for (g, sums) in self.sums.iter_mut().enumerate() {
            let mut before = [f64::NAN; 2];
            for y in strain.iter().skip(g).step_by(n) {
                if y.is_finite() {
                    sums.n += 1;
                    sums.sum += y;
                    sums.squares += y * y;
                } else {
                    sums.missing += 1;
                }
                let [b, a] = before;
                let second = b - 2.0 * a + y;
                if second.is_finite() {
                    sums.seconds += second * second;
                    sums.n_seconds += 1;
                }
                before = [a, *y];
            }
        }
        let rows = strain.chunks_exact(n).zip(loads.chunks_exact(k));
        for (row, f) in rows.step_by(THINNED) {
            if !f.iter().all(|v| v.is_finite()) {
                continue;
            }
            for ((y, s), sums) in row.iter().zip(&self.s).zip(&mut self.sums) {
                let r = y - s.iter().zip(f).map(|(s, f)| s * f).sum::<f64>();
                if r.is_finite() {
                    for (sum, v) in sums
                        .thinned
                        .iter_mut()
                        .zip([1.0, *y, r, y * y, y * r, r * r])
                    {
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

impl Sums {
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
            mean: mean / MICRO,
            sd: variance.sqrt() / MICRO,
            noise: (self.seconds / self.n_seconds as f64 / 6.0).sqrt() / MICRO,
            residual: (rr / m).sqrt() / MICRO,
            gain: with / own,
            missing: self.missing,
        }
    }
}
