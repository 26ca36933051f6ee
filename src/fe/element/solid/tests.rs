use super::form::SolidInput;
use crate::linalg::{DMatrix, Matrix6};
use crate::model::{Vec3, solid_edges};
use nastran::cards::SolidShape;

fn steel() -> Matrix6<f64> {
    let (e, nu) = (210_000.0, 0.3);
    let c = e / ((1.0 + nu) * (1.0 - 2.0 * nu));
    Matrix6::from_fn(|i, j| match (i < 3, j < 3, i == j) {
        (true, true, true) => c * (1.0 - nu),
        (true, true, false) => c * nu,
        (false, false, true) => e / (2.0 + 2.0 * nu),
        _ => 0.0,
    })
}

/// Returns a distorted element in a general orientation. `mids` of its edges have a grid, and the last one is not in the middle.
fn distorted_element(shape: SolidShape, mids: &[usize]) -> SolidInput {
    let r = nalgebra::Rotation3::from_euler_angles(0.4, -0.9, 1.7);
    let corners: &[[f64; 3]] = match shape {
        SolidShape::Tetra => &[[0., 0., 0.], [10., 1., 0.], [2., 8., -1.], [1., 2., 9.]],
        SolidShape::Penta => &[
            [0., 0., 0.],
            [10., 1., 0.],
            [2., 8., -1.],
            [1., 0., 9.],
            [11., 2., 8.],
            [3., 9., 10.],
        ],
        SolidShape::Hexa => &[
            [0., 0., 0.],
            [10., 1., 0.],
            [11., 9., -1.],
            [-1., 8., 0.5],
            [1., 0., 9.],
            [10., 2., 8.],
            [9., 9., 10.],
            [0., 10., 9.],
        ],
        SolidShape::Pyram => &[
            [0., 0., 0.],
            [10., 1., 0.],
            [11., 9., -1.],
            [-1., 8., 0.5],
            [5., 4., 9.],
        ],
    };
    let mut x: Vec<Vec3> = corners.iter().map(|c| Vec3::from(*c)).collect();
    for (k, m) in mids.iter().enumerate() {
        let (a, b) = solid_edges(shape)[*m];
        let off = if k + 1 == mids.len() { 0.4 } else { 0.0 };
        x.push((x[a] + x[b]) / 2.0 + Vec3::new(off, -off, 0.5 * off));
    }
    SolidInput {
        shape,
        x: x.iter()
            .map(|x| r * x + Vec3::new(900.0, -300.0, 50.0))
            .collect(),
        mids: mids.to_vec(),
    }
}

fn all_elements() -> Vec<SolidInput> {
    vec![
        distorted_element(SolidShape::Tetra, &[]),
        distorted_element(SolidShape::Penta, &[]),
        distorted_element(SolidShape::Hexa, &[]),
        distorted_element(SolidShape::Pyram, &[]),
        distorted_element(SolidShape::Tetra, &[0, 1, 2, 3, 4, 5]),
        distorted_element(SolidShape::Penta, &[0, 1, 2, 3, 4, 5, 6, 7, 8]),
        distorted_element(SolidShape::Hexa, &(0..12).collect::<Vec<_>>()),
        // Some mid-side grids are missing.
        distorted_element(SolidShape::Tetra, &[1, 4]),
        distorted_element(SolidShape::Penta, &[0, 3, 7]),
        distorted_element(SolidShape::Hexa, &[0, 2, 5, 8, 11]),
    ]
}

#[test]
fn six_rigid_motions_and_no_other_leave_a_solid_unstrained() {
    for s in all_elements() {
        let k = s.form(&steel(), None).unwrap().stiffness;
        let n = k.nrows();
        let largest = k.amax();
        let size = s.x.iter().map(|x| x.norm()).fold(0.0, f64::max);
        for mode in 0..6 {
            let r = DMatrix::from_fn(n, 1, |i, _| {
                let mut t = Vec3::zeros();
                t[mode % 3] = 1.0;
                let u = if mode < 3 {
                    t
                } else {
                    t.cross(&s.x[i / 3]) / size
                };
                u[i % 3]
            });
            let residual = (&k * r).amax() / largest;
            assert!(
                residual < 1e-10,
                "{:?} {} grids: {residual:e}",
                s.shape,
                n / 3
            );
        }
        let values = k.symmetric_eigenvalues();
        let zero = values
            .iter()
            .filter(|v| v.abs() < 1e-9 * values.max())
            .count();
        assert_eq!(zero, 6, "{:?} {} grids", s.shape, n / 3);
    }
}

