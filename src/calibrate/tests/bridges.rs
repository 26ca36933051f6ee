//! Two measured county bridges under a truck of known weight (`shared/bridges`). Half of the runs are calibration runs, and the other runs are
//! weighed.

use crate::calibrate::*;
use crate::recovery::{ErrorModel, Readings, recover};
use crate::sensitivity::Load;
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::path::{Path, PathBuf};

/// Weight of the truck, kN.
const TRUCK: f64 = 219.386;
/// Noise of a channel over one second, strain (README of the data).
const NOISE: f64 = 0.03e-6;

struct Bridge {
    gauges: Vec<String>,
    lanes: Vec<String>,
    /// Name, lane, strain.
    runs: Vec<(String, usize, Vec<f64>)>,
}

fn find_bridge_file(path: &str) -> Option<PathBuf> {
    crate::support::find_shared_path(&format!("bridges/{path}"))
}

/// Cells of a table by row; quoted commas inside notes are respected.
fn cells(path: &Path) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(path).unwrap();
    let split = |line: &str| {
        let (mut out, mut quoted) = (vec![String::new()], false);
        for c in line.chars() {
            match c {
                '"' => quoted = !quoted,
                ',' if !quoted => out.push(String::new()),
                c => out.last_mut().unwrap().push(c),
            }
        }
        out
    };
    text.lines().map(split).collect()
}

/// Returns the runs that `keep` selects by the columns quality and fit_for_weighing.
fn bridge(name: &str, keep: impl Fn(&str, &str) -> bool) -> Option<Bridge> {
    let runs = cells(&find_bridge_file(&format!("{name}/runs.csv"))?);
    let peaks = cells(&find_bridge_file(&format!("{name}/peaks.csv"))?);
    let column = |n: &str| runs[0].iter().position(|h| h == n);
    let (lane, quality, fit, truck) = (
        column("lane")?,
        column("quality"),
        column("fit_for_weighing"),
        column("truck_kN")?,
    );
    let mut lanes: Vec<String> = runs[1..]
        .iter()
        .map(|r| r[lane].clone())
        .filter(|l| !l.is_empty())
        .collect();
    lanes.sort();
    lanes.dedup();
    let strain = |run: &str| -> Vec<f64> {
        let row = peaks.iter().find(|p| p[0] == run).unwrap();
        row[1..]
            .iter()
            .map(|v| v.parse::<f64>().map_or(f64::NAN, |x| x * 1e-6))
            .collect()
    };
    let word = |r: &[String], c: Option<usize>| c.map_or(String::new(), |c| r[c].clone());
    let kept = runs[1..]
        .iter()
        .filter(|r| !r[truck].is_empty() && keep(&word(r, quality), &word(r, fit)));
    Some(Bridge {
        gauges: peaks[0][1..].to_vec(),
        runs: kept
            .map(|r| {
                (
                    r[0].clone(),
                    lanes.iter().position(|l| *l == r[lane]).unwrap(),
                    strain(&r[0]),
                )
            })
            .collect(),
        lanes,
    })
}

fn task(b: &Bridge, teach: &[usize]) -> Task {
    let k = b.lanes.len();
    let known = |i: &usize| {
        let (run, lane, strain) = &b.runs[*i];
        KnownRun {
            run: run.clone(),
            strain: strain.clone(),
            noise_factor: 1.0,
            loads: KnownLoads::from_exact(
                (0..k)
                    .map(|l| if l == *lane { TRUCK } else { 0.0 })
                    .collect(),
            ),
            group: *lane,
        }
    };
    Task {
        gauges: b.gauges.clone(),
        loads: b.lanes.iter().map(Load::from_name).collect(),
        noise: NOISE,
        model: None,
        runs: teach.iter().map(known).collect(),
        sums: vec![vec![1.0; k]],
        common_zero: CommonZero::None,
        scale_sd: 0.0,
        gauge_noise: None,
    }
}

