//! Intervals on a structure with supports in its deck. The built-in solver computes S, and 2,000 seeded trials use runs
//! and samples.

use crate::drawn::Numbers;
use std::fmt::Write;
use strainbridge::host::context::InMemory;
use strainbridge::recovery::history::{Filter, SampleLoads};
use strainbridge::recovery::{ErrorModel, Readings, Sums, recover};
use strainbridge::sensitivity::Sensitivity;
use strainbridge::{Context, Job};

const TRIALS: usize = 2000;
/// Numbers of 10 mm squares along and across the plate, which is fixed along its short edge.
const LONG: usize = 12;
const WIDE: usize = 3;

fn grid(i: usize, j: usize) -> usize {
    1 + i * (WIDE + 1) + j
}

pub(super) fn deck() -> String {
    let mut text =
        "SOL 101\nCEND\nSPC = 1\nBEGIN BULK\nMAT1,1,2.1+5,,.3,7.85-9\nPSHELL,1,1,4.,1,,1\n"
            .to_owned();
    for i in 0..=LONG {
        for j in 0..=WIDE {
            let _ = writeln!(text, "GRID,{},,{}.,{}.,0.", grid(i, j), 10 * i, 10 * j);
        }
    }
    for i in 0..LONG {
        for j in 0..WIDE {
            let corners = [
                grid(i, j),
                grid(i + 1, j),
                grid(i + 1, j + 1),
                grid(i, j + 1),
            ];
            let [a, b, c, d] = corners;
            let _ = writeln!(text, "CQUAD4,{},1,{a},{b},{c},{d}", 1 + i * WIDE + j);
        }
    }
    let _ = writeln!(text, "SPC1,1,123456,1,THRU,{}\nENDDATA", 1 + WIDE);
    text
}

pub(super) fn job() -> String {
    let mut text =
        "units = \"mm-t-s\"\n[model]\ndeck = \"plate.bdf\"\nmesh_error = false\n".to_owned();
    for (name, at, component) in [
        ("tip", grid(LONG, 1), "FZ"),
        ("corner", grid(LONG, WIDE), "FZ"),
        ("middle", grid(LONG / 2, 1), "FZ"),
        ("pull", grid(LONG, 2), "FX"),
    ] {
        let _ = writeln!(
            text,
            "[[load]]\nname = \"{name}\"\ngrid = {at}\ncomponent = \"{component}\"\nexpected = 50.0"
        );
    }
    for g in 0..9 {
        let (element, surface) = (2 + 4 * g, ["top", "bottom"][g % 2]);
        let (x, y) = [(1, 0), (0, 1), (1, 1)][g % 3];
        let _ = writeln!(
            text,
            "[[gauge]]\nname = \"G{g}\"\nelement = {element}\nsurface = \"{surface}\"\ndirection = [{x}, {y}, 0]"
        );
    }
    text
}

fn trials(s: &Sensitivity, errors: ErrorModel) -> Vec<(Vec<f64>, Vec<f64>)> {
    let mut numbers = Numbers(19);
    let trial = |_| {
        let f: Vec<f64> = s
            .loads
            .iter()
            .map(|_| 50.0 * numbers.draw_normal())
            .collect();
        let strain = s.values.row_iter().map(|row| {
            let own: f64 = row.iter().zip(&f).map(|(s, f)| s * f).sum();
            own + errors.noise * numbers.draw_normal()
        });
        let strain = strain.collect();
        (f, strain)
    };
    (0..TRIALS).map(trial).collect()
}

#[test]
fn intervals_on_a_supported_structure_cover() {
    let files = InMemory::default()
        .with_file("plate.bdf", deck())
        .with_file("job.toml", job());
    let cx = Context::new(&files);
    let job = Job::read("job.toml", &files).unwrap_or_else(|f| panic!("{f:?}"));
    let sensed = strainbridge::sensitivity(&job, &cx).unwrap_or_else(|f| panic!("{f:?}"));
    let s = &sensed.prepared.sensitivity;
    // On its support, one load bends the plate with the stress F L over the section modulus. With inertia relief it
    // would not.
    let root = s.gauges.iter().position(|g| g == "G0").unwrap();
    let bending = 6.0 * (10.0 * LONG as f64 - 5.0) / (10.0 * WIDE as f64 * 16.0) / 2.1e5;
    let got = s.values[(root, 0)].abs();
    assert!((got / bending - 1.0).abs() < 0.2, "{got} against {bending}");
    let errors = ErrorModel {
        noise: 1e-6,
        model_rel: 0.0,
    };
    let trials = trials(s, errors);
    let held = |covered: usize| covered as f64 / (TRIALS * s.loads.len()) as f64;
    let mut covered = 0;
    for (f, strain) in &trials {
        let readings = Readings {
            run: "R".into(),
            strain: strain.clone(),
            noise_factor: 1.0,
        };
        let got = recover(s, &[readings], errors);
        for (l, f) in f.iter().enumerate() {
            let [low, high] = got.runs[0].estimate.interval(l);
            covered += usize::from(low <= *f && *f <= high);
        }
    }
    let runs = held(covered);
    let (n, k) = (s.gauges.len(), s.loads.len());
    let judged: Vec<Readings> = trials
        .iter()
        .step_by(10)
        .map(|t| Readings {
            run: "t".into(),
            strain: t.1.clone(),
            noise_factor: 1.0,
        })
        .collect();
    let judged = recover(s, &judged, errors);
    let filter = Filter::new(
        s,
        vec![0.0; n],
        errors,
        1.0,
        &judged.typical,
        judged.widening,
    )
    .unwrap();
    let samples: Vec<f64> = trials.iter().flat_map(|t| t.1.clone()).collect();
    let (mut out, mut sums) = (SampleLoads::default(), Sums::new(n, k));
    filter.apply(&samples, 1.0, &mut out, &mut sums);
    covered = 0;
    for ((f, _), got) in trials.iter().zip(out.values.chunks_exact(k)) {
        let sigma = filter.sigma(got);
        let half = sigma.iter().map(|s| filter.coverage_factor() * s);
        covered += f
            .iter()
            .zip(got)
            .zip(half)
            .filter(|((f, got), half)| (*f - *got).abs() <= *half)
            .count();
    }
    let samples = held(covered);
    println!(
        "on a support: {:.1} % of runs, {:.1} % of samples",
        100.0 * runs,
        100.0 * samples
    );
    // 8,000 intervals determine the share within .25 %.
    for share in [runs, samples] {
        assert!(
            (0.935..=0.965).contains(&share),
            "runs {runs}, samples {samples}"
        );
    }
}

