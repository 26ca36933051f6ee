use super::*;
use crate::model::Vec3;

fn steel() -> ShellLaw {
    let (e, nu) = (210_000.0, 0.3);
    let (c, g) = (e / (1.0 - nu * nu), e / (2.0 + 2.0 * nu));
    let m = [[c, nu * c, 0.0], [nu * c, c, 0.0], [0.0, 0.0, g]];
    ShellLaw {
        membrane: Some(m),
        bending: Some(m),
        coupling: None,
        shear: Some([[g * 5.0 / 6.0, 0.0], [0.0, g * 5.0 / 6.0]]),
    }
}

/// Returns a warped, skewed quadrilateral in a general orientation. Its directors are tilted towards assumed neighbours.
fn warped_quad() -> [Vec3; 4] {
    let r = nalgebra::Rotation3::from_euler_angles(0.4, -0.9, 1.7);
    [
        [0.0, 0.0, 0.0],
        [42.0, 3.0, 2.0],
        [37.0, 35.0, -3.0],
        [-4.0, 28.0, 4.0],
    ]
    .map(|x| r * Vec3::from(x) + Vec3::new(900.0, -300.0, 50.0))
}

fn tilt_directors<const N: usize>(x: &[Vec3; N]) -> [Vec3; N] {
    let n = (x[1] - x[0]).cross(&(x[N - 1] - x[0])).normalize();
    std::array::from_fn(|k| {
        (n + Vec3::new(0.1 * k as f64, -0.12, 0.07 * (k % 2) as f64)).normalize()
    })
}

fn input<'a, const N: usize>(
    x: [Vec3; N],
    directors: [Vec3; N],
    law: &'a ShellLaw,
    zoffs: f64,
) -> ShellInput<'a, N> {
    ShellInput {
        x,
        directors,
        thickness: [6.0; N],
        law,
        zoffs,
        k6rot: 100.0,
        parts: Parts::All,
        sides: Sides::Straight,
        heat: None,
    }
}

/// Returns the largest entry of K R over the six rigid motions, divided by the largest entry of K and by the size.
fn rigid_residual<const N: usize, const M: usize>(k: &[[f64; M]; M], x: &[Vec3; N]) -> f64 {
    let largest = k.iter().flatten().fold(0.0_f64, |a, v| a.max(v.abs()));
    let size = x.iter().map(|v| v.norm()).fold(0.0, f64::max);
    let mut worst = 0.0_f64;
    for mode in 0..6 {
        let mut r = [0.0; M];
        for (c, x) in x.iter().enumerate() {
            let mut w = Vec3::zeros();
            let mut u = Vec3::zeros();
            if mode < 3 {
                u[mode] = 1.0
            } else {
                w[mode - 3] = 1.0
            }
            let u = u + w.cross(x);
            for i in 0..3 {
                r[6 * c + i] = u[i];
                r[6 * c + 3 + i] = w[i];
            }
        }
        for row in k {
            worst = worst.max(
                row.iter().zip(&r).map(|(a, b)| a * b).sum::<f64>().abs()
                    / if mode < 3 { 1.0 } else { size },
            );
        }
    }
    worst / largest
}

fn zero_modes<const M: usize>(k: &[[f64; M]; M]) -> usize {
    let m = nalgebra::DMatrix::from_fn(M, M, |i, j| k[i][j]);
    let values = m.symmetric_eigenvalues();
    let largest = values.max();
    values.iter().filter(|v| v.abs() < 1e-9 * largest).count()
}

#[test]
fn six_rigid_motions_and_no_other_leave_a_warped_quadrilateral_unstrained() {
    let (law, x) = (steel(), warped_quad());
    for (directors, zoffs) in [(tilt_directors(&x), 0.0), (tilt_directors(&x), 5.0)] {
        let m = quad4(&input(x, directors, &law, zoffs)).unwrap();
        assert!(rigid_residual(&m.stiffness, &x) < 1e-10);
        assert_eq!(zero_modes(&m.stiffness), 6);
    }
}

#[test]
fn six_rigid_motions_and_no_other_leave_a_triangle_unstrained() {
    let law = steel();
    let [a, b, c, _] = warped_quad();
    let x = [a, b, c];
    for zoffs in [0.0, -4.0] {
        let m = tria3(&input(x, tilt_directors(&x), &law, zoffs)).unwrap();
        assert!(rigid_residual(&m.stiffness, &x) < 1e-10);
        assert_eq!(zero_modes(&m.stiffness), 6);
    }
}