/// Results of weighing the other half of the runs.
#[derive(Default)]
struct WeighingResults {
    /// Error over the true total.
    errors: Vec<f64>,
    /// Half width of the 95 % interval over the true total.
    halves: Vec<f64>,
    held: usize,
    /// Runs whose largest recovered load is not the load of their lane.
    wrong_lanes: Vec<String>,
    /// Runs among `wrong_lanes` without a finding, with at least one interval that does not contain its load.
    unreported: Vec<String>,
    /// Runs in the right lane with a finding that they have several loads at once.
    alarms: usize,
}

/// Weighs half of the runs with a calibration from the other half. Each seed draws the halves at random within each lane.
fn weigh(name: &str, seeds: std::ops::Range<u64>) -> Option<WeighingResults> {
    let b = bridge(name, |_, fit| fit == "1")?;
    let k = b.lanes.len();
    let mut out = WeighingResults::default();
    for seed in seeds {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let (mut teach, mut test): (Vec<usize>, Vec<usize>) = (Vec::new(), Vec::new());
        for lane in 0..k {
            let mut list: Vec<usize> = (0..b.runs.len()).filter(|i| b.runs[*i].1 == lane).collect();
            list.shuffle(&mut random);
            let half = list.len().div_ceil(2);
            teach.extend_from_slice(&list[..half]);
            test.extend_from_slice(&list[half..]);
        }
        let c = calibrate(&task(&b, &teach)).unwrap();
        let factors: Vec<f64> = test.iter().map(|_| random.random_range(0.5..1.4)).collect();
        let readings: Vec<Readings> = test
            .iter()
            .zip(&factors)
            .map(|(i, x)| Readings {
                run: b.runs[*i].0.clone(),
                strain: b.runs[*i].2.iter().map(|v| v * x).collect(),
                noise_factor: 1.0,
            })
            .collect();
        let errors = ErrorModel {
            noise: NOISE,
            model_rel: 0.0,
        };
        let found = recover(&c.sensitivity, &readings, errors);
        for ((i, x), r) in test.iter().zip(&factors).zip(&found.runs) {
            let e = &r.estimate;
            let total: f64 = e.values.iter().sum();
            let half = e.coverage_factor * e.covariance.iter().sum::<f64>().sqrt();
            let truth = TRUCK * x;
            out.errors.push((total - truth) / truth);
            out.halves.push(half / truth);
            out.held += usize::from((total - truth).abs() <= half);
            let lane = (0..k)
                .max_by(|a, b| e.values[*a].total_cmp(&e.values[*b]))
                .unwrap();
            let name = &b.runs[*i].0;
            let mut findings_of_run = found.findings.iter().filter(|f| f.subject == *name);
            if lane == b.runs[*i].1 {
                out.alarms +=
                    usize::from(findings_of_run.any(|f| f.code == "loads-unlike-calibration-runs"));
                continue;
            }
            out.wrong_lanes.push(name.clone());
            let holds = |l: usize| {
                let load = if l == b.runs[*i].1 { truth } else { 0.0 };
                (e.values[l] - load).abs() <= e.coverage_factor * e.sigma(l)
            };
            if findings_of_run.next().is_none() && !(0..k).all(holds) {
                out.unreported.push(name.clone());
            }
        }
    }
    Some(out)
}

