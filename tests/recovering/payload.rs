//! Payloads with a calibrated S.
//!
//! The intervals have the right coverage over many calibrations. Weight and place agree with `recover` on the same
//! strain.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::fmt::Write;
use strainbridge::calibrate::{CommonZero, KnownLoads, KnownRun, Task, calibrate};
use strainbridge::host::context::InMemory;
use strainbridge::linalg::Matrix;
use strainbridge::payload::{PayloadModel, PayloadRun, Place, WeighSpec, weigh};
use strainbridge::recovery::{ErrorModel, Readings, recover};
use strainbridge::sensitivity::{Load, Sensitivity};
use strainbridge::{Context, Job};

const NOISE: f64 = 0.5e-6;
/// Scatter of each gauge in a run.
///
/// If the gauges scatter together, a dozen runs of eight gauges estimate the covariance too inaccurately. The coverage
/// of `recover` and `payload` is then 91 %.
const SCATTER: f64 = 0.03;

/// Microstrain per kN, and per kN m of shift.
const ROWS: [[f64; 2]; 8] = [
    [3.1, 1.2],
    [2.4, -0.9],
    [1.9, 1.5],
    [2.8, -1.6],
    [0.8, 1.1],
    [1.2, -0.7],
    [3.5, 0.4],
    [0.6, -0.8],
];

struct Lot(ChaCha8Rng);

impl Lot {
    fn draw_normal(&mut self) -> f64 {
        let u: f64 = self.0.random_range(1e-12..1.0);
        let v: f64 = self.0.random_range(0.0..1.0);
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }

    fn strain(&mut self, f: [f64; 2]) -> Vec<f64> {
        let one = |row: &[f64; 2]| {
            let clean = 1e-6 * (row[0] * f[0] + row[1] * f[1]);
            clean * (1.0 + SCATTER * self.draw_normal()) + NOISE * self.draw_normal()
        };
        ROWS.iter().map(one).collect()
    }

    /// Returns the weight in kN and its shift in m.
    fn payload(&mut self) -> [f64; 2] {
        [
            self.0.random_range(20.0..100.0),
            self.0.random_range(-2.0..2.0),
        ]
    }
}

/// Returns S calibrated with a dozen payloads. `loads` is the number of loads, one or two.
fn calibrate_sensitivity(lot: &mut Lot, loads: usize) -> Sensitivity {
    let runs = (0..12).map(|i| {
        let [weight, x] = lot.payload();
        let x = if loads == 1 { 0.0 } else { x };
        let f = [weight, weight * x];
        KnownRun {
            run: format!("R{i}"),
            strain: lot.strain(f),
            noise_factor: 1.0,
            loads: KnownLoads::from_exact(f[..loads].to_vec()),
            group: i,
        }
    });
    let task = Task {
        gauges: (0..ROWS.len()).map(|g| format!("G{g}")).collect(),
        loads: ["payload", "payload.MY"][..loads]
            .iter()
            .map(|name| Load::from_name(*name))
            .collect(),
        noise: NOISE,
        model: None,
        runs: runs.collect(),
        sums: Vec::new(),
        common_zero: CommonZero::None,
        scale_sd: 0.0,
        gauge_noise: None,
    };
    calibrate(&task).unwrap().sensitivity
}

fn model(s: &Sensitivity) -> PayloadModel {
    let loads = s.loads.len();
    let column = |k: usize| if k < loads { (k, 1.0) } else { (0, 0.0) };
    let known = s.uncertainty.as_ref().unwrap();
    PayloadModel {
        gauges: s.gauges.clone(),
        wheels: Matrix::zeros(ROWS.len(), 0),
        payload: Matrix::from_fn(ROWS.len(), 3, |g, k| {
            if k < loads { s.values[(g, k)] } else { 0.0 }
        }),
        floor: Some(Matrix::zeros(0, 3)),
        arms: None,
        calibrated: Some(known.of_loads(&[column(0), column(1), column(2)])),
        noise: None,
    }
}

fn spec(s: &Sensitivity, place: Place) -> WeighSpec {
    WeighSpec {
        place,
        model_rel: s.relative_sd(),
        reaction_sigma: 1.0,
        largest: 1e5,
        region: Some([[-3.0, 3.0], [-1.0, 1.0]]),
    }
}

