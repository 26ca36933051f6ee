//! The standard set of R. H. MacNeal and R. L. Harder, Finite Elements in Analysis and Design 1 (1985) 3, and similar
//! tests.
//!
//! References and tolerances are those of `../shared/benchmarks/macneal_harder.md`.

use crate::mesh::{Bulk, assert_near, record};

/// Returns the patch of five quadrilaterals, or of the same quadrilaterals split into triangles. Its grids are 1 to 8,
/// of which 5 to 8 are inner grids.
fn patch(split: bool) -> (Bulk, Vec<(u32, f64, f64)>) {
    let mut b = Bulk::shell(1e6, 0.25, 0.001);
    let xy = [
        (0.0, 0.0),
        (0.24, 0.0),
        (0.24, 0.12),
        (0.0, 0.12),
        (0.04, 0.02),
        (0.18, 0.03),
        (0.16, 0.08),
        (0.08, 0.08),
    ];
    let grids: Vec<(u32, f64, f64)> = xy
        .iter()
        .map(|&(x, y)| (b.grid([x, y, 0.0]), x, y))
        .collect();
    for q in [
        [1, 2, 6, 5],
        [2, 3, 7, 6],
        [3, 4, 8, 7],
        [4, 1, 5, 8],
        [5, 6, 7, 8],
    ] {
        if split {
            b.tria([q[0], q[1], q[2]]);
            b.tria([q[0], q[2], q[3]]);
        } else {
            b.quad(q);
        }
    }
    (b, grids)
}

fn spc(b: &mut Bulk, grid: u32, dof: usize, value: f64) {
    b.card(&format!("SPC,1,{grid},{dof},{value:.12E}"));
}

#[test]
fn membrane_patch_test_is_exact() {
    for split in [false, true] {
        let (mut b, grids) = patch(split);
        for &(g, x, y) in &grids[..4] {
            spc(&mut b, g, 1, 1e-3 * (x + y / 2.0));
            spc(&mut b, g, 2, 1e-3 * (y + x / 2.0));
            b.hold("3456", [g]);
        }
        b.force(5, [0.0; 3]);
        b.text = b
            .text
            .replace("FORCE,1,5,0,1.0,0.0,0.0,0.0", "FORCE,1,1,0,0.0,1.0,0.0,0.0");
        let s = b.solve();
        for centre in &s.case.shells.centre {
            for surface in centre {
                // The shear strain refers to the element frame, so the test compares invariants.
                let [ex, ey, g] = *surface;
                assert!(((ex + ey) / 2e-3 - 1.0).abs() < 1e-8, "{surface:?}");
                let radius = ((ex - ey) / 2.0).hypot(g / 2.0);
                assert!((radius / 5e-4 - 1.0).abs() < 1e-8, "{surface:?}");
            }
        }
    }
}

#[test]
fn bending_patch_test_is_exact() {
    for split in [false, true] {
        let (mut b, grids) = patch(split);
        for &(g, x, y) in &grids[..4] {
            spc(&mut b, g, 3, 0.5e-3 * (x * x + x * y + y * y));
            spc(&mut b, g, 4, 1e-3 * (y + x / 2.0));
            spc(&mut b, g, 5, -1e-3 * (x + y / 2.0));
            b.hold("126", [g]);
        }
        b.card("FORCE,1,1,0,0.0,1.0,0.0,0.0");
        let s = b.solve();
        for centre in &s.case.shells.centre {
            for (surface, z) in centre.iter().zip([-0.0005, 0.0005]) {
                let [ex, ey, g] = *surface;
                assert!(((ex + ey) / (-2e-3 * z) - 1.0).abs() < 1e-8, "{surface:?}");
                let radius = ((ex - ey) / 2.0).hypot(g / 2.0);
                assert!(
                    (radius / (5e-4 * z.abs()) - 1.0).abs() < 1e-8,
                    "{surface:?}"
                );
            }
        }
    }
}

/// Returns the slender cantilever 6 x 0.2 x 0.1 with 6 x 1 elements. `slant` moves the upper (+) and lower (-) grids of
/// interior edge i along the beam.
fn cantilever(slant: impl Fn(usize) -> f64) -> (Bulk, [u32; 2]) {
    let mut b = Bulk::shell(1e7, 0.3, 0.1);
    let ids = b.patch(6, 1, |u, v| {
        let i = (u * 6.0).round() as usize;
        let shift = if i == 0 || i == 6 {
            0.0
        } else {
            slant(i) * (v - 0.5) * 0.2
        };
        [6.0 * u + shift, 0.2 * v, 0.0]
    });
    b.hold("123456", ids[0].clone());
    (b, [ids[6][0], ids[6][1]])
}

