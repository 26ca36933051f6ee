//! Forms the stiffness of a shell as a sum of products of rows in one pass. Blocks of the stiffness stay in registers while all rows are added.

use super::types::Row;

/// Unknowns of the largest element, its rows' length here.
const WIDE: usize = 24;
/// Rows of a homogeneous quadrilateral: nine at each of its four points.
const ROOM: usize = 36;
/// Rows and columns of a block of the sum.
const BLOCK: (usize, usize) = (4, 8);

/// Rows `a` and `p`. The sum of `a' p` over the rows is a stiffness, which is symmetric.
#[derive(Debug)]
pub(super) struct Products {
    rows: Vec<([f64; WIDE], [f64; WIDE])>,
}

impl Products {
    /// Creates an empty list with capacity for the products of four points.
    pub(super) fn new() -> Self {
        Self {
            rows: Vec::with_capacity(ROOM),
        }
    }

    /// Adds a' D b.
    pub(super) fn add<const R: usize, const M: usize>(
        &mut self,
        a: &[Row<M>; R],
        law: &[[f64; R]; R],
        b: &[Row<M>; R],
    ) {
        for (a, row) in a.iter().zip(law) {
            let (mut left, mut right) = ([0.0; WIDE], [0.0; WIDE]);
            left[..M].copy_from_slice(a);
            for (c, b) in row.iter().zip(b) {
                for i in 0..M {
                    right[i] += c * b[i];
                }
            }
            self.rows.push((left, right));
        }
    }

    /// Returns the sum of all added products.
    pub(super) fn sum<const M: usize>(&self) -> [[f64; M]; M] {
        let mut sum = [[0.0; WIDE]; WIDE];
        pulp::Arch::new().dispatch(UpperHalf(&self.rows, &mut sum));
        std::array::from_fn(|i| std::array::from_fn(|j| sum[i.min(j)][i.max(j)]))
    }
}

/// Blocks of the sum on and above the diagonal, from rows.
struct UpperHalf<'a>(
    &'a [([f64; WIDE], [f64; WIDE])],
    &'a mut [[f64; WIDE]; WIDE],
);

impl pulp::WithSimd for UpperHalf<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        const H: usize = BLOCK.0;
        const W: usize = BLOCK.1;
        let Self(rows, sum) = self;
        for top in (0..WIDE).step_by(H) {
            for left in (top / W * W..WIDE).step_by(W) {
                let mut block = [[0.0; W]; H];
                for (a, p) in rows {
                    for i in 0..H {
                        for j in 0..W {
                            block[i][j] += a[top + i] * p[left + j];
                        }
                    }
                }
                for i in 0..H {
                    sum[top + i][left..left + W].copy_from_slice(&block[i]);
                }
            }
        }
    }
}
