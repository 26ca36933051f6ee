use super::*;
use nastran::bdf::{MemoryLoader, read_deck};

fn model(bulk: &str) -> Model {
    let text = format!("CEND\nBEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,100.,0.,0.\n{bulk}ENDDATA\n");
    let deck = read_deck("deck.bdf", text.into_bytes(), &mut MemoryLoader::default());
    Model::from_cards(&deck.cards).0
}

fn nodal(quantity: &str, grid: u32, force: f64) -> String {
    let head = format!("$TITLE   = T\n${quantity}\n$REAL OUTPUT\n$SUBCASE ID = 1\n");
    let row = |head: String, a: f64| format!("{head:<18}{a:>18.6E}{:>18.6E}{:>18.6E}\n", 0.0, 0.0);
    head + &row(format!("{grid:>10}       G"), force) + &row("-CONT-".to_string(), 0.0)
}

#[test]
fn grids_that_moved_are_an_error_with_the_worst_named() {
    let (here, there) = (model(""), model("GRID,3,,0.,1.,0.\n"));
    assert!(check_coordinates(&here, "run.op2", &there).is_empty());
    let mut moved = there.clone();
    moved.grids[1].x.z += 0.5;
    let findings = check_coordinates(&here, "run.op2", &moved);
    assert_eq!(
        (findings.len(), findings[0].code, findings[0].measured),
        (1, "coordinates-differ", Some(0.5))
    );
    // Rounding to single precision in the geometry blocks is not a difference.
    moved.grids[1].x = here.grids[1].x.map(|v| f64::from((v * 1.000_000_1) as f32));
    assert!(check_coordinates(&here, "run.op2", &moved).is_empty());
}

#[test]
fn reactions_are_reported_where_the_structure_should_be_free() {
    let text = nodal("OLOADS", 1, 1000.0) + &nodal("SPCF", 2, -1000.0);
    let file = ResultsFile::read(text.as_bytes(), "run.pch").unwrap();
    let m = model("");
    assert!(check_free(&m, "run.pch", &file, Supports::AsDeck).is_empty());
    let findings = check_free(&m, "run.pch", &file, Supports::Free);
    assert_eq!(
        (findings[0].code, findings[0].measured, findings[0].limit),
        ("not-free", Some(1000.0), Some(1.0))
    );
    let inertia_relief = model("PARAM,INREL,-2\n");
    assert_eq!(
        check_free(&inertia_relief, "run.pch", &file, Supports::AsDeck).len(),
        1
    );
    let quiet = nodal("OLOADS", 1, 1000.0) + &nodal("SPCF", 2, 1e-4);
    let file = ResultsFile::read(quiet.as_bytes(), "run.pch").unwrap();
    assert!(check_free(&m, "run.pch", &file, Supports::Free).is_empty());
}

#[test]
fn material_frame_output_is_warned_of() {
    let text = nodal("DISPLACEMENTS", 1, 0.0);
    let file = ResultsFile::read(text.as_bytes(), "run.pch").unwrap();
    let m = model("PARAM,OMID,YES\n");
    assert!(
        check_output(&m, "run.pch", &file)
            .iter()
            .any(|f| f.code == "omid")
    );
}
