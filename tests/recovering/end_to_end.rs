//! One record through all steps: conditioning, recovery, comparison with measured wheel forces, sections.
//!
//! A half vehicle on its tyres drives twice over the same bump. Its equations of motion give the wheel forces, which no part of the recovery knows.
//! Gauges follow another S than the job states, by 0.3 % in each entry. The logger adds noise, offsets, spikes, and strain of a temperature ramp.

use crate::drawn::Numbers;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fmt::Write;
use strainbridge::host::context::InMemory;
use strainbridge::vehicle::preset::{PresetRequest, vehicle};
use strainbridge::vehicle::response::{Inputs, PrescribedMotion, ResponseRules, compute_response};
use strainbridge::vehicle::tyre::add_tyres;
use strainbridge::workflow::recover::RecoveredLoads;
use strainbridge::{Context, Job, Outcome, recover};

const RATE: f64 = 500.0;
const SECONDS: f64 = 60.0;
/// Both passes over the bump begin at these times at the front axle; the rear axle follows.
const BUMPS: [f64; 2] = [20.0, 40.0];
const BEHIND: f64 = 0.4;
/// Microstrain per N, by gauge.
const S: [[f64; 2]; 8] = [
    [0.020, 0.002],
    [0.018, -0.004],
    [0.003, 0.021],
    [-0.005, 0.019],
    [0.011, 0.012],
    [0.014, -0.009],
    [-0.008, 0.015],
    [0.016, 0.006],
];
const MODEL: f64 = 0.003;
const NOISE: f64 = 1.0;
const THERMAL: f64 = 1.4;
/// Clock of the wheel force transducers less the clock of the strain, s.
const LATE: f64 = 1.2346;
const FORCE_NOISE: f64 = 20.0;

fn height(t: f64, phases: &[f64]) -> f64 {
    let starts = BUMPS.map(|b| t - b);
    let bump = |u: f64| {
        if (0.0..0.3).contains(&u) {
            0.03 * (TAU * u / 0.6).sin()
        } else {
            0.0
        }
    };
    let waves = phases.iter().enumerate().map(|(k, p)| {
        let f = 0.3 + 0.21 * k as f64;
        4e-3 / (1.0 + 2.0 * f) * ((TAU * f * t + p).sin() - p.sin())
    });
    let begun = ((t - 6.0) / 2.0).clamp(0.0, 1.0);
    begun * waves.sum::<f64>() + starts.into_iter().map(bump).sum::<f64>()
}

/// Dynamic forces of the front and the rear wheel, N, at `RATE`.
fn wheel_forces(numbers: &mut Numbers) -> [Vec<f64>; 2] {
    let request = PresetRequest {
        model: "half".to_owned(),
        ..PresetRequest::default()
    };
    let mut half = vehicle(&request).unwrap();
    let tyres = add_tyres(&mut half, &BTreeMap::new());
    let phases: Vec<f64> = (0..40).map(|_| 3.0 * numbers.draw_normal()).collect();
    let n = (RATE * (SECONDS + 5.0)) as usize;
    let mut inputs = Inputs {
        rate_hz: RATE,
        forces: vec![None; 2],
        motions: vec![None; half.bodies.len()],
        tyres: vec![None; 2],
    };
    for tyre in &tyres {
        let late = if tyre.wheel == 0 { 0.0 } else { BEHIND };
        let road = (0..n).map(|i| height((i as f64 / RATE - late).max(0.0), &phases));
        let body = half.links[tyre.link].ends[1].1.body;
        inputs.motions[body] = Some(PrescribedMotion::Displacements(vec![road.collect()]));
        inputs.tyres[tyre.wheel] = Some(tyre.link);
    }
    // Wheelbase 1 along x, in units of the wheelbase: 7 t of body, a radius of gyration of 0.45, its centre at 0.55.
    let value = |name: &str| match name {
        "m_b" => 7000.0,
        "mx_b" => -0.55 * 7000.0,
        "mxx_b" => (0.55f64.powi(2) + 0.45f64.powi(2)) * 7000.0,
        "m_f" => 650.0,
        "m_r" => 900.0,
        "k_sf" => 3.2e5,
        "k_sr" => 4.5e5,
        "c_sf" | "c_sr" => 1.8e4,
        "k_tf" | "k_tr" => 1.6e6,
        "c_tf" | "c_tr" => 1.5e3,
        _ => f64::NAN,
    };
    let values: Vec<f64> = half.parameters().iter().map(|p| value(&p.name)).collect();
    let rules = ResponseRules::default();
    let found = compute_response(&half, &values, &inputs, &rules).unwrap();
    [0, 1].map(|w| found.wheels[w].clone().unwrap())
}