fn run(strain: Vec<f64>) -> PayloadRun {
    PayloadRun {
        run: "L1".to_owned(),
        sigma: vec![NOISE; strain.len()],
        strain,
        reactions: Vec::new(),
        shift: [0.0; 2],
    }
}

#[test]
fn intervals_of_payloads_hold_over_calibrations() {
    for (place, loads) in [(Place::Known, 1), (Place::Free, 2)] {
        let mut lot = Lot(ChaCha8Rng::seed_from_u64(1));
        let (mut held, mut held_place, trials) = (0, 0, 600);
        for _ in 0..trials {
            let s = calibrate_sensitivity(&mut lot, loads);
            let [weight, x] = lot.payload();
            let x = if loads == 1 { 0.0 } else { x };
            let strain = lot.strain([weight, weight * x]);
            let found = weigh(&model(&s), &[run(strain)], &spec(&s, place));
            let w = &found.runs[0];
            held += usize::from(w.interval[0] <= weight && weight <= w.interval[1]);
            let half = strainbridge::estimate::student_95(w.dof) * w.shift_covariance[0].sqrt();
            held_place += usize::from((w.shift[0] - x).abs() <= half);
        }
        // The limit is 95 +- 3 %. It contains three standard errors of 600 trials, and the error of Student's factor
        // with few runs.
        let share = |n: usize| n as f64 / f64::from(trials);
        assert!((0.92..=0.98).contains(&share(held)), "{place:?} {held}");
        if place == Place::Free {
            // Near the zero of the gauges, the scatter is less than the calibration's mean over all places. The
            // coverage is therefore larger.
            assert!(share(held_place) >= 0.92, "{held_place}");
        }
    }
}

#[test]
fn weight_and_moment_have_the_sigma_of_recover_where_both_ask_the_same() {
    for (place, loads) in [(Place::Known, 1), (Place::Free, 2)] {
        let mut lot = Lot(ChaCha8Rng::seed_from_u64(2));
        for _ in 0..20 {
            let s = calibrate_sensitivity(&mut lot, loads);
            let [weight, x] = lot.payload();
            let x = if loads == 1 { 0.0 } else { x };
            let strain = lot.strain([weight, weight * x]);
            let found = weigh(&model(&s), &[run(strain.clone())], &spec(&s, place));
            let readings = [Readings {
                run: "L1".to_owned(),
                strain,
                noise_factor: 1.0,
            }];
            let errors = ErrorModel {
                noise: NOISE,
                model_rel: 0.0,
            };
            let recovered = recover(&s, &readings, errors);
            let (e, w) = (&recovered.runs[0].estimate, &found.runs[0]);
            // Sums of products in another order.
            let alike = |a: f64, b: f64| (a - b).abs() < 1e-9 * b.abs();
            assert!(alike(w.force, e.values[0]) && alike(w.sigma, e.sigma(0)));
            let [low, high] = e.interval(0);
            assert!(alike(w.interval[0], low) && alike(w.interval[1], high));
            if loads == 2 {
                assert!(alike(w.shift[0] * w.force, e.values[1]));
            }
        }
    }
}

/// Wheels at the corners of the plate.
const WHEELS: [(&str, u32); 4] = [("A", 10), ("B", 12), ("C", 210), ("D", 212)];

/// Returns a gauge along the plate, or at an angle to it.
fn gauge(name: &str, element: usize, surface: &str, angle_deg: u32) -> String {
    format!(
        "[[gauge]]\nname = \"{name}\"\nelement = {element}\nsurface = \"{surface}\"\ndirection = [1, 0, 0]\nangle_deg = {angle_deg}\n"
    )
}

