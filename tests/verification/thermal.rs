//! Temperature: free bodies expand without mechanical strain, fixed bodies are strained, and layered bodies bend. Set 9
//! is the temperature.

use crate::mesh::{Bulk, Solved, assert_near};
use strainbridge::fe::{HeatedStrain, SolveOptions};

const ALPHA: f64 = 1.2e-5;

fn steel() -> Bulk {
    let mut b = Bulk::default();
    b.card("MAT1,1,210000.,,.3,7.85-9,1.2-5,20.");
    b
}

/// Adds a warped patch of quadrilaterals and triangles of thickness 4.
fn sheet(b: &mut Bulk) -> Vec<Vec<u32>> {
    b.card("PSHELL,1,1,4.0,1,,1");
    let ids = b.patch(3, 3, |u, v| {
        [
            90.0 * u + 8.0 * v * (1.0 - v) * u,
            60.0 * v + 6.0 * u * (1.0 - u) * v,
            0.0,
        ]
    });
    let tip = b.grid([110.0, 20.0, 0.0]);
    b.tria([ids[3][0], tip, ids[3][1]]);
    ids
}

fn largest_strain(s: &Solved) -> f64 {
    s.case
        .shells
        .centre
        .iter()
        .chain(s.case.shells.corners.iter().flatten())
        .flatten()
        .flatten()
        .filter(|v| !v.is_nan())
        .fold(0.0, |a, v| a.max(v.abs()))
}

#[test]
fn a_free_sheet_grows_and_strains_nothing_mechanically() {
    let mut b = steel();
    let ids = sheet(&mut b);
    b.card("TEMPD,9,120.");
    b.hold("123456", [ids[0][0]]);
    let s = b.solve_hot();
    // 100 degrees above TREF.
    for row in &ids {
        for g in row {
            let x = s.model.grids[s.model.grid_ix(*g).unwrap().us()].x;
            for i in 0..3 {
                assert!((s.displacement_at(*g)[i] - 100.0 * ALPHA * x[i]).abs() < 1e-9);
            }
        }
    }
    assert!(largest_strain(&s) < 1e-12, "{:e}", largest_strain(&s));
}

#[test]
fn total_strain_holds_the_expansion_of_a_free_sheet_and_of_a_free_bar() {
    let mut b = steel();
    let ids = sheet(&mut b);
    let ends = [b.grid([300.0, 0.0, 0.0]), b.grid([400.0, 0.0, 0.0])];
    b.card("PBAR,5,1,100.,1000.,1000.,1500.\n,5.,0.,-5.,0.,0.,5.,0.,-5.");
    b.card(&format!("CBAR,901,5,{},{},0.,0.,1.", ends[0], ends[1]));
    b.card("TEMPD,9,120.");
    b.hold("123456", [ids[0][0], ends[0]]);
    let hot = 100.0 * ALPHA;
    let total = SolveOptions {
        heated: HeatedStrain::Total,
        ..SolveOptions::default()
    };
    let (mechanical, total) = (b.solve_hot(), b.solve_hot_with(&total));
    assert!(largest_strain(&mechanical) < 1e-12);
    for surface in total.case.shells.centre.iter().flatten() {
        for (e, exact) in surface.iter().zip([hot, hot, 0.0]) {
            assert!((e - exact).abs() < 1e-12, "{surface:?}");
        }
    }
    for (solved, exact) in [(&mechanical, 0.0), (&total, hot)] {
        for (_, points) in solved.case.beams.stations.iter().flatten() {
            assert!(
                points.iter().all(|e| (e - exact).abs() < 1e-12),
                "{points:?}"
            );
        }
    }
}

#[test]
fn a_held_sheet_carries_the_whole_thermal_strain() {
    let mut b = steel();
    let ids = sheet(&mut b);
    b.card("TEMPD,9,120.");
    b.hold("123456", ids.iter().flatten().copied());
    b.hold("123456", [17]);
    // One free grid on a spring keeps the system of equations from being empty.
    let free = b.grid([500.0, 0.0, 0.0]);
    b.card(&format!("CELAS2,900,1.0,{free},1"));
    b.hold("23456", [free]);
    let s = b.solve_hot();
    for surface in s.case.shells.centre.iter().flatten() {
        for (e, exact) in surface.iter().zip([-100.0 * ALPHA, -100.0 * ALPHA, 0.0]) {
            assert!((e - exact).abs() < 1e-14, "{surface:?}");
        }
    }
}

#[test]
fn a_gradient_through_the_thickness_bends_a_free_sheet_to_a_bowl() {
    let mut b = steel();
    let ids = sheet(&mut b);
    b.card("TEMPP1,9,1,20.,5.\n,2,THRU,99");
    b.hold("123456", [ids[0][0]]);
    let s = b.solve_hot();
    assert!(largest_strain(&s) < 1e-10, "{:e}", largest_strain(&s));
    // The top is warmer and longer. The sheet bends down from the fixed corner: w = -alpha T' (x^2 + y^2) / 2.
    let far = ids[3][3];
    let x = s.model.grids[s.model.grid_ix(far).unwrap().us()].x;
    assert_near(
        "bowl",
        s.displacement_at(far)[2],
        -ALPHA * 5.0 * (x.x * x.x + x.y * x.y) / 2.0,
        1e-6,
    );
}

