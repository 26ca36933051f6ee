//! Repeats and their common error, runs with a known sum only, and a column that the loads depend on. The tests draw the truth and check the coverage
//! and width of intervals.

use super::installed_position::draw_normal;
use crate::calibrate::*;
use crate::linalg::Matrix;
use crate::recovery::{ErrorModel, Readings, estimate};
use crate::sensitivity::{Load, Sensitivity};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

const NOISE: f64 = 0.1e-6;
const GAUGES: usize = 8;

/// Returns two lanes of a bridge: strain of each gauge per kN.
pub(super) fn lanes(random: &mut ChaCha8Rng) -> Matrix {
    Matrix::from_fn(GAUGES, 2, |g, l| {
        let near = if l == 0 { GAUGES - g } else { g + 1 };
        1e-7 * (0.2 + near as f64 / GAUGES as f64) * (1.0 + 0.1 * draw_normal(random))
    })
}

pub(super) fn task(k: usize, runs: Vec<KnownRun>, model: Option<ModelPrior>) -> Task {
    Task {
        gauges: (0..GAUGES).map(|g| format!("G{g}")).collect(),
        loads: (0..k).map(|l| Load::from_name(format!("L{l}"))).collect(),
        noise: NOISE,
        model,
        runs,
        sums: vec![vec![1.0; k]],
        common_zero: CommonZero::None,
        scale_sd: 0.0,
        gauge_noise: None,
    }
}

/// Recovers one more run. Returns each load and the sum, with sigma and half width of the interval.
pub(super) fn recover_with_intervals(
    s: &Sensitivity,
    strain: Vec<f64>,
    noise: f64,
) -> Vec<[f64; 3]> {
    let readings = Readings {
        run: "new".into(),
        strain,
        noise_factor: 1.0,
    };
    let errors = ErrorModel {
        noise,
        model_rel: 0.0,
    };
    let e = estimate(s, &readings, errors).estimate;
    let k = s.loads.len();
    let one = |value: f64, sigma: f64| [value, sigma, sigma * e.coverage_factor];
    let mut out: Vec<[f64; 3]> = (0..k).map(|l| one(e.values[l], e.sigma(l))).collect();
    let all: f64 = e.covariance.iter().sum();
    out.push(one(e.values.iter().sum(), all.sqrt()));
    out
}

/// Results of weighing, for one load or sum.
#[derive(Debug)]
struct Tally {
    /// Share of the 95 % intervals that contain the true value.
    held: f64,
    /// Sd of the error over the stated sigma, both root mean squares.
    ratio: f64,
    /// Mean half width.
    half: f64,
}

fn tally(trials: &[Vec<[f64; 3]>], which: usize) -> Tally {
    let all = || trials.iter().filter_map(|t| t.get(which));
    let n = all().count() as f64;
    let square = |i: usize| all().map(|t| t[i] * t[i]).sum::<f64>();
    Tally {
        held: all().filter(|t| t[0].abs() <= t[2]).count() as f64 / n,
        ratio: (square(0) / square(1)).sqrt(),
        half: all().map(|t| t[2]).sum::<f64>() / n,
    }
}

/// Simulates six loadings of a bridge, five passages of each, and one more truck that is weighed. The offset of a loading from its lane moves `aside`
/// (1 sd, of the strain) from one lane's pattern to the other's. The offset of each passage moves `passage`. `stated` is whether the job states which
/// runs are repeats.
fn passages(aside: f64, passage: f64, stated: bool, seed: u64) -> Vec<[f64; 3]> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let s = lanes(&mut random);
    let strain = |f: [f64; 2], off: f64, random: &mut ChaCha8Rng| -> Vec<f64> {
        let moved = [f[0] - off, f[1] + off];
        (0..GAUGES)
            .map(|g| {
                (0..2).map(|l| s[(g, l)] * moved[l]).sum::<f64>() + NOISE * draw_normal(random)
            })
            .collect()
    };
    let mut runs = Vec::new();
    for group in 0..6 {
        let weight = random.random_range(150.0..400.0);
        let west = f64::from(group) / 5.0;
        let f = [weight * west, weight * (1.0 - west)];
        let of_group = aside * weight * draw_normal(&mut random);
        for _ in 0..5 {
            let off = of_group + passage * weight * draw_normal(&mut random);
            runs.push(KnownRun {
                run: format!("R{}", runs.len()),
                strain: strain(f, off, &mut random),
                noise_factor: 1.0,
                loads: KnownLoads::from_exact(f.to_vec()),
                group: if stated { group as usize } else { runs.len() },
            });
        }
    }
    let weight = random.random_range(150.0..400.0);
    let west = random.random_range(0.0..1.0);
    let f = [weight * west, weight * (1.0 - west)];
    let off = weight * aside.hypot(passage) * draw_normal(&mut random);
    let read = strain(f, off, &mut random);
    let c = calibrate(&task(2, runs, None)).unwrap();
    let truth = [f[0], f[1], weight];
    let found = recover_with_intervals(&c.sensitivity, read, NOISE);
    found
        .iter()
        .zip(truth)
        .map(|([v, sigma, half], f)| [(v - f) / weight, sigma / weight, half / weight])
        .collect()
}

