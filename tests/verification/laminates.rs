//! Compares laminates with classical lamination theory. The test computes the theory separately, as sums over thin
//! slices.

use crate::mesh::{Bulk, assert_near, mass_of};
use nalgebra::{Matrix3, Matrix6, Vector6};
use strainbridge::fe::ply_strains;
use strainbridge::model::ShellIx;

const E1: f64 = 140_000.0;
const E2: f64 = 10_000.0;
const NU12: f64 = 0.3;
const G12: f64 = 5_000.0;

/// Returns the reduced stiffness in axes that are turned by `degrees` from the fibres.
fn reduced_stiffness_at(degrees: f64) -> Matrix3<f64> {
    let d = 1.0 - NU12 * NU12 * E2 / E1;
    let q = Matrix3::new(
        E1 / d,
        NU12 * E2 / d,
        0.0,
        NU12 * E2 / d,
        E2 / d,
        0.0,
        0.0,
        0.0,
        G12,
    );
    let (s, c) = degrees.to_radians().sin_cos();
    let t = Matrix3::new(
        c * c,
        s * s,
        c * s,
        s * s,
        c * c,
        -c * s,
        -2.0 * c * s,
        2.0 * c * s,
        c * c - s * s,
    );
    t.transpose() * q * t
}

/// Returns A, B and D, summed over slices.
fn abd(plies: &[(f64, f64)]) -> Matrix6<f64> {
    let total: f64 = plies.iter().map(|p| p.1).sum();
    let mut m = Matrix6::zeros();
    let mut z = -total / 2.0;
    for (angle, t) in plies {
        const SLICES: usize = 4000;
        let dz = t / SLICES as f64;
        let q = reduced_stiffness_at(*angle);
        for i in 0..SLICES {
            let h = z + (i as f64 + 0.5) * dz;
            for (r, c, w) in [(0, 0, 1.0), (0, 3, h), (3, 0, h), (3, 3, h * h)] {
                let mut block = m.fixed_view_mut::<3, 3>(r, c);
                block += q * (w * dz);
            }
        }
        z += t;
    }
    m
}

/// Returns a distorted strip of the laminate with the material angle `theta`, under a force `n` per width along x.
fn strip(plies: &[(f64, f64)], theta: f64, n: f64) -> (Bulk, Vec<Vec<u32>>) {
    let mut b = Bulk::default();
    b.card(&format!(
        "MAT8,1,{E1:?},{E2:?},{NU12:?},{G12:?},{G12:?},{G12:?},1.5-9"
    ));
    let list: Vec<String> = plies
        .iter()
        .map(|(a, t)| format!("1,{t:?},{a:?},YES"))
        .collect();
    let lines: Vec<String> = list
        .chunks(2)
        .map(|c| format!(",{}", c.join(",")))
        .collect();
    b.card(&format!("PCOMP,1\n{}", lines.join("\n")));
    // Both ends are straight, so that the load is uniform along them.
    let ids = b.patch(6, 4, |u, v| {
        let inner = u * (1.0 - u);
        [60.0 * u + 10.0 * inner * (v - 0.4), 20.0 * v, 0.0]
    });
    b.text = b
        .text
        .lines()
        .map(|l| {
            if l.starts_with("CQUAD4") {
                format!("{l},{theta:?}\n")
            } else {
                format!("{l}\n")
            }
        })
        .collect();
    for j in 0..=4 {
        let share = if j == 0 || j == 4 { 0.5 } else { 1.0 };
        let f = n * 20.0 / 4.0 * share;
        b.force(ids[6][j], [f, 0.0, 0.0]);
        b.force(ids[0][j], [-f, 0.0, 0.0]);
    }
    b.hold("123456", [ids[3][2]]);
    (b, ids)
}

