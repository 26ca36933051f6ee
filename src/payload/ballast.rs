//! Lumped masses with which the reactions of a model agree with the measured reactions. They are found by bounded least squares, with the range of
//! every mass that the data permit.

use crate::linalg::{Matrix, Vector};

/// Task of the search for ballast masses.
#[derive(Clone, Debug, PartialEq)]
pub struct BallastSpec {
    /// Number of masses.
    pub masses: usize,
    /// Region of the masses in plan: lower and upper bound along the axis, lower and upper bound across.
    pub region: [[f64; 2]; 2],
    /// Largest weight of one mass.
    pub largest: f64,
    /// Standard deviation of each measured reaction.
    pub sigma: Vec<f64>,
}

/// A mass, with the range that the data permit if the other masses are adjusted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BallastMass {
    /// Weight.
    pub weight: f64,
    /// 95 % interval of the weight.
    pub weight_range: [f64; 2],
    /// Place in plan.
    pub at: [f64; 2],
    /// 95 % intervals of the place.
    pub at_range: [[f64; 2]; 2],
}

/// Result of the search for masses.
#[derive(Clone, Debug, PartialEq)]
pub struct BallastFit {
    /// Masses, front first.
    pub masses: Vec<BallastMass>,
    /// Reactions with these masses, from the table of unit reactions.
    pub reactions: Vec<f64>,
    /// Sum of squares of the misfit, divided by the variances.
    pub chi2: f64,
    /// Number of combinations of the `3 n` unknowns that the data determine.
    pub fixed: usize,
}

/// Points of the table of unit reactions, along and across.
const TABLE: [usize; 2] = [41, 9];
/// Pull of every number towards its start, in sigma per range: decides among equals only.
const TIE: f64 = 1e-3;
/// Number of starts of the search in addition to the even start.
const STARTS: u64 = 40;
/// Steps of one search.
const STEPS: usize = 200;
/// Rise of chi2 that bounds a 95 % range of one number.
const RISE: f64 = 3.84;
/// Bisections towards the edge of a range.
const BISECTIONS: usize = 16;
/// Change in sigma that a combination must make over its whole range to count as fixed by the data.
const FIXED: f64 = 2.0;

/// Computes the masses by bounded least squares: `min sum ((before + sum w unit(x, y) - measured) / sigma)^2` over weights and places.
///
/// `unit(place)` gives the reactions to a unit weight at a place. They are tabulated once over the region. Unknowns that the data do not determine
/// take the value nearest to an even distribution over the region.
pub fn size_ballast(
    before: &[f64],
    measured: &[f64],
    unit: impl Fn([f64; 2]) -> Vec<f64>,
    spec: &BallastSpec,
) -> BallastFit {
    let problem = Problem::new(before, measured, unit, spec);
    let even = problem.even();
    let mut best = problem.search(even.clone(), None);
    for s in 0..STARTS {
        // Deterministic low-discrepancy start (golden-ratio steps).
        let start: Vec<f64> = (0..even.len() as u64)
            .map(|k| ((s + 1) as f64 * GOLDEN[(k % 3) as usize] + k as f64 * 0.37).fract())
            .collect();
        let found = problem.search(start, None);
        if problem.objective(&found) < problem.objective(&best) - 1e-9 {
            best = found;
        }
    }
    let least = problem.chi2(&best);
    let ranges: Vec<[f64; 2]> = (0..best.len())
        .map(|k| problem.range(&best, k, least + RISE))
        .collect();
    let scale = |k: usize, v: f64| problem.physical(k, v);
    let mut masses: Vec<BallastMass> = (0..spec.masses)
        .map(|m| {
            let pair = |k: usize| {
                [
                    scale(3 * m + k, ranges[3 * m + k][0]),
                    scale(3 * m + k, ranges[3 * m + k][1]),
                ]
            };
            BallastMass {
                weight: scale(3 * m, best[3 * m]),
                weight_range: pair(0),
                at: [
                    scale(3 * m + 1, best[3 * m + 1]),
                    scale(3 * m + 2, best[3 * m + 2]),
                ],
                at_range: [pair(1), pair(2)],
            }
        })
        .collect();
    masses.sort_by(|a, b| a.at[0].total_cmp(&b.at[0]));
    let jacobian = problem.jacobian(&best);
    let fixed = jacobian
        .rows(0, before.len())
        .into_owned()
        .singular_values()
        .iter()
        .filter(|s| **s > FIXED)
        .count();
    BallastFit {
        masses,
        reactions: problem.reactions(&best),
        chi2: least,
        fixed,
    }
}

