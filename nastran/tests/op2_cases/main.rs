//! Compares every case of the shared set with an OP2 with the result of pyNastran (`expected.json`). A new case needs no code.

mod cases;
mod columns;
mod mesh;
mod raw_strain;
#[path = "../support/mod.rs"]
mod support;
mod tables;

use cases::at_least;
use nastran::op2::{ByteOrder, Op2};

#[test]
fn byte_order_word_size_label_and_table_names_agree() {
    at_least(25, |case, op2, expected| {
        let layout = &expected["op2"];
        let order = if op2.byte_order == ByteOrder::Little {
            "little"
        } else {
            "big"
        };
        assert_eq!(layout["byte_order"], order, "{case}");
        assert_eq!(layout["word_bytes"], op2.word_bytes, "{case}");
        assert_eq!(
            layout["version_label"].as_str(),
            op2.version_label.as_deref(),
            "{case}"
        );
        let names: Vec<&str> = op2.tables.iter().map(|t| t.name.as_str()).collect();
        let want: Vec<&str> = layout["tables"]
            .as_array()
            .unwrap()
            .iter()
            .map(|t| t.as_str().unwrap())
            .collect();
        assert_eq!(want, names, "{case}");
        1
    });
}

#[test]
fn every_result_table_agrees_in_ids_sums_and_sampled_rows() {
    // The set has 433.
    at_least(400, tables::compare);
}

#[test]
fn shell_strain_in_a_table_named_for_stress_agrees() {
    // The set has four.
    at_least(4, raw_strain::compare);
}

#[test]
fn grid_point_weight_agrees() {
    // The set has three.
    at_least(3, |case, op2, expected| {
        let want = &expected["op2"]["grid_point_weight"];
        let Some((_, want)) = want.as_object().and_then(|o| o.iter().next()) else {
            return 0;
        };
        let got = op2
            .grid_point_weight()
            .unwrap_or_else(|| panic!("{case}: no grid point weight"));
        assert_eq!(want["reference_point"], got.reference, "{case}");
        let same = |name: &str, got: &[f64]| {
            let want: Vec<f64> = want[name]
                .as_array()
                .unwrap()
                .iter()
                .flat_map(|r| match r.as_array() {
                    Some(row) => row.iter().map(|v| v.as_f64().unwrap()).collect(),
                    None => vec![r.as_f64().unwrap()],
                })
                .collect();
            let same = want
                .iter()
                .zip(got)
                .all(|(w, g)| (w - g).abs() <= 1e-15 * w.abs());
            assert!(
                same && want.len() == got.len(),
                "{case} {name}: {got:?}, pyNastran {want:?}"
            );
        };
        same("MO", got.mo.as_flattened());
        same("mass", &got.mass);
        same("cg", got.cg.as_flattened());
        1
    });
}

#[test]
fn a_file_that_is_no_op2_is_refused_with_its_first_bytes() {
    let err = Op2::read(b"$ a deck\nCEND\nBEGIN BULK\n").unwrap_err();
    assert!(err.to_string().contains("not an OP2"), "{err}");
    assert!(Op2::read(b"").is_err());
}

#[test]
fn cards_of_the_geometry_blocks_agree_with_the_mesh() {
    // The set has 21 files with geometry blocks.
    at_least(18, |case, op2, expected| {
        usize::from(mesh::compare(case, op2, expected))
    });
}
