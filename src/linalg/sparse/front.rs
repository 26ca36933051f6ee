//! One step of the multifrontal factorisation (Duff and Reid 1983): assemble a front, eliminate its columns, pass the rest on.

use super::block_matrix::BlockMatrix;
use super::symbolic::Symbolic;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{
    LltRegularization, cholesky_in_place, cholesky_in_place_scratch,
};
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, Par};

/// What a supernode leaves for its parent: a lower triangle over its rows, by columns.
#[derive(Debug)]
pub(super) struct Update {
    pub(super) supernode: usize,
    pub(super) values: Vec<f64>,
}

/// A run of unknowns that keep their neighbours from a child's rows to the parent's front.
struct Run {
    from: usize,
    to: usize,
    len: usize,
}

/// The panel (columns of L, by columns, rows of the supernode and below) and the update of supernode `s`; pivots of the scaled
/// matrix at or below `tiny` are replaced by `huge`.
pub(super) fn eliminate(
    symbolic: &Symbolic,
    a: &BlockMatrix,
    scale: &[f64],
    s: usize,
    children: Vec<Update>,
    (tiny, huge): (f64, f64),
    par: Par,
) -> Result<(Vec<f64>, Update), usize> {
    let node = &symbolic.supernodes[s];
    let (nc, nb) = (node.n_cols, node.n_rows);
    let n = nc + nb;
    let mut panel = vec![0.0; n * nc];
    let mut update = vec![0.0; nb * nb];
    let mut row_offset = Vec::with_capacity(node.rows.len());
    let mut at = nc;
    for &r in &node.rows {
        row_offset.push(at);
        at += symbolic.start[r as usize + 1] - symbolic.start[r as usize];
    }
    let first = symbolic.start[node.first as usize];
    let offset = |g: u32| {
        if g < node.end {
            symbolic.start[g as usize] - first
        } else {
            node.rows.binary_search(&g).map_or(0, |i| row_offset[i])
        }
    };
    for g in node.first..node.end {
        let (sg, mg) = (
            symbolic.start[g as usize],
            symbolic.start[g as usize + 1] - symbolic.start[g as usize],
        );
        let col = sg - first;
        for b in a.column[g as usize]..a.column[g as usize + 1] {
            let h = a.row[b];
            let sh = symbolic.start[h as usize];
            let mh = symbolic.start[h as usize + 1] - sh;
            let row = offset(h);
            for j in 0..mg {
                let from = if h == g { j } else { 0 };
                let target = &mut panel[(col + j) * n + row..][..mh];
                let source = &a.values[a.value_start[b] + j * mh..][..mh];
                for i in from..mh {
                    target[i] += source[i] * scale[sg + j] * scale[sh + i];
                }
            }
        }
    }
    for child in children {
        let rows = &symbolic.supernodes[child.supernode].rows;
        let m = symbolic.supernodes[child.supernode].n_rows;
        let mut runs: Vec<Run> = Vec::new();
        let mut from = 0;
        for &g in rows {
            let len = symbolic.start[g as usize + 1] - symbolic.start[g as usize];
            let to = offset(g);
            match runs.last_mut() {
                Some(run) if run.to + run.len == to => run.len += len,
                _ => runs.push(Run { from, to, len }),
            }
            from += len;
        }
        for (k, run) in runs.iter().enumerate() {
            for j in 0..run.len {
                let (source, target) = (&child.values[(run.from + j) * m..][..m], run.to + j);
                let (column, shift) = if target < nc {
                    (&mut panel[target * n..][..n], 0)
                } else {
                    (&mut update[(target - nc) * nb..][..nb], nc)
                };
                for (i, row) in runs[k..].iter().enumerate() {
                    let skip = if i == 0 { j } else { 0 };
                    let to = &mut column[row.to + skip - shift..][..row.len - skip];
                    for (t, v) in to
                        .iter_mut()
                        .zip(&source[row.from + skip..][..row.len - skip])
                    {
                        *t += v;
                    }
                }
            }
        }
    }
    if nc > 0 {
        let (mut top, mut bottom) =
            MatMut::from_column_major_slice_mut(&mut panel, n, nc).split_at_row_mut(nc);
        let before = top.to_owned();
        let mut memory = MemBuffer::new(cholesky_in_place_scratch::<f64>(
            nc,
            par,
            Default::default(),
        ));
        let done = cholesky_in_place(
            top.rb_mut(),
            LltRegularization::default(),
            par,
            MemStack::new(&mut memory),
            Default::default(),
        );
        if done.is_err() || (0..nc).any(|j| top[(j, j)] * top[(j, j)] <= tiny) {
            top.copy_from(&before);
            cholesky_with_lost_pivots(top.rb_mut(), tiny, huge).map_err(|j| first + j)?;
        }
        if nb > 0 {
            solve_lower_triangular_in_place(top.rb(), bottom.rb_mut().transpose_mut(), par);
            matmul(
                MatMut::from_column_major_slice_mut(&mut update, nb, nb),
                BlockStructure::TriangularLower,
                Accum::Add,
                bottom.rb(),
                BlockStructure::Rectangular,
                bottom.rb().transpose(),
                BlockStructure::Rectangular,
                -1.0,
                par,
            );
        }
    }
    Ok((
        panel,
        Update {
            supernode: s,
            values: update,
        },
    ))
}

/// Column by column Cholesky of the lower triangle in which a pivot at or below `tiny` becomes `huge`: its unknown is held at zero.
/// Slower than the blocked one; only for fronts that need it. The error is the column of a pivot that is not a number.
fn cholesky_with_lost_pivots(mut a: MatMut<'_, f64>, tiny: f64, huge: f64) -> Result<(), usize> {
    let n = a.ncols();
    for j in 0..n {
        let pivot = a[(j, j)];
        if pivot.is_nan() {
            return Err(j);
        }
        let root = if pivot <= tiny { huge } else { pivot }.sqrt();
        a[(j, j)] = root;
        let (_, mut right) = a.rb_mut().split_at_col_mut(j);
        let (column, mut rest) = right.rb_mut().split_at_col_mut(1);
        let mut column = column.col_mut(0);
        for i in j + 1..n {
            column[i] /= root;
        }
        for k in j + 1..n {
            let factor = column[k];
            if factor != 0.0 {
                for i in k..n {
                    rest[(i, k - j - 1)] -= factor * column[i];
                }
            }
        }
    }
    Ok(())
}
