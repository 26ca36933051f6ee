use super::content_hz;
use std::f64::consts::TAU;

/// Returns uniform noise of unit standard deviation (splitmix64).
fn noise(n: usize) -> Vec<f64> {
    let mut state = 5_u64;
    (0..n)
        .map(|_| {
            state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let mut z = state;
            z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            (((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0) * 3.0_f64.sqrt()
        })
        .collect()
}

fn sines(n: usize, rate: f64, parts: &[(f64, f64)]) -> Vec<f64> {
    (0..n)
        .map(|i| {
            let t = i as f64 / rate;
            5.0 + parts
                .iter()
                .map(|(f, a)| a * (TAU * f * t).sin())
                .sum::<f64>()
        })
        .collect()
}

#[test]
fn the_highest_of_two_sines_is_found_and_one_of_a_thousandth_of_the_power_is_not() {
    let bin = 200.0 / 4096.0;
    let x = sines(20_000, 200.0, &[(1.3, 10.0), (7.0, 2.0)]);
    // The limit is three lines of the spectrum.
    let f = content_hz(&[x], 200.0, 0.0).unwrap();
    assert!((f - 7.0).abs() < 3.0 * bin, "{f}");
    let x = sines(20_000, 200.0, &[(1.3, 10.0), (7.0, 0.3)]);
    let f = content_hz(&[x], 200.0, 0.0).unwrap();
    assert!((f - 1.3).abs() < 3.0 * bin, "{f}");
}

#[test]
fn white_noise_does_not_count_as_content() {
    let mut x = sines(40_000, 200.0, &[(2.0, 3.0)]);
    x.iter_mut()
        .zip(noise(40_000))
        .for_each(|(x, e)| *x += 0.5 * e);
    // The limit is four lines of 200 / 4096 Hz.
    let f = content_hz(&[x], 200.0, 0.0).unwrap();
    assert!((f - 2.0).abs() < 0.2, "{f}");
    // Pure noise of the declared density has no content. Its variance is 1 over 0 to 100 Hz.
    assert_eq!(content_hz(&[noise(40_000)], 200.0, 0.01), None);
}

#[test]
fn pieces_of_a_record_count_together_and_short_pieces_do_not_count() {
    let (a, b) = (
        sines(8000, 100.0, &[(1.0, 1.0)]),
        sines(8000, 100.0, &[(11.0, 1.0)]),
    );
    // The limit is four lines of 100 / 4096 Hz.
    let f = content_hz(&[a, b], 100.0, 0.0).unwrap();
    assert!((f - 11.0).abs() < 0.1, "{f}");
    assert_eq!(content_hz(&[vec![1.0, 2.0, 1.0]], 100.0, 0.0), None);
    assert_eq!(content_hz(&[], 100.0, 0.0), None);
}
