//! Computes how one gauge that reads 10 % too much changes loads and their intervals: the table of docs/4-recovering-loads.md.
//!
//! `cargo run --release --example one_gauge_off [JOBS] [GAUGE,GAUGE..]` (300 jobs, all gauges). The frame is ../shared/nastran/mystran_frame_units:
//! 20 gauges, 9 loads, 12 runs. Every job draws new noise (1 microstrain) and a new model error (2 % of each coefficient of S).
#![allow(clippy::print_stdout)]

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::error::Error;
use strainbridge::estimate::NORMAL_95;
use strainbridge::finding::Severity;
use strainbridge::linalg::{Matrix, Vector};
use strainbridge::recovery::{
    ErrorModel, GAUGE_SUSPECT, Gain, Readings, Recovery, Shift, ShiftKind, Widening, recover,
};
use strainbridge::sensitivity::{Load, Sensitivity};

const FOLDER: &str = "../shared/nastran/mystran_frame_units/measured";
/// Gain error of the gauge, as a share of its reading.
const OFF: f64 = 0.1;
/// Noise and model error that the job states; the true errors have the same size.
const ERRORS: ErrorModel = ErrorModel {
    noise: 1e-6,
    model_rel: 0.02,
};

/// S in strain per N, and the loads of the runs, N.
struct Frame {
    s: Sensitivity,
    runs: Vec<Vec<f64>>,
}

/// Counts of one job, or of several jobs together.
#[derive(Default)]
struct Counts {
    jobs: usize,
    stopped: usize,
    /// Jobs without a stop in which a gauge is identified as suspect. `silent` counts the intervals of the jobs in which no gauge is identified, as
    /// in `kept`.
    named: usize,
    silent: [usize; 2],
    /// Intervals of the jobs without a stop: intervals that contain the load, and all intervals.
    kept: [usize; 2],
    asked: usize,
}

impl Counts {
    fn add(mut self, other: Self) -> Self {
        self.jobs += other.jobs;
        self.stopped += other.stopped;
        self.named += other.named;
        self.asked += other.asked;
        for i in 0..2 {
            self.silent[i] += other.silent[i];
            self.kept[i] += other.kept[i];
        }
        self
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let jobs: u64 = arguments.next().map_or(Ok(300), |n| n.parse())?;
    let only = arguments.next();
    let frame = read()?;
    println!(
        "gauge  leverage  mean t  shift  stopped %  misled %  holding %  named, not stopped %  holding where none is named %"
    );
    if only.is_none() {
        line(&frame, jobs, None);
    }
    for (g, name) in frame.s.gauges.iter().enumerate() {
        let wanted = |list: &String| list.split(',').any(|n| n == name);
        if only.as_ref().is_none_or(wanted) {
            line(&frame, jobs, Some(g));
        }
    }
    Ok(())
}

/// Prints the line of the table for one gauge with a gain error, or for no such gauge.
fn line(frame: &Frame, jobs: u64, off: Option<usize>) {
    let total = (0..jobs)
        .into_par_iter()
        .map(|seed| job(frame, seed, off))
        .reduce(Counts::default, Counts::add);
    let percent = |part: usize, of: usize| 100.0 * part as f64 / of.max(1) as f64;
    let about = off.map_or(String::new(), |g| {
        format!(
            "{:8.2}  {:6.1}  {:5.1}",
            leverage(frame, g),
            mean_t(frame, g),
            largest_shift(frame, g)
        )
    });
    println!(
        "{:5}  {about:23}  {:9.2}  {:8.2}  {:9.1}  {:20.2}  {:9.1}",
        off.map_or("none", |g| &frame.s.gauges[g]),
        percent(total.stopped, total.jobs),
        percent(total.kept[1] - total.kept[0], total.asked),
        percent(total.kept[0], total.kept[1]),
        percent(total.named, total.jobs - total.stopped),
        percent(total.silent[0], total.silent[1]),
    );
}

/// Runs one job with a gain error of one gauge.
fn job(frame: &Frame, seed: u64, off: Option<usize>) -> Counts {
    let got = recover(&frame.s, &readings(frame, seed, off), ERRORS);
    let asked = frame.runs.len() * frame.s.loads.len();
    let mut out = Counts {
        jobs: 1,
        asked,
        ..Counts::default()
    };
    if got.findings.iter().any(|f| f.severity == Severity::Error) {
        out.stopped = 1;
        return out;
    }
    out.kept = [count_holding_intervals(frame, &got), asked];
    match got.findings.iter().any(|f| f.code == GAUGE_SUSPECT) {
        true => out.named = 1,
        false => out.silent = out.kept,
    }
    out
}

/// Returns the number of intervals that contain the load.
fn count_holding_intervals(frame: &Frame, got: &Recovery) -> usize {
    let pairs = got.runs.iter().zip(&frame.runs);
    pairs
        .flat_map(|(run, truth)| truth.iter().enumerate().map(move |(l, f)| (run, l, *f)))
        .filter(|(run, l, f)| {
            let [low, high] = run.estimate.interval(*l);
            low <= *f && *f <= high
        })
        .count()
}

/// Returns the readings of the runs, computed with model errors in S.
fn readings(frame: &Frame, seed: u64, off: Option<usize>) -> Vec<Readings> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (n, k) = (frame.s.gauges.len(), frame.s.loads.len());
    let s = Matrix::from_fn(n, k, |g, l| {
        frame.s.values[(g, l)] * (1.0 + ERRORS.model_rel * draw_gaussian(&mut rng))
    });
    let run = |(i, f): (usize, &Vec<f64>)| Readings {
        run: format!("R{i}"),
        strain: (0..n)
            .map(|g| {
                let gain = if off == Some(g) { 1.0 + OFF } else { 1.0 };
                let strain: f64 = (0..k).map(|l| s[(g, l)] * f[l]).sum();
                gain * strain + ERRORS.noise * draw_gaussian(&mut rng)
            })
            .collect(),
        noise_factor: 1.0,
    };
    frame.runs.iter().enumerate().map(run).collect()
}

