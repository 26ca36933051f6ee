//! Elimination of the first unknowns of a dense symmetric matrix, lower triangles by columns.
//!
//! Blocks are halved until they are narrow enough to stay in registers; the remaining work is matrix products. Threads share large matrices in tiles
//! of a fixed size, so that rounding doesn't depend on the number of threads. Entries above diagonals are never read.

use super::narrow_blocks;
use faer::linalg::matmul::matmul;
use faer::prelude::{IntoConst, Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

/// Columns eliminated at a time.
const BLOCK: usize = 96;
/// Rows of a tile: with `BLOCK` columns they stay in the cache.
const TILE: usize = 192;
/// Columns of a product whose upper triangle is formed in vain.
const STRIP: usize = 48;

/// Whether threads share a matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Tiles {
    /// One thread has it to itself.
    Own,
    /// All threads that are free take part.
    Shared,
}

/// Factors the first `w` columns in place. `panel` contains all rows of these columns.
///
/// # Errors
/// The column whose pivot is not positive.
pub(super) fn eliminate(mut panel: MatMut<'_, f64>, tiles: Tiles) -> Result<(), usize> {
    let w = panel.ncols();
    for k in (0..w).step_by(BLOCK) {
        let n = BLOCK.min(w - k);
        let (done, rest) = panel.rb_mut().split_at_col_mut(k);
        let rows = rest.nrows() - k;
        let done = done.into_const().subrows(k, rows);
        let (mut own, below) = rest
            .subrows_mut(k, rows)
            .subcols_mut(0, n)
            .split_at_row_mut(n);
        let (left_block, done_below) = done.split_at_row(n);
        subtract(own.rb_mut(), left_block, left_block);
        cholesky(own.rb_mut()).map_err(|i| k + i)?;
        let own = own.into_const();
        let finish = |(at, mut tile): (usize, MatMut<'_, f64>)| {
            let rows = tile.nrows();
            subtract(tile.rb_mut(), done_below.subrows(at, rows), left_block);
            solve(own, tile);
        };
        match tiles {
            Tiles::Own => row_tiles(below).into_iter().for_each(finish),
            Tiles::Shared => row_tiles(below).into_par_iter().for_each(finish),
        }
    }
    Ok(())
}

/// a -= b c'
fn subtract(a: MatMut<'_, f64>, b: MatRef<'_, f64>, c: MatRef<'_, f64>) {
    if b.ncols() > 0 {
        matmul(a, Accum::Add, b, c.transpose(), -1.0, Par::Seq);
    }
}

/// The factor of a diagonal block.
fn cholesky(a: MatMut<'_, f64>) -> Result<(), usize> {
    let n = a.nrows();
    if n <= narrow_blocks::MOST {
        return narrow_blocks::cholesky(a);
    }
    let left = half(n);
    let (mut a00, _, mut a10, mut a11) = a.split_at_mut(left, left);
    cholesky(a00.rb_mut())?;
    solve(a00.rb(), a10.rb_mut());
    let left_block = a10.into_const();
    subtract(a11.rb_mut(), left_block, left_block);
    cholesky(a11).map_err(|i| left + i)
}

/// x in x l' = b, which `x` holds.
fn solve(l: MatRef<'_, f64>, x: MatMut<'_, f64>) {
    let n = l.nrows();
    if n <= narrow_blocks::MOST {
        narrow_blocks::solve(l, x);
        return;
    }
    let left = half(n);
    let (l00, _, l10, l11) = l.split_at(left, left);
    let (mut x0, mut x1) = x.split_at_col_mut(left);
    solve(l00, x0.rb_mut());
    subtract(x1.rb_mut(), x0.rb(), l10);
    solve(l11, x1);
}

/// About half, so that narrow blocks are full.
fn half(n: usize) -> usize {
    (n / 2).next_multiple_of(narrow_blocks::MOST)
}

/// Computes the lower triangle of `update -= below below'`. With `Accum::Replace`, the previous content of `update` is not read.
pub(super) fn take_out(
    update: MatMut<'_, f64>,
    begin: Accum,
    below: MatRef<'_, f64>,
    tiles: Tiles,
) {
    let strip = |(at, strip): (usize, MatMut<'_, f64>)| {
        let (n, rows) = (strip.ncols(), strip.nrows() - at);
        let (lower, right) = (below.subrows(at, rows), below.subrows(at, n));
        let to = strip.subrows_mut(at, rows);
        matmul(to, begin, lower, right.transpose(), -1.0, Par::Seq);
    };
    let all = strips(update);
    match tiles {
        Tiles::Own => all.into_iter().for_each(strip),
        Tiles::Shared => all.into_par_iter().for_each(strip),
    }
}

/// Returns the number of multiplications of [`eliminate`] and [`take_out`] in sequence, however many threads share the matrix. Every block of columns
/// contributes the block itself and one tile of rows, then one strip.
pub(super) fn longest_chain(own: usize, below: usize) -> f64 {
    let blocks = (0..own).step_by(BLOCK).map(|k| {
        let (n, tile) = (BLOCK.min(own - k), TILE.min(own + below - k));
        let (n, before, tile) = (n as f64, k as f64, tile as f64);
        n * n * before + n * n * n / 6.0 + tile * n * (before + n / 2.0)
    });
    let strip = (STRIP.min(below) * below) as f64 * own as f64;
    blocks.sum::<f64>() + strip
}

/// Tiles of rows with the first row of each.
fn row_tiles(mut a: MatMut<'_, f64>) -> Vec<(usize, MatMut<'_, f64>)> {
    let mut tiles = Vec::with_capacity(a.nrows() / TILE + 1);
    let mut at = 0;
    while a.nrows() > 0 {
        let n = TILE.min(a.nrows());
        let (tile, rest) = a.split_at_row_mut(n);
        tiles.push((at, tile));
        (at, a) = (at + n, rest);
    }
    tiles
}

/// Strips of columns with the first column of each.
fn strips(mut a: MatMut<'_, f64>) -> Vec<(usize, MatMut<'_, f64>)> {
    let mut strips = Vec::with_capacity(a.ncols() / STRIP + 1);
    let mut at = 0;
    while a.ncols() > 0 {
        let n = STRIP.min(a.ncols());
        let (strip, rest) = a.split_at_col_mut(n);
        strips.push((at, strip));
        (at, a) = (at + n, rest);
    }
    strips
}
