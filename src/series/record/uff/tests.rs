use crate::series::error::SeriesError;
use crate::series::record::{Options, Record, open_record};
use std::sync::Arc;

/// Returns a data set 58 of 6 samples with `step` between them. Its abscissa has kind 17 (time) and the given `unit`.
fn data_set(name: &str, step: f64, unit: &str) -> String {
    let none = "         0    0    0    0 NONE                 NONE                \n";
    format!(
        "    -1\n    58\n{name}\nNONE\nNONE\nNONE\nNONE\n    1         0    1         0 {name:<10}         1   1 NONE               0   0\n\
         {:>10}{:>10}{:>10}{:>13.5e}{step:>13.5e}{:>13.5e}\n        17    0    0    0 Time                 {unit:<20}\n\
         {:>10}    0    0    0 {name:<20} uE                  \n{none}{none}\
         {:>13.5e}{:>13.5e}{:>13.5e}{:>13.5e}{:>13.5e}{:>13.5e}\n    -1\n",
        2, 6, 1, 0.0, 0.0, 3, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0
    )
}

fn open(text: &str, time_unit_s: Option<f64>) -> Result<Record, SeriesError> {
    let options = Options {
        time_unit_s,
        ..Options::default()
    };
    open_record(Arc::new(text.as_bytes().to_vec()), &options)
}

#[test]
fn the_unit_of_the_abscissa_counts() {
    for (unit, stated, rate_hz) in [
        ("s", true, 0.1),
        ("ms", true, 100.0),
        ("NONE", false, 0.1),
        ("", false, 0.1),
    ] {
        let record = open(&data_set("P1", 10.0, unit), None).unwrap();
        assert!(
            (record.clock.rate_hz / rate_hz - 1.0).abs() < 1e-12,
            "{unit}"
        );
        assert_eq!(record.is_time_unit_stated(), stated);
    }
    let record = open(&data_set("P1", 10.0, "NONE"), Some(1e-3)).unwrap();
    assert!((record.clock.rate_hz - 100.0).abs() < 1e-9);
    assert!(record.is_time_unit_stated());
    let refused = open(&data_set("P1", 10.0, "Hz"), None).err().unwrap();
    assert!(refused.to_string().contains("`Hz`"), "{refused}");
}

#[test]
fn two_data_sets_of_one_name_are_named() {
    let text = data_set("P1", 0.01, "s") + &data_set("P2", 0.01, "s") + &data_set("P1", 0.01, "s");
    let open = |wanted: &str| {
        let options = Options {
            wanted: vec![wanted.to_owned()],
            ..Options::default()
        };
        open_record(Arc::new(text.as_bytes().to_vec()), &options)
    };
    let refused = open("P1").err().unwrap();
    assert!(
        refused
            .to_string()
            .contains("the file contains `P1` 2 times"),
        "{refused}"
    );
    // A channel that occurs once is read by its name.
    let record = open("P2").unwrap();
    let names: Vec<&str> = record.columns().iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["P1#1", "P2", "P1#3"]);
}
