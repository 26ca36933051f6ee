//! `[dynamic]`: a beam excited near its first mode and between its first two modes, compared with the Euler-Bernoulli
//! beam.

use crate::drawn::Numbers;
use crate::in_fleet::{check_extremes, fleet_and_extremes};
use std::f64::consts::TAU;
use std::fmt::Write;
use strainbridge::host::context::InMemory;
use strainbridge::host::store::Memory;
use strainbridge::{Context, Job};

/// Number of elements along the beam.
const N: usize = 60;
const LENGTH: f64 = 2000.0;
/// Modulus E, second moment I, and mass per length, in the units mm, t, s.
const E: f64 = 210_000.0;
const I: f64 = 4000.0;
const LINE_MASS: f64 = 7.85e-9 * 200.0;
/// Elements with gauges, counted from the clamp.
const GAUGED: [usize; 3] = [3, 20, 40];
/// Sine components of the force at the tip: amplitude in N, and frequency divided by the first natural frequency. The
/// second natural frequency is at 6.27.
const PARTS: [[f64; 2]; 4] = [[10.0, 0.07], [6.0, 0.45], [3.0, 0.93], [8.0, 2.6]];
const RATE: f64 = 250.0;
const SAMPLES: usize = 5000;

fn deck() -> String {
    let mut text = String::from(
        "SOL 101\nCEND\nSPC = 1\nBEGIN BULK\nMAT1,1,210000.,,.3,7.85-9\nPBAR,2,1,200.,4000.,9000.,8000.\n,5.,0.\n",
    );
    for i in 0..=N {
        let _ = writeln!(
            text,
            "GRID,{},,{:.4},0.,0.",
            i + 1,
            LENGTH * i as f64 / N as f64
        );
    }
    for i in 1..=N {
        let _ = writeln!(text, "CBAR,{i},2,{i},{},0.,1.,0.", i + 1);
    }
    // Only the bending plane is free. No gauge here measures modes of the other plane or of torsion.
    text + "SPC1,1,123456,1\nENDDATA\n"
}

fn job(more: &str) -> String {
    job_of(&GAUGED, more)
}

fn job_of(gauged: &[usize], more: &str) -> String {
    let mut text = format!(
        "units = \"mm-t-s\"\n[model]\ndeck = \"beam.bdf\"\nmesh_error = false\n[[load]]\nname = \"tip\"\ngrid = {}\ncomponent = \"FY\"\nexpected = 10.0\n",
        N + 1
    );
    for e in gauged {
        let _ = writeln!(
            text,
            "[[gauge]]\nname = \"G{e}\"\nelement = {e}\npoint = \"C\"\nstation = 0.5"
        );
    }
    text + "[measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 0.2\nreference = \"none\"\n"
        + more
}

fn first_hz() -> f64 {
    (1.875_104_07 / LENGTH).powi(2) * (E * I / LINE_MASS).sqrt() / TAU
}

/// Returns the curvature at `x` under a tip force with the frequency `hz`, divided by the static curvature.
///
/// With `b^4 = m w^2 / (E I)` it follows from `w'''' = b^4 w`, clamped at 0, `E I w'''(L) = -F`, `w''(L) = 0`
/// (Timoshenko, Vibration Problems in Engineering, 1937, section 56).
fn curvature_amplification(x: f64, hz: f64) -> f64 {
    let b = ((TAU * hz).powi(2) * LINE_MASS / (E * I)).powf(0.25);
    let (l, y) = (b * LENGTH, b * x);
    let even = l.sin() + l.sinh();
    let odd = l.cos() + l.cosh();
    let shape = even * (y.cos() + y.cosh()) - odd * (y.sin() + y.sinh());
    shape / (2.0 * b * (1.0 + l.cos() * l.cosh())) / (LENGTH - x)
}

fn parts(t: f64, of_part: impl Fn(f64) -> f64) -> f64 {
    let part = |[size, share]: &[f64; 2]| {
        let hz = share * first_hz();
        size * of_part(hz) * (TAU * hz * t).sin()
    };
    PARTS.iter().map(part).sum()
}

/// Returns the deck of the beam and its strain record. The record is the static S of the deck times the dynamic
/// amplification in closed form.
fn record() -> InMemory {
    let files = InMemory::default()
        .with_file("beam.bdf", deck())
        .with_file("job.toml", job(""));
    let read = Job::read("job.toml", &files).unwrap_or_else(|f| panic!("{f:?}"));
    let sensed =
        strainbridge::sensitivity(&read, &Context::new(&files)).unwrap_or_else(|f| panic!("{f:?}"));
    let s = &sensed.prepared.sensitivity.values;
    let table = table(&GAUGED, s.as_slice(), SAMPLES, |_, x, t| {
        parts(t, |hz| curvature_amplification(x, hz))
    });
    files.with_file("strain.csv", table)
}

