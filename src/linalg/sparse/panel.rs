//! Substitution with the columns of one supernode, for `K` right-hand sides stored by rows. Four columns at a time are read once, from the first row
//! to the last, while the values that they multiply stay in registers.

/// Columns that go together.
const TOGETHER: usize = 4;

/// A supernode's columns of the factor.
#[derive(Clone, Copy)]
pub(super) struct Panel<'a> {
    /// Values by columns, each column from its diagonal down.
    pub(super) values: &'a [f64],
    /// Rows of the supernode, then the rows below.
    pub(super) rows: usize,
    /// Number of columns, equal to the number of the supernode's rows.
    pub(super) own: usize,
}

/// One panel and the rows it works on.
struct Forward<'a, 'b, const K: usize>(Panel<'a>, &'b mut [[f64; K]]);

struct Backward<'a, 'b, const K: usize>(Panel<'a>, &'b mut [[f64; K]]);

impl<const K: usize> pulp::WithSimd for Forward<'_, '_, K> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self(panel, work) = self;
        for j in (0..panel.own).step_by(TOGETHER) {
            match panel.own - j {
                1 => panel.forward_columns::<1, K>(j, work),
                2 => panel.forward_columns::<2, K>(j, work),
                3 => panel.forward_columns::<3, K>(j, work),
                _ => panel.forward_columns::<TOGETHER, K>(j, work),
            }
        }
    }
}

impl<const K: usize> pulp::WithSimd for Backward<'_, '_, K> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self(panel, work) = self;
        for j in (0..panel.own).step_by(TOGETHER).rev() {
            match panel.own - j {
                1 => panel.backward_columns::<1, K>(j, work),
                2 => panel.backward_columns::<2, K>(j, work),
                3 => panel.backward_columns::<3, K>(j, work),
                _ => panel.backward_columns::<TOGETHER, K>(j, work),
            }
        }
    }
}

impl Panel<'_> {
    /// Solves `L11 x = b` on the rows of the supernode, which are the first rows of `work`. Then subtracts `L21 x` from the other rows.
    pub(super) fn forward<const K: usize>(self, work: &mut [[f64; K]]) {
        pulp::Arch::new().dispatch(Forward(self, work));
    }

    /// Solves `L11' x = b - L21' y` on the rows of the supernode, which are the first rows of `work`. `y` are the other rows.
    pub(super) fn backward<const K: usize>(self, work: &mut [[f64; K]]) {
        pulp::Arch::new().dispatch(Backward(self, work));
    }

    /// `N` columns from the `j`th, each from its diagonal down.
    #[inline(always)]
    fn columns<const N: usize>(&self, j: usize) -> [&[f64]; N] {
        std::array::from_fn(|a| {
            let column = j + a;
            // Earlier columns lack the rows above their diagonals: 0, 1 .. column - 1 rows.
            let from = column * self.rows - column * column.saturating_sub(1) / 2;
            &self.values[from..][..self.rows - column]
        })
    }

    /// Returns the part of these columns below the rows of all `N`.
    #[inline(always)]
    fn lower_part<'a, const N: usize>(columns: &[&'a [f64]; N], below: usize) -> [&'a [f64]; N] {
        std::array::from_fn(|a| &columns[a][N - a..][..below])
    }

    #[inline(always)]
    fn forward_columns<const N: usize, const K: usize>(&self, j: usize, work: &mut [[f64; K]]) {
        let columns = self.columns::<N>(j);
        let (own, below) = work[j..self.rows].split_at_mut(N);
        let mut x = [[0.0; K]; N];
        for a in 0..N {
            let mut v = own[a];
            for b in 0..a {
                for m in 0..K {
                    v[m] -= columns[b][a - b] * x[b][m];
                }
            }
            let inverse = 1.0 / columns[a][0];
            for m in 0..K {
                x[a][m] = v[m] * inverse;
            }
        }
        own.copy_from_slice(&x);
        let lower = Self::lower_part(&columns, below.len());
        for i in 0..below.len() {
            let mut sum = below[i];
            for a in 0..N {
                let l = lower[a][i];
                for m in 0..K {
                    sum[m] -= l * x[a][m];
                }
            }
            below[i] = sum;
        }
    }

    #[inline(always)]
    fn backward_columns<const N: usize, const K: usize>(&self, j: usize, work: &mut [[f64; K]]) {
        let columns = self.columns::<N>(j);
        let (own, below) = work[j..self.rows].split_at_mut(N);
        let lower = Self::lower_part(&columns, below.len());
        let mut sums = [[0.0; K]; N];
        for i in 0..below.len() {
            let y = below[i];
            for a in 0..N {
                let l = lower[a][i];
                for m in 0..K {
                    sums[a][m] += l * y[m];
                }
            }
        }
        for a in (0..N).rev() {
            let mut v = own[a];
            for m in 0..K {
                v[m] -= sums[a][m];
            }
            for b in a + 1..N {
                for m in 0..K {
                    v[m] -= columns[a][b - a] * own[b][m];
                }
            }
            let inverse = 1.0 / columns[a][0];
            for m in 0..K {
                own[a][m] = v[m] * inverse;
            }
        }
    }
}
