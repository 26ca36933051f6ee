//! A clamped strip whose strain is known in closed form, with gauges away from their nominal positions.

use crate::calibrate::*;
use crate::linalg::Matrix;
use crate::recovery::{ErrorModel, Readings, estimate};
use crate::sensitivity::{Load, Sensitivity};
use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

pub(super) const NOISE: f64 = 1e-6;
const POSITION: f64 = 5.0;
const ANGLE: f64 = 3.0 * std::f64::consts::PI / 180.0;
const LENGTH: f64 = 1000.0;
const WIDTH: f64 = 100.0;
const POISSON: f64 = 0.3;
/// Strain at the hottest place of each load of size 1.
const HOT: f64 = 300e-6;

pub(super) fn draw_normal(random: &mut ChaCha8Rng) -> f64 {
    let (u, v): (f64, f64) = (
        random.random_range(1e-300..1.0),
        random.random_range(0.0..1.0),
    );
    (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}

/// Returns exx, eyy, gxy at (x, y) of a strip clamped at x = 0, for each load of size 1. The loads are a tip force out of plane, a moment in plane, a
/// pull and a torque. The equations are Euler's beam and Saint-Venant's torsion.
fn strain(x: f64, y: f64) -> [[f64; 3]; 4] {
    let axial = |e: f64| [e, -POISSON * e, 0.0];
    [
        axial(HOT * (LENGTH - x) / LENGTH),
        axial(HOT * 2.0 * y / WIDTH),
        axial(HOT),
        [0.0, 0.0, HOT],
    ]
}

/// Nominal position of a gauge: x, y, angle of its axis.
pub(super) type Site = [f64; 3];

pub(super) fn row(site: Site, [along, across, turned]: [f64; 3]) -> Vec<f64> {
    let (s, c) = site[2].sin_cos();
    let (x, y) = (
        site[0] + along * c - across * s,
        site[1] + along * s + across * c,
    );
    let (s, c) = (site[2] + turned).sin_cos();
    let read = |e: [f64; 3]| e[0] * c * c + e[1] * s * s + e[2] * s * c;
    strain(x, y).map(read).to_vec()
}

pub(super) fn sites() -> Vec<Site> {
    let at = |x: f64, y: f64, deg: f64| [x, y, deg.to_radians()];
    vec![
        at(150.0, 30.0, 0.0),
        at(150.0, -30.0, 0.0),
        at(300.0, 20.0, 45.0),
        at(300.0, -20.0, -45.0),
        at(500.0, 35.0, 20.0),
        at(500.0, -35.0, 90.0),
        at(700.0, 10.0, -30.0),
        at(200.0, 0.0, 60.0),
    ]
}

/// Six pushes: each load alone, two together.
pub(super) fn pushes() -> Vec<[f64; 4]> {
    let mut out: Vec<[f64; 4]> = (0..4)
        .map(|l| std::array::from_fn(|m| if l == m { 1.0 } else { 0.0 }))
        .collect();
    out.extend([[1.0, -1.0, 0.0, 0.5], [-0.5, 0.5, 0.5, 1.0]]);
    out
}

pub(super) fn reading(row: &[f64], f: &[f64; 4]) -> f64 {
    row.iter().zip(f).map(|(s, f)| s * f).sum()
}

/// Returns the least standard deviations of (along, across, turned) of an unbiased estimate from the pushes and the stated tolerances. They come from
/// the inverse of `J' J / noise^2 + prior`, with `J` by differences of the closed form. The gain is known to within `gain`.
fn sd_lower_bound(site: Site, gain: f64) -> [f64; 3] {
    let pushes = pushes();
    let drawn = row(site, [0.0; 3]);
    let jacobian = DMatrix::from_fn(pushes.len(), 4, |r, c| {
        if c == 3 {
            return reading(&drawn, &pushes[r]);
        }
        let step = if c == 2 { 1e-5 } else { 1e-3 };
        let side = |sign: f64| {
            let mut offset = [0.0; 3];
            offset[c] = sign * step;
            reading(&row(site, offset), &pushes[r])
        };
        (side(1.0) - side(-1.0)) / (2.0 * step)
    });
    let stated = DVector::from_vec(vec![POSITION, POSITION, ANGLE, gain]);
    let information = jacobian.transpose() * &jacobian / (NOISE * NOISE)
        + DMatrix::from_diagonal(&stated.map(|s| 1.0 / (s * s)));
    let covariance = information.try_inverse().unwrap();
    std::array::from_fn(|i| covariance[(i, i)].sqrt())
}

struct Trial {
    held: usize,
    of: usize,
    /// Stated sd over the bound.
    over_bound: Vec<f64>,
    /// Errors of loads recovered with the nominal positions, and with the installed positions.
    before: Vec<f64>,
    after: Vec<f64>,
}

fn trial(seed: u64) -> Trial {
    const MODEL: f64 = 5e-4;
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let sites = sites();
    let offsets: Vec<[f64; 3]> = sites
        .iter()
        .map(|_| {
            [
                POSITION * draw_normal(&mut random),
                POSITION * draw_normal(&mut random),
                ANGLE * draw_normal(&mut random),
            ]
        })
        .collect();
    let mut read = |f: &[f64; 4]| -> Vec<f64> {
        let of = |(s, o): (&Site, &[f64; 3])| {
            reading(&row(*s, *o), f) + NOISE * draw_normal(&mut random)
        };
        sites.iter().zip(&offsets).map(of).collect()
    };
    let known = pushes();
    let runs = known.iter().enumerate().map(|(i, f)| KnownRun {
        run: format!("R{i}"),
        strain: read(f),
        noise_factor: 1.0,
        loads: KnownLoads::from_exact(f.to_vec()),
        group: i,
    });
    let drawn = Matrix::from_fn(sites.len(), 4, |g, l| row(sites[g], [0.0; 3])[l]);
    let loads: Vec<Load> = (0..4).map(|l| Load::from_name(format!("L{l}"))).collect();
    let gauges: Vec<String> = (0..sites.len()).map(|g| format!("G{g}")).collect();
    let task = Task {
        gauges: gauges.clone(),
        loads: loads.clone(),
        noise: NOISE,
        model: Some(ModelPrior {
            values: drawn.clone(),
            moves: Vec::new(),
            off_drawing: None,
            uncertainty_rel: MODEL,
        }),
        runs: runs.collect(),
        sums: Vec::new(),
        common_zero: CommonZero::None,
        scale_sd: 0.0,
        gauge_noise: None,
    };
    let tolerance = GlueTolerance {
        position: POSITION,
        angle_rad: ANGLE,
    };
    let found =
        calibrate_installed_gauges(&task, tolerance, |g, o| Some(row(sites[g], o))).unwrap();
    let new = [0.7, -0.4, 0.9, 0.6];
    let readings = Readings {
        run: "new".into(),
        strain: read(&new),
        noise_factor: 1.0,
    };
    let errors = ErrorModel {
        noise: NOISE,
        model_rel: 0.0,
    };
    let off = |s: &Sensitivity| -> Vec<f64> {
        let e = estimate(s, &readings, errors).estimate;
        e.values.iter().zip(&new).map(|(a, b)| a - b).collect()
    };
    let plain = Sensitivity {
        gauges,
        loads,
        values: drawn,
        uncertainty: None,
        noise: None,
    };
    let mut out = Trial {
        held: 0,
        of: 0,
        over_bound: Vec::new(),
        before: off(&plain),
        after: off(&found.sensitivity),
    };
    let kinds = [MoveKind::Along, MoveKind::Across, MoveKind::Turned];
    for ((glued, truth), site) in found.as_glued.iter().zip(&offsets).zip(&sites) {
        let bound = sd_lower_bound(*site, MODEL);
        for (i, kind) in kinds.into_iter().enumerate() {
            let g = glued.find_move(kind).unwrap();
            out.held += usize::from((g.value - truth[i]).abs() < 1.96 * g.sigma);
            out.of += 1;
            out.over_bound.push(g.sigma / bound[i]);
        }
    }
    out
}

#[test]
fn six_pushes_determine_positions_of_gauges_as_well_as_is_possible() {
    let trials: Vec<Trial> = (0..60).into_par_iter().map(trial).collect();
    let (held, of) = trials
        .iter()
        .fold((0, 0), |a, t| (a.0 + t.held, a.1 + t.of));
    let share = held as f64 / of as f64;
    // With 1,440 intervals, one standard deviation of the share is 0.6 %.
    assert!((share - 0.95).abs() < 0.03, "{held} of {of} held");
    let ratios: Vec<f64> = trials.iter().flat_map(|t| t.over_bound.clone()).collect();
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    assert!((mean - 1.0).abs() < 0.1, "sd over its bound: {mean}");
    let rms = |v: &dyn Fn(&Trial) -> Vec<f64>| {
        let all: Vec<f64> = trials.iter().flat_map(v).collect();
        (all.iter().map(|x| x * x).sum::<f64>() / all.len() as f64).sqrt()
    };
    let (before, after) = (rms(&|t| t.before.clone()), rms(&|t| t.after.clone()));
    assert!(after < 0.5 * before, "loads off by {before}, then {after}");
}
