use super::block_matrix::DenseTerm;
use super::*;

/// Returns a grid of springs with `side` squared groups of `m` unknowns each. A stiffness joins every pair of neighbours. A corner is fixed if
/// `held`.
fn lattice(side: usize, m: usize, held: bool) -> (BlockGraph, Vec<u8>, Vec<(Vec<u32>, Vec<f64>)>) {
    let n = side * side;
    let mut terms = Vec::new();
    for i in 0..side {
        for j in 0..side {
            let v = (i * side + j) as u32;
            if i + 1 < side {
                terms.push(vec![v, v + side as u32]);
            }
            if j + 1 < side {
                terms.push(vec![v, v + 1]);
            }
        }
    }
    let pair = |w: f64| {
        let mut k = vec![0.0; 4 * m * m];
        for a in 0..m {
            for b in 0..m {
                let v = if a == b { w } else { 0.1 * w / m as f64 };
                k[a * 2 * m + b] += v;
                k[(m + a) * 2 * m + m + b] += v;
                k[a * 2 * m + m + b] -= v;
                k[(m + a) * 2 * m + b] -= v;
            }
        }
        k
    };
    let mut all: Vec<(Vec<u32>, Vec<f64>)> = terms
        .iter()
        .enumerate()
        .map(|(i, t)| (t.clone(), pair(1.0 + (i % 7) as f64)))
        .collect();
    if held {
        let mut k = vec![0.0; m * m];
        (0..m).for_each(|a| k[a * m + a] = 3.0);
        all.push((vec![0], k));
    }
    (
        BlockGraph::from_cliques(n, || terms.iter().map(Vec::as_slice)),
        vec![m as u8; n],
        all,
    )
}

fn assemble(
    symbolic: &Symbolic,
    graph: &BlockGraph,
    terms: &[(Vec<u32>, Vec<f64>)],
    m: usize,
) -> BlockMatrix {
    let groups: Vec<Vec<u32>> = terms.iter().map(|t| t.0.clone()).collect();
    let term = |i: usize| {
        let (groups, matrix) = terms[i].clone();
        let offsets = (0..=groups.len()).map(|i| i * m).collect();
        Ok::<_, ()>(DenseTerm {
            groups,
            offsets,
            matrix,
        })
    };
    BlockMatrix::assemble_terms(symbolic, graph, &groups, term).unwrap()
}

#[test]
fn the_solution_of_many_right_hand_sides_satisfies_the_equations() {
    for (side, m) in [(1, 3), (2, 6), (23, 6), (60, 2)] {
        let (graph, sizes, terms) = lattice(side, m, true);
        let symbolic = Symbolic::analyse(&graph, &sizes).unwrap();
        let matrix = assemble(&symbolic, &graph, &terms, m);
        let factor = Factor::new(&symbolic, matrix.clone()).unwrap();
        assert!(factor.lost.is_empty());
        let n = symbolic.n_unknowns();
        // There are more right-hand sides than one pass solves.
        let b: Vec<f64> = (0..29 * n)
            .map(|i| ((i * 37 + 11) % 101) as f64 / 50.0 - 1.0)
            .collect();
        let mut x = b.clone();
        factor.solve(&mut x);
        for (x, b) in x.chunks(n).zip(b.chunks(n)) {
            let r = matrix.times(&symbolic, x);
            let worst = r
                .iter()
                .zip(b)
                .map(|(r, b)| (r - b).abs())
                .fold(0.0, f64::max);
            assert!(worst < 1e-9, "side {side}: residual {worst:e}");
        }
    }
}

#[test]
fn every_unknown_is_in_one_branch_or_the_top_and_threads_change_nothing() {
    let (side, m) = (60, 3);
    let (graph, sizes, terms) = lattice(side, m, true);
    let symbolic = Symbolic::analyse(&graph, &sizes).unwrap();
    let (n, branches) = (symbolic.n_unknowns(), &symbolic.branches);
    let mut times = vec![0; n];
    for b in &branches.list {
        times[b.unknowns.clone()].iter_mut().for_each(|t| *t += 1);
    }
    let mut in_top = 0;
    for (g, place) in (0..).zip(&branches.in_top) {
        if *place != u32::MAX {
            assert_eq!(*place as usize, in_top);
            in_top += symbolic.of_group(g).len();
            times[symbolic.of_group(g)].iter_mut().for_each(|t| *t += 1);
        }
    }
    assert_eq!(in_top, branches.n_top);
    assert!(times.iter().all(|t| *t == 1));
    // The lattice is divided, and the top is the smaller part.
    assert!(branches.list.len() > 8 && branches.n_top < n / 2);
    let matrix = assemble(&symbolic, &graph, &terms, m);
    let solved = |threads: usize| {
        let mut x: Vec<f64> = (0..7 * n).map(|i| ((i * 31) % 17) as f64 - 8.0).collect();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let accuracies = pool.build().unwrap().install(|| {
            let factor = Factor::new(&symbolic, matrix.clone()).unwrap();
            factor.solve_refined(&mut x, 0.0)
        });
        (x, accuracies.len())
    };
    let (one, accuracies) = solved(1);
    assert_eq!(accuracies, 7);
    for threads in [2, 5] {
        // Equal in every bit, although the factor too is computed by this number of threads.
        assert!(solved(threads).0 == one);
    }
}

