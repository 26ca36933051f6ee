//! Compares a result table of pyNastran with the blocks of this crate.

use crate::columns;
use nastran::op2::Op2;
use nastran::results::{Analysis, Rows};
use serde_json::Value;
use std::collections::HashMap;

/// Compares every result table of a case. Returns their number.
pub fn compare(case: &str, op2: &Op2<'_>, expected: &Value) -> usize {
    let empty = Vec::new();
    let results = expected["op2"]["results"].as_array().unwrap_or(&empty);
    let mut used: HashMap<String, usize> = HashMap::new();
    for want in results {
        let place = format!("{case} {} {}", want["result"], want["subcase_key"]);
        assert!(want["l2"].is_array(), "{place}: the oracle has no numbers");
        let steps = want["shape"][0].as_u64().unwrap() as usize;
        let mut blocks = find_matching_blocks(op2, want);
        // One key may mean several series of blocks (buckling loops), which are compared in the order of the file.
        let key = format!(
            "{}{}{}{}",
            want["result"], want["subcase_key"], want["table_name"], want["element_type"]
        );
        let skip = used.entry(key).or_default();
        blocks.drain(..(*skip).min(blocks.len()));
        *skip += steps;
        assert!(
            blocks.len() >= steps,
            "{place}: {} blocks for {steps} steps",
            blocks.len()
        );
        compare_table(&place, op2, want, &blocks[..steps]);
    }
    results.len()
}

/// Returns the blocks that may correspond to the table.
fn find_matching_blocks(op2: &Op2<'_>, want: &Value) -> Vec<usize> {
    let quantity = columns::quantity(want["result"].as_str().unwrap());
    let int = |name: &str| want[name].as_i64();
    let sort2 = want["subcase_key"]
        .as_str()
        .unwrap()
        .split(',')
        .nth(2)
        .is_some_and(|s| s.trim() == "2");
    (0..op2.blocks.len())
        .filter(|i| {
            let b = &op2.blocks[*i];
            b.quantity == quantity
                && b.sort2 == sort2
                && !b.complex
                && int("isubcase") == Some(i64::from(b.subcase))
                && int("analysis_code").map(|c| Analysis::from_code(c as i32)) == Some(b.analysis)
                && int("num_wide") == Some(i64::from(b.num_wide))
                && (int("element_type").is_none()
                    || int("element_type") == b.element.map(|e| i64::from(e.0)))
                && (sort2 || want["table_name"].as_str() == Some(b.table.as_str()))
        })
        .collect()
}

fn compare_table(place: &str, op2: &Op2<'_>, want: &Value, blocks: &[usize]) {
    let rows: Vec<Rows> = blocks
        .iter()
        .map(|b| op2.rows(*b).unwrap_or_else(|e| panic!("{place}: {e}")))
        .collect();
    let theirs: Vec<&str> = want["columns"]
        .as_array()
        .unwrap()
        .iter()
        .map(|c| c.as_str().unwrap())
        .collect();
    let at = columns::positions(want["result"].as_str().unwrap(), &theirs, rows[0].columns);
    // pyNastran stores nodal tables of 64-bit files as float32.
    let tolerance = if want["dtype"] == "float64" {
        1e-12
    } else {
        1e-6
    };
    let n = want["shape"][1].as_u64().unwrap() as usize;
    for r in &rows {
        assert_eq!(r.len(), n, "{place}: rows");
    }
    for (c, &column) in at.iter().enumerate() {
        let value = |r: &Rows, i: usize| {
            Some(r.row(i)[column])
                .filter(|v| !v.is_nan())
                .unwrap_or(0.0)
        };
        let (mut l2, mut sum, mut abs, mut weighted, mut largest) = (0.0, 0.0, 0.0, 0.0, 0.0_f64);
        for r in &rows {
            for i in 0..n {
                let x = value(r, i);
                l2 += x * x;
                sum += x;
                abs += x.abs();
                weighted += x * (i + 1) as f64 / n as f64;
                largest = largest.max(x.abs());
            }
        }
        for (name, got, scale) in [
            ("l2", f64::sqrt(l2), l2.sqrt()),
            ("sum", sum, abs),
            ("sum_abs", abs, abs),
            ("sum_weighted_row_over_n", weighted, abs),
        ] {
            let w = want[name][c].as_f64().unwrap();
            assert!(
                (w - got).abs() <= tolerance * scale,
                "{place}: {name} of {} is {got}, pyNastran {w}",
                theirs[c]
            );
        }
        let id_columns = want["id_columns"].as_array().unwrap().len();
        for sample in want["rows"].as_array().unwrap() {
            let step = sample[0].as_u64().unwrap() as usize;
            let i = sample[1].as_u64().unwrap() as usize;
            if let Some(w) = sample[2 + id_columns + c].as_f64() {
                let got = rows[step].row(i)[column];
                assert!(
                    (w - got).abs() <= tolerance * largest,
                    "{place}: step {step} row {i} {}: {got}, pyNastran {w}",
                    theirs[c]
                );
            }
        }
    }
    compare_ids(place, want, &rows);
}

fn compare_ids(place: &str, want: &Value, rows: &[Rows]) {
    let kinds: Vec<&str> = want["id_columns"]
        .as_array()
        .unwrap()
        .iter()
        .map(|c| c.as_str().unwrap())
        .collect();
    for sample in want["rows"].as_array().unwrap() {
        let (step, i) = (
            sample[0].as_u64().unwrap() as usize,
            sample[1].as_u64().unwrap() as usize,
        );
        let id = rows[step].ids[i];
        for (k, kind) in kinds.iter().enumerate() {
            let got = match (k, *kind) {
                (0, _) => id.entity,
                (_, "layer") => id.layer,
                (_, "node" | "gridtype" | "element") => id.at,
                (_, other) => panic!("{place}: unknown id column {other}"),
            };
            assert_eq!(sample[2 + k], got, "{place}: step {step} row {i} {kind}");
        }
    }
}