/// Returns a record of elements with gauges, with noise.
///
/// `strain` returns the strain of a gauge (by number) at `x` and a time, divided by the static strain for 1 N.
fn table(
    gauged: &[usize],
    s: &[f64],
    samples: usize,
    strain: impl Fn(usize, f64, f64) -> f64,
) -> String {
    let mut numbers = Numbers(11);
    let names: Vec<String> = gauged.iter().map(|e| format!("G{e}")).collect();
    let mut table = format!("time,{}\n", names.join(","));
    for i in 0..samples {
        let t = i as f64 / RATE;
        let _ = write!(table, "{t:.4}");
        for (g, e) in gauged.iter().enumerate() {
            let x = (*e as f64 - 0.5) * LENGTH / N as f64;
            let strain = 1e6 * s[g] * strain(g, x, t);
            match strain.is_finite() {
                true => {
                    let _ = write!(table, ",{:.5}", strain + 0.2 * numbers.draw_normal());
                }
                false => table.push(','),
            }
        }
        table.push('\n');
    }
    table
}

/// Returns the largest error of the recovered samples, their number, the share of intervals that contain the load, and
/// the codes of findings.
fn recover_record(files: InMemory, more: &str) -> (f64, usize, f64, Vec<&'static str>) {
    let files = files.with_file("job.toml", job(more));
    let job = Job::read("job.toml", &files).unwrap_or_else(|f| panic!("{f:?}"));
    let got =
        strainbridge::recover(&job, &Context::new(&files)).unwrap_or_else(|f| panic!("{f:?}"));
    let record = got.answer.record().unwrap();
    assert_eq!(record.motion.is_some(), !more.is_empty());
    let (mut worst, mut held, mut known) = (0.0_f64, 0, 0);
    for row in record.history.as_ref().unwrap().rows() {
        let Some([value, low, high]) = row.loads[0] else {
            continue;
        };
        let expected = parts(row.time, |_| 1.0);
        worst = worst.max((value - expected).abs());
        held += usize::from((low..=high).contains(&expected));
        known += 1;
    }
    let codes = got.findings.iter().map(|f| f.code).collect();
    (worst, known, held as f64 / known as f64, codes)
}

#[test]
fn a_beam_shaken_near_its_first_mode_gives_its_force_once_its_vibration_is_taken_out() {
    assert!((curvature_amplification(500.0, 1e-3) - 1.0).abs() < 1e-6);
    let files = record();
    let (worst, known, _, codes) = recover_record(files.clone(), "");
    // At .93 of the first natural frequency, strain is seven times the static strain, so 3 N read as 20 N. Beyond it
    // the sign is wrong.
    assert!(worst > 20.0, "{worst}");
    assert_eq!(known, SAMPLES);
    assert!(codes.contains(&"content-near-first-mode"), "{codes:?}");
    let up_to = 3.5 * first_hz();
    let dynamic = format!(
        "[dynamic]\nup_to_hz = {up_to:.4}\ndamping = 1e-5\nfrequency_uncertainty_rel = 0.001\n"
    );
    let (worst, known, held, codes) = recover_record(files, &dynamic);
    // The force is 27 N at most. Lumped masses of 60 elements change frequencies by about 1e-4, and the response at .93
    // by 15 times as much. 10 N give 59 microstrain at the clamp, so noise of .2 microstrain is .05 N.
    assert!(worst < 0.3, "{worst}");
    assert!(known > SAMPLES * 9 / 10 && known < SAMPLES, "{known}");
    assert!(held > 0.93, "{held}");
    assert!(codes.contains(&"vibration-removed"), "{codes:?}");
    let unwanted = [
        "content-near-first-mode",
        "content-beyond-band",
        "samples-with-gaps",
    ];
    assert!(codes.iter().all(|c| !unwanted.contains(c)), "{codes:?}");
}

#[test]
fn content_beyond_the_band_is_reported() {
    let dynamic = format!(
        "[dynamic]\nup_to_hz = {:.4}\ndamping = 1e-5\n",
        0.8 * first_hz()
    );
    // 3 N of 12 N are at .93 of the first natural frequency. That is more than a hundredth of the power.
    let (_, _, _, codes) = recover_record(record(), &dynamic);
    assert!(codes.contains(&"content-beyond-band"), "{codes:?}");
}