fn mean_sd(v: &[f64]) -> (f64, f64) {
    let n = v.len() as f64;
    let mean = v.iter().sum::<f64>() / n;
    (
        mean,
        (v.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt(),
    )
}

fn median(v: &[f64]) -> f64 {
    let mut sorted = v.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

#[test]
fn half_of_the_runs_at_ponca_calibrate_to_weigh_the_others_within_their_intervals() {
    let Some(w) = weigh("ponca", 0..20) else {
        return;
    };
    let (_, sd) = mean_sd(&w.errors);
    // Limits of the protocol over twenty splits: nine of ten 95 % intervals contain the load, half width 9 %, scatter 4 %.
    assert!(
        w.held as f64 >= 0.9 * w.errors.len() as f64,
        "{} of {}",
        w.held,
        w.errors.len()
    );
    assert!(
        median(&w.halves) < 0.09 && sd < 0.04,
        "{} {sd}",
        median(&w.halves)
    );
    assert!(w.wrong_lanes.is_empty(), "{:?}", w.wrong_lanes);
}

/// Sixty other splits. The residuals of some runs at 30 and 45 mph are far larger than the scatter of the calibration. The known scatter must still
/// identify their lane.
#[test]
fn runs_that_scatter_more_than_calibration_runs_are_weighed_in_their_lane() {
    let Some(w) = weigh("ponca", 20..80) else {
        return;
    };
    eprintln!(
        "{} of {} held, wrong lanes {:?}, unreported {:?}, {} alarms",
        w.held,
        w.errors.len(),
        w.wrong_lanes,
        w.unreported,
        w.alarms
    );
    assert!(w.held as f64 >= 0.93 * w.errors.len() as f64);
    // The scatter of trucks has longer tails than a Gaussian. Fifteen in a thousand runs in their lane are reported, although the limit is for one.
    assert!(100 * w.alarms <= 2 * w.errors.len(), "{}", w.alarms);
    // One of 900 runs in the splits of the program's own trials is just within the limit.
    assert!(w.unreported.len() <= 1, "{:?}", w.unreported);
    // The strain of R29 and R31 (30 mph, middle, going north) is between two lanes if only runs going south calibrate the middle.
    let others = w.wrong_lanes.iter().filter(|r| *r != "R29" && *r != "R31");
    // One in a hundred of the other runs may have a wrong lane, the rate of false alarms that other tests allow.
    assert!(
        100 * others.count() <= w.errors.len(),
        "{:?}",
        w.wrong_lanes
    );
}

#[test]
fn half_of_the_runs_at_ashland_calibrate_to_weigh_the_others_within_their_intervals() {
    let Some(w) = weigh("ashland", 0..20) else {
        return;
    };
    // Limits of the protocol: nine of ten intervals contain the load, half width 20 %, scatter 7 %.
    assert!(
        w.held as f64 >= 0.9 * w.errors.len() as f64,
        "{} of {}",
        w.held,
        w.errors.len()
    );
    assert!(median(&w.halves) < 0.2, "{}", median(&w.halves));
    // R51 ran between two lanes (README of the data). It is the only run with a wrong lane.
    assert!(
        w.wrong_lanes.iter().all(|r| r == "R51"),
        "{:?}",
        w.wrong_lanes
    );
    // The scatter includes R51, which no column of S describes.
    let (_, sd) = mean_sd(&w.errors);
    assert!(sd <= 0.07, "{sd}");
}

#[test]
fn a_wrong_lane_and_loggers_tared_under_load_are_identified() {
    let Some(b) = bridge("ponca", |_, _| true) else {
        return;
    };
    let all: Vec<usize> = (0..b.runs.len()).collect();
    let c = calibrate(&task(&b, &all)).unwrap();
    let wrong: Vec<&str> = c.refused.iter().map(|r| b.runs[*r].0.as_str()).collect();
    assert_eq!(wrong, ["R39"]);
    let findings_of_run = c.findings.iter().find(|f| f.subject == "R39").unwrap();
    assert!(
        findings_of_run
            .message
            .contains("the stated load is `east`, and the strain fits `middle`"),
        "{}",
        findings_of_run.message
    );
    let b = bridge("ashland", |_, _| true).unwrap();
    let all: Vec<usize> = (0..b.runs.len()).collect();
    let c = calibrate(&task(&b, &all)).unwrap();
    for run in ["R38", "R39", "R51"] {
        assert!(c.findings.iter().any(|f| f.subject == run), "{run}");
    }
}

/// Returns the findings on gauges when the test runs of a planted case are weighed with its calibration runs.
fn check_planted_case(case: &str) -> Option<(Vec<String>, Vec<String>)> {
    let folder = format!("planted/{case}");
    find_bridge_file(&format!("{folder}/truth.json"))?;
    let b = bridge(&folder, |_, _| true)?;
    let roles = cells(&find_bridge_file(&format!("{folder}/runs.csv"))?);
    let role = roles[0].iter().position(|h| h == "role")?;
    let teaches = |i: &usize| {
        roles
            .iter()
            .any(|r| r[0] == b.runs[*i].0 && r[role] == "calibration")
    };
    let (teach, test): (Vec<usize>, Vec<usize>) = (0..b.runs.len()).partition(teaches);
    let c = calibrate(&task(&b, &teach)).unwrap();
    let readings: Vec<Readings> = test
        .iter()
        .map(|i| Readings {
            run: b.runs[*i].0.clone(),
            strain: b.runs[*i].2.clone(),
            noise_factor: 1.0,
        })
        .collect();
    let errors = ErrorModel {
        noise: NOISE,
        model_rel: 0.0,
    };
    let found = recover(&c.sensitivity, &readings, errors);
    let gauges = found
        .findings
        .iter()
        .filter(|f| f.code.starts_with("gauge") || f.code.starts_with("input"));
    Some(
        gauges
            .map(|f| (f.code.to_owned(), f.subject.clone()))
            .unzip(),
    )
}

#[test]
fn planted_faults_of_gauges_are_named_and_controls_stay_clean() {
    for (case, code, subject) in [
        ("case02", "inputs-exchanged", ["B5411", "B7059"].as_slice()),
        ("case03", "input-sign-reversed", &["B7060"]),
        ("case04", "gauge-suspect", &["B5412"]),
        ("case06", "gauge-dead", &["B7031"]),
        ("case07", "inputs-exchanged", &["B5406", "B5381"]),
    ] {
        let Some((codes, subjects)) = check_planted_case(case) else {
            return;
        };
        assert_eq!(
            codes.first().map(String::as_str),
            Some(code),
            "{case}: {codes:?} {subjects:?}"
        );
        assert!(
            subject.iter().all(|s| subjects[0].contains(s)),
            "{case}: {subjects:?}"
        );
    }
    // Peaks do not show the fault in two of the cases. In case 08 the gauge drifts by 20 microstrain over each record. At the peaks, minus the zero
    // of each record, the other gauges predict its reading to 1 % (-1.6 +- 7.9 microstrain). In case 09 the gauge reads 0.7 of its true strain, which
    // is 0.96 of the prediction from the other gauges. In other cases at Ponca, where this gauge is sound, it reads 0.93 to 1.47 of the prediction.
    // These cases must not blame another gauge.
    for case in ["case01", "case05", "case08", "case09", "case10"] {
        let (codes, subjects) = check_planted_case(case).unwrap();
        assert!(codes.is_empty(), "{case}: {codes:?} {subjects:?}");
    }
}

/// Fault of one or two gauges in the readings of consecutive runs.
#[derive(Clone, Copy, Debug, PartialEq)]
enum PlantedFault {
    Nothing,
    Exchanged,
    Turned,
    /// The gauge reads 0.7 of the true strain.
    Weak,
    /// The zero of the gauge drifts by 20 microstrain from the first run to the last.
    Drifting,
    /// Noise alone from the middle run on.
    Dead,
}

/// Calibrates with half of the complete runs of a bridge and recovers the other half with a fault at some gauges. These gauges are drawn from the
/// gauges that read a fifth of the largest strain. Returns the gauges at fault and the reported gauges.
fn with_fault(b: &Bridge, planted: PlantedFault, seed: u64) -> (Vec<String>, Vec<String>) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let whole = |i: &usize| b.runs[*i].2.iter().all(|v| v.is_finite());
    let (mut teach, mut test): (Vec<usize>, Vec<usize>) = (Vec::new(), Vec::new());
    for lane in 0..b.lanes.len() {
        let of_lane = |i: &usize| b.runs[*i].1 == lane && whole(i);
        let mut list: Vec<usize> = (0..b.runs.len()).filter(of_lane).collect();
        list.shuffle(&mut random);
        let half = list.len().div_ceil(2);
        teach.extend_from_slice(&list[..half]);
        test.extend_from_slice(&list[half..]);
    }
    test.sort_unstable();
    let n = b.gauges.len();
    let size = |g: &usize| {
        let all = b.runs.iter().map(|r| r.2[*g].abs());
        all.filter(|v| v.is_finite()).fold(0.0, f64::max)
    };
    let most = (0..n).map(|g| size(&g)).fold(0.0, f64::max);
    let mut pool: Vec<usize> = (0..n).filter(|g| size(g) > 0.2 * most).collect();
    pool.shuffle(&mut random);
    let (g, h) = (pool[0], pool[1]);
    let last = (test.len() - 1) as f64;
    let read = |(at, i): (usize, &usize)| {
        let mut strain = b.runs[*i].2.clone();
        match planted {
            PlantedFault::Nothing => {}
            PlantedFault::Exchanged => strain.swap(g, h),
            PlantedFault::Turned => strain[g] *= -1.0,
            PlantedFault::Weak => strain[g] *= 0.7,
            PlantedFault::Drifting => strain[g] += 20e-6 * at as f64 / last,
            PlantedFault::Dead if 2 * at >= test.len() => {
                strain[g] = NOISE * (0.7 - (at % 3) as f64)
            }
            PlantedFault::Dead => {}
        }
        Readings {
            run: b.runs[*i].0.clone(),
            strain,
            noise_factor: 1.0,
        }
    };
    let readings: Vec<Readings> = test.iter().enumerate().map(read).collect();
    let c = calibrate(&task(b, &teach)).unwrap();
    let errors = ErrorModel {
        noise: NOISE,
        model_rel: 0.0,
    };
    let found = recover(&c.sensitivity, &readings, errors).findings;
    let named = found
        .iter()
        .filter(|f| f.code.starts_with("gauge") || f.code.starts_with("input"));
    let named = named.flat_map(|f| f.subject.split(", ").map(str::to_owned));
    let faulty = match planted {
        PlantedFault::Nothing => Vec::new(),
        PlantedFault::Exchanged => vec![b.gauges[g].clone(), b.gauges[h].clone()],
        _ => vec![b.gauges[g].clone()],
    };
    (faulty, named.collect())
}

/// Each bridge has five trials of each fault and ten without a fault. With `STRAINBRIDGE_TRIALS=20` it has twenty and forty.
#[test]
fn faults_at_gauges_drawn_at_random_are_named_and_sound_gauges_are_not() {
    use PlantedFault::*;
    let asked: u64 = std::env::var("STRAINBRIDGE_TRIALS").map_or(5, |t| t.parse().unwrap());
    for name in ["ponca", "ashland"] {
        let Some(b) = bridge(name, |_, fit| fit == "1") else {
            return;
        };
        let mut blamed = Vec::new();
        for planted in [Nothing, Exchanged, Turned, Weak, Drifting, Dead] {
            let trials = if planted == Nothing { 2 * asked } else { asked };
            let mut hits = 0;
            for seed in 0..trials {
                let (faulty, named) = with_fault(&b, planted, 1000 + seed);
                hits += u64::from(named.first().is_some_and(|g| faulty.contains(g)));
                let sound = named.into_iter().filter(|g| !faulty.contains(g));
                blamed.extend(sound.map(|g| (planted, seed, g)));
            }
            eprintln!("{name}, {planted:?}: {hits} of {trials} named");
            // A reversed gauge is wrong by twice its strain, a hundred times the scatter of repeats.
            assert!(planted != Turned || hits + 1 >= trials, "{name}: {hits}");
        }
        eprintln!("{name}: blamed {blamed:?}");
        // The allowed rate is one in a hundred of `7 * asked` trials. The limit is exceeded with a chance of one in twenty.
        assert!(blamed.len() as u64 <= 1 + asked / 10, "{name}: {blamed:?}");
    }
}