#[test]
fn work_on_paper_is_that_of_a_dense_matrix_and_bounded_by_its_longest_chain() {
    // All groups are connected: one front, or a chain of fronts, of a dense matrix.
    let n: u32 = 100;
    let all: Vec<u32> = (0..n).collect();
    let graph = BlockGraph::from_cliques(n as usize, || std::iter::once(all.as_slice()));
    let dense = Symbolic::analyse(&graph, &[6; 100]).unwrap();
    let cube = (6.0 * f64::from(n)).powi(3) / 6.0;
    assert!((dense.tree_work().total / cube - 1.0).abs() < 1e-9);
    let (graph, sizes, _) = lattice(60, 3, true);
    for symbolic in [dense, Symbolic::analyse(&graph, &sizes).unwrap()] {
        let work = symbolic.tree_work();
        let with = |threads| symbolic.work_with(threads);
        assert!((with(1) / work.total - 1.0).abs() < 1e-9);
        for threads in [2, 4, 8, 64] {
            assert!(with(threads) <= with(threads / 2));
            assert!(with(threads) >= work.longest.max(work.total / threads as f64));
        }
    }
}

#[test]
fn epsilon_is_small_where_digits_are_lost_and_refinement_makes_it_no_larger() {
    let (side, m) = (40, 6);
    let (graph, sizes, mut terms) = lattice(side, m, true);
    // Every third spring is a million times softer than the other springs, so that digits are lost.
    for (_, k) in terms.iter_mut().step_by(3) {
        k.iter_mut().for_each(|k| *k *= 1e-6);
    }
    let symbolic = Symbolic::analyse(&graph, &sizes).unwrap();
    let matrix = assemble(&symbolic, &graph, &terms, m);
    let factor = Factor::new(&symbolic, matrix.clone()).unwrap();
    assert!(factor.lost.is_empty());
    let n = symbolic.n_unknowns();
    let b: Vec<f64> = (0..2 * n).map(|i| ((i * 7) % 13) as f64 - 6.0).collect();
    let (mut plain, mut refined) = (b.clone(), b.clone());
    factor.solve(&mut plain);
    let accuracies = factor.solve_refined(&mut refined, 0.0);
    let epsilon = |x: &[f64], b: &[f64]| {
        let ax = matrix.times(&symbolic, x);
        let lost: f64 = (0..n).map(|i| x[i] * (b[i] - ax[i])).sum();
        let work: f64 = x.iter().zip(b).map(|(x, b)| x * b).sum();
        (lost / work).abs()
    };
    for c in 0..2 {
        let at = c * n..(c + 1) * n;
        // Both residuals are rounding errors, summed in a different order, so that only their sizes are similar. A residual of the wrong matrix is of
        // order one.
        assert!(epsilon(&plain[at.clone()], &b[at.clone()]) < 1e-6);
        assert!(accuracies[c].first < 1e-6, "{:e}", accuracies[c].first);
        assert!(accuracies[c].last <= accuracies[c].first);
        assert!(epsilon(&refined[at.clone()], &b[at]) < 1e-6);
    }
}

#[test]
fn every_unknown_that_nothing_holds_is_reported_and_stays_at_zero() {
    let (graph, sizes, terms) = lattice(12, 3, false);
    let symbolic = Symbolic::analyse(&graph, &sizes).unwrap();
    let matrix = assemble(&symbolic, &graph, &terms, 3);
    let factor = Factor::new(&symbolic, matrix.clone()).unwrap();
    assert_eq!(
        factor.lost.len(),
        3,
        "three free translations, smallest pivot {:e}",
        factor.smallest_pivot
    );
    let mut x = vec![0.0; symbolic.n_unknowns()];
    x[0] = 1.0;
    x[3 * 143] = -1.0;
    let b = x.clone();
    factor.solve(&mut x);
    let r = matrix.times(&symbolic, &x);
    assert!(r.iter().zip(&b).all(|(r, b)| (r - b).abs() < 1e-9));
}

#[test]
fn the_factor_has_no_more_entries_than_a_band_would() {
    let (graph, sizes, _) = lattice(60, 2, true);
    let symbolic = Symbolic::analyse(&graph, &sizes).unwrap();
    let n = symbolic.n_unknowns();
    assert!(symbolic.factor_nonzeros() < n * 2 * 60 / 2);
}

#[test]
fn components_are_counted() {
    let cliques: [&[u32]; 2] = [&[0, 2], &[1, 3, 4]];
    let (of, count) = BlockGraph::from_cliques(6, || cliques.iter().copied()).components();
    assert_eq!((of, count), (vec![0, 1, 0, 1, 1, 2], 3));
}