/// Returns the load estimator, with weights for the typical loads of the runs.
fn gain(frame: &Frame) -> Option<Gain> {
    let all: Vec<usize> = (0..frame.s.gauges.len()).collect();
    let n = frame.runs.len() as f64;
    let typical: Vec<f64> = (0..frame.s.loads.len())
        .map(|l| (frame.runs.iter().map(|f| f[l] * f[l]).sum::<f64>() / n).sqrt())
        .collect();
    Gain::new(&frame.s, &all, ERRORS, 1.0, &typical)
}

fn leverage(frame: &Frame, gauge: usize) -> f64 {
    gain(frame).map_or(f64::NAN, |g| g.leverage[gauge])
}

/// Returns the largest shift of a load in a run, relative to the half width of its interval.
fn largest_shift(frame: &Frame, gauge: usize) -> f64 {
    let Some(gain) = gain(frame) else {
        return f64::NAN;
    };
    let shift = Shift {
        gauge,
        kind: ShiftKind::Gain,
        size: OFF,
    };
    let of_run = |f: &Vec<f64>| {
        let by_load = gain.shift(f, &shift).unwrap_or_default();
        let sigma = gain.sigma(f, &Widening::none());
        let ratios = by_load.into_iter().zip(sigma);
        ratios.fold(0.0_f64, |worst, (d, sd)| {
            worst.max(d.abs() / (NORMAL_95 * sd))
        })
    };
    frame.runs.iter().map(of_run).fold(0.0, f64::max)
}

/// Returns the mean of `t` for a gauge with the gain error: `t^2 = d' P d`, `P = V^-1 - V^-1 X (X' V^-1 X)^-1 X' V^-1`. `V` is the covariance of all
/// readings, with a block `V_g` over the runs for each gauge. `X` is the strain under the loads of each run, and `d` is the excess reading of the
/// gauge.
fn mean_t(frame: &Frame, gauge: usize) -> f64 {
    let (n, k, runs) = (frame.s.gauges.len(), frame.s.loads.len(), &frame.runs);
    let row = |g: usize| Vector::from_fn(k, |l, _| frame.s.values[(g, l)]);
    let inverse = |g: usize| {
        let noise = ERRORS.noise_variance(1.0);
        let of = |i: usize, j: usize| {
            let shared = ERRORS.model_error_covariance(row(g).iter().copied(), &runs[i], &runs[j]);
            shared + if i == j { noise } else { 0.0 }
        };
        Matrix::from_fn(runs.len(), runs.len(), of).try_inverse()
    };
    let mut information = Matrix::zeros(runs.len() * k, runs.len() * k);
    for g in 0..n {
        let Some(v) = inverse(g) else { return f64::NAN };
        information += v.kronecker(&(row(g) * row(g).transpose()));
    }
    let (Some(v), Some(covariance)) = (inverse(gauge), information.try_inverse()) else {
        return f64::NAN;
    };
    let d = Vector::from_fn(runs.len(), |i, _| {
        OFF * (0..k)
            .map(|l| frame.s.values[(gauge, l)] * runs[i][l])
            .sum::<f64>()
    });
    let weighed = &v * &d;
    let u = weighed.kronecker(&row(gauge));
    let square = d.dot(&weighed) - (u.transpose() * covariance * &u)[(0, 0)];
    square.max(0.0).sqrt()
}

/// Draws a standard normal number with the method of Box and Muller.
fn draw_gaussian(rng: &mut ChaCha8Rng) -> f64 {
    let u: f64 = rng.random_range(f64::MIN_POSITIVE..1.0);
    let v: f64 = rng.random_range(0.0..1.0);
    (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}

/// Names in the header, names in the first column, and the numbers after `skip` columns.
type Table = (Vec<String>, Vec<String>, Vec<Vec<f64>>);

fn table(file: &str, skip: usize) -> Result<Table, Box<dyn Error>> {
    let text = std::fs::read_to_string(format!("{FOLDER}/{file}"))?;
    let mut lines = text.lines().map(|l| l.split(',').map(str::to_owned));
    let head = lines.next().ok_or("an empty table")?.skip(skip).collect();
    let (mut names, mut rows) = (Vec::new(), Vec::new());
    for line in lines {
        let cells: Vec<String> = line.collect();
        let numbers: Result<Vec<f64>, _> = cells.iter().skip(skip).map(|c| c.parse()).collect();
        rows.push(numbers?);
        names.extend(cells.into_iter().next());
    }
    Ok((head, names, rows))
}

/// Reads the frame; the files are in microstrain per kN and in kN.
fn read() -> Result<Frame, Box<dyn Error>> {
    let (names, gauges, s) = table("sensitivity_truth.csv", 1)?;
    let (_, _, loads) = table("loads_truth.csv", 2)?;
    let s = Sensitivity {
        values: Matrix::from_fn(gauges.len(), names.len(), |g, l| s[g][l] * 1e-9),
        uncertainty: None,
        noise: None,
        gauges,
        loads: names.iter().map(Load::from_name).collect(),
    };
    let runs = loads
        .into_iter()
        .map(|f| f.into_iter().map(|v| v * 1e3).collect())
        .collect();
    Ok(Frame { s, runs })
}