#[test]
fn stiffness_is_symmetric_and_areas_add_up() {
    let (law, x) = (steel(), warped_quad());
    let m = quad4(&input(x, tilt_directors(&x), &law, 3.0)).unwrap();
    let largest = m
        .stiffness
        .iter()
        .flatten()
        .fold(0.0_f64, |a, v| a.max(v.abs()));
    for i in 0..24 {
        for j in 0..24 {
            assert!((m.stiffness[i][j] - m.stiffness[j][i]).abs() < 1e-12 * largest);
        }
    }
    let area = 0.5 * (x[2] - x[0]).cross(&(x[3] - x[1])).norm();
    let products = corner_products(&x, &[6.0; 4]);
    let sum: f64 = products.area.iter().flatten().sum();
    assert!(
        (sum / area - 1.0).abs() < 0.01,
        "warped area is a little more than its projection"
    );
    let volume: f64 = products.volume.iter().flatten().sum();
    assert!((volume / sum - 6.0).abs() < 1e-12);
}

#[test]
fn a_linear_displacement_field_gives_its_own_strain_at_centre_and_corners() {
    let law = steel();
    let x =
        [[0.0, 0.0], [40.0, 4.0], [33.0, 30.0], [-3.0, 27.0]].map(|[a, b]| Vec3::new(a, b, 0.0));
    let frame = output_frame(&x).unwrap();
    let m = quad4(&input(x, [Vec3::z(); 4], &law, 0.0)).unwrap();
    // u = G x in the basic frame, with curvature: w = (a x^2 + b y^2)/2 + c x y, rotations its slopes.
    let (g, (a, b, c)) = ([[1e-3, 4e-4], [-2e-4, 5e-4]], (2e-5, -1e-5, 3e-5));
    let mut u = [0.0; 24];
    for (k, x) in x.iter().enumerate() {
        u[6 * k] = g[0][0] * x.x + g[0][1] * x.y;
        u[6 * k + 1] = g[1][0] * x.x + g[1][1] * x.y;
        u[6 * k + 2] = 0.5 * (a * x.x * x.x + b * x.y * x.y) + c * x.x * x.y;
        u[6 * k + 3] = b * x.y + c * x.x;
        u[6 * k + 4] = -(a * x.x + c * x.y);
    }
    let (e1, e2) = (frame.row(0), frame.row(1));
    let tensor = |t: [[f64; 2]; 2], p: nalgebra::RowVector3<f64>, q: nalgebra::RowVector3<f64>| {
        (0..2)
            .map(|i| (0..2).map(|j| p[i] * t[i][j] * q[j]).sum::<f64>())
            .sum::<f64>()
    };
    let shear = 0.5 * (g[0][1] + g[1][0]);
    let mid = [[g[0][0], shear], [shear, g[1][1]]];
    let bend = [[-a, -c], [-c, -b]];
    let expect = |t| {
        [
            tensor(t, e1.into(), e1.into()),
            tensor(t, e2.into(), e2.into()),
            2.0 * tensor(t, e1.into(), e2.into()),
        ]
    };
    for rows in m.corners.iter().chain([&m.centre]) {
        for (rows, expected, size) in [
            (rows.membrane, expect(mid), 1e-3),
            (rows.curvature, expect(bend), 3e-5),
        ] {
            for (row, expected) in rows.iter().zip(expected) {
                let got: f64 = row.iter().zip(&u).map(|(a, b)| a * b).sum();
                assert!(
                    (got - expected).abs() < 1e-10 * size,
                    "{got} for {expected}"
                );
            }
        }
    }
}

#[test]
fn shells_whose_sides_bend_have_six_rigid_motions_and_no_other() {
    let (law, x) = (steel(), warped_quad());
    let mut quad = input(x, tilt_directors(&x), &law, 0.0);
    (quad.sides, quad.k6rot) = (Sides::Bending, 1e3);
    let m = quad4(&quad).unwrap();
    assert!(rigid_residual(&m.stiffness, &x) < 1e-10);
    assert_eq!(zero_modes(&m.stiffness), 6);
    let corners = [x[0], x[1], x[2]];
    let mut tria = input(corners, tilt_directors(&corners), &law, 0.0);
    (tria.sides, tria.k6rot) = (Sides::Bending, 1e3);
    let m = tria3(&tria).unwrap();
    assert!(rigid_residual(&m.stiffness, &corners) < 1e-10);
    assert_eq!(zero_modes(&m.stiffness), 6);
}

#[test]
fn a_folded_or_flat_shape_is_refused() {
    let law = steel();
    let line = [Vec3::zeros(), Vec3::x(), Vec3::x() * 2.0];
    assert!(tria3(&input(line, [Vec3::z(); 3], &law, 0.0)).is_err());
    let bow_tie =
        [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]].map(|[a, b]| Vec3::new(a, b, 0.0));
    assert!(quad4(&input(bow_tie, [Vec3::z(); 4], &law, 0.0)).is_err());
}
