use super::align::delay;
use super::channels::{Channel, Channels};
use super::csv::read_csv;
use super::detrend::{line, rms};
use super::error::SeriesError;
use super::integrate::integrate_in_band;
use super::quality::{Kind, check_channels};
use super::spectrum::Band;
use super::welch::{CrossSpectra, cross_spectra};
use rand::{RngExt, SeedableRng};
use std::f64::consts::PI;

const RATE: f64 = 500.0;

/// White noise of unit standard deviation (sum of uniform numbers), equal on every machine.
fn noise(n: usize, seed: u64) -> Vec<f64> {
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    (0..n)
        .map(|_| (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0)
        .collect()
}

fn record(list: &[(&str, Vec<f64>)]) -> Channels {
    let list = list
        .iter()
        .map(|(n, s)| Channel {
            name: (*n).into(),
            unit: String::new(),
            samples: s.clone(),
        })
        .collect();
    Channels::from_list(RATE, list).unwrap()
}

fn codes(record: &Channels) -> Vec<(String, &'static str)> {
    let kind = |n: &str| {
        if n.starts_with("a_") {
            Kind::Acceleration
        } else {
            Kind::Force
        }
    };
    check_channels(record, 9.81, kind)
        .into_iter()
        .map(|f| (f.subject, f.code))
        .collect()
}

/// Returns a realistic body acceleration: band-limited noise on gravity.
fn live_acceleration(seed: u64) -> Vec<f64> {
    let x = integrate_in_band(
        &noise(16_000, seed),
        RATE,
        Band {
            low_hz: 1.0,
            high_hz: 15.0,
        },
        0,
    );
    let scale = 2.0 / rms(&x);
    x.iter()
        .zip(noise(16_000, seed + 99))
        .map(|(v, e)| 9.81 + v * scale + 0.02 * e)
        .collect()
}

/// Returns x minus its least squares line.
fn without_line(x: &[f64]) -> Vec<f64> {
    let (offset, slope) = line(x);
    let flat = |(i, v): (usize, &f64)| v - offset - slope * i as f64;
    x.iter().enumerate().map(flat).collect()
}

/// Coherence |Sxy|^2 / (Sxx Syy), 0 to 1. It tests all three spectra at once.
fn coherence(s: &CrossSpectra) -> Vec<f64> {
    (0..s.xy.len())
        .map(|k| s.xy[k].norm_sqr() / (s.xx[k] * s.yy[k]))
        .collect()
}

#[test]
fn integration_in_the_frequency_domain_returns_a_sine_and_ignores_an_offset() {
    let (f, n) = (4.0, 10_000);
    let w = 2.0 * PI * f;
    let a: Vec<f64> = (0..n)
        .map(|i| 9.81 - w * w * (w * i as f64 / RATE).sin())
        .collect();
    let d = integrate_in_band(
        &a,
        RATE,
        Band {
            low_hz: 0.3,
            high_hz: f64::INFINITY,
        },
        2,
    );
    for i in 4000..6000 {
        // The high-pass passes (0.3/4)^4 = 3e-5 of it.
        assert!((d[i] - (w * i as f64 / RATE).sin()).abs() < 2e-3);
    }
}

#[test]
fn a_high_pass_keeps_the_double_integral_of_noise_small_where_detrending_does_not() {
    let n = 32_000;
    let w = 2.0 * PI * 2.0;
    let a: Vec<f64> = noise(n, 5)
        .iter()
        .enumerate()
        .map(|(i, e)| 0.05 * e - w * w * 0.01 * (w * i as f64 / RATE).sin())
        .collect();
    let truth = |i: usize| 0.01 * (w * i as f64 / RATE).sin();
    let error = |d: &[f64]| {
        rms(&(5000..27_000).map(|i| d[i] - truth(i)).collect::<Vec<_>>()) / (0.01 / 2f64.sqrt())
    };
    let open = without_line(&integrate_in_band(
        &a,
        RATE,
        Band {
            low_hz: 0.0,
            high_hz: f64::INFINITY,
        },
        2,
    ));
    let banded = integrate_in_band(
        &a,
        RATE,
        Band {
            low_hz: 0.5,
            high_hz: f64::INFINITY,
        },
        2,
    );
    assert!(error(&open) > 1.0, "{}", error(&open));
    assert!(error(&banded) < 0.02, "{}", error(&banded));
}

#[test]
fn a_shift_by_part_of_a_sample_moves_a_sine_by_its_phase() {
    let f = 7.3;
    let sine = |i: usize, late: f64| 2.0 + (2.0 * PI * f * (i as f64 / RATE - late)).sin();
    let x: Vec<f64> = (0..8000).map(|i| sine(i, 0.0)).collect();
    for seconds in [0.0004, -0.005, 0.1234] {
        let y = delay(&x, RATE, seconds);
        // The ends of the record are left out, because the start and the end of the record disturb them.
        for k in 2000..6000 {
            assert!((y[k] - sine(k, seconds)).abs() < 1e-2, "{seconds} {k}");
        }
    }
}

#[test]
fn white_noise_has_a_flat_density_and_no_coherence_with_another() {
    let (x, y) = (noise(64_000, 3), noise(64_000, 4));
    let s = cross_spectra(&x, &y, RATE, 512);
    // 125 segments without overlap and 190 lines give a level to .65 %, or 1 % because a window correlates neighbours. The limit is three times 1 %.
    // For 125 segments of unrelated signals, the mean coherence is 1/125.
    let level = s.xx[10..200].iter().sum::<f64>() / 190.0;
    assert!((level * RATE / 2.0 - 1.0).abs() < 0.03, "{level}");
    assert!(coherence(&s)[10..200].iter().sum::<f64>() / 190.0 < 0.02);
}

#[test]
fn sound_channels_give_no_finding() {
    assert_eq!(
        codes(&record(&[
            ("a_body", live_acceleration(10)),
            ("a_wheel", live_acceleration(20)),
            (
                "f_wheel",
                live_acceleration(30).iter().map(|v| v * 3000.0).collect()
            )
        ])),
        vec![]
    );
}

#[test]
fn a_steady_sine_and_a_wheel_off_the_ground_are_no_saturation() {
    let sine: Vec<f64> = (0..20_000)
        .map(|i| 9.81 + 3.0 * (2.0 * PI * 5.0 * i as f64 / 1000.0).sin())
        .collect();
    let lifting: Vec<f64> = live_acceleration(31)
        .iter()
        .zip(noise(20_000, 8))
        .map(|(v, e)| (20_000.0 + 15_000.0 * (v - 9.81)).max(0.0) + 10.0 * e)
        .collect();
    assert_eq!(codes(&record(&[("a_1", sine)])), vec![]);
    assert_eq!(codes(&record(&[("f_wheel", lifting)])), vec![]);
}

#[test]
fn saturation_before_the_noise_is_seen_through_it() {
    let clipped: Vec<f64> = live_acceleration(10)
        .iter()
        .zip(noise(16_000, 9))
        .map(|(v, e)| v.clamp(6.0, 13.0) + 0.02 * e)
        .collect();
    assert_eq!(
        codes(&record(&[("a_body", clipped)])),
        vec![("a_body".to_owned(), "saturated-channel")]
    );
}

#[test]
fn each_fault_of_a_channel_is_named() {
    let sound = live_acceleration(20);
    let faulty = |f: &dyn Fn(usize, f64) -> f64| {
        live_acceleration(10)
            .iter()
            .enumerate()
            .map(|(i, v)| f(i, *v))
            .collect::<Vec<f64>>()
    };
    let cases: Vec<(&str, Vec<f64>)> = vec![
        ("dead-channel", faulty(&|_, _| 9.81)),
        ("dead-channel", faulty(&|_, v| 9.81 + 0.005 * (v - 9.81))),
        ("saturated-channel", faulty(&|_, v| v.min(12.0))),
        (
            "spikes",
            faulty(&|i, v| if i % 5000 == 77 { v + 30.0 } else { v }),
        ),
        ("drift", faulty(&|i, v| v + 1.0 * i as f64 / 16_000.0)),
        (
            "missing-samples",
            faulty(&|i, v| if i == 500 { f64::NAN } else { v }),
        ),
        (
            "stuck-channel",
            faulty(&|i, v| if (600..700).contains(&i) { 9.9 } else { v }),
        ),
        ("offset", faulty(&|_, v| v + 0.8)),
    ];
    for (code, samples) in cases {
        let found = codes(&record(&[("a_body", samples), ("a_wheel", sound.clone())]));
        assert!(
            found.iter().any(|(s, c)| s == "a_body" && *c == code),
            "{code}: {found:?}"
        );
        assert!(
            found.iter().all(|(s, _)| s == "a_body"),
            "{code}: {found:?}"
        );
    }
}

#[test]
fn missing_samples_are_bridged_by_straight_lines() {
    let (filled, counts) =
        record(&[("a", vec![f64::NAN, 1.0, f64::NAN, 3.0, f64::INFINITY])]).with_gaps_filled();
    assert_eq!(filled.samples("a").unwrap(), [1.0, 1.0, 2.0, 3.0, 3.0]);
    assert_eq!(counts, [3]);
}

#[test]
fn a_csv_gives_rate_units_and_missing_samples() {
    let text =
        b"\xef\xbb\xbft;a_body [m/s2];f_wheel (N)\r\n0;1.5;2\r\n0.002;;3e3\r\n0.004;nan;-4\r\n";
    let r = read_csv(text, None).unwrap();
    assert!((r.rate_hz - 500.0).abs() < 1e-9);
    assert_eq!(
        (r.list[0].unit.as_str(), r.list[1].unit.as_str()),
        ("m/s2", "N")
    );
    assert_eq!(r.samples("f_wheel").unwrap(), [2.0, 3000.0, -4.0]);
    assert!(r.samples("a_body").unwrap()[1].is_nan());
}

#[test]
fn bad_csv_names_the_line_and_the_remedy() {
    let line = |t: &[u8], hz| read_csv(t, hz).unwrap_err();
    assert!(matches!(
        line(b"t,a\n0,1\n0.1\n", None),
        SeriesError::Line { line: 3, .. }
    ));
    assert!(matches!(
        line(b"t,a\n0,1\n0.1,x\n", None),
        SeriesError::Line { line: 3, .. }
    ));
    assert!(matches!(
        line(b"t,a\n0,1\n0.1,1\n0.2,1\n0.5,1\n0.6,1\n", None),
        SeriesError::UnevenTime { line: 5, .. }
    ));
    assert!(matches!(
        line(b"t,a\n0,1\n0.1,1\n0.2,1\n", Some(20.0)),
        SeriesError::Rate { .. }
    ));
    assert!(matches!(line(b"a\n0\n", None), SeriesError::NoRate));
    assert!(matches!(line(b"", None), SeriesError::Line { .. }));
    assert!(matches!(
        read_csv(b"a\n1\n", Some(5.0)).unwrap().samples("b"),
        Err(SeriesError::Missing { .. })
    ));
}

#[test]
fn what_to_do_stays_whole_where_names_and_remedies_hold_colons() {
    let missing = read_csv(b"left: front\n1\n", Some(5.0))
        .unwrap()
        .samples("rear: left")
        .unwrap_err();
    let (wrong, remedy) = missing.parts();
    assert!(wrong.contains("`rear: left`") && wrong.contains("left: front"));
    assert_eq!(remedy, "name it in the job or rename the column");
    let line = SeriesError::Line {
        line: 1,
        what: "no line names the columns".into(),
        remedy: "begin with a header line: `time` and one name for each channel",
    };
    assert_eq!(
        line.parts().1,
        "begin with a header line: `time` and one name for each channel"
    );
    assert_eq!(
        line.to_string(),
        format!("{}: {}", line.parts().0, line.parts().1)
    );
}

#[test]
fn channels_of_different_length_are_refused_by_name() {
    let list = vec![
        Channel {
            name: "a".into(),
            unit: String::new(),
            samples: vec![1.0; 5],
        },
        Channel {
            name: "b".into(),
            unit: String::new(),
            samples: vec![1.0; 4],
        },
    ];
    assert!(
        Channels::from_list(1.0, list)
            .unwrap_err()
            .to_string()
            .contains("`b` has 4")
    );
}

/// Numbers by `tests/golden/scipy_series.py` (scipy 1.17.1).
#[test]
fn spectra_agree_with_scipy() {
    let text = include_str!("../../tests/golden/scipy_series.json");
    let golden: serde_json::Value = serde_json::from_str(text).unwrap();
    let numbers = |v: &serde_json::Value| {
        v.as_array()
            .unwrap()
            .iter()
            .map(|x| x.as_f64().unwrap())
            .collect::<Vec<f64>>()
    };
    let close = |a: &[f64], b: &[f64], tolerance: f64| {
        assert_eq!(a.len(), b.len());
        let scale = b.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        for (i, (x, y)) in a.iter().zip(b).enumerate() {
            assert!((x - y).abs() < tolerance * scale, "{i}: {x} {y}");
        }
    };
    let x = numbers(&golden["x"]);
    let y = numbers(&golden["y"]);
    let s = cross_spectra(&x, &y, 100.0, 64);
    close(&s.xx, &numbers(&golden["welch_x"]), 1e-12);
    close(&coherence(&s), &numbers(&golden["coherence"]), 1e-10);
    close(
        &s.xy.iter().map(|c| c.re).collect::<Vec<_>>(),
        &numbers(&golden["csd_re"]),
        1e-12,
    );
    close(
        &s.xy.iter().map(|c| c.im).collect::<Vec<_>>(),
        &numbers(&golden["csd_im"]),
        1e-12,
    );
}

/// scipy.signal.csd and coherence 1.17.1 (hann, nperseg 128, noverlap 64, detrend constant) of two formulas at 200 Hz: frequency, density of x, of y,
/// coherence, phase in degrees.
#[test]
fn coherence_and_phase_are_the_values_of_scipy() {
    let noise = |i: u64, step: u64, prime: u64| (i * step % prime) as f64 / prime as f64 - 0.5;
    let x: Vec<f64> = (0..1000)
        .map(|i| (0.3 * i as f64).sin() + noise(i, 7919, 101))
        .collect();
    let y = (0..1000).map(|i| 0.5 * (0.3 * i as f64 - 0.4).sin() + noise(i, 104_729, 97));
    let found = cross_spectra(&x, &y.collect::<Vec<f64>>(), 200.0, 128);
    let coherence = found.coherence();
    let expected = [
        [
            1.5625,
            6.397430576e-05,
            5.602093119e-05,
            5.204545556e-01,
            -1.513908962e+01,
        ],
        [
            9.375,
            2.106815392e-01,
            5.446218446e-02,
            9.780285594e-01,
            -2.304056181e+01,
        ],
        [
            10.9375,
            7.362268397e-02,
            1.828413715e-02,
            9.953673524e-01,
            -2.329465659e+01,
        ],
        [
            31.25,
            4.198121835e-04,
            1.616372713e-04,
            4.463639953e-03,
            -1.353169831e+02,
        ],
        [
            78.125,
            3.360404750e-05,
            9.963672401e-05,
            2.640950301e-01,
            -6.016717928e+01,
        ],
        [
            98.4375,
            8.424583923e-05,
            6.870923754e-05,
            1.010241451e-01,
            6.415037406e+00,
        ],
    ];
    for [f, xx, yy, c, phase] in expected {
        let k = found
            .f_hz
            .iter()
            .position(|g| (g - f).abs() < 1e-9)
            .unwrap();
        let got = [
            found.xx[k],
            found.yy[k],
            coherence[k],
            found.xy[k].arg().to_degrees(),
        ];
        for (got, expected) in got.into_iter().zip([xx, yy, c, phase]) {
            assert!((got / expected - 1.0).abs() < 1e-6, "{f}: {got} {expected}");
        }
    }
    // A gap leaves out the two segments that contain it.
    let mut gapped = x.clone();
    gapped[200] = f64::NAN;
    assert_eq!(
        cross_spectra(&gapped, &x, 200.0, 128).n_segments,
        found.n_segments - 2
    );
}
