//! Gravity in the means of accelerometers.

use super::*;

/// Returns accelerometers of one vehicle with these means, read as m/s2.
fn accelerometers(means: &[f64]) -> Vec<MotionChannel<'static>> {
    let names = ["a_body", "a_wheel", "a_rear"];
    let channel = |(name, mean): (&&'static str, &f64)| MotionChannel {
        name,
        kind: ChannelKind::Acceleration,
        is_unit_stated: false,
        unit: "m/s2".to_owned(),
        mean: *mean,
        scatter: 1.0,
    };
    names.iter().zip(means).map(channel).collect()
}

#[test]
fn the_mean_of_an_accelerometer_shows_its_sign_and_unit() {
    let g = 9.80665;
    let unit = |list: &[usize], name, factor: f64| MotionFault::Unit(list.to_vec(), name, factor);
    for (means, expected) in [
        (vec![g, 0.98 * g], vec![]),
        // Sensors that do not measure gravity have offsets.
        (vec![0.0, 1.0], vec![]),
        (vec![g, -g], vec![MotionFault::Sign(vec![1])]),
        (vec![-g, -1.05 * g], vec![MotionFault::Sign(vec![0, 1])]),
        (vec![1.0, 1.02], vec![unit(&[0, 1], "g", g)]),
        (vec![g, 0.99], vec![unit(&[1], "g", g)]),
        (vec![1e3 * g, g], vec![unit(&[0], "mm/s2", 1e-3)]),
        (
            vec![1.0, -1.0, 1.0],
            vec![MotionFault::Sign(vec![1]), unit(&[0, 1, 2], "g", g)],
        ),
    ] {
        let channels = accelerometers(&means);
        assert_eq!(faults_by_gravity(&channels, g), expected, "{means:?}");
        let findings = findings_by_gravity(&channels, g, "data.csv");
        assert_eq!(findings.len(), expected.len());
        assert!(findings.iter().all(|f| f.severity == Severity::Error));
    }
    let all = findings_by_gravity(&accelerometers(&[1.0, 1.0]), g, "data.csv");
    assert_eq!(
        (all[0].code, all[0].subject.as_str()),
        ("input-unit", "all")
    );
}