/// The recovered loads of a draw, and the forces behind them.
fn recovered(seed: u64) -> (Outcome<RecoveredLoads>, [Vec<f64>; 2]) {
    let mut numbers = Numbers(seed);
    let forces = wheel_forces(&mut numbers);
    let actual = S.map(|row| row.map(|s| s * (1.0 + MODEL * numbers.draw_normal())));
    let offsets = S.map(|_| 40.0 * numbers.draw_normal());
    let mut strain = "time [s],G1,G2,G3,G4,G5,G6,G7,G8,T [degC]\n".to_owned();
    for i in 0..(RATE * SECONDS) as usize {
        let t = i as f64 / RATE;
        let degrees = 18.0 + 9.0 * t / SECONDS;
        let _ = write!(strain, "{t:.4}");
        for (g, row) in actual.iter().enumerate() {
            let spike = if i % 3700 == 1500 + 40 * g {
                600.0
            } else {
                0.0
            };
            let load = row[0] * forces[0][i] + row[1] * forces[1][i];
            let reading =
                load + offsets[g] + THERMAL * degrees + spike + NOISE * numbers.draw_normal();
            let _ = write!(strain, ",{reading:.5}");
        }
        let _ = writeln!(strain, ",{degrees:.4}");
    }
    // The transducers start later, at another rate, on another clock. Straight lines between samples at 500 Hz err by less than their noise.
    let mut measured = "time [s],front [N],rear [N]\n".to_owned();
    for i in 0..(400.0 * (SECONDS - 5.0)) as usize {
        let t = i as f64 / 400.0;
        let place = (t + LATE) * RATE;
        let (k, u) = (place.floor() as usize, place.fract());
        let _ = write!(measured, "{t:.5}");
        for f in &forces {
            let value = f[k] + u * (f[k + 1] - f[k]) + FORCE_NOISE * numbers.draw_normal();
            let _ = write!(measured, ",{value:.3}");
        }
        measured.push('\n');
    }
    let mut s = "gauge,front,rear\n".to_owned();
    for (g, row) in S.iter().enumerate() {
        let _ = writeln!(s, "G{},{},{}", g + 1, row[0], row[1]);
    }
    let [first, second] = BUMPS.map(|b| (b - 0.2, b + 2.8));
    let job = format!(
        "units = \"m-kg-s\"\nload = [{{ name = \"front\", component = \"FZ\" }}, {{ name = \"rear\", component = \"FZ\" }}]\n\
         calibration = {{ model_uncertainty_rel = {MODEL} }}\nsensitivity = {{ file = \"s.csv\" }}\n\
         measured = {{ strain = \"strain.csv\", noise_microstrain = {NOISE}, reference = \"none\" }}\n\
         conditioning = {{ spikes = true, temperature = {{ channel = \"T\", microstrain_per_degC = {THERMAL} }}, zero_s = [0.0, 5.0] }}\n\
         compare = {{ file = \"wft.csv\", units = {{ force = \"N\" }}, noise = {{ force = {FORCE_NOISE} }} }}\n\
         [[section]]\nname = \"first\"\nstart_s = {}\nend_s = {}\n[[section]]\nname = \"second\"\nstart_s = {}\nend_s = {}\n",
        first.0, first.1, second.0, second.1
    );
    let files = InMemory::default()
        .with_file("s.csv", s)
        .with_file("strain.csv", strain)
        .with_file("wft.csv", measured)
        .with_file("job.toml", job);
    let job = Job::read("job.toml", &files).unwrap();
    (recover(&job, &Context::new(&files)).unwrap(), forces)
}

/// In each of four draws: intervals contain the measured forces in 95 +- 2 % of the samples, and the interval of the damage ratio contains 1.
#[test]
fn a_record_with_faults_gives_the_measured_forces_within_their_intervals() {
    let (mut shares, mut ratios) = (Vec::new(), 0);
    for seed in 1..=4 {
        let (found, forces) = recovered(seed);
        let shift = found.comparison.shift.as_ref().unwrap();
        assert!((shift.shift_s - LATE).abs() < 1e-3, "{}", shift.shift_s);
        let errors = found
            .findings
            .iter()
            .filter(|f| f.severity == strainbridge::Severity::Error);
        assert_eq!(errors.count(), 0, "{:?}", found.findings);
        for load in &found.comparison.loads {
            let [low, ratio, high] = [
                load.damage_ratio_low,
                load.damage_ratio,
                load.damage_ratio_high,
            ]
            .map(Option::unwrap);
            println!(
                "draw {seed}, {}: {:.2} % within, rms {:.1} N, bias {:.1} N, damage ratio {ratio:.4} ({low:.4} to {high:.4})",
                load.load,
                100.0 * load.share_within,
                load.rms,
                load.bias
            );
            shares.push(load.share_within);
            ratios += u8::from(low <= 1.0 && 1.0 <= high);
        }
        let spectra = found.comparison.spectra.as_ref().unwrap();
        let step = spectra.f_hz[1];
        for load in &spectra.loads {
            // The road has waves up to 8.5 Hz.
            let k = (2.0 / step) as usize;
            assert!(
                load.coherence[k] > 0.99,
                "{}: {}",
                load.load,
                load.coherence[k]
            );
        }
        // Each pass over the bump has the extremes of the wheel forces, to five standard deviations of a load and the error of S.
        for row in &found.sections.as_ref().unwrap().sections {
            let begin = if row.section == "first" {
                BUMPS[0]
            } else {
                BUMPS[1]
            } - 0.2;
            let from = (begin * RATE).round() as usize;
            let force =
                &forces[usize::from(row.load == "rear")][from..from + (3.0 * RATE) as usize];
            let high = force.iter().copied().fold(f64::MIN, f64::max);
            let low = force.iter().copied().fold(f64::MAX, f64::min);
            let most = 5.0 * 33.0 + 3.0 * MODEL * high.max(-low);
            assert!(
                (row.max - high).abs() < most,
                "{}: {} {high}",
                row.section,
                row.max
            );
            assert!(
                (row.min - low).abs() < most,
                "{}: {} {low}",
                row.section,
                row.min
            );
            assert!(row.damage_low < row.damage && row.damage < row.damage_high);
        }
    }
    let mean = shares.iter().sum::<f64>() / shares.len() as f64;
    println!(
        "mean share within: {:.2} %, ratios whose interval contains 1: {ratios} of 8",
        100.0 * mean
    );
    assert!((0.93..=0.97).contains(&mean), "{mean}");
    assert!(ratios >= 7, "{ratios}");
}