#[test]
fn what_dynamic_cannot_do_is_a_fault_of_its_line() {
    let fault = |files: InMemory, text: String| {
        let files = files.with_file("job.toml", text);
        let faults = match Job::read("job.toml", &files) {
            Ok(job) => strainbridge::recover(&job, &Context::new(&files))
                .map(|_| ())
                .unwrap_err(),
            Err(faults) => faults,
        };
        let first = faults.first().unwrap().clone();
        assert!(first.line.is_some(), "{first:?}");
        format!("{}: {}", first.field, first.wrong)
    };
    let files = record();
    let fast = fault(
        files.clone(),
        job("[dynamic]\nup_to_hz = 100.0\ndamping = 0.02\n"),
    );
    assert!(fast.contains("samples per second"), "{fast}");
    let bare = fault(files.clone(), job("[dynamic]\nup_to_hz = 10.0\n"));
    assert!(bare.starts_with("dynamic.damping"), "{bare}");
    let heavy = fault(
        files.clone(),
        job("[dynamic]\nup_to_hz = 10.0\ndamping = 2.0\n"),
    );
    assert!(heavy.starts_with("dynamic.damping"), "{heavy}");
    for wrong in [
        "\"guess\"",
        "[]",
        "[{ up_to_hz = 5.0, damping = 0.2 }, { up_to_hz = 4.0, damping = 0.02 }]",
        "[{ up_to_hz = 5.0, damping = 0.0 }]",
    ] {
        let text = format!("[dynamic]\nup_to_hz = 10.0\ndamping = {wrong}\n");
        let printed = fault(files.clone(), job(&text));
        assert!(printed.starts_with("dynamic.damping"), "{printed}");
    }
    let given = "units = \"mm-t-s\"\n[sensitivity]\nfile = \"S.csv\"\nper = { force = \"N\" }\n[measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 0.2\n\
                 [dynamic]\nup_to_hz = 10.0\ndamping = 0.02\n";
    let s = "gauge,tip\nG3,1.0\nG20,0.5\nG40,0.2\n".to_owned();
    let given = fault(files.with_file("S.csv", s), given.to_owned());
    assert!(given.contains("without a model"), "{given}");
}

/// Returns S of the elements with gauges, computed by the job.
fn compute_sensitivity(gauged: &[usize]) -> Vec<f64> {
    let files = InMemory::default()
        .with_file("beam.bdf", deck())
        .with_file("job.toml", job_of(gauged, ""));
    let job = Job::read("job.toml", &files).unwrap();
    let sensed = strainbridge::sensitivity(&job, &Context::new(&files)).unwrap();
    sensed.prepared.sensitivity.values.as_slice().to_vec()
}

/// Recovers a tip force and returns the share of intervals that contain it, the largest error, the mean half width, and
/// the codes.
///
/// `course` is the force over time. `strain` gives the strain of a gauge (by number) at `x` and a time, divided by the
/// static strain for 1 N.
fn recover_tip_force(
    gauged: &[usize],
    samples: usize,
    more: &str,
    course: impl Fn(f64) -> f64,
    strain: impl Fn(usize, f64, f64) -> f64,
) -> (f64, f64, f64, Vec<&'static str>) {
    let files = InMemory::default()
        .with_file("beam.bdf", deck())
        .with_file(
            "strain.csv",
            table(gauged, &compute_sensitivity(gauged), samples, strain),
        )
        .with_file("job.toml", job_of(gauged, more));
    let job = Job::read("job.toml", &files).unwrap();
    let got =
        strainbridge::recover(&job, &Context::new(&files)).unwrap_or_else(|f| panic!("{f:?}"));
    let record = got.answer.record().unwrap();
    let (mut worst, mut held, mut known, mut width) = (0.0_f64, 0, 0, 0.0);
    for row in record.history.as_ref().unwrap().rows() {
        let Some([value, low, high]) = row.loads[0] else {
            continue;
        };
        let expected = course(row.time);
        worst = worst.max((value - expected).abs());
        held += usize::from((low..=high).contains(&expected));
        width += 0.5 * (high - low);
        known += 1;
    }
    let codes = got.findings.iter().map(|f| f.code).collect();
    let known = f64::from(known);
    (held as f64 / known, worst, width / known, codes)
}

