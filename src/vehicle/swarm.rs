//! Particle swarm: the thesis' way to the parameters, kept to compare with.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// How a swarm flies.
#[derive(Clone, Debug, PartialEq)]
pub struct Flight {
    /// Particles.
    pub particles: usize,
    /// Cognitive and social factors.
    pub factors: [f64; 2],
    /// At most this many rounds.
    pub rounds: usize,
    /// Stops when the best has gained less than `tolerance` (relative) over this many rounds.
    pub stall: usize,
    /// Relative gain that counts.
    pub tolerance: f64,
    /// Start of the random numbers.
    pub seed: u64,
}

impl Flight {
    /// 40 particles with the stop of MATLAB's `particleswarm`: 20 stalled rounds at 1e-6, at most 200 rounds a parameter.
    pub fn of(n_parameters: usize, seed: u64) -> Self {
        Self {
            particles: 40,
            factors: [1.49, 1.49],
            rounds: 200 * n_parameters,
            stall: 20,
            tolerance: 1e-6,
            seed,
        }
    }
}

/// The best place found, its objective, and how often the objective was evaluated.
#[derive(Clone, Debug, PartialEq)]
pub struct Landing {
    /// Parameters.
    pub x: Vec<f64>,
    /// Objective there.
    pub objective: f64,
    /// Evaluations.
    pub evaluations: usize,
}

/// Minimum of `objective` within bounds by a swarm with random inertia weight, w = 0.5 + rand(0.4, 0.9) / 2.
///
/// v <- w v + c1 r1 (own best - x) + c2 r2 (swarm's best - x); x <- x + v, held at the bounds.
///
/// # Reference
/// Thesis section 2.3.4, equations 2.3 to 2.5; Kennedy & Eberhart, Proc. ICNN 1995, 1942.
pub fn swarm(objective: impl Fn(&[f64]) -> f64, bounds: &[[f64; 2]], flight: &Flight) -> Landing {
    let mut rng = ChaCha8Rng::seed_from_u64(flight.seed);
    let n = bounds.len();
    let start = |rng: &mut ChaCha8Rng| {
        bounds
            .iter()
            .map(|[lo, hi]| lo + (hi - lo) * rng.random::<f64>())
            .collect::<Vec<f64>>()
    };
    let mut x: Vec<Vec<f64>> = (0..flight.particles.max(1))
        .map(|_| start(&mut rng))
        .collect();
    let mut v: Vec<Vec<f64>> = x.iter().map(|_| vec![0.0; n]).collect();
    let mut own: Vec<(Vec<f64>, f64)> = x.iter().map(|p| (p.clone(), objective(p))).collect();
    let mut evaluations = own.len();
    let best_of = |own: &[(Vec<f64>, f64)]| {
        own.iter()
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .cloned()
            .unwrap_or_default()
    };
    let mut best = best_of(&own);
    let mut history = vec![best.1];
    for _ in 0..flight.rounds {
        for i in 0..x.len() {
            let w = 0.5 + (0.4 + 0.5 * rng.random::<f64>()) / 2.0;
            for j in 0..n {
                let (r1, r2): (f64, f64) = (rng.random(), rng.random());
                v[i][j] = w * v[i][j]
                    + flight.factors[0] * r1 * (own[i].0[j] - x[i][j])
                    + flight.factors[1] * r2 * (best.0[j] - x[i][j]);
                let [lo, hi] = bounds[j];
                let next = x[i][j] + v[i][j];
                if next < lo || next > hi {
                    v[i][j] = 0.0;
                }
                x[i][j] = next.clamp(lo, hi);
            }
            let f = objective(&x[i]);
            evaluations += 1;
            if f < own[i].1 {
                own[i] = (x[i].clone(), f);
                if f < best.1 {
                    best.clone_from(&own[i]);
                }
            }
        }
        history.push(best.1);
        let before = history
            .len()
            .checked_sub(1 + flight.stall)
            .and_then(|k| history.get(k));
        if before.is_some_and(|b| (b - best.1).abs() <= flight.tolerance * best.1.abs().max(1.0)) {
            break;
        }
    }
    Landing {
        x: best.0,
        objective: best.1,
        evaluations,
    }
}

/// The thesis' objective (5.6, 5.10) for a quarter vehicle: each equation solved for its acceleration, squared misses over the
/// largest miss, summed. `rows` are equations as (inertia column, other columns, target); parameters are inertias by equation,
/// then the others.
#[derive(Clone, Debug)]
pub struct ThesisObjective {
    /// Acceleration of each equation, and which parameter is its mass.
    pub accelerations: Vec<(usize, Vec<f64>)>,
    /// Outside force of each equation.
    pub targets: Vec<Vec<f64>>,
    /// Other columns of each equation with their parameter.
    pub columns: Vec<Vec<(usize, Vec<f64>)>>,
}

impl ThesisObjective {
    /// From equations of motion with a single inertia each (totals are left out).
    pub fn of(equations: &[super::equations::Equation], n_inertias: usize) -> Self {
        let mut out = Self {
            accelerations: vec![],
            targets: vec![],
            columns: vec![],
        };
        for e in equations
            .iter()
            .filter(|e| e.columns.iter().filter(|c| c.0 < n_inertias).count() == 1)
        {
            for (p, c) in e.columns.iter().filter(|c| c.0 < n_inertias) {
                out.accelerations.push((*p, c.clone()));
            }
            out.targets.push(e.target.clone());
            out.columns.push(
                e.columns
                    .iter()
                    .filter(|c| c.0 >= n_inertias)
                    .cloned()
                    .collect(),
            );
        }
        out
    }

    /// Its value.
    pub fn value(&self, x: &[f64]) -> f64 {
        let mut total = 0.0;
        for ((mass, a), (target, columns)) in self
            .accelerations
            .iter()
            .zip(self.targets.iter().zip(&self.columns))
        {
            let (mut sum, mut largest) = (0.0, 0.0f64);
            for t in 0..a.len() {
                let force = target[t] - columns.iter().map(|(p, c)| x[*p] * c[t]).sum::<f64>();
                let miss = a[t] - force / x[*mass];
                sum += miss * miss;
                largest = largest.max(miss.abs());
            }
            total += sum / largest.max(f64::MIN_POSITIVE);
        }
        total
    }
}