/// Steps of the starts: powers of the inverse plastic number.
const GOLDEN: [f64; 3] = [0.819_172_5, 0.671_043_6, 0.549_700_5];

struct Problem<'a> {
    before: &'a [f64],
    measured: &'a [f64],
    spec: &'a BallastSpec,
    table: Vec<Vec<f64>>,
}

impl<'a> Problem<'a> {
    fn new(
        before: &'a [f64],
        measured: &'a [f64],
        unit: impl Fn([f64; 2]) -> Vec<f64>,
        spec: &'a BallastSpec,
    ) -> Self {
        let point = |k: usize, i: usize| {
            let [low, high] = spec.region[k];
            low + (high - low) * i as f64 / (TABLE[k] - 1) as f64
        };
        let mut table = Vec::with_capacity(TABLE[0] * TABLE[1]);
        for i in 0..TABLE[0] {
            for j in 0..TABLE[1] {
                table.push(unit([point(0, i), point(1, j)]));
            }
        }
        Self {
            before,
            measured,
            spec,
            table,
        }
    }

    /// Numbers in 0..1 to what they mean: 3 m weight, 3 m + 1 and 3 m + 2 place.
    fn physical(&self, k: usize, v: f64) -> f64 {
        match k % 3 {
            0 => v * self.spec.largest,
            axis => {
                let [low, high] = self.spec.region[axis - 1];
                low + (high - low) * v
            }
        }
    }

    /// Returns masses spread evenly along the region, each an equal share of the missing weight.
    fn even(&self) -> Vec<f64> {
        let n = self.spec.masses as f64;
        let missing: f64 = self
            .measured
            .iter()
            .zip(self.before)
            .map(|(m, b)| m - b)
            .sum();
        let share = (missing / n / self.spec.largest).clamp(0.0, 1.0);
        (0..self.spec.masses)
            .flat_map(|m| [share, (m as f64 + 0.5) / n, 0.5])
            .collect()
    }

    /// Unit reactions at a place given in 0..1, bilinear in the table.
    fn unit(&self, u: f64, v: f64) -> Vec<f64> {
        let cell = |t: f64, n: usize| {
            let s = t.clamp(0.0, 1.0) * (n - 1) as f64;
            let i = (s.floor() as usize).min(n - 2);
            (i, s - i as f64)
        };
        let ((i, a), (j, b)) = (cell(u, TABLE[0]), cell(v, TABLE[1]));
        let at = |i: usize, j: usize, k: usize| self.table[i * TABLE[1] + j][k];
        (0..self.before.len())
            .map(|k| {
                (1.0 - a) * ((1.0 - b) * at(i, j, k) + b * at(i, j + 1, k))
                    + a * ((1.0 - b) * at(i + 1, j, k) + b * at(i + 1, j + 1, k))
            })
            .collect()
    }

    fn reactions(&self, p: &[f64]) -> Vec<f64> {
        let mut r = self.before.to_vec();
        for m in p.chunks_exact(3) {
            for (r, u) in r.iter_mut().zip(self.unit(m[1], m[2])) {
                *r += m[0] * self.spec.largest * u;
            }
        }
        r
    }

    fn chi2(&self, p: &[f64]) -> f64 {
        self.reactions(p)
            .iter()
            .zip(self.measured)
            .zip(&self.spec.sigma)
            .map(|((r, m), s)| ((r - m) / s).powi(2))
            .sum()
    }

