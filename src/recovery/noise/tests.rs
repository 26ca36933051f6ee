//! Noise estimated from readings, in simulation with a known truth. Limits of coverage are three standard deviations of a binomial share.

use super::super::{ErrorModel, Readings, Recovery, recover};
use super::{NOISE_ASSUMED, noise_without_load};
use crate::finding::Severity;
use crate::linalg::{Matrix, spd};
use crate::sensitivity::{GaugeNoise, Load, Sensitivity};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const GAUGES: usize = 16;
const LOADS: usize = 4;
const NOISE: ErrorModel = ErrorModel {
    noise: 1e-6,
    model_rel: 0.0,
};

/// Returns a standard normal number (Box and Muller).
fn draw_normal(rng: &mut ChaCha8Rng) -> f64 {
    let [u, v]: [f64; 2] = [rng.random(), rng.random()];
    (-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}

/// Seeded structure with readings of known loads.
struct Trial {
    s: Sensitivity,
    readings: Vec<Readings>,
    truth: Vec<Vec<f64>>,
    /// Covariance of the noise, in units of the stated noise.
    noise: Matrix,
    /// Samples without load, strain.
    unloaded: Vec<Vec<f64>>,
}

impl Trial {
    fn new(seed: u64, runs: usize, noise: Matrix) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let values = Matrix::from_fn(GAUGES, LOADS, |_, _| 3e-6 * draw_normal(&mut rng));
        let root = spd::cholesky(noise.as_slice(), GAUGES).unwrap();
        let errors = |rng: &mut ChaCha8Rng| -> Vec<f64> {
            let white: Vec<f64> = (0..GAUGES).map(|_| draw_normal(rng)).collect();
            let of = |g: usize| spd::dot(&root[g * GAUGES..(g + 1) * GAUGES], &white);
            (0..GAUGES).map(|g| NOISE.noise * of(g)).collect()
        };
        let (mut readings, mut truth) = (Vec::new(), Vec::new());
        for i in 0..runs {
            let f: Vec<f64> = (0..LOADS).map(|_| 30.0 * draw_normal(&mut rng)).collect();
            let errors = errors(&mut rng);
            let of = |g: usize| spd::dot(values.row(g).transpose().as_slice(), &f) + errors[g];
            readings.push(Readings {
                run: format!("R{i}"),
                strain: (0..GAUGES).map(of).collect(),
                noise_factor: 1.0,
            });
            truth.push(f);
        }
        let unloaded = (0..400).map(|_| errors(&mut rng)).collect();
        let s = Sensitivity {
            gauges: (0..GAUGES).map(|g| format!("G{g:02}")).collect(),
            loads: (0..LOADS)
                .map(|l| Load::from_name(format!("L{l}")))
                .collect(),
            values,
            uncertainty: None,
            noise: None,
        };
        Self {
            s,
            readings,
            truth,
            noise,
            unloaded,
        }
    }

    fn recover(&self) -> Recovery {
        recover(&self.s, &self.readings, NOISE)
    }

    /// Returns the share of the intervals that contain the true load: over all loads, and the smallest share of a load.
    fn interval_coverage(&self, recovery: &Recovery) -> (f64, f64) {
        let by_load = (0..LOADS).map(|l| {
            let inside = |(r, f): (&super::super::RunEstimate, &Vec<f64>)| {
                let [low, high] = r.estimate.interval(l);
                low <= f[l] && f[l] <= high
            };
            let pairs = recovery.runs.iter().zip(&self.truth);
            let held = pairs.filter(|p| inside(*p)).count();
            held as f64 / self.truth.len() as f64
        });
        let by_load: Vec<f64> = by_load.collect();
        let least = by_load.iter().copied().fold(1.0, f64::min);
        (by_load.iter().sum::<f64>() / LOADS as f64, least)
    }

    /// Returns the mean half width divided by that of the best estimate, which uses the true covariance of the noise.
    fn width(&self, recovery: &Recovery) -> f64 {
        let best = Sensitivity {
            noise: Some(GaugeNoise::of_covariance(self.noise.clone())),
            ..self.s.clone()
        };
        let best = recover(&best, &self.readings[..1], NOISE);
        let (ours, best) = (&recovery.runs[0].estimate, &best.runs[0].estimate);
        let ratio = |l: usize| ours.sigma(l) / best.sigma(l);
        (0..LOADS).map(ratio).sum::<f64>() / LOADS as f64
    }
}

/// Returns noise with the stated root mean square. It varies by gauge from a third to three times the stated noise.
fn by_gauge(correlation: f64) -> Matrix {
    let sd: Vec<f64> = (0..GAUGES)
        .map(|g| (2.2 * ((7 * g) % GAUGES) as f64 / (GAUGES - 1) as f64 - 1.1).exp())
        .collect();
    let rms = (sd.iter().map(|v| v * v).sum::<f64>() / GAUGES as f64).sqrt();
    let sd: Vec<f64> = sd.iter().map(|v| v / rms).collect();
    GaugeNoise::with_correlation(&sd, correlation)
        .covariance()
        .clone()
}