/// The first mode is at three times the upper limit of the band. Its response within the band is an eighth of the load.
#[test]
fn a_mode_beyond_the_band_is_taken_out_all_the_same() {
    let wave = |t: f64| 10.0 * (TAU * t).sin();
    let more = "[dynamic]\nup_to_hz = 1.07\ndamping = 0.005\n";
    let (held, worst, _, codes) = recover_tip_force(&[3], 5000, more, wave, |_, x, t| {
        curvature_amplification(x, 1.0) * wave(t)
    });
    assert!(held > 0.93, "{held} {worst}");
    assert!(worst < 0.1, "{worst}");
    assert!(!codes.contains(&"content-near-first-mode"), "{codes:?}");
    // Model and damping are exact, and frequencies are exact except for the mesh. The second mode leaves no residual
    // that would blame a gauge.
    let two = |t: f64| [5.0 * (TAU * 0.3 * t).sin(), 10.0 * (TAU * 2.6 * t).sin()];
    let more = "[dynamic]\nup_to_hz = 4.0\ndamping = 1e-5\nfrequency_uncertainty_rel = 2e-4\ndamping_uncertainty_rel = 0\n";
    let (held, _, _, codes) = recover_tip_force(
        &GAUGED,
        5000,
        more,
        |t| two(t).iter().sum(),
        |_, x, t| {
            curvature_amplification(x, 0.3) * two(t)[0]
                + curvature_amplification(x, 2.6) * two(t)[1]
        },
    );
    assert!(held > 0.93, "{held}");
    let blamed = [
        "gauge-suspect",
        "strain-not-explained",
        "residual-above-stated-errors",
    ];
    assert!(codes.iter().all(|c| !blamed.contains(c)), "{codes:?}");
}

/// The true frequencies are 1 % and 2 % above those of the model, and the stated standard deviation is 2 %.
///
/// The residual of the vibration blames no gauge, and the intervals are only as wide as the stated error requires. A
/// gauge with an error of a third still causes a finding.
#[test]
fn an_error_of_frequency_blames_no_gauge() {
    let two = |t: f64| [5.0 * (TAU * 0.3 * t).sin(), 10.0 * (TAU * 2.6 * t).sin()];
    let more = "[dynamic]\nup_to_hz = 4.0\ndamping = 0.002\n";
    let real = |share: f64, x: f64, t: f64| {
        curvature_amplification(x, 0.3 / share) * two(t)[0]
            + curvature_amplification(x, 2.6 / share) * two(t)[1]
    };
    for share in [1.01, 1.02] {
        let (held, worst, width, codes) = recover_tip_force(
            &GAUGED,
            5000,
            more,
            |t| two(t).iter().sum(),
            |_, x, t| real(share, x, t),
        );
        assert!(held > 0.9, "{share} {held}");
        // The program estimates the frequency from the record. Errors of 1 % of the strain of the mode at each gauge
        // remain, about .5 N of 15 N.
        assert!(worst < 0.3 && width < 1.0, "{share} {width} {worst}");
        let blamed = ["gauge-suspect", "strain-not-explained"];
        assert!(codes.iter().all(|c| !blamed.contains(c)), "{codes:?}");
    }
    // 10 % is five times the stated standard deviation.
    let far = |_: usize, x: f64, t: f64| real(1.1, x, t);
    let (.., codes) = recover_tip_force(&GAUGED, 5000, more, |t| two(t).iter().sum(), far);
    assert!(codes.contains(&"modes-contradicted"), "{codes:?}");
    let off = |g: usize, x: f64, t: f64| real(1.01, x, t) * if g == 1 { 1.3 } else { 1.0 };
    let (_, _, _, codes) = recover_tip_force(&GAUGED, 5000, more, |t| two(t).iter().sum(), off);
    let printed = [
        "gauge-suspect",
        "strain-not-explained",
        "residual-above-stated-errors",
    ];
    assert!(codes.iter().any(|c| printed.contains(c)), "{codes:?}");
}

/// Two gauges, each without a reading in one half of the record. No sample has both.
#[test]
fn gauges_that_never_read_together_have_intervals_of_their_own() {
    let wave = |t: f64| 10.0 * (TAU * 2.6 * t).sin();
    let more = "[dynamic]\nup_to_hz = 4.0\ndamping = 0.002\n";
    let end = 5000.0 / RATE;
    let (held, worst, ..) = recover_tip_force(&[3, 20], 5000, more, wave, |g, x, t| {
        match (g == 0) == (t < 0.5 * end) {
            true => f64::NAN,
            false => curvature_amplification(x, 2.6 / 1.02) * wave(t),
        }
    });
    assert!(worst > 0.3, "{worst}");
    assert!(held > 0.9, "{held} {worst}");
}