fn tip(slant: impl Fn(usize) -> f64, direction: [f64; 3]) -> f64 {
    let (mut b, ends) = cantilever(slant);
    ends.iter()
        .for_each(|g| b.force(*g, direction.map(|c| 0.5 * c)));
    let s = b.solve();
    ends.iter()
        .map(|g| {
            (0..3)
                .map(|i| 0.5 * s.displacement_at(*g)[i] * direction[i])
                .sum::<f64>()
        })
        .sum()
}

#[test]
fn straight_cantilever_rectangular_mesh() {
    assert_near("extension", tip(|_| 0.0, [1.0, 0.0, 0.0]), 3.0e-5, 0.01);
    assert_near("in-plane", tip(|_| 0.0, [0.0, 1.0, 0.0]), 0.1081, 0.02);
    assert_near("out-of-plane", tip(|_| 0.0, [0.0, 0.0, 1.0]), 0.4321, 0.03);
}

#[test]
fn straight_cantilever_distorted_meshes_bend_out_of_plane() {
    let trapezoid = |i: usize| if i.is_multiple_of(2) { 1.0 } else { -1.0 };
    // A four-node element that is not rectangular locks in its plane. This is known from every such element.
    record(
        "trapezoidal in-plane",
        tip(trapezoid, [0.0, 1.0, 0.0]),
        0.1081,
    );
    record(
        "parallelogram in-plane",
        tip(|_| 1.0, [0.0, 1.0, 0.0]),
        0.1081,
    );
    assert_near("trapezoidal", tip(trapezoid, [0.0, 0.0, 1.0]), 0.4321, 0.05);
    assert_near("parallelogram", tip(|_| 1.0, [0.0, 0.0, 1.0]), 0.4321, 0.04);
}

fn curved_beam_deflection(n: usize, m: usize, direction: [f64; 3]) -> f64 {
    let mut b = Bulk::shell(1e7, 0.25, 0.1);
    let ids = b.patch(m, n, |u, v| {
        let (r, a) = (4.12 + 0.2 * u, v * std::f64::consts::FRAC_PI_2);
        [r * a.cos(), r * a.sin(), 0.0]
    });
    b.hold("123456", (0..=m).map(|i| ids[i][0]));
    // The consistent share of a uniform edge load.
    for i in 0..=m {
        let share = if i == 0 || i == m { 0.5 } else { 1.0 } / m as f64;
        b.force(ids[i][n], direction.map(|c| c * share));
    }
    let s = b.solve();
    let mean = |i: usize| {
        (0..=m)
            .map(|j| s.displacement_at(ids[j][n])[i])
            .sum::<f64>()
            / (m + 1) as f64
    };
    (0..3).map(|i| mean(i) * direction[i]).sum()
}

#[test]
fn curved_cantilever() {
    for (n, m) in [(6, 1), (12, 1), (24, 2)] {
        record(
            &format!("curved in-plane, {n} x {m}"),
            curved_beam_deflection(n, m, [0.0, 1.0, 0.0]),
            0.08734,
        );
        record(
            &format!("curved out-of-plane, {n} x {m}"),
            curved_beam_deflection(n, m, [0.0, 0.0, 1.0]),
            0.5022,
        );
    }
    // At the tip the inner grid moves less and the outer grid more (.929 and .955 at 6 x 1). The work of a load on both
    // grids is proportional to their mean displacement.
    //
    // The beam points along -x at the tip. A load along x is axial, a load along y is tangential, and vertical (MH) is
    // radial.
    assert_near(
        "in-plane, 48 x 2",
        curved_beam_deflection(48, 2, [0.0, 1.0, 0.0]),
        0.08734,
        0.02,
    );
    assert_near(
        "out-of-plane, 6 x 1",
        curved_beam_deflection(6, 1, [0.0, 0.0, 1.0]),
        0.5022,
        0.07,
    );
}

fn twisted_beam_deflection(t: f64, load: f64, width: bool) -> f64 {
    let mut b = Bulk::shell(29e6, 0.22, t);
    let ids = b.patch(12, 2, |u, v| {
        let (a, y) = (u * std::f64::consts::FRAC_PI_2, 1.1 * (v - 0.5));
        [12.0 * u, y * a.cos(), y * a.sin()]
    });
    b.hold("123456", ids[0].clone());
    // The width of the tip is along z.
    let direction = if width {
        [0.0, 0.0, load]
    } else {
        [0.0, load, 0.0]
    };
    for (g, share) in ids[12].iter().zip([0.25, 0.5, 0.25]) {
        b.force(*g, direction.map(|c| c * share));
    }
    let s = b.solve();
    s.displacement_at(ids[12][1])[if width { 2 } else { 1 }]
}

