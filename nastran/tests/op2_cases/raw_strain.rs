//! Shell strain that pyNastran skips. The script of the oracle reads it word by word.

use nastran::op2::Op2;
use nastran::results::{Quantity, ShellForm};
use serde_json::Value;

/// Compares a case. Returns the number of its blocks.
pub fn compare(case: &str, op2: &Op2<'_>, expected: &Value) -> usize {
    let empty = Vec::new();
    let blocks = expected["raw_shell_strain"].as_array().unwrap_or(&empty);
    for want in blocks {
        let element = if want["element_type"] == "CQUAD4" {
            33
        } else {
            74
        };
        let place = format!("{case} type {element} subcase {}", want["subcase"]);
        let block = (0..op2.blocks.len())
            .find(|i| {
                let b = &op2.blocks[*i];
                b.quantity == Quantity::Strain
                    && b.element.is_some_and(|e| e.0 == element)
                    && want["subcase"] == b.subcase
            })
            .unwrap_or_else(|| panic!("{place}: no block"));
        let fiber = want["s_code"].as_i64().unwrap() & 4 != 0;
        assert_eq!(
            op2.blocks[block].form,
            Some(if fiber {
                ShellForm::Fiber
            } else {
                ShellForm::Curvature
            }),
            "{place}"
        );
        let rows = op2.rows(block).unwrap();
        assert_eq!(want["rows_in_file"], rows.len() / 2, "{place}");
        for c in 0..16 {
            let column = (0..rows.len())
                .filter(|i| i % 2 == c / 8)
                .map(|i| rows.row(i)[c % 8]);
            let largest = column.clone().fold(0.0, |a: f64, x| a.max(x.abs()));
            let l2 = column.map(|x| x * x).sum::<f64>().sqrt();
            assert!(
                (want["l2"][c].as_f64().unwrap() - l2).abs() <= 1e-12 * l2,
                "{place}: column {c}"
            );
            for sample in want["rows"].as_array().unwrap() {
                let i = (0..rows.len())
                    .step_by(2)
                    .find(|i| sample[0] == rows.ids[*i].entity)
                    .unwrap();
                let got = rows.row(i + c / 8)[c % 8];
                assert!(
                    (sample[1 + c].as_f64().unwrap() - got).abs() <= 1e-12 * largest,
                    "{place}: column {c}"
                );
            }
        }
    }
    blocks.len()
}
