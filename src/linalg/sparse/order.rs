//! Elimination orders that keep the factor small: nested dissection against approximate minimum degree.

use super::graph::BlockGraph;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;
use feral_metis::{CscPattern, MetisOptions, metis_order_full};
use serde::Serialize;

/// Ordering that was kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum OrderingMethod {
    /// Multilevel nested dissection (Karypis and Kumar 1998).
    NestedDissection,
    /// Approximate minimum degree (Amestoy, Davis and Duff 1996).
    MinimumDegree,
}

/// Returns orders (new to old) to compare, each with its name. Nested dissection is left out for graphs of unsuitable size.
pub(super) fn candidates(graph: &BlockGraph) -> Vec<(OrderingMethod, Vec<u32>)> {
    let (metis, degree) = rayon::join(|| nested_dissection(graph), || minimum_degree(graph));
    let mut all = Vec::new();
    if let Some(order) = metis {
        all.push((OrderingMethod::NestedDissection, order));
    }
    if let Some(order) = degree {
        all.push((OrderingMethod::MinimumDegree, order));
    }
    if all.is_empty() {
        all.push((
            OrderingMethod::MinimumDegree,
            (0..graph.n() as u32).collect(),
        ));
    }
    all
}

fn nested_dissection(graph: &BlockGraph) -> Option<Vec<u32>> {
    let start: Vec<i32> = graph
        .start
        .iter()
        .map(|&s| i32::try_from(s).ok())
        .collect::<Option<_>>()?;
    let rows: Vec<i32> = graph.neighbours.iter().map(|&v| v as i32).collect();
    let pattern = CscPattern::new(graph.n(), &start, &rows)?;
    let (order, _, _) = metis_order_full(&pattern, &MetisOptions::default()).ok()?;
    permutation(order.into_iter().map(|v| v as u32).collect(), graph.n())
}

fn minimum_degree(graph: &BlockGraph) -> Option<Vec<u32>> {
    let n = graph.n();
    let rows: Vec<usize> = graph.neighbours.iter().map(|&v| v as usize).collect();
    let pattern =
        SymbolicSparseColMatRef::<'_, usize>::new_checked(n, n, &graph.start, None, &rows);
    let scratch = amd::order_maybe_unsorted_scratch::<usize>(n, graph.neighbours.len());
    let mut memory = MemBuffer::try_new(scratch).ok()?;
    let (mut forward, mut inverse) = (vec![0_usize; n], vec![0_usize; n]);
    amd::order(
        &mut forward,
        &mut inverse,
        pattern,
        amd::Control::default(),
        MemStack::new(&mut memory),
    )
    .ok()?;
    permutation(forward.into_iter().map(|v| v as u32).collect(), n)
}

/// The order itself if every vertex is in it once.
fn permutation(order: Vec<u32>, n: usize) -> Option<Vec<u32>> {
    let mut seen = vec![false; n];
    let fits = order.len() == n
        && order.iter().all(|&v| {
            seen.get_mut(v as usize)
                .is_some_and(|s| !std::mem::replace(s, true))
        });
    fits.then_some(order)
}