fn all_passages(aside: f64, passage: f64, stated: bool) -> Vec<Vec<[f64; 3]>> {
    (0..400)
        .into_par_iter()
        .map(|seed| passages(aside, passage, stated, seed))
        .collect()
}

#[test]
fn with_stated_repeats_intervals_cover_a_loading_off_its_lane() {
    let stated = all_passages(0.03, 0.005, true);
    let unstated = all_passages(0.03, 0.005, false);
    for load in 0..2 {
        let (with, without) = (tally(&stated, load), tally(&unstated, load));
        // The limit is three standard deviations of a binomial of 400, 3.3 %.
        assert!((0.915..0.985).contains(&with.held), "{with:?} {without:?}");
        assert!(without.held < 0.915, "{with:?} {without:?}");
    }
}

#[test]
fn repeats_without_a_common_error_count_as_any_other_runs() {
    let stated = all_passages(0.0, 0.03, true);
    let unstated = all_passages(0.0, 0.03, false);
    for load in 0..2 {
        let (with, without) = (tally(&stated, load), tally(&unstated, load));
        assert!((0.915..0.985).contains(&with.held), "{with:?} {without:?}");
        // One trial in twenty finds a common error by chance.
        assert!(with.half < 1.1 * without.half, "{with:?} {without:?}");
        assert!((0.8..1.2).contains(&with.ratio), "{with:?}");
    }
}

/// Returns loads of three bays with a known sum, 1 sd `sd`, from a scale.
fn by_sum(total: f64, sd: f64) -> KnownLoads {
    const WIDE: f64 = 300.0;
    let d = WIDE * WIDE;
    let whole = 3.0 * d + sd * sd;
    let covariance = (0..9).map(|i| if i % 4 == 0 { d } else { 0.0 } - d * d / whole);
    KnownLoads {
        mean: vec![d * total / whole; 3],
        covariance: covariance.collect(),
    }
}

/// Information that separates the loads of runs with a known sum only.
#[derive(Clone, Copy, Debug, PartialEq)]
enum LoadSeparation {
    /// A model.
    Model,
    /// Four more runs that are weighed bay by bay.
    Runs,
    /// Nothing.
    Nothing,
}

/// Simulates sixteen runs of three bays with a known sum only, and one more run to be weighed. Returns its loads, their sum, and the sum from a true
/// S with noise alone.
fn by_sums(apart: LoadSeparation, seed: u64) -> Vec<[f64; 3]> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let model = Matrix::from_fn(GAUGES, 3, |_, _| 1e-6 * draw_normal(&mut random));
    let gains: Vec<f64> = (0..GAUGES)
        .map(|_| 1.0 + 0.03 * draw_normal(&mut random))
        .collect();
    let s = Matrix::from_fn(GAUGES, 3, |g, l| {
        model[(g, l)] * gains[g] * (1.0 + 0.02 * draw_normal(&mut random))
    });
    let draw = |random: &mut ChaCha8Rng| [(); 3].map(|()| random.random_range(0.0..30.0));
    let read = |f: [f64; 3], random: &mut ChaCha8Rng| -> Vec<f64> {
        let row = |g: usize| (0..3).map(|l| s[(g, l)] * f[l]).sum::<f64>();
        (0..GAUGES)
            .map(|g| row(g) + NOISE * draw_normal(random))
            .collect()
    };
    let run = |i: usize, strain: Vec<f64>, loads: KnownLoads| KnownRun {
        run: format!("R{i}"),
        strain,
        noise_factor: 1.0,
        loads,
        group: i,
    };
    let mut runs = Vec::new();
    let bays = [
        [20.0, 0.0, 0.0],
        [0.0, 20.0, 0.0],
        [0.0, 0.0, 20.0],
        [10.0; 3],
    ];
    for f in bays.into_iter().filter(|_| apart == LoadSeparation::Runs) {
        let strain = read(f, &mut random);
        runs.push(run(runs.len(), strain, KnownLoads::from_exact(f.to_vec())));
    }
    for _ in 0..16 {
        let f = draw(&mut random);
        let total: f64 = f.iter().sum::<f64>() + 0.1 * draw_normal(&mut random);
        let strain = read(f, &mut random);
        runs.push(run(runs.len(), strain, by_sum(total, 0.1)));
    }
    let prior = ModelPrior {
        values: model.clone(),
        moves: Vec::new(),
        off_drawing: None,
        uncertainty_rel: 0.1,
    };
    let prior = (apart == LoadSeparation::Model).then_some(prior);
    let c = calibrate(&task(3, runs, prior)).unwrap();
    // If only the sum is known, two of three combinations are undetermined.
    let expected = if apart == LoadSeparation::Runs { 0 } else { 2 };
    assert_eq!(c.undetermined.len(), expected, "{apart:?}");
    let f = draw(&mut random);
    let found = recover_with_intervals(&c.sensitivity, read(f, &mut random), NOISE);
    let truth = [f[0], f[1], f[2], f.iter().sum()];
    let each = found.iter().zip(truth);
    let mut out: Vec<[f64; 3]> = each
        .map(|([v, sigma, half], f)| [v - f, *sigma, *half])
        .collect();
    let best = NOISE * (s.transpose() * &s).try_inverse().unwrap().sum().sqrt();
    out.push([0.0, best, 1.96 * best]);
    out
}