#[test]
fn twisted_cantilever_of_warped_elements() {
    assert_near(
        "in the plane of the tip",
        twisted_beam_deflection(0.32, 1.0, true),
        0.005424,
        0.03,
    );
    assert_near(
        "normal to it",
        twisted_beam_deflection(0.32, 1.0, false),
        0.001754,
        0.03,
    );
    assert_near(
        "thin, in the plane of the tip",
        twisted_beam_deflection(0.0032, 1e-6, true),
        0.005256,
        0.05,
    );
    assert_near(
        "thin, normal to it",
        twisted_beam_deflection(0.0032, 1e-6, false),
        0.001294,
        0.05,
    );
}

/// Returns the deflection at the centre of a plate 2 x `length`. The mesh is a quarter with `n` elements per half side.
fn plate(length: f64, n: usize, clamped: bool, point: bool) -> f64 {
    let mut b = Bulk::shell(1.7472e7, 0.3, 1e-4);
    let ids = b.patch(n, n, |u, v| [u, v * length / 2.0, 0.0]);
    // Symmetry at x = 0 and y = 0. Supported edges at x = 1 and y = length / 2.
    b.hold("15", (0..=n).map(|j| ids[0][j]));
    b.hold("24", (0..=n).map(|i| ids[i][0]));
    b.hold("126", ids.iter().flatten().copied());
    let (x_edge, y_edge) = if clamped {
        ("345", "345")
    } else {
        ("34", "35")
    };
    b.hold(x_edge, (0..=n).map(|j| ids[n][j]));
    b.hold(y_edge, (0..=n).map(|i| ids[i][n]));
    if point {
        b.force(ids[0][0], [0.0, 0.0, 1e-4]);
    } else {
        b.card(&format!("PLOAD2,1,1e-4,1,THRU,{}", n * n));
    }
    b.solve().displacement_at(ids[0][0])[2]
}

#[test]
fn rectangular_plate() {
    for (length, clamped, point, reference) in [
        (2.0, false, false, 4.062),
        (2.0, false, true, 11.60),
        (2.0, true, false, 1.26),
        (2.0, true, true, 5.60),
        (10.0, false, false, 12.97),
        (10.0, false, true, 16.96),
        (10.0, true, false, 2.56),
        (10.0, true, true, 7.23),
    ] {
        let tolerance = if length < 5.0 { 0.015 } else { 0.06 };
        let what = format!("plate, length {length}, clamped {clamped}, point {point}");
        record(
            &format!("{what}, 4"),
            plate(length, 4, clamped, point),
            reference,
        );
        assert_near(
            &what,
            plate(length, 8, clamped, point),
            reference,
            tolerance,
        );
    }
}

fn scordelis_lo(n: usize) -> f64 {
    let mut b = Bulk::shell(4.32e8, 0.0, 0.25);
    let ids = b.patch(n, n, |u, v| {
        let a = (40.0 * v).to_radians();
        [25.0 * u, 25.0 * a.sin(), 25.0 * a.cos()]
    });
    // u = 0 is mid span (symmetry), u = 1 the diaphragm, v = 0 the crown (symmetry), v = 1 the free edge.
    b.hold("156", ids[0].clone());
    b.hold("23", ids[n].clone());
    b.hold("246", ids.iter().map(|row| row[0]));
    // A load of 90 per unit surface, vertically down.
    b.text += &format!("PLOAD4,1,1,90.0,,,,THRU,{}\n,0,0.0,0.0,-1.0\n", n * n);
    -b.solve().displacement_at(ids[0][n])[2]
}

#[test]
fn scordelis_lo_roof() {
    record("Scordelis-Lo, 4", scordelis_lo(4), 0.3024);
    let (coarse, fine) = (scordelis_lo(8) / 0.3024, scordelis_lo(16) / 0.3024);
    assert_near("Scordelis-Lo, 8", coarse, 1.0, 0.02);
    assert_near("Scordelis-Lo, 16", fine, 0.995, 0.01);
    assert!(
        (fine - 0.995).abs() <= (coarse - 0.995).abs(),
        "{coarse} {fine}"
    );
}

fn hemisphere(n: usize) -> f64 {
    let mut b = Bulk::shell(6.825e7, 0.3, 0.04);
    let ids = b.patch(n, n, |u, v| {
        let (a, p) = (90.0_f64.to_radians() * u, (72.0 * v).to_radians());
        [
            10.0 * p.cos() * a.cos(),
            10.0 * p.cos() * a.sin(),
            10.0 * p.sin(),
        ]
    });
    b.hold("246", ids[0].clone());
    b.hold("156", ids[n].clone());
    b.hold("3", [ids[n / 2][n]]);
    b.force(ids[0][0], [1.0, 0.0, 0.0]);
    b.force(ids[n][0], [0.0, -1.0, 0.0]);
    b.solve().displacement_at(ids[0][0])[0]
}

