use super::packed::{packed_f32, packed_i16, packed_u32, short};
use super::*;
use maud::Render;
use serde_json::json;

#[test]
fn packed_numbers_are_the_base64_of_their_little_endian_bytes() {
    // Base64 by RFC 4648 of 00 00 80 3f (1.0), of 01 00 02 00 and of 00 00 01 00 (65536), worked by hand.
    assert_eq!(
        packed_f32([1.0].into_iter()),
        json!({ "dtype": "f4", "bdata": "AACAPw==" })
    );
    assert_eq!(
        packed_u32(&[1, 2]),
        json!({ "dtype": "u2", "bdata": "AQACAA==" })
    );
    assert_eq!(
        packed_u32(&[65_536]),
        json!({ "dtype": "u4", "bdata": "AAABAA==" })
    );
    // -32768 stands for nothing, 32767 for the largest.
    assert_eq!(
        packed_i16([f64::NAN, 2.0, -2.0].into_iter(), 2.0)["bdata"],
        "AID/fwGA"
    );
}

#[test]
fn numbers_keep_six_digits_and_what_is_none_is_null() {
    assert_eq!(short(123_456_789.0), json!(123_457_000.0));
    assert_eq!(short(f64::NAN), json!(null));
}

#[test]
fn the_scripts_hold_plotly_and_load_nothing() {
    let text = scripts();
    assert!(text.contains("plotly.js v"));
    // The second script of the crate's string.
    assert!(!text.contains("MathJax.loader") && !text.contains("MathJax ="));
    // Nothing is loaded by address.
    assert!(!text.contains("<script src") && !text.contains("import(\"http"));
    assert_eq!(text.matches("</script>").count(), 2);
}

#[test]
fn a_history_spans_the_extremes_with_their_interval_and_leaves_gaps_out() {
    let trace = LoadTrace {
        name: "A<B".into(),
        unit: "kN".into(),
        times: vec![[0.0, 4.0], [4.0, 8.0], [9.0, 12.0]],
        half: 1.0,
        spans: vec![[-3.0, 0.0, 4.0], [f64::NAN; 3], [1.0, 1.0, 1.0]],
    };
    let figure = history(&[trace]);
    let of = |k: usize| &figure.choices[0].1[k]["y"];
    // Interval around the extremes, then the extremes, then the mean.
    assert_eq!(*of(0), json!([-4.0, null, 0.0]));
    assert_eq!(*of(1), json!([5.0, null, 2.0]));
    assert_eq!(*of(3), json!([4.0, null, 1.0]));
    assert_eq!(*of(4), json!([0.0, null, 1.0]));
    // The middle of each span in its own time.
    assert_eq!(figure.choices[0].1[4]["x"], json!([2.0, 6.0, 10.5]));
    // Nothing in the data can end its script early.
    let page = figure.render().into_string();
    assert!(page.contains("A\\u003cB") && page.matches("</script>").count() == 1);
}

#[test]
fn points_keep_their_run_where_readings_are_missing() {
    let gauge = |name: &str, residual| GaugePoints {
        name: name.into(),
        residual,
        points: [vec![(f64::NAN, 1.0), (2.0, 3.0)], Vec::new()],
    };
    let runs = ["R1".to_owned(), "R2".to_owned()];
    let figure = agreement(
        &[gauge("P1", 0.0), gauge("P2", 5.0)],
        ["used", "held out"],
        [&runs, &[]],
    );
    // All, then the worst first.
    let names: Vec<&str> = figure.choices.iter().map(|c| c.0.as_str()).collect();
    assert_eq!(
        names,
        ["all gauges", "P2, residual 5.000 µε", "P1, residual 0 µε"]
    );
    let points = &figure.choices[1].1[1];
    assert_eq!((&points["x"], &points["y"]), (&json!([2.0]), &json!([3.0])));
    assert_eq!(points["text"], json!(["P2 R2"]));
}

#[test]
fn a_heat_map_shows_shares_of_each_column_and_says_the_values() {
    let names = |list: [&str; 2]| list.map(str::to_owned);
    let value = |r: usize, c: usize| [[1.0, 0.0], [-4.0, 0.0]][r][c];
    let figure = heat_map(&names(["P1", "P2"]), &names(["A", "B"]), "µε", value);
    let trace = &figure.choices[0].1[0];
    assert_eq!(trace["z"], json!([[0.25, 0.0], [-1.0, 0.0]]));
    assert_eq!(trace["customdata"], json!([[1.0, 0.0], [-4.0, 0.0]]));
}
