//! Where gauges can go: rows, or strain tensors that represent every angle at a place.

use super::angle_variance::{self, Form, Trig};
use rayon::prelude::*;

/// Number of places that the scan computes together.
pub const LANES: usize = 8;

/// Angles a gauge may have at a place.
#[derive(Clone, Debug, PartialEq)]
pub enum Angles {
    /// A place is one fixed row.
    Fixed,
    /// These angles, radians from the element x axis; each is a separate candidate.
    Grid(Vec<f64>),
    /// Any angle; at most one gauge a place.
    Continuous,
}

/// Standard deviation of a reading: `sd^2 = noise^2 + extra + form + (angle_sd |d row / d angle|)^2 + (model_rel |row|)^2`, the row in strain
/// at the expected loads.
#[derive(Clone, Debug, PartialEq)]
pub struct Scatter {
    /// Noise, 1 sd, in the unit of the rows.
    pub noise: f64,
    /// Angle tolerance, 1 sd, radians; needs tensors.
    pub angle_sd: f64,
    /// Uncertainty of the contribution of each load to the reading, 1 sd, a fraction (model and gauge factor, squares added). It needs tensors.
    pub model_rel: f64,
    /// Separate variance of each place; empty if none.
    pub extra: Vec<f64>,
    /// Variance of each place that depends on the gauge's direction: a quadratic form of the direction (position tolerance, gradient over the
    /// grid). It needs tensors; empty if none.
    pub forms: Vec<Form>,
}

impl Scatter {
    /// Returns equal noise at all places, as the only error.
    pub fn with_uniform_noise(noise: f64) -> Self {
        Self {
            noise,
            angle_sd: 0.0,
            model_rel: 0.0,
            extra: Vec::new(),
            forms: Vec::new(),
        }
    }
}

/// A gauge among the candidates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Index of the place.
    pub place: u32,
    /// Index into the angle grid, 0 otherwise.
    pub step: u16,
    /// Angle, radians from the element x axis; 0 for fixed rows.
    pub angle: f64,
}

/// All candidates of a problem with `k` loads.
#[derive(Clone, Debug)]
pub struct Candidates {
    k: usize,
    n: usize,
    angles: Angles,
    /// By block of [`LANES`] places, load, component (1 for rows; exx, eyy, gxy for tensors), lane. Columns are times `expected`.
    blocks: Vec<f64>,
    scatter: Scatter,
    /// The Gram form of the loads, by place; empty where the variance does not depend on the angle.
    slopes: Vec<Form>,
    /// Basic-frame positions, for spacing; empty: none known.
    positions: Vec<[f64; 3]>,
}

impl Candidates {
    /// Creates candidates with fixed rows. `fill(place, row)` writes the row of a place (strain per unit of each column).
    pub fn from_rows(
        k: usize,
        n: usize,
        scatter: Scatter,
        fill: impl Fn(usize, &mut [f64]) + Sync,
    ) -> Self {
        let blocks = fill_blocks(n, k, &fill);
        Self {
            k,
            n,
            angles: Angles::Fixed,
            blocks,
            scatter,
            slopes: Vec::new(),
            positions: Vec::new(),
        }
    }

    /// Creates candidates from tensors. `fill(place, t)` writes `t[3 load + component]` for each load times its expected size. The components are
    /// exx, eyy, gxy (engineering shear) in the element frame.
    pub fn from_tensors(
        k: usize,
        n: usize,
        angles: Angles,
        scatter: Scatter,
        fill: impl Fn(usize, &mut [f64]) + Sync,
    ) -> Self {
        let blocks = fill_blocks(n, 3 * k, &fill);
        let mut c = Self {
            k,
            n,
            angles,
            blocks,
            scatter,
            slopes: Vec::new(),
            positions: Vec::new(),
        };
        if c.scatter.angle_sd > 0.0 || c.scatter.model_rel > 0.0 {
            c.slopes = (0..n)
                .into_par_iter()
                .map(|p| {
                    let mut g = [0.0; 6];
                    for l in 0..k {
                        let [x, y, s] = c.tensor(p, l);
                        for (v, a) in g.iter_mut().zip([x * x, y * y, s * s, x * y, x * s, y * s]) {
                            *v += a;
                        }
                    }
                    g
                })
                .collect();
        }
        c
    }

    /// Returns these candidates with a position for each place.
    pub fn with_positions(mut self, positions: Vec<[f64; 3]>) -> Self {
        self.positions = positions;
        self
    }

    /// Returns the number of columns.
    pub fn n_loads(&self) -> usize {
        self.k
    }

    /// Returns the number of places.
    pub fn n_places(&self) -> usize {
        self.n
    }

    /// Returns the number of rows: places times angles, or places if the angle is continuous.
    pub fn n_rows(&self) -> usize {
        match &self.angles {
            Angles::Grid(a) => self.n * a.len(),
            _ => self.n,
        }
    }

    /// Returns the angles at a place.
    pub fn angles(&self) -> &Angles {
        &self.angles
    }

    /// Returns the positions of the places, if known.
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// Returns the components a load has in the blocks: 1 for rows, 3 for tensors.
    pub fn components(&self) -> usize {
        if self.angles == Angles::Fixed { 1 } else { 3 }
    }

    /// Returns the blocks of [`LANES`] places, each `n_loads x components x LANES`.
    pub fn blocks(&self) -> &[f64] {
        &self.blocks
    }