#[test]
fn a_linear_displacement_field_gives_its_own_strain_at_every_point_of_a_straight_solid() {
    let g = nalgebra::Matrix3::new(1e-3, 4e-4, -2e-4, 5e-4, -3e-4, 6e-4, 1e-4, 2e-4, 7e-4);
    let mut exact = [0.0; 6];
    for (e, (a, b)) in exact
        .iter_mut()
        .zip([(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)])
    {
        *e = if a == b {
            g[(a, a)]
        } else {
            g[(a, b)] + g[(b, a)]
        };
    }
    for s in all_elements() {
        let formed = s.form(&steel(), None).unwrap();
        let u: Vec<f64> =
            s.x.iter()
                .flat_map(|x| {
                    let u = g * x;
                    [u.x, u.y, u.z]
                })
                .collect();
        // The incompatible modes remain zero under constant strain.
        for m in 0..formed.share.nrows() {
            let amount: f64 = u
                .iter()
                .enumerate()
                .map(|(j, u)| formed.share[(m, j)] * u)
                .sum();
            assert!(amount.abs() < 1e-11, "{:?}: {amount:e}", s.shape);
        }
        for point in s.rule() {
            let at = s.strain_columns_at(point).unwrap();
            for (c, exact) in exact.iter().enumerate() {
                let got: f64 = at.columns.iter().zip(&u).map(|(b, u)| b[c] * u).sum();
                assert!(
                    (got - exact).abs() < 1e-12,
                    "{:?}: {got} for {exact}",
                    s.shape
                );
            }
        }
    }
}

#[test]
fn products_of_shape_functions_add_up_to_the_volume_and_its_first_moment() {
    for s in all_elements() {
        let n = s.x.len();
        let p = s.products();
        let volume: f64 = s
            .rule()
            .iter()
            .map(|q| s.strain_columns_at(q).unwrap().volume)
            .sum();
        let sum: f64 = p.iter().sum();
        let exact_volume = matches!(
            s.shape,
            SolidShape::Hexa | SolidShape::Tetra | SolidShape::Pyram
        );
        // The volume of a curved wedge needs a higher degree along its height than the stiffness rule has.
        let tolerance = if exact_volume { 1e-9 } else { 1e-6 };
        assert!(
            (sum / volume - 1.0).abs() < tolerance,
            "{:?} {n}: {sum} {volume}",
            s.shape
        );
        // x is a field of the shape functions, so x' P x is positive.
        let moment: f64 = (0..n)
            .map(|i| s.x[i].x * (0..n).map(|j| p[i * n + j] * s.x[j].x).sum::<f64>())
            .sum();
        assert!(moment > 0.0);
    }
}

#[test]
fn a_mirrored_solid_is_the_same_body_and_a_folded_one_is_refused() {
    let s = distorted_element(SolidShape::Hexa, &[]);
    let mut mirrored = s.clone();
    mirrored.x = [4, 5, 6, 7, 0, 1, 2, 3].map(|i| s.x[i]).to_vec();
    let volume = |s: &SolidInput| s.products().iter().sum::<f64>();
    assert!((volume(&mirrored) / volume(&s) - 1.0).abs() < 1e-12);
    let k = |s: &SolidInput| s.form(&steel(), None).unwrap().stiffness;
    let (a, b) = (k(&s), k(&mirrored));
    assert!((a[(0, 0)] - b[(12, 12)]).abs() < 1e-9 * a.amax());
    let mut folded = s.clone();
    folded.x.swap(1, 2);
    assert!(folded.form(&steel(), None).is_err());
}