#[test]
fn of_runs_weighed_by_sums_and_nothing_else_the_sum_is_known_and_what_it_is_made_of_is_not() {
    let trials: Vec<Vec<[f64; 3]>> = (0..400)
        .into_par_iter()
        .map(|seed| by_sums(LoadSeparation::Nothing, seed))
        .collect();
    let sum = tally(&trials, 3);
    // The limit is three standard deviations of a binomial of 400, 3.3 %.
    assert!((0.917..=0.983).contains(&sum.held), "{sum:?}");
    assert!((0.85..1.15).contains(&sum.ratio), "{sum:?}");
    // Three columns come from sixteen runs, and the sum of each run has the error of one sum from noise.
    let best = tally(&trials, 4);
    assert!(sum.half < 1.5 * best.half, "{sum:?} {best:?}");
    // Loads are up to 30.
    for load in 0..3 {
        let narrowest = trials.iter().map(|t| t[load][2]).fold(f64::MAX, f64::min);
        assert!(narrowest > 15.0, "{load}: {narrowest}");
    }
}

#[test]
fn runs_with_known_sum_alone_calibrate_with_intervals_as_wide_as_their_errors() {
    for apart in [LoadSeparation::Model, LoadSeparation::Runs] {
        let trials: Vec<Vec<[f64; 3]>> = (0..200)
            .into_par_iter()
            .map(|seed| by_sums(apart, seed))
            .collect();
        // Index 3 is the sum of the loads.
        for which in 0..4 {
            let found = tally(&trials, which);
            // The limit is three standard deviations of a binomial of 200, 4.6 %.
            let held = (0.904..=0.996).contains(&found.held);
            assert!(held, "{apart:?} {which}: {found:?}");
            let as_wide = (0.8..1.2).contains(&found.ratio);
            assert!(as_wide, "{apart:?} {which}: {found:?}");
        }
    }
}

/// Returns the error of the slope from sixteen passages in two lanes, and its sigma.
fn slope_of(slope: f64, seed: u64) -> [f64; 2] {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let s = lanes(&mut random);
    let (mut runs, mut column) = (Vec::new(), Vec::new());
    for i in 0..16 {
        let f = if i % 2 == 0 {
            [220.0, 0.0]
        } else {
            [0.0, 220.0]
        };
        // Both lanes have one mean speed, because a slope is relative to the loads at the mean.
        let speed = 20.0 + 4.0 * f64::from(i / 2) * 2.0;
        let size = (1.0 + slope * (speed - 48.0)) * (1.0 + 0.02 * draw_normal(&mut random));
        let row = |g: usize| (0..2).map(|l| s[(g, l)] * f[l] * size).sum::<f64>();
        column.push(speed);
        runs.push(KnownRun {
            run: format!("R{i}"),
            strain: (0..GAUGES)
                .map(|g| row(g) + NOISE * draw_normal(&mut random))
                .collect(),
            noise_factor: 1.0,
            loads: KnownLoads::from_exact(f.to_vec()),
            group: (i % 2) as usize,
        });
    }
    let task = task(2, runs, None);
    let c = calibrate(&task).unwrap();
    let found = depends_on(&task, &c.left_out, &column).unwrap();
    [found.slope_rel - slope, found.sigma]
}

#[test]
fn the_sigma_of_a_slope_is_what_slopes_scatter_by() {
    // Over the speeds, the last slope changes loads by seven times the scatter of passages (both root mean squares).
    for slope in [0.0, 0.002, 0.004, 0.008] {
        let trials: Vec<[f64; 2]> = (0..300)
            .into_par_iter()
            .map(|seed| slope_of(slope, seed))
            .collect();
        let square = |i: usize| trials.iter().map(|t| t[i] * t[i]).sum::<f64>();
        let ratio = (square(0) / square(1)).sqrt();
        // The error of a ratio from 300 trials is 4 %. The limit is three times this error.
        assert!((0.88..1.12).contains(&ratio), "{slope}: {ratio}");
    }
}
