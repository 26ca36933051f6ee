//! Substitution with the columns of one supernode, for `K` right-hand sides row by row: four columns at a time go by once, from the first
//! row to the last, while what they multiply stays in registers.

/// Columns that go together.
const TOGETHER: usize = 4;

/// A supernode's columns of the factor.
#[derive(Clone, Copy)]
pub(super) struct Panel<'a> {
    /// By columns.
    pub(super) values: &'a [f64],
    /// Rows: its own and those below.
    pub(super) rows: usize,
    /// Columns, as many as own rows.
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
    /// Solves L11 x = b on its own rows, the first of `work`, and takes L21 x out of the rest.
    pub(super) fn forward<const K: usize>(self, work: &mut [[f64; K]]) {
        pulp::Arch::new().dispatch(Forward(self, work));
    }

    /// Solves L11' x = b - L21' y on its own rows, the first of `work`, where the rest is y.
    pub(super) fn backward<const K: usize>(self, work: &mut [[f64; K]]) {
        pulp::Arch::new().dispatch(Backward(self, work));
    }

    /// `N` columns from the `j`th, from the row of the first down.
    #[inline(always)]
    fn columns<const N: usize>(&self, j: usize) -> [&[f64]; N] {
        std::array::from_fn(|a| &self.values[(j + a) * self.rows + j..(j + a + 1) * self.rows])
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
                    v[m] -= columns[b][a] * x[b][m];
                }
            }
            let inverse = 1.0 / columns[a][a];
            for m in 0..K {
                x[a][m] = v[m] * inverse;
            }
        }
        own.copy_from_slice(&x);
        let columns = columns.map(|c| &c[N..][..below.len()]);
        for i in 0..below.len() {
            let mut sum = below[i];
            for a in 0..N {
                let l = columns[a][i];
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
        let lower = columns.map(|c| &c[N..][..below.len()]);
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
                    v[m] -= columns[a][b] * own[b][m];
                }
            }
            let inverse = 1.0 / columns[a][a];
            for m in 0..K {
                own[a][m] = v[m] * inverse;
            }
        }
    }
}