#[test]
fn a_record_shorter_than_the_filter_is_a_fault_whatever_is_blank_in_it() {
    let s = compute_sensitivity(&GAUGED);
    let blank = |_: usize, _: f64, t: f64| {
        if (t - 0.2).abs() < 1e-6 {
            f64::NAN
        } else {
            1.0
        }
    };
    let more = format!("[dynamic]\nup_to_hz = {}\ndamping = 0.01\n", first_hz());
    let files = InMemory::default()
        .with_file("beam.bdf", deck())
        .with_file("strain.csv", table(&GAUGED, &s, 250, blank))
        .with_file("job.toml", job(&more));
    let job = Job::read("job.toml", &files).unwrap();
    let faults = strainbridge::recover(&job, &Context::new(&files)).map(|_| ());
    let faults = faults.unwrap_err();
    let first = faults.first().unwrap();
    assert!(
        first.wrong.contains("depends on half of that time"),
        "{first:?}"
    );
    assert!(first.remedy.contains("longer time"), "{first:?}");
}

#[test]
fn modes_are_solved_once_and_kept() {
    let more = "[dynamic]\nup_to_hz = 10.0\ndamping = 0.01\nfrequency_uncertainty_rel = 0.001\n";
    let files = record().with_file("job.toml", job(more));
    let job = Job::read("job.toml", &files).unwrap();
    let kept = Memory::default();
    let once = || strainbridge::recover(&job, &Context::new(&files).store(&kept)).unwrap();
    let outcomes = [once(), once()];
    let seconds = outcomes
        .each_ref()
        .map(|o| serde_json::to_value(&o.seconds).unwrap());
    assert!(seconds[0].get("modes").is_some(), "{seconds:?}");
    assert!(seconds[1].get("modes").is_none(), "{seconds:?}");
    let values = outcomes
        .each_ref()
        .map(|o| o.answer.record().unwrap().loads[0].value);
    assert_eq!(values[0], values[1]);
}

/// Bands that state the same damping for all modes give the same loads as one number. A damping that the record
/// determines gives loads within the intervals.
#[test]
fn damping_by_band_and_from_the_record_give_the_loads_of_a_number() {
    let head = format!(
        "[dynamic]\nup_to_hz = {:.4}\nfrequency_uncertainty_rel = 0.001\n",
        3.5 * first_hz()
    );
    let with = |damping: &str| recover_record(record(), &format!("{head}damping = {damping}\n"));
    let number = with("1e-5");
    let bands = with("[{ up_to_hz = 1.0, damping = 1e-5 }, { up_to_hz = 50.0, damping = 1e-5 }]");
    assert_eq!(number, bands);
    let (worst, _, held, codes) = with("\"estimate\"");
    assert!(held > 0.93 && worst < 1.0, "{held} {worst}");
    assert!(!codes.contains(&"modes-contradicted"), "{codes:?}");
}

#[test]
fn fleet_removes_vibration_as_recover_does() {
    let up_to = 3.5 * first_hz();
    let dynamic = format!(
        "[dynamic]\nup_to_hz = {up_to:.4}\ndamping = 1e-5\nfrequency_uncertainty_rel = 0.001\n"
    );
    let files = record();
    let (fleet, findings, extremes) = fleet_and_extremes("dynamic", &files, &job(&dynamic));
    check_extremes(&fleet, &findings, &extremes);
    let codes: Vec<&str> = findings.iter().map(|f| f.code).collect();
    assert!(codes.contains(&"vibration-removed"), "{codes:?}");
    assert!(!codes.contains(&"samples-with-gaps"), "{codes:?}");
    // Extremes of the force that acts, with the limit of the recovered samples above.
    let times = (0..SAMPLES).map(|i| i as f64 / RATE);
    let forces: Vec<f64> = times.map(|t| parts(t, |_| 1.0)).collect();
    let largest = forces.iter().copied().fold(f64::MIN, f64::max);
    let tip = &fleet.vehicles[0].loads[0];
    assert!(
        (tip.max.unwrap() - largest).abs() < 0.3,
        "{:?} {largest}",
        tip.max
    );
    // Without the section, 3 N near the first mode read as 20 N.
    let (fleet, ..) = fleet_and_extremes("static", &files, &job(""));
    assert!(fleet.vehicles[0].loads[0].max.unwrap() > largest + 10.0);
}
