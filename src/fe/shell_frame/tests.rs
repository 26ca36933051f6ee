use super::*;
use crate::fe::strain_tensor::{basic_tensor, strain_along};

fn v(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::new(x, y, z)
}

/// Returns a skewed, tilted quad in the plane of two orthonormal vectors.
fn quad() -> ([Vec3; 4], Vec3, Vec3) {
    let a = v(2.0, 1.0, -1.0).normalize();
    let b = a.cross(&v(0.3, -1.0, 0.8)).normalize();
    let at = |x: f64, y: f64| v(1.0, -2.0, 0.5) + a * x + b * y;
    (
        [at(0.0, 0.0), at(2.0, 0.3), at(2.4, 1.7), at(-0.4, 1.1)],
        a,
        b,
    )
}

/// Returns the strain of a symmetric tensor in a frame: exx, eyy, gxy (engineering shear).
fn in_frame(tensor: &Mat3, axes: &Mat3) -> [f64; 3] {
    let local = axes * tensor * axes.transpose();
    [local[(0, 0)], local[(1, 1)], 2.0 * local[(0, 1)]]
}

#[test]
fn axes_are_orthonormal_and_right_handed() {
    let (p, a, b) = quad();
    for axes in [
        quad_axes(p).unwrap(),
        tria_axes([p[0], p[1], p[2]]).unwrap(),
        balanced_axes(a, b + 0.4 * a).unwrap(),
    ] {
        assert!((axes * axes.transpose() - Mat3::identity()).norm() < 1e-15);
        assert!((axes.determinant() - 1.0).abs() < 1e-15);
        assert!((axes.row(2).transpose() - a.cross(&b)).norm() < 1e-15);
    }
}

#[test]
fn the_x_axis_of_a_rectangle_is_side_1_2_whatever_its_aspect() {
    for h in [0.1, 1.0, 7.0] {
        let axes = quad_axes([
            v(0.0, 0.0, 0.0),
            v(2.0, 0.0, 0.0),
            v(2.0, h, 0.0),
            v(0.0, h, 0.0),
        ])
        .unwrap();
        assert!((axes - Mat3::identity()).norm() < 1e-15);
    }
}

#[test]
fn a_degenerate_element_has_no_frame() {
    let p = v(1.0, 1.0, 1.0);
    assert!(quad_axes([p; 4]).is_none());
    assert!(tria_axes([p, p * 2.0, p * 3.0]).is_none());
}

#[test]
fn pure_shear_is_plus_and_minus_half_gamma_at_45_degrees() {
    let (p, a, b) = quad();
    let axes = quad_axes(p).unwrap();
    let (x, y) = (axes.row(0).transpose(), axes.row(1).transpose());
    let gamma = 3e-4;
    let tensor = basic_tensor([0.0, 0.0, gamma], 0.0, &axes);
    assert!((strain_along(&tensor, &(x + y)) - gamma / 2.0).abs() < 1e-19);
    assert!((strain_along(&tensor, &(x - y)) + gamma / 2.0).abs() < 1e-19);
    assert!(strain_along(&tensor, &x).abs() < 1e-19);
    assert!(strain_along(&tensor, &a.cross(&b)).abs() < 1e-19);
}

#[test]
fn renumbering_the_corners_of_a_quad_leaves_the_basic_tensor_unchanged() {
    let (p, a, b) = quad();
    // A plane strain state in the quad's plane plus a normal strain, which every correct output must return.
    let n = a.cross(&b);
    let shear = (a * b.transpose() + b * a.transpose()) * 1.5e-4;
    let truth: Mat3 =
        a * a.transpose() * 4e-4 - b * b.transpose() * 1e-4 + shear - n * n.transpose() * 9e-5;
    let mut frames = Vec::new();
    for start in 0..4 {
        for forward in [1, 3] {
            let corner = |i: usize| p[(start + forward * i) % 4];
            let axes = quad_axes([corner(0), corner(1), corner(2), corner(3)]).unwrap();
            let tensor = basic_tensor(in_frame(&truth, &axes), -9e-5, &axes);
            assert!((tensor - truth).norm() < 1e-18);
            frames.push(axes);
        }
    }
    // The frames differ by quarter turns and by the direction of their normal.
    assert!((frames[0] - frames[2]).norm() > 1.0);
}

#[test]
fn turning_the_whole_mesh_turns_the_tensor() {
    let (p, _, _) = quad();
    let turn = nalgebra::Rotation3::from_euler_angles(0.7, -1.1, 2.3);
    let strain = [2e-4, -1e-4, 3e-4];
    let here = basic_tensor(strain, -4e-5, &quad_axes(p).unwrap());
    let there = basic_tensor(strain, -4e-5, &quad_axes(p.map(|x| turn * x)).unwrap());
    let r = turn.matrix();
    assert!((there - r * here * r.transpose()).norm() < 1e-18);
}

#[test]
fn balanced_axes_put_x_as_far_from_r_as_y_from_s() {
    let (_, a, b) = quad();
    let (r, s) = (a * 3.0, b + 0.6 * a);
    let axes = balanced_axes(r, s).unwrap();
    let x = axes.row(0).transpose().dot(&r.normalize());
    let y = axes.row(1).transpose().dot(&s.normalize());
    assert!((x - y).abs() < 1e-15);
    assert!(x > 0.5);
}