    fn objective(&self, p: &[f64]) -> f64 {
        let tie = p
            .iter()
            .zip(self.even())
            .map(|(p, e)| (TIE * (p - e)).powi(2));
        self.chi2(p) + tie.sum::<f64>()
    }

    fn residual(&self, p: &[f64]) -> Vector {
        let mut r: Vec<f64> = self
            .reactions(p)
            .iter()
            .zip(self.measured)
            .zip(&self.spec.sigma)
            .map(|((r, m), s)| (r - m) / s)
            .collect();
        r.extend(p.iter().zip(self.even()).map(|(p, e)| TIE * (p - e)));
        Vector::from_vec(r)
    }

    /// Central differences, one-sided at the bounds.
    fn jacobian(&self, p: &[f64]) -> Matrix {
        const STEP: f64 = 1e-4;
        let n = self.before.len() + p.len();
        let mut j = Matrix::zeros(n, p.len());
        for k in 0..p.len() {
            let (mut up, mut down) = (p.to_vec(), p.to_vec());
            up[k] = (p[k] + STEP).min(1.0);
            down[k] = (p[k] - STEP).max(0.0);
            let d = (self.residual(&up) - self.residual(&down)) / (up[k] - down[k]);
            j.set_column(k, &d);
        }
        j
    }

    /// Levenberg and Marquardt with numbers at a bound held there while the slope pushes outward; `held` stays where it is.
    fn search(&self, mut p: Vec<f64>, held: Option<usize>) -> Vec<f64> {
        let mut damping = 1e-3;
        let mut best = self.objective(&p);
        for _ in 0..STEPS {
            let (r, j) = (self.residual(&p), self.jacobian(&p));
            let slope = j.transpose() * &r;
            let free: Vec<usize> = (0..p.len())
                .filter(|k| Some(*k) != held)
                .filter(|k| !(p[*k] <= 0.0 && slope[*k] > 0.0 || p[*k] >= 1.0 && slope[*k] < 0.0))
                .collect();
            if free.is_empty() {
                break;
            }
            let normal = Matrix::from_fn(free.len(), free.len(), |a, b| {
                j.column(free[a]).dot(&j.column(free[b]))
            });
            let right = Vector::from_fn(free.len(), |a, _| -slope[free[a]]);
            let mut moved = false;
            for _ in 0..12 {
                let mut damped = normal.clone();
                for a in 0..free.len() {
                    damped[(a, a)] += damping * normal[(a, a)].max(TIE * TIE);
                }
                let Some(step) = damped.lu().solve(&right) else {
                    damping *= 4.0;
                    continue;
                };
                let mut q = p.clone();
                for (a, k) in free.iter().enumerate() {
                    q[*k] = (p[*k] + step[a]).clamp(0.0, 1.0);
                }
                let value = self.objective(&q);
                if value < best {
                    moved = best - value > 1e-12 * best.max(1e-12);
                    (p, best) = (q, value);
                    damping = (damping * 0.3).max(1e-12);
                    break;
                }
                damping *= 4.0;
            }
            if !moved {
                break;
            }
        }
        p
    }

    /// Returns the range of number `k` in which the other numbers can keep chi2 under `limit`, by bisection between the best value and the bound.
    fn range(&self, best: &[f64], k: usize, limit: f64) -> [f64; 2] {
        let edge = |bound: f64| {
            let (mut inside, mut outside) = (best.to_vec(), bound);
            for i in 0..=BISECTIONS {
                let mut p = inside.clone();
                p[k] = if i == 0 {
                    bound
                } else {
                    (inside[k] + outside) / 2.0
                };
                let trial = p[k];
                p = self.search(p, Some(k));
                if self.chi2(&p) > limit {
                    outside = trial;
                } else {
                    inside = p;
                }
                if inside[k] == bound {
                    break;
                }
            }
            inside[k]
        };
        [edge(0.0), edge(1.0)]
    }
}
