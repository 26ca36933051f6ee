//! Joint uncertainty of several sizes.

use super::page::{Block, number};

/// Returns the joint covariance of named sizes as a folded table with its correlations; `None` for fewer than two sizes, for which sigma suffices.
pub(in crate::report) fn covariance_block(names: &[String], by_rows: &[f64]) -> Option<Block> {
    let n = names.len();
    if n < 2 || by_rows.len() != n * n {
        return None;
    }
    let entry = |i: usize, k: usize| by_rows.get(i * n + k).copied().unwrap_or(f64::NAN);
    let table = |value: &dyn Fn(usize, usize) -> f64| {
        let row = |(i, name): (usize, &String)| {
            let cells = (0..n).map(|k| number(value(i, k)));
            std::iter::once(name.clone()).chain(cells).collect()
        };
        let head: Vec<&str> = std::iter::once("")
            .chain(names.iter().map(String::as_str))
            .collect();
        Block::table(&head, names.iter().enumerate().map(row).collect())
    };
    let correlation = |i: usize, k: usize| {
        let both = (entry(i, i) * entry(k, k)).sqrt();
        if both > 0.0 { entry(i, k) / both } else { 0.0 }
    };
    Some(Block::Folded {
        summary: "Joint covariance of the sizes, in the product of their units; below it their correlation".into(),
        blocks: vec![table(&entry), table(&correlation)],
    })
}