/// Returns a plate of 20 by 2 with this density. The job has these loads, gauges and further lines, and reads `strain`.
fn plate_on_wheels(
    density: &str,
    (loads, gauges): (&[(&str, u32)], &str),
    more: &str,
    strain: &str,
) -> InMemory {
    let mut deck = "SOL 101\nCEND\nBEGIN BULK\n".to_owned();
    for i in 0..=20 {
        for (j, y) in [0.0, 1.0, 2.0].into_iter().enumerate() {
            let _ = writeln!(deck, "GRID,{},,{i}.,{y:?},0.", 10 * (i + 1) + j);
        }
    }
    for i in 0..20 {
        for j in 0..2 {
            let (a, b) = (10 * (i + 1) + j, 10 * (i + 2) + j);
            let id = 10 * (i + 1) + j;
            let _ = writeln!(deck, "CQUAD4,{id},1,{a},{b},{},{}", b + 1, a + 1);
        }
    }
    let _ = write!(
        deck,
        "PSHELL,1,1,.05,1,,1\nMAT1,1,2.+11,,.3,{density}\nENDDATA\n"
    );
    let mut job =
        "units = \"m-kg-s\"\n[model]\ndeck = \"deck.bdf\"\nmesh_error = false\nsupport = \"free\"\n".to_owned();
    for (name, grid) in loads {
        let _ = writeln!(
            job,
            "[[load]]\nname = \"{name}\"\ngrid = {grid}\ncomponent = \"FZ\""
        );
    }
    let _ = write!(
        job,
        "{gauges}[measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 0.5\n{more}"
    );
    InMemory::default()
        .with_file("deck.bdf", deck)
        .with_file("job.toml", job)
        .with_file("strain.csv", strain)
}

/// The readings limit the payload. The mass of the model does not.
#[test]
fn a_payload_of_many_times_the_mass_of_the_model_is_weighed() {
    let strain = "run,TOP,BOTTOM\nR1,-50,50\nR2,-500,500\nR3,-750,750\n";
    let weights = |density: &str| -> Vec<f64> {
        let loads = [&WHEELS[..], &[("P", 111)]].concat();
        let gauges = gauge("TOP", 90, "top", 0) + &gauge("BOTTOM", 90, "bottom", 0);
        let more = "[payload]\ngrid = 111\n";
        let files = plate_on_wheels(density, (&loads, &gauges), more, strain);
        let job = Job::read("job.toml", &files).unwrap();
        let found = strainbridge::payload(&job, &Context::new(&files)).unwrap();
        let runs = found.weighing.runs.iter();
        runs.inspect(|r| assert_eq!(r.refused, None, "{}", r.run))
            .map(|r| r.force)
            .collect()
    };
    let (heavy, light) = (weights("7800."), weights(".1"));
    // The mass of the light plate is 0.2 kg.
    assert!(light[2] > 100.0 * 0.2 * 9.81, "{light:?}");
    for (run, size) in [1.0, 10.0, 15.0].into_iter().enumerate() {
        let (expected, found) = (size * heavy[0], light[run]);
        assert!((found / expected - 1.0).abs() < 3e-3, "{found} {expected}");
        assert!((heavy[run] / found - 1.0).abs() < 1e-6, "{found}");
    }
}

/// The total loads of a model on its wheels add up to its weight, not to zero.
#[test]
fn total_loads_are_compared_with_the_weight_of_the_model() {
    let places = [40, 41, 100, 101, 160, 161];
    let gauges = |angle: u32| places.map(|e| gauge(&format!("G{e}_{angle}"), e, "bottom", angle));
    let names = |angle: u32| places.map(|e| format!("G{e}_{angle}")).join(",");
    let unbalanced = |along: f64| -> Option<String> {
        let readings = format!("{},0,0,0,0,0,0", vec![along.to_string(); 6].join(","));
        let strain = format!("run,{},{}\nR1,{readings}\n", names(0), names(45));
        let gauges = gauges(0).concat() + &gauges(45).concat();
        let more = "reference = \"gravity\"\n";
        let files = plate_on_wheels("7800.", (&WHEELS, &gauges), more, &strain);
        let job = Job::read("job.toml", &files).unwrap();
        let found = strainbridge::recover(&job, &Context::new(&files)).unwrap();
        let mut findings = found.findings.iter();
        let balance = findings.find(|f| f.code == "loads-not-in-balance");
        balance.map(|f| f.message.clone())
    };
    assert_eq!(unbalanced(0.0), None);
    let words = unbalanced(2000.0).unwrap();
    assert!(words.contains("the weight of the model"), "{words}");
    // 7800 x 20 x 2 x .05 kg times standard gravity.
    assert!(words.contains("expected 152983.740"), "{words}");
}