fn correlated_covariance(correlation: f64) -> Matrix {
    GaugeNoise::with_correlation(&[1.0; GAUGES], correlation)
        .covariance()
        .clone()
}

/// Returns three standard deviations of a share of 95 % in this number of trials.
fn slack(of: usize) -> f64 {
    3.0 * (0.95 * 0.05 / of as f64).sqrt()
}

fn severity(recovery: &Recovery) -> Option<Severity> {
    let found = recovery.findings.iter().find(|f| f.code == NOISE_ASSUMED);
    found.map(|f| f.severity)
}

#[test]
fn intervals_hold_with_noise_that_residuals_show() {
    const RUNS: usize = 600;
    for (seed, noise) in [correlated_covariance(0.9), by_gauge(0.0), by_gauge(0.8)]
        .into_iter()
        .enumerate()
    {
        let trial = Trial::new(seed as u64, RUNS, noise);
        let got = trial.recover();
        let ((held, least), width) = (trial.interval_coverage(&got), trial.width(&got));
        println!("held {held:.3}, least {least:.3}, width {width:.2}");
        assert_eq!(severity(&got), Some(Severity::Info), "{:?}", got.findings);
        // An estimate below the stated noise is replaced by the stated noise, so intervals may be too wide by the error of the estimate.
        assert!(held > 0.95 - slack(LOADS * RUNS) && held < 0.97, "{held}");
        assert!(least > 0.9, "{least}");
        assert!((0.95..1.1).contains(&width), "{width}");
    }
}

#[test]
fn noise_as_stated_changes_nothing() {
    for (seed, runs) in [(1, 12), (2, 60), (3, 600)] {
        let trial = Trial::new(seed, runs, correlated_covariance(0.0));
        let got = trial.recover();
        assert_eq!(severity(&got), None, "{:?}", got.findings);
        assert_eq!(got.noise, None);
        let one = recover(&trial.s, &trial.readings[..1], NOISE);
        assert_eq!(got.runs[0].estimate.values, one.runs[0].estimate.values);
    }
}

#[test]
fn noise_that_no_form_explains_is_an_error() {
    // Two cases: noise correlated by position along a beam, and noise by gauge with too few runs to estimate it.
    let place = |g: usize| 8.0 * g as f64 / (GAUGES - 1) as f64;
    let beam = Matrix::from_fn(GAUGES, GAUGES, |g, h| (-(place(g) - place(h)).abs()).exp());
    for (runs, noise) in [(600, beam), (60, by_gauge(0.0))] {
        let got = Trial::new(5, runs, noise).recover();
        assert_eq!(severity(&got), Some(Severity::Error), "{:?}", got.findings);
        assert_eq!(got.noise, None);
    }
}

#[test]
fn a_zero_record_shows_noise_of_any_form() {
    let place = |g: usize| 8.0 * g as f64 / (GAUGES - 1) as f64;
    let beam = Matrix::from_fn(GAUGES, GAUGES, |g, h| (-(place(g) - place(h)).abs()).exp());
    for noise in [correlated_covariance(0.9), by_gauge(0.0), beam] {
        let mut trial = Trial::new(9, 600, noise);
        let (found, finding) = noise_without_load(&trial.s, &trial.unloaded, NOISE);
        assert_eq!(finding.map(|f| f.severity), Some(Severity::Info));
        trial.s.noise = found;
        let got = trial.recover();
        let (held, least) = trial.interval_coverage(&got);
        println!("held {held:.3}, least {least:.3}");
        // The weights come from 400 samples of 16 gauges, so the true errors are 4 % larger than predicted.
        assert!((0.93..0.97).contains(&held), "{held}");
        assert!(least > 0.9, "{least}");
    }
    let white = Trial::new(9, 1, correlated_covariance(0.0));
    let (found, finding) = noise_without_load(&white.s, &white.unloaded, NOISE);
    assert!(found.is_none() && finding.is_none());
}

/// Coverage over `STRAINBRIDGE_TRIALS` seeded structures with noise.
#[test]
fn coverage_over_structures() {
    let trials = std::env::var("STRAINBRIDGE_TRIALS").ok();
    let trials: u64 = trials.and_then(|t| t.parse().ok()).unwrap_or(3);
    const RUNS: usize = 200;
    let (mut sum, mut of) = (0.0, 0);
    for seed in 0..trials {
        let correlation = [0.0, 0.4, 0.8][(seed % 3) as usize];
        let trial = Trial::new(100 + seed, RUNS, by_gauge(correlation));
        let got = trial.recover();
        if severity(&got) == Some(Severity::Error) {
            continue;
        }
        sum += trial.interval_coverage(&got).0;
        of += 1;
    }
    assert!(of as u64 * 10 >= trials * 9, "{of} of {trials}");
    let share = sum / f64::from(of);
    println!("{:.1} % of the intervals of {of} structures", 100.0 * share);
    assert!((0.93..0.97).contains(&share), "{share}");
}

