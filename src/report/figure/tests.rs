use super::packed_numbers::{packed_deltas, round_number, steps_of};
use super::*;
use maud::Render;
use serde_json::json;

#[test]
fn packed_numbers_are_the_base64_of_their_steps_in_variable_length() {
    // Rows of two, worked by hand: 1, 2, then 301 - 1 = 300 and 1 - 2 = -1. Steps 1, 2, 300, -1 are encoded as 2, 4, 600, 1. 600 is 4 * 128 + 88, so
    // the bytes are 02 04 d8 04 01. Base64 follows RFC 4648.
    assert_eq!(packed_deltas(&[1, 2, 301, 1], 2), json!("AgTYBAE="));
    assert_eq!(packed_deltas(&[], 3), json!(""));
    // 2047 encodes the largest value, -2048 a missing one.
    assert_eq!(
        steps_of([f64::NAN, 2.0, -2.0, 0.0].into_iter(), 2.0),
        [-2048, 2047, -2047, 0]
    );
}

#[test]
fn numbers_keep_six_digits_and_what_is_none_is_null() {
    assert_eq!(round_number(123_456_789.0), json!(123_457_000.0));
    assert_eq!(round_number(f64::NAN), json!(null));
}

#[test]
fn a_page_has_the_scripts_that_it_needs_and_they_load_nothing() {
    assert_eq!(scripts("<p>words</p>"), "");
    let figure = scripts("<figure data-figure=\"chart\">");
    let scene = scripts("<figure data-figure=\"scene\"><div data-pointing>");
    assert!(!figure.contains("webgl2") && scene.contains("webgl2"));
    for text in [&figure, &scene] {
        assert!(!text.contains("src=") && !text.contains("import(") && !text.contains("fetch("));
        // The only address is the namespace of SVG, which is never fetched.
        assert_eq!(
            text.matches("http").count(),
            text.matches("http://www.w3.org/2000/svg").count()
        );
        assert_eq!(text.matches("</script>").count(), 1);
    }
    // A page with figures and no scene stays far below 1 MB.
    assert!(figure.len() < 60_000, "{}", figure.len());
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
    // The axis title contains the name and the unit of the load.
    assert_eq!(figure.choices[0].1[0]["ytitle"], "A<B, kN");
    let of = |k: usize| &figure.choices[0].1[k]["y"];
    // Traces 0 and 1 bound the interval. The extremes follow, then the mean.
    assert_eq!(*of(0), json!([-4.0, null, 0.0]));
    assert_eq!(*of(1), json!([5.0, null, 2.0]));
    assert_eq!(*of(3), json!([4.0, null, 1.0]));
    assert_eq!(*of(4), json!([0.0, null, 1.0]));
    // Each time is the middle of its span.
    assert_eq!(figure.choices[0].1[4]["x"], json!([2.0, 6.0, 10.5]));
    // Text in the data cannot close the script element.
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
    // All gauges first, then single gauges by decreasing residual.
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
fn a_heat_map_shows_shares_of_each_column_and_states_the_values() {
    let names = |list: [&str; 2]| list.map(str::to_owned);
    let value = |r: usize, c: usize| [[1.0, 0.0], [-4.0, 0.0]][r][c];
    let figure = heat_map(&names(["P1", "P2"]), &names(["A", "B"]), "µε", value);
    let trace = &figure.choices[0].1[0];
    assert_eq!(trace["z"], json!([[0.25, 0.0], [-1.0, 0.0]]));
    assert_eq!(trace["customdata"], json!([[1.0, 0.0], [-4.0, 0.0]]));
}