#[test]
fn hemisphere_with_a_hole() {
    record("hemisphere, 4", hemisphere(4), 0.0940);
    assert_near("hemisphere, 8", hemisphere(8), 0.0940, 0.03);
    assert_near("hemisphere, 16", hemisphere(16), 0.0940, 0.02);
}

fn pinched_cylinder(n: usize) -> f64 {
    let mut b = Bulk::shell(3e6, 0.3, 3.0);
    let ids = b.patch(n, n, |u, v| {
        let a = v * std::f64::consts::FRAC_PI_2;
        [300.0 * u, 300.0 * a.sin(), 300.0 * a.cos()]
    });
    b.hold("156", ids[0].clone());
    b.hold("23", ids[n].clone());
    b.hold("246", ids.iter().map(|row| row[0]));
    b.hold("345", ids.iter().map(|row| row[n]));
    b.force(ids[0][0], [0.0, 0.0, -0.25]);
    -b.solve().displacement_at(ids[0][0])[2]
}

#[test]
fn pinched_cylinder_with_diaphragms() {
    record("pinched cylinder, 8", pinched_cylinder(8), 1.8248e-5);
    assert_near(
        "pinched cylinder, 16",
        pinched_cylinder(16),
        1.8248e-5,
        0.08,
    );
    assert_near(
        "pinched cylinder, 32",
        pinched_cylinder(32),
        1.8248e-5,
        0.02,
    );
}

fn raasch(n: usize, m: usize) -> f64 {
    let mut b = Bulk::shell(3300.0, 0.35, 2.0);
    let (first, second) = (14.0 * 60.0_f64.to_radians(), 46.0 * 150.0_f64.to_radians());
    let ids = b.patch(n, m, |u, v| {
        // Arc length along the hook. The joint of both arcs is close to a grid line.
        let s = u * (first + second);
        let (x, z) = if s <= first {
            let a = s / 14.0;
            (14.0 * a.sin(), 14.0 * (1.0 - a.cos()))
        } else {
            // The centre of the second arc is on the other side of the joint.
            let (a, b) = (60.0_f64.to_radians(), (s - first) / 46.0);
            let (cx, cz) = (
                14.0 * a.sin() + 46.0 * a.sin(),
                14.0 * (1.0 - a.cos()) - 46.0 * a.cos(),
            );
            (cx - 46.0 * (a - b).sin(), cz + 46.0 * (a - b).cos())
        };
        [x, 20.0 * v, z]
    });
    b.hold("123456", ids[0].clone());
    for (j, g) in ids[n].iter().enumerate() {
        let share = if j == 0 || j == m { 0.5 } else { 1.0 } / m as f64;
        b.force(*g, [0.0, share, 0.0]);
    }
    b.solve().displacement_at(ids[n][m / 2])[1] / 4.9352
}

#[test]
fn raasch_hook_converges_with_shared_normals() {
    let ratios: Vec<f64> = [(7, 1), (14, 3), (28, 5), (70, 10)]
        .iter()
        .map(|&(n, m)| raasch(n, m))
        .collect();
    eprintln!("Raasch hook, 7 x 1, 14 x 3, 28 x 5, 70 x 10: {ratios:.4?}");
    assert!(
        (ratios[2] - 1.0).abs() < 0.03 && ratios.windows(2).all(|w| w[1] > w[0]),
        "{ratios:?}"
    );
    assert!((ratios[3] - 1.0).abs() < 0.02, "{ratios:?}");
}

#[test]
fn an_in_plane_cantilever_converges_with_the_square_of_the_mesh_size() {
    // Depth 0.5, length 2, end shear. The reference is a fine mesh of the same elements, as the closed form needs
    // parabolic end shear.
    let tip = |n: usize| {
        let mut b = Bulk::shell(1e4, 0.3, 0.1);
        let ids = b.patch(4 * n, n, |u, v| {
            [2.0 * u, 0.5 * v + 0.05 * u * (v - 0.5), 0.0]
        });
        b.hold("123456", ids[0].clone());
        for (j, g) in ids[4 * n].iter().enumerate() {
            let share = if j == 0 || j == n { 0.5 } else { 1.0 } / n as f64;
            b.force(*g, [0.0, share, 0.0]);
        }
        b.solve().displacement_at(ids[4 * n][n / 2])[1]
    };
    let (a, b, c, fine) = (tip(2), tip(4), tip(8), tip(32));
    let order = |p: f64, q: f64| ((p - fine).abs() / (q - fine).abs()).log2();
    eprintln!("orders {:.2} {:.2}", order(a, b), order(b, c));
    assert!(
        order(a, b) > 1.3 && order(b, c) > 1.3,
        "orders {} {}",
        order(a, b),
        order(b, c)
    );
}
