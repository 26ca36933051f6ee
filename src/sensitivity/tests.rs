use super::*;
use crate::finding::Severity;
use crate::linalg::Matrix;

fn s(rows: usize, values: &[f64], names: &[&str]) -> Sensitivity {
    Sensitivity {
        gauges: (0..rows).map(|i| format!("G{i}")).collect(),
        loads: names.iter().map(|n| Load::named(*n)).collect(),
        values: Matrix::from_row_slice(rows, names.len(), values),
        uncertainty: None,
    }
}

#[test]
fn two_loads_that_act_alike_are_named_with_their_combination() {
    let s = s(
        4,
        &[1.0, 2.0, 0.0, 2.0, 4.0, 1.0, 3.0, 6.0, 0.0, 4.0, 8.0, -1.0],
        &["LF", "RF", "LM"],
    );
    assert_eq!(s.rank(), 2);
    let f = check_separability(&s);
    let bad = f.iter().find(|f| f.code == "loads-not-separable").unwrap();
    assert_eq!(bad.severity, Severity::Error);
    assert!(
        bad.subject.contains("LF") && bad.subject.contains("RF") && !bad.subject.contains("LM"),
        "{}",
        bad.subject
    );
    // LF - 0.5 RF strains nothing: (1, 2, 3, 4) - (2, 4, 6, 8) / 2.
    assert!(
        bad.message.contains("0.500 RF") || bad.message.contains("2.00 LF"),
        "{}",
        bad.message
    );
}

#[test]
fn fewer_gauges_than_loads_names_what_stays_free() {
    let s = s(1, &[1.0, 1.0], &["A", "B"]);
    let codes: Vec<&str> = check_separability(&s).iter().map(|f| f.code).collect();
    assert!(
        codes.contains(&"fewer-gauges-than-loads") && codes.contains(&"loads-not-separable"),
        "{codes:?}"
    );
    assert_eq!(s.condition_number(), f64::INFINITY);
}

#[test]
fn a_load_that_strains_nothing_is_named_once() {
    let s = s(3, &[1.0, 0.0, 2.0, 0.0, 3.0, 0.0], &["A", "B"]);
    let f = check_separability(&s);
    assert_eq!(f.len(), 1, "{f:?}");
    assert_eq!(
        (f[0].code, f[0].subject.as_str()),
        ("load-without-strain", "B")
    );
}

#[test]
fn units_change_the_raw_condition_number_and_not_the_scaled_one() {
    let newton = s(3, &[1.0, 0.1, 0.2, 1.0, -0.3, 0.4], &["F", "M"]);
    let mut millimetre = newton.clone();
    millimetre.values.column_mut(1).scale_mut(1e-3);
    assert!((newton.condition_number_scaled() - millimetre.condition_number_scaled()).abs() < 1e-9);
    assert!(millimetre.condition_number() > 100.0 * newton.condition_number());
}