/// Compares the strain at both surfaces of every element along basic x and y. The rows are in the bisector frame.
fn check(plies: &[(f64, f64)], theta: f64) {
    let n = 25.0;
    let (b, _) = strip(plies, 0.0, n);
    // THETA is measured from side 1-2, whose direction varies in the distorted strip. A coordinate system replaces it
    // here.
    let mut b = b;
    let (s, c) = theta.to_radians().sin_cos();
    b.card(&format!(
        "CORD2R,7,0,0.,0.,0.,0.,0.,1.,\n,{c:.9E},{s:.9E},0."
    ));
    b.text = b
        .text
        .lines()
        .map(|l| {
            match l
                .strip_prefix("CQUAD4")
                .and_then(|l| l.strip_suffix(",0.0"))
            {
                Some(rest) => format!("CQUAD4{rest},7\n"),
                None => format!("{l}\n"),
            }
        })
        .collect();
    let solved = b.solve();
    let total: f64 = plies.iter().map(|p| p.1).sum();
    let in_place: Vec<(f64, f64)> = plies.iter().map(|(a, t)| (a + theta, *t)).collect();
    let state = abd(&in_place).try_inverse().unwrap() * Vector6::new(n, 0.0, 0.0, 0.0, 0.0, 0.0);
    for (ix, surfaces) in solved
        .case
        .shells
        .elements
        .iter()
        .zip(&solved.case.shells.centre)
    {
        for (got, z) in surfaces.iter().zip([-total / 2.0, total / 2.0]) {
            let exact: Vec<f64> = (0..3).map(|i| state[i] + z * state[i + 3]).collect();
            let size = exact.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
            let invariants = |e: &[f64]| [e[0] + e[1], ((e[0] - e[1]) / 2.0).hypot(e[2] / 2.0)];
            for (a, b) in invariants(got).iter().zip(invariants(&exact)) {
                // The slices of the closed form have an error of 1e-7.
                assert!(
                    (a - b).abs() < 1e-5 * size,
                    "{ix:?} z {z}: {got:?} for {exact:?}"
                );
            }
        }
    }
}

#[test]
fn a_laminate_under_tension_strains_and_curves_as_lamination_theory_states() {
    check(&[(0.0, 0.5), (90.0, 0.5), (90.0, 0.5), (0.0, 0.5)], 0.0);
    // An unsymmetric laminate bends under tension.
    check(&[(0.0, 0.7), (90.0, 0.5)], 0.0);
    check(&[(0.0, 0.7), (90.0, 0.5), (45.0, 0.4)], 0.0);
    // An unbalanced laminate twists under tension.
    check(&[(30.0, 0.5), (-20.0, 0.8)], 15.0);
}

#[test]
fn plies_strain_in_their_own_axes() {
    let plies = [(30.0, 0.5), (30.0, 0.5)];
    let (b, _) = strip(&plies, 0.0, 25.0);
    let s = b.solve();
    let state = abd(&plies).try_inverse().unwrap() * Vector6::new(25.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    let (e, (sin, cos)) = (state, 30_f64.to_radians().sin_cos());
    let along = cos * cos * e[0] + sin * sin * e[1] + cos * sin * e[2];
    // Element 1 is in the distorted corner. Its side 1-2 is along x there.
    let plies = ply_strains(&s.model, ShellIx(0), &s.case.shells.centre[0]);
    assert_eq!(plies.len(), 2);
    assert_near("fibre strain", plies[0][0], along, 1e-4);
}

#[test]
fn plies_of_one_material_make_its_plate_and_a_sandwich_shears_by_its_core() {
    let cantilever = |property: &str| {
        let mut b = Bulk::default();
        b.card("MAT1,1,70000.,,.3,2.7-9");
        b.card("MAT1,2,100.,50.,,1.-10");
        b.card(property);
        let ids = b.patch(20, 2, |u, v| [200.0 * u, 20.0 * v, 0.0]);
        b.hold("123456", ids[0].clone());
        for (j, share) in [0.25, 0.5, 0.25].iter().enumerate() {
            b.force(ids[20][j], [0.0, 0.0, 10.0 * share]);
        }
        let s = b.solve();
        (s.displacement_at(ids[20][1])[2], mass_of(&s.model).mass)
    };
    let (plate, mass) = cantilever("PSHELL,1,1,6.0,1,,1");
    let (layers, layered_mass) = cantilever("PCOMP,1\n,1,1.0,,,1,2.0\n,1,3.0");
    // TS/T is 0.833333 in the plate and 5/6 in the layers.
    assert_near("plate of layers", layers, plate, 1e-6);
    assert_near("its mass", layered_mass, mass, 1e-12);
    let (soft, _) = cantilever("PCOMP,1\n,1,1.0,,,2,18.0\n,1,1.0");
    // Thin faces at the distance 19: D = E t d^2 / 2 per width, shear stiffness G d^2 / c.
    let (d, l) = (19.0_f64, 200.0_f64);
    let bending = 10.0 / 20.0 * l.powi(3) / (3.0 * 70_000.0 * d * d / 2.0);
    let shear = 10.0 / 20.0 * l / (50.0 * d * d / 18.0);
    assert_near("sandwich", soft, bending + shear, 0.02);
}
