use super::super::{Number, format_real, read_number, shortest_real};

fn parse_real(text: &str) -> Option<f64> {
    match read_number(text.as_bytes()) {
        Some(Number::Real(x)) => Some(x),
        _ => None,
    }
}

#[test]
fn reals_may_lack_the_exponent_letter_or_digits_next_to_the_point() {
    let cases = [
        ("1.5-3", 1.5e-3),
        ("-1.42569-13", -1.42569e-13),
        ("1.D-3", 1e-3),
        ("1.5d+3", 1.5e3),
        (".5", 0.5),
        ("1.", 1.0),
        ("+5.", 5.0),
        ("2.9+7", 2.9e7),
        ("1440.E6", 1.44e9),
        ("1E5", 1e5),
        ("7.0E+1", 70.0),
        ("- 2.5", -2.5),
        ("2.5 E-1", 0.25),
        ("3.5510038288-06", 3.5510038288e-6),
    ];
    for (text, value) in cases {
        assert_eq!(parse_real(text), Some(value), "{text}");
    }
    assert_eq!(
        parse_real("-0.").map(f64::to_bits),
        Some((-0.0_f64).to_bits())
    );
}

#[test]
fn integers_have_neither_point_nor_exponent() {
    assert_eq!(read_number(b"12"), Some(Number::Integer(12)));
    assert_eq!(read_number(b"+5"), Some(Number::Integer(5)));
    assert_eq!(read_number(b"-1"), Some(Number::Integer(-1)));
    assert_eq!(read_number(b"0007"), Some(Number::Integer(7)));
    assert_eq!(read_number(b"123456789012345678901234"), None);
}

#[test]
fn text_and_broken_numbers_are_no_numbers() {
    for text in [
        "", ".", "-", "+", "E5", "1.E", "1.+", "1-3", "1 2", "1. 2", "1.2.3", "THRU", "6/20/72",
        "1.5-3-2", "0x1", "1.+999",
    ] {
        assert_eq!(read_number(text.as_bytes()), None, "{text:?}");
    }
}

/// Returns the next number of a linear congruential generator (Knuth, MMIX).
fn next(state: &mut u64) -> u64 {
    *state = state
        .wrapping_mul(6364136223846793005)
        .wrapping_add(1442695040888963407);
    *state >> 11
}

#[test]
fn reals_are_rounded_as_the_standard_library_rounds() {
    let mut state = 1;
    for _ in 0..40_000 {
        let digits = next(&mut state) % 10_u64.pow((next(&mut state) % 18 + 1) as u32);
        let exponent = (next(&mut state) % 80) as i64 - 40;
        let point = next(&mut state) as usize % (digits.to_string().len() + 1);
        let mut mantissa = digits.to_string();
        mantissa.insert(point, '.');
        let nastran = format!("{mantissa}{exponent:+}");
        let usual: f64 = format!("{mantissa}e{exponent}").parse().unwrap();
        assert_eq!(
            parse_real(&nastran).map(f64::to_bits),
            Some(usual.to_bits()),
            "{nastran}"
        );
    }
}

#[test]
fn the_shortest_form_of_a_real_reads_back_as_the_same_real() {
    let mut state = 7;
    for _ in 0..20_000 {
        let x = f64::from_bits(next(&mut state) << 12 ^ next(&mut state));
        if x.is_finite() {
            let text = shortest_real(x);
            assert_eq!(
                parse_real(&text).map(f64::to_bits),
                Some(x.to_bits()),
                "{text}"
            );
        }
    }
}

#[test]
fn reals_are_written_short() {
    let cases = [
        (0.0, "0."),
        (-0.0, "-0."),
        (1.0, "1."),
        (1.5e-3, ".0015"),
        (-2.5, "-2.5"),
        (7.85e-9, "7.85-9"),
        (2.1e11, "2.1+11"),
        (210000.0, "210000."),
        (1.2345e-10, ".12345-9"),
        (0.3, ".3"),
    ];
    for (x, text) in cases {
        assert_eq!(shortest_real(x), text);
    }
}

#[test]
fn reals_in_sixteen_columns_keep_eleven_digits_and_more() {
    let mut state = 3;
    for _ in 0..20_000 {
        let exponent = (next(&mut state) % 40) as i32 - 20;
        let x = (next(&mut state) as f64 / (1_u64 << 53) as f64 - 0.5) * 10_f64.powi(exponent);
        let text = format_real(x, 16);
        assert!(text.len() <= 16, "{text}");
        let back = parse_real(&text).unwrap();
        assert!((back - x).abs() <= 5e-11 * x.abs(), "{x:e} {text}");
        let positive = format_real(x.abs(), 16);
        assert!(
            (parse_real(&positive).unwrap() - x.abs()).abs() <= 5e-12 * x.abs(),
            "{x:e} {positive}"
        );
    }
}