/// Returns a case of the shared folder: S in strain per unit load, readings and, if the case has it, the truth.
fn case(name: &str) -> Option<(Sensitivity, Vec<Vec<f64>>, Vec<Vec<f64>>)> {
    let read = |file: &str| crate::support::text(&format!("cases/calibrate/{name}/{file}"));
    let numbers = |text: &str| -> Vec<Vec<f64>> {
        let rows = text.lines().skip(1).map(|l| l.split(',').skip(1));
        rows.map(|r| r.map(|v| v.parse().unwrap()).collect())
            .collect()
    };
    let s = numbers(&read("S.csv")?);
    let strain = numbers(&read("strain.csv")?);
    let truth = match name.starts_with("coloured") {
        true => Vec::new(),
        false => numbers(&read("truth.csv")?),
    };
    let (n, k) = (s.len(), s[0].len());
    let s = Sensitivity {
        gauges: (0..n).map(|g| format!("G{g:02}")).collect(),
        loads: (0..k).map(|l| Load::from_name(format!("L{l}"))).collect(),
        values: Matrix::from_fn(n, k, |g, l| 1e-6 * s[g][l]),
        uncertainty: None,
        noise: None,
    };
    let strain = strain.into_iter();
    let strain = strain.map(|row| row.into_iter().map(|v| 1e-6 * v).collect());
    Some((s, strain.collect(), truth))
}

/// With the noise as stated, 1,850 and 2,026 of 2,400 intervals contained the true load.
#[test]
fn shared_noise_of_two_cases_is_shown() {
    for name in ["noise_common_mode_rho09", "noise_differs_by_gauge"] {
        let Some((s, strain, truth)) = case(name) else {
            return;
        };
        let readings = strain.into_iter().enumerate().map(|(i, strain)| Readings {
            run: format!("R{i}"),
            strain,
            noise_factor: 1.0,
        });
        let readings: Vec<Readings> = readings.collect();
        let got = recover(&s, &readings, NOISE);
        let held = got.runs.iter().zip(&truth).flat_map(|(r, f)| {
            f.iter().enumerate().map(|(l, f)| {
                let [low, high] = r.estimate.interval(l);
                usize::from(low <= *f && *f <= high)
            })
        });
        let held: usize = held.sum();
        println!("{name}: {held} of 2400");
        // Limits: 95 % and four standard deviations of a binomial count.
        assert!((2237..=2323).contains(&held), "{name}: {held}");
    }
}

#[test]
fn coloured_noise_of_a_record_makes_no_sound_gauge_a_suspect() {
    let Some((s, strain, _)) = case("coloured_noise_names_sound_gauge") else {
        return;
    };
    let samples = strain.into_iter().enumerate();
    let samples = samples.map(|(i, strain)| Readings::of_sample(0.01 * i as f64, strain, 1.0));
    let got = super::super::recover_samples(&s, samples.collect(), NOISE);
    let named = |f: &&crate::finding::Finding| f.code == "gauge-suspect";
    assert_eq!(got.findings.iter().find(named), None);
}

/// First-order noise of the stated size at 100 Hz, with typical corner frequencies of loggers and drift, for 15 s each.
#[test]
fn coloured_noise_names_no_gauge_more_often_than_white_noise() {
    let trials = std::env::var("STRAINBRIDGE_TRIALS").ok();
    let trials: u64 = trials.and_then(|t| t.parse().ok()).unwrap_or(2);
    let mut named = [0; 3];
    for seed in 0..trials {
        for (i, corner_hz) in [5.0, 0.2, 0.05].into_iter().enumerate() {
            let mut rng = ChaCha8Rng::seed_from_u64(1000 + seed);
            let trial = Trial::new(2000 + seed, 1500, correlated_covariance(0.0));
            let keep = (-std::f64::consts::TAU * corner_hz * 0.01_f64).exp();
            let mut state: Vec<f64> = (0..GAUGES).map(|_| draw_normal(&mut rng)).collect();
            let samples = trial.truth.iter().enumerate().map(|(i, f)| {
                let row = |g: usize, e: f64| {
                    spd::dot(trial.s.values.row(g).transpose().as_slice(), f) + NOISE.noise * e
                };
                let strain = state.iter().enumerate().map(|(g, e)| row(g, *e)).collect();
                for e in &mut state {
                    *e = keep * *e + (1.0 - keep * keep).sqrt() * draw_normal(&mut rng);
                }
                Readings::of_sample(0.01 * i as f64, strain, 1.0)
            });
            let samples: Vec<Readings> = samples.collect();
            let got = super::super::recover_samples(&trial.s, samples, NOISE);
            named[i] += u64::from(got.findings.iter().any(|f| f.code == "gauge-suspect"));
        }
    }
    println!("named {named:?} of {trials}");
    // A finding on a gauge occurs in one correct record in twenty. The limit allows for chance.
    let most = (0.05 * trials as f64 + 3.0 * (0.05 * trials as f64).sqrt()).ceil() as u64;
    assert!(named[..2].iter().all(|n| *n <= most), "{named:?}");
    // At 0.05 Hz a record of 15 s has fewer than five independent samples. So few samples hardly determine their effective number.
    assert!(3 * named[2] <= trials.max(3), "{named:?}");
}