#[test]
fn a_bimetal_strip_bends_as_timoshenko_states() {
    // Timoshenko 1925: kappa = 6 (a2 - a1) dT (1 + m)^2 / (h (3 (1 + m)^2 + (1 + m n)(m^2 + 1 / (m n)))), m = t1 / t2,
    // n = E1 / E2. The formula is also valid for a plate whose layers have equal Poisson ratios.
    let (e1, e2, a1, a2, t1, t2, dt) = (210_000.0, 70_000.0, 1.2e-5, 2.3e-5, 2.0, 3.0, 50.0);
    let mut b = Bulk::default();
    b.card(&format!("MAT1,1,{e1:?},,.3,,{a1:?},0."));
    b.card(&format!("MAT1,2,{e2:?},,.3,,{a2:?},0."));
    b.card("PCOMP,1\n,1,2.0,,,2,3.0");
    b.card("TEMPD,9,50.");
    let ids = b.patch(6, 2, |u, v| [120.0 * u, 20.0 * v + 4.0 * u * v, 0.0]);
    b.hold("123456", [ids[0][0]]);
    let s = b.solve_hot();
    let (m, n, h): (f64, f64, f64) = (t1 / t2, e1 / e2, t1 + t2);
    let kappa = 6.0 * (a2 - a1) * dt * (1.0 + m).powi(2)
        / (h * (3.0 * (1.0 + m).powi(2) + (1.0 + m * n) * (m * m + 1.0 / (m * n))));
    // The second layer is on top and expands more, so the strip bends down.
    assert_near(
        "bimetal",
        s.displacement_at(ids[6][0])[2],
        -kappa * 120.0 * 120.0 / 2.0,
        1e-6,
    );
}

#[test]
fn bars_and_rods_grow_freely_push_when_held_and_bend_under_a_gradient() {
    let build = |held: bool| {
        let mut b = steel();
        b.card("PBAR,2,1,200.,9000.,4000.,8000.\n,5.,4.,-5.,4.,-5.,-4.,5.,-4.");
        b.card("PROD,3,1,50.");
        let g: Vec<u32> = [
            [0., 0., 0.],
            [100., 0., 0.],
            [250., 0., 0.],
            [100., 80., 0.],
        ]
        .iter()
        .map(|x| b.grid(*x))
        .collect();
        b.card("CBAR,1,2,1,2,0.,1.,0.");
        b.card("CBAR,2,2,2,3,0.,1.,0.");
        b.card("CROD,3,3,2,4");
        b.hold("123456", [g[0]]);
        b.hold("13456", [g[3]]);
        b.hold(if held { "123456" } else { "" }, held.then_some(g[2]));
        b
    };
    let mut b = build(false);
    b.card("TEMPD,9,120.");
    let s = b.solve_hot();
    assert_near("bar", s.displacement_at(3)[0], 100.0 * ALPHA * 250.0, 1e-10);
    // The rod moves its free end away. At grid 4, only x is fixed.
    assert_near("rod", s.displacement_at(4)[1], 100.0 * ALPHA * 80.0, 1e-10);
    for (_, strain) in s.case.beams.stations.iter().flatten() {
        assert!(strain.iter().all(|e| e.abs() < 1e-13), "{strain:?}");
    }
    let mut b = build(true);
    b.card("TEMPD,9,120.");
    let s = b.solve_hot();
    for (_, strain) in s.case.beams.stations.iter().flatten() {
        // The rod is free at its end and has no effect on the others.
        assert!(
            strain.iter().all(|e| (e + 100.0 * ALPHA).abs() < 1e-12),
            "{strain:?}"
        );
    }
    // The temperature rises along element y, here basic y. The cantilever bends away from the warm side.
    let mut b = build(false);
    b.card("TEMPD,9,20.");
    b.card("TEMPRB,9,1,20.,20.,3.,3.,0.,0.,\n,\n,2");
    let s = b.solve_hot();
    let tip = s.displacement_at(3)[1];
    assert_near(
        "gradient along y",
        tip,
        -ALPHA * 3.0 * 250.0 * 250.0 / 2.0,
        0.02,
    );
}

#[test]
fn solids_under_a_linear_temperature_field_are_free_of_mechanical_strain() {
    // A temperature field that is linear in the coordinates strains a free body compatibly, without stress.
    let mut b = steel();
    b.card("PSOLID,1,1");
    let id = |b: &mut Bulk, x: [f64; 3]| {
        let g = b.grid(x);
        b.card(&format!("TEMP,9,{g},{:?}", 20.0 + 2.0 * x[0] + 7.0 * x[2]));
        g
    };
    // A row of two rectangular bricks, with a ten-node tetrahedron next to them.
    let mut layer = Vec::new();
    for x in [0.0, 10.0, 20.0] {
        for (y, z) in [(0.0, 0.0), (6.0, 0.0), (6.0, 4.0), (0.0, 4.0)] {
            layer.push(id(&mut b, [x, y, z]));
        }
    }
    for (e, i) in [(1, 0), (2, 4)] {
        let g: Vec<String> = [0, 4, 5, 1, 3, 7, 6, 2]
            .map(|k| layer[i + k].to_string())
            .to_vec();
        b.card(&format!(
            "CHEXA,{e},1,{}\n,{}",
            g[..6].join(","),
            g[6..].join(",")
        ));
    }
    b.hold("123", [layer[0]]);
    b.hold("23", [layer[8]]);
    b.hold("3", [layer[1]]);
    let s = b.solve_hot();
    for (centre, corners) in s.case.solids.centre.iter().zip(&s.case.solids.corners) {
        for e in centre.iter().chain(corners.iter().flatten()) {
            assert!(e.abs() < 1e-12, "{centre:?}");
        }
    }
    // Length along the bottom edge of the row, in x: the integral of alpha dT.
    assert_near(
        "length",
        s.displacement_at(layer[8])[0],
        ALPHA * (2.0 * 200.0),
        1e-9,
    );
}