    fn tensor(&self, place: usize, load: usize) -> [f64; 3] {
        let (b, lane) = (place / LANES, place % LANES);
        let at = (b * self.k + load) * 3 * LANES + lane;
        std::array::from_fn(|c| self.blocks[at + c * LANES])
    }

    /// Returns the variance of a reading at a place as a function of the angle.
    pub fn variance(&self, place: usize) -> Trig {
        let mut v = [0.0; 5];
        if let Some(form) = self.slopes.get(place) {
            let (turn, model) = (
                self.scatter.angle_sd.powi(2),
                self.scatter.model_rel.powi(2),
            );
            let (slope, row) = (angle_variance::of_slope(form), angle_variance::of_row(form));
            v = std::array::from_fn(|i| turn * slope[i] + model * row[i]);
        }
        if let Some(form) = self.scatter.forms.get(place) {
            let more = angle_variance::of_row(form);
            v.iter_mut().zip(more).for_each(|(a, b)| *a += b);
        }
        v[0] += self.fixed_variance(place);
        v
    }

    /// Returns these candidates with noise as the only error.
    pub fn with_noise_only(mut self) -> Self {
        self.scatter = Scatter::with_uniform_noise(self.scatter.noise);
        self.slopes = Vec::new();
        self
    }

    /// Returns the part of the variance that does not depend on the angle.
    pub fn fixed_variance(&self, place: usize) -> f64 {
        self.scatter.noise * self.scatter.noise
            + self.scatter.extra.get(place).copied().unwrap_or(0.0)
    }

    /// Returns whether the variance depends on the angle.
    pub fn has_slopes(&self) -> bool {
        !self.slopes.is_empty() || !self.scatter.forms.is_empty()
    }

    /// Returns the standard deviation of a gauge's reading.
    pub fn sd(&self, choice: Choice) -> f64 {
        angle_variance::value(
            &self.variance(choice.place as usize),
            &angle_variance::phases(choice.angle),
        )
        .sqrt()
    }

    /// Returns the change of a gauge's reading with its angle: rms over the expected loads (independent), per radian. It is 0 for fixed rows.
    pub fn turn_rms(&self, choice: Choice) -> f64 {
        if self.angles == Angles::Fixed {
            return 0.0;
        }
        let (s, c) = (2.0 * choice.angle).sin_cos();
        (0..self.k)
            .map(|l| {
                let [x, y, g] = self.tensor(choice.place as usize, l);
                (c * g - s * (x - y)).powi(2)
            })
            .sum::<f64>()
            .sqrt()
    }

    /// Returns the row of a gauge divided by the standard deviation of its reading.
    pub fn row(&self, choice: Choice) -> Vec<f64> {
        let p = choice.place as usize;
        if self.angles == Angles::Fixed {
            let w = 1.0 / self.fixed_variance(p).sqrt();
            let (b, lane) = (p / LANES, p % LANES);
            return (0..self.k)
                .map(|l| w * self.blocks[(b * self.k + l) * LANES + lane])
                .collect();
        }
        let w = 1.0
            / angle_variance::value(&self.variance(p), &angle_variance::phases(choice.angle))
                .sqrt();
        let (s, c) = choice.angle.sin_cos();
        (0..self.k)
            .map(|l| {
                let [x, y, g] = self.tensor(p, l);
                w * (c * c * x + s * s * y + s * c * g)
            })
            .collect()
    }

    /// Returns a smaller problem: these places only (indices ascending), positions and scatter kept.
    pub fn subset(&self, places: &[u32]) -> Self {
        let kc = self.k * self.components();
        let blocks = fill_blocks(places.len(), kc, &|i: usize, out: &mut [f64]| {
            let p = places[i] as usize;
            let (b, lane) = (p / LANES, p % LANES);
            for (j, v) in out.iter_mut().enumerate() {
                *v = self.blocks[(b * kc + j) * LANES + lane];
            }
        });
        let pick = |v: &[f64]| -> Vec<f64> {
            places
                .iter()
                .filter_map(|&p| v.get(p as usize).copied())
                .collect()
        };
        Self {
            k: self.k,
            n: places.len(),
            angles: self.angles.clone(),
            blocks,
            scatter: Scatter {
                extra: pick(&self.scatter.extra),
                forms: places
                    .iter()
                    .filter_map(|&p| self.scatter.forms.get(p as usize).copied())
                    .collect(),
                noise: self.scatter.noise,
                angle_sd: self.scatter.angle_sd,
                model_rel: self.scatter.model_rel,
            },
            slopes: places
                .iter()
                .filter_map(|&p| self.slopes.get(p as usize).copied())
                .collect(),
            positions: places
                .iter()
                .filter_map(|&p| self.positions.get(p as usize).copied())
                .collect(),
        }
    }
}

fn fill_blocks(n: usize, width: usize, fill: &(impl Fn(usize, &mut [f64]) + Sync)) -> Vec<f64> {
    let mut blocks = vec![0.0; n.div_ceil(LANES) * width * LANES];
    blocks
        .par_chunks_mut((width * LANES).max(1))
        .enumerate()
        .for_each_init(
            || vec![0.0; width],
            |row, (b, block)| {
                for lane in 0..LANES.min(n - b * LANES) {
                    row.fill(0.0);
                    fill(b * LANES + lane, row);
                    for (j, &v) in row.iter().enumerate() {
                        block[j * LANES + lane] = v;
                    }
                }
            },
        );
    blocks
}