/// Returns a record of 2,000 samples at 1 kHz. The tip load has 100 Hz, the corner load 7 Hz. `change` alters the
/// readings of a sample.
fn record(change: impl Fn(&mut [f64])) -> InMemory {
    let files = InMemory::default()
        .with_file("plate.bdf", deck())
        .with_file("job.toml", job());
    let read = Job::read("job.toml", &files).unwrap_or_else(|f| panic!("{f:?}"));
    let sensed =
        strainbridge::sensitivity(&read, &Context::new(&files)).unwrap_or_else(|f| panic!("{f:?}"));
    let s = &sensed.prepared.sensitivity;
    let mut numbers = Numbers(23);
    let mut table = format!("time,{}\n", s.gauges.join(","));
    for i in 0..2000 {
        let t = f64::from(i) / 1000.0;
        let wave = |hz: f64| 50.0 * (std::f64::consts::TAU * hz * t).sin();
        let f = [wave(100.0), wave(7.0), 0.5 * wave(3.0), wave(1.0)];
        let made = s.values.row_iter().map(|row| {
            let own: f64 = row.iter().zip(&f).map(|(s, f)| s * f).sum();
            1e6 * own + numbers.draw_normal()
        });
        let mut readings: Vec<f64> = made.collect();
        change(&mut readings);
        let _ = write!(table, "{t:.3}");
        for v in readings {
            let _ = write!(table, ",{v:.4}");
        }
        table.push('\n');
    }
    let measured = "[measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 1.0\nmodel_uncertainty_rel = 0.01\n";
    files
        .with_file("job.toml", job() + measured)
        .with_file("strain.csv", table)
}

#[test]
fn content_is_held_against_the_mode_of_the_structure_as_it_is_held() {
    let files = record(|_| {});
    let job = Job::read("job.toml", &files).unwrap_or_else(|f| panic!("{f:?}"));
    let got =
        strainbridge::recover(&job, &Context::new(&files)).unwrap_or_else(|f| panic!("{f:?}"));
    let found: Vec<_> = got
        .findings
        .iter()
        // The other loads contain only noise at high frequencies.
        .filter(|f| f.code == "content-near-first-mode" && f.subject == "load `tip`")
        .collect();
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].message.contains("held by SPC set 1"), "{found:?}");
    assert!(!found[0].message.contains("free"), "{found:?}");
    // The first bending frequency of a cantilever is 3.516 / (2 pi) sqrt(E I / (m L^4)). A plate with a width of a
    // third of its length is close to it.
    let bends = 3.516 / std::f64::consts::TAU * 4.0 / 12.0_f64.sqrt()
        * (2.1e5_f64 / 7.85e-9).sqrt()
        / (10.0 * LONG as f64).powi(2);
    let limit = found[0].limit.unwrap();
    assert!((3.0 * limit / bends - 1.0).abs() < 0.1, "{limit} {bends}");
}

#[test]
fn a_gauge_with_reversed_sign_is_reported_first_and_no_finding_lists_thousands() {
    let files = record(|y| y[3] = -y[3]);
    let job = Job::read("job.toml", &files).unwrap_or_else(|f| panic!("{f:?}"));
    let got =
        strainbridge::recover(&job, &Context::new(&files)).unwrap_or_else(|f| panic!("{f:?}"));
    let first = got.findings.first().unwrap();
    assert_eq!(
        (first.code, first.subject.as_str()),
        ("input-sign-reversed", "G3")
    );
    let unexplained = got
        .findings
        .iter()
        .find(|f| f.code == "strain-not-explained");
    let unexplained = unexplained.unwrap();
    // The subject gives a few samples, or states that all are affected.
    assert!(unexplained.subject.len() < 150, "{}", unexplained.subject);
    for f in got.findings.iter() {
        assert!(f.subject.len() + f.message.len() < 1000, "{f:?}");
    }
}
