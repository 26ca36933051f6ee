//! A gauge dragged over a part whose picture is coarser than the model. The gauge must land on the model.

use crate::pointing::{folder, run_page_steps};
use nastran::bdf::{MemoryLoader, read_deck};
use serde_json::json;
use std::f64::consts::TAU;
use std::fmt::Write;
use strainbridge::fe::strain_tensor::Surface;
use strainbridge::model::{Model, Vec3};
use strainbridge::report::page::Page;
use strainbridge::report::scene::{
    Field, FieldValues, Mark, PickTargets, Places, scene_of_model, scene_section,
};

/// Number of squares of 1 mm along x and y. A page cannot draw so many squares individually.
const SIDE: u32 = 320;
/// Height and length of the waves, mm.
const HEIGHT: f64 = 1.0;
const LENGTH: f64 = 12.0;

fn z(y: f64) -> f64 {
    HEIGHT * (TAU * y / LENGTH).cos()
}

/// Returns a corrugated sheet with waves along y.
fn sheet() -> Model {
    let mut deck =
        String::from("SOL 101\nCEND\nBEGIN BULK\nMAT1,1,210000.,,.3,7.85-9\nPSHELL,1,1,2.0,1,,1\n");
    for (j, i) in (0..=SIDE).flat_map(|j| (0..=SIDE).map(move |i| (j, i))) {
        let id = 1 + (SIDE + 1) * j + i;
        let _ = writeln!(deck, "GRID,{id},,{i}.,{j}.,{:.5}", z(f64::from(j)));
    }
    for (j, i) in (0..SIDE).flat_map(|j| (0..SIDE).map(move |i| (j, i))) {
        let a = 1 + (SIDE + 1) * j + i;
        let (b, id) = (a + SIDE + 1, 1 + SIDE * j + i);
        let _ = writeln!(deck, "CQUAD4,{id},1,{a},{},{},{b}", a + 1, b + 1);
    }
    deck.push_str("ENDDATA\n");
    let deck = read_deck("sheet.bdf", deck.into_bytes(), &mut MemoryLoader::default());
    Model::from_deck(&deck).0
}

#[test]
fn a_gauge_that_is_dragged_over_a_coarser_picture_lands_on_the_elements() {
    let model = sheet();
    let mut scene = scene_of_model(&model, Places::default());
    scene.pointing = PickTargets::Gauges;
    // A long list of fields makes the picture coarser.
    let field = |i: usize| Field {
        name: format!("F{i}"),
        unit: String::new(),
        values: FieldValues::Magnitudes(Vec::new()),
        scale: 1.0,
    };
    scene.fields = (0..18).map(field).collect();
    let start = [160.0, 156.0, z(156.0)];
    scene.marks = vec![Mark {
        name: "P01".into(),
        at: Vec3::from(start),
        axes: Some([Vec3::x(), Vec3::z()]),
        surface: Some(Surface::Top),
        note: String::new(),
        gap: None,
    }];
    let section = scene_section("Model", &scene);
    let html = Page::new("Sheet", "", &[], vec![section]).to_html();
    assert!(html.contains("coarser than the model"));
    let report = folder("sheet").join("report.html");
    std::fs::write(&report, html).unwrap();
    // Over a whole wave: crest, flanks, trough.
    let places = (0..=12)
        .map(|k| 100.0 + f64::from(k))
        .map(|y| [140.0, y, z(y)]);
    let places: Vec<[f64; 3]> = places.collect();
    let mut steps = vec![json!(["view", "z"]), json!(["tool", "gauge"])];
    let mut from = start;
    for to in &places {
        steps.push(json!(["drag", from, to]));
        steps.push(json!(["lines"]));
        from = *to;
    }
    let Some(printed) = run_page_steps(&report, 1280, &json!(steps)) else {
        return;
    };
    for k in 0..places.len() {
        let row = printed["lines"][k][1]
            .as_str()
            .unwrap()
            .lines()
            .nth(1)
            .unwrap();
        let cells: Vec<f64> = row
            .split(',')
            .skip(2)
            .take(3)
            .map(|c| c.parse().unwrap())
            .collect();
        let off = cells[2] - z(cells[1]);
        // The wave has a radius of 3.6 mm. The middles of squares of 1 mm are 0.034 mm off, and a plane through them
        // has the same error at its ends. The raster of the middles is 0.02 mm. The facets of the picture, 2 to 3 mm
        // wide, are up to 0.2 mm off.
        assert!(off.abs() < 0.09, "{off} at {cells:?}");
    }
}
