//! Invariants of every structure: balance, independence of supports and of the frame, rigid motions.

use crate::mesh::{Bulk, assert_near, free_modes};
use strainbridge::fe::*;
use strainbridge::model::Model;

/// Returns a curved, folded strip of quadrilaterals and triangles, with a mass on an RBE3 and a bar across. The strip
/// is rotated by `turn` about an oblique axis.
fn folded_strip(turn: f64) -> (Bulk, impl Fn([f64; 3]) -> [f64; 3]) {
    let axis = nalgebra::Unit::new_normalize(nalgebra::Vector3::new(1.0, -2.0, 0.5));
    let r = nalgebra::Rotation3::from_axis_angle(&axis, turn);
    let rotate = move |x: [f64; 3]| {
        let v = r * nalgebra::Vector3::from(x);
        [v.x, v.y, v.z]
    };
    let mut b = Bulk::default();
    b.card("MAT1,1,210000.,,.3,7.85-9");
    b.card("PSHELL,1,1,4.0,1,,1");
    b.card("PBAR,2,1,200.,9000.,4000.,8000.");
    let ids = b.patch(10, 4, |u, v| {
        let (a, y) = (1.2 * u, 60.0 * v);
        rotate([
            300.0 * a.sin(),
            y,
            300.0 * (1.0 - a.cos()) + if v > 0.6 { 100.0 * (v - 0.6) } else { 0.0 },
        ])
    });
    for i in 0..4 {
        let [a, c] = [ids[i][4], ids[i + 1][4]];
        let top = b.grid(rotate([
            300.0 * (0.12 * (i as f64 + 0.5)).sin(),
            75.0,
            60.0 + 12.0 * i as f64,
        ]));
        b.tria([a, c, top]);
    }
    let point = b.grid(rotate([150.0, 30.0, 160.0]));
    b.card(&format!(
        "RBE3,901,,{point},123456,1.0,123,{},{},\n,{},{},{}",
        ids[3][1], ids[3][3], ids[6][1], ids[6][3], ids[8][2]
    ));
    b.card(&format!("CONM2,902,{point},,2.-4"));
    let up = rotate([0.0, 0.0, 1.0]);
    b.card(&format!(
        "CBAR,903,2,{},{},{:.9E},{:.9E},{:.9E}",
        ids[0][2], ids[10][2], up[0], up[1], up[2]
    ));
    (b, rotate)
}

fn strains(model: &Model, loads: &[UnitLoad]) -> (Solution, SolveReport) {
    solve_unit_loads(model, loads, &SolveOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn load(model: &Model, grid: u32, force: [f64; 3], moment: [f64; 3]) -> UnitLoad {
    UnitLoad::AtGrid {
        grid: model.grid_ix(grid).unwrap(),
        force: force.into(),
        moment: moment.into(),
    }
}

fn flatten_centre_strains(case: &CaseResult) -> Vec<f64> {
    case.shells
        .centre
        .iter()
        .flatten()
        .flatten()
        .copied()
        .collect()
}

fn largest_magnitude(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |a, b| a.max(b.abs()))
}

fn worst_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter()
        .zip(b)
        .map(|(x, y)| (x - y).abs())
        .fold(0.0, f64::max)
        / largest_magnitude(a)
}

#[test]
fn turning_the_whole_model_turns_the_answer() {
    let ((a, ra), (b, rb)) = (folded_strip(0.0), folded_strip(0.83));
    let (ma, mb) = (a.model(), b.model());
    let (f, m) = ([100.0, -40.0, 70.0], [900.0, 300.0, -500.0]);
    let (sa, _) = strains(&ma, &[load(&ma, 20, ra(f), ra(m))]);
    let (sb, _) = strains(&mb, &[load(&mb, 20, rb(f), rb(m))]);
    let d = worst_difference(
        &flatten_centre_strains(&sa.cases[0]),
        &flatten_centre_strains(&sb.cases[0]),
    );
    eprintln!("turned model: {d:e}");
    assert!(d < 1e-7, "{d:e}");
}

#[test]
fn strains_from_two_supports_agree() {
    let (mut b, rotate) = folded_strip(0.4);
    b.card("SUPORT1,7,1,123,5,23,51,3");
    b.card("SUPORT1,8,12,123456");
    let model = b.model();
    let at = load(&model, 33, rotate([100.0, -40.0, 70.0]), [0.0; 3]);
    let case = |relief| LoadCase {
        subcase: 1,
        label: String::new(),
        loads: vec![at.clone()],
        spc: None,
        mpc: None,
        relief,
    };
    let solve = |relief| {
        let (s, r) = solve_cases(&model, &[case(relief)], &SolveOptions::default())
            .unwrap_or_else(|e| panic!("{e}"));
        assert!(r.balance[0].residual < 1e-10, "{:?}", r.balance);
        flatten_centre_strains(&s.cases[0])
    };
    let one = solve(Relief::Suport(Some(7)));
    let d = worst_difference(&one, &solve(Relief::Suport(Some(8))));
    assert!(d < 1e-6, "{d:e}");
    let d = worst_difference(&one, &solve(Relief::Automatic));
    assert!(d < 1e-6, "{d:e}");
}

#[test]
fn gravity_alone_strains_a_free_structure_nowhere_and_a_finding_reports_it() {
    let (mut b, _) = folded_strip(0.0);
    b.card("GRAV,5,,9810.,0.3,0.1,-1.0");
    b.card("FORCE,6,20,0,1.0,0.0,0.0,100.0");
    let model = b.model();
    let (s, report) = strains(&model, &[UnitLoad::Set(5), UnitLoad::Set(6)]);
    assert!(
        s.findings
            .iter()
            .any(|f| f.code == "load-is-inertia-only" && f.subject == "subcase 1"),
        "{:?}",
        s.findings
    );
    let (weight, force) = (
        largest_magnitude(&flatten_centre_strains(&s.cases[0])),
        largest_magnitude(&flatten_centre_strains(&s.cases[1])),
    );
    assert!(weight < 1e-8 * force, "{weight:e} {force:e}");
    let mass = report.mass.unwrap().mass;
    assert_near(
        "gravity resultant",
        report.balance[0].applied[2],
        -9810.0 * mass,
        1e-9,
    );
    for (a, i) in report.balance[1]
        .applied
        .iter()
        .zip(report.balance[1].inertia)
    {
        assert!((a + i).abs() < 1e-7 * 100.0, "{:?}", report.balance[1]);
    }
}

/// K R = 0 except at the supports, within 1e-10 of the largest entry times the size of the motion.
///
/// The surface is curved in both directions and has an offset, split quadrilaterals, and bars that are not on its
/// grids.
#[test]
fn no_rigid_motion_of_a_curved_model_is_resisted() {
    let mut b = Bulk::default();
    b.card("MAT1,1,210000.,,.3,7.85-9");
    b.card("PSHELL,1,1,4.0,1,,1");
    b.card("PBAR,2,1,200.,9000.,4000.,8000.");
    let ids = b.patch(8, 6, |u, v| {
        let (a, c) = (1.5 * u, 0.9 * v + 0.3 * u);
        [200.0 * a.sin(), 150.0 * c, 200.0 * a.cos() + 60.0 * c * c]
    });
    for i in 0..4 {
        b.tria([ids[2 * i][6], ids[2 * i + 1][6], ids[2 * i][3]]);
        b.card(&format!(
            "CBAR,{},2,{},{},0.,1.,0.3\n,,,3.,-4.,5.,0.,2.,1.",
            700 + i,
            ids[i][0],
            ids[i + 2][2]
        ));
    }
    b.card(&format!(
        "CQUAD4,800,1,{},{},{},{},0.0,3.0",
        ids[0][0], ids[2][0], ids[2][2], ids[0][2]
    ));
    let model = b.model();
    let (n, entries) = supported_stiffness(&model).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(n, 6 * model.grids.len(), "every dof is an unknown");
    let largest = entries.iter().fold(0.0_f64, |a, e| a.max(e.2.abs()));
    let mut resisted = vec![false; n];
    for mode in 0..6 {
        let mut r = Vec::with_capacity(n);
        for g in &model.grids {
            let mut w = nalgebra::Vector3::zeros();
            let mut t = nalgebra::Vector3::zeros();
            if mode < 3 {
                t[mode] = 1.0;
            } else {
                w[mode - 3] = 1.0;
                t = w.cross(&g.x);
            }
            r.extend([t.x, t.y, t.z, w.x, w.y, w.z]);
        }
        let size = r.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
        let mut f = vec![0.0; n];
        for (i, j, v) in &entries {
            f[*i] += v * r[*j];
            if i != j {
                f[*j] += v * r[*i];
            }
        }
        for (flag, f) in resisted.iter_mut().zip(&f) {
            *flag |= f.abs() > 1e-10 * largest * size;
        }
    }
    let count = resisted.iter().filter(|r| **r).count();
    assert!(count <= 6, "{count} dofs resist, six are supports");
}

#[test]
fn a_part_that_nothing_joins_is_named() {
    let (mut b, _) = folded_strip(0.0);
    let far = [
        b.grid([900.0, 0.0, 0.0]),
        b.grid([950.0, 0.0, 0.0]),
        b.grid([950.0, 50.0, 0.0]),
    ];
    b.tria(far);
    let model = b.model();
    let error = solve_unit_loads(
        &model,
        &[load(&model, 20, [0.0, 0.0, 1.0], [0.0; 3])],
        &SolveOptions::default(),
    )
    .unwrap_err();
    let FeError::Mechanism { parts, .. } = &error else {
        panic!("{error}")
    };
    assert!(
        parts.iter().any(|p| p.contains(&far[0].to_string())),
        "{error}"
    );
}

#[test]
fn a_hinge_without_torsion_support_is_named_with_what_hangs_there() {
    let mut b = Bulk::default();
    b.card("MAT1,1,210000.,,.3,7.85-9");
    b.card("PBAR,2,1,200.,9000.,4000.,8000.");
    let g: Vec<u32> = (0..4)
        .map(|i| b.grid([100.0 * f64::from(i), 0.0, 0.0]))
        .collect();
    b.card(&format!("CBAR,1,2,{},{},0.,1.,0.", g[0], g[1]));
    b.card(&format!("CBAR,2,2,{},{},0.,1.,0.,\n,,45", g[1], g[2]));
    b.card(&format!("CBAR,3,2,{},{},0.,1.,0.,\n,,5", g[2], g[3]));
    b.hold("1234", [g[0]]);
    b.force(g[3], [0.0, 0.0, 1.0]);
    let model = b.model();
    let case = LoadCase {
        subcase: 1,
        label: String::new(),
        loads: vec![UnitLoad::Set(1)],
        spc: Some(1),
        mpc: None,
        relief: Relief::None,
    };
    let error = solve_cases(&model, &[case], &SolveOptions::default()).unwrap_err();
    let FeError::Mechanism { dofs, .. } = &error else {
        panic!("{error}")
    };
    assert!(dofs.iter().all(|d| d.hangs.contains("CBAR")), "{error}");
}

#[test]
fn an_rbe3_on_a_line_and_a_dof_dependent_twice_are_refused_by_name() {
    let (mut b, _) = folded_strip(0.0);
    let point = b.grid([1.0, 2.0, 300.0]);
    b.card(&format!("RBE3,911,,{point},123456,1.0,123,1,2,\n,3"));
    let model = b.model();
    let at = load(&model, 20, [0.0, 0.0, 1.0], [0.0; 3]);
    let error =
        solve_unit_loads(&model, std::slice::from_ref(&at), &SolveOptions::default()).unwrap_err();
    assert!(error.to_string().contains("RBE3 911"), "{error}");

    let (mut b, _) = folded_strip(0.0);
    b.card("RBE2,921,1,123456,12");
    b.card("RBE2,922,2,123,12");
    let error = solve_unit_loads(&b.model(), &[at], &SolveOptions::default()).unwrap_err();
    let FeError::DependentTwice { claims, .. } = &error else {
        panic!("{error}")
    };
    assert!(claims.iter().any(|c| c.contains("922")), "{error}");
}

#[test]
fn free_modes_of_a_uniform_beam_follow_euler() {
    let mut b = Bulk::default();
    b.card("MAT1,1,210000.,,.3,7.85-9");
    b.card("PBAR,2,1,200.,9000.,4000.,8000.");
    let n = 40;
    let g: Vec<u32> = (0..=n)
        .map(|i| b.grid([50.0 * f64::from(i), 0.0, 0.0]))
        .collect();
    for i in 0..n as usize {
        b.card(&format!("CBAR,{},2,{},{},0.,1.,0.", i + 1, g[i], g[i + 1]));
    }
    let modes = free_modes(&b.model(), None, 4).modes;
    let l = 50.0 * f64::from(n);
    let exact = |k: f64, i: f64| {
        k * k / (l * l) * (210_000.0 * i / (7.85e-9 * 200.0_f64)).sqrt() / std::f64::consts::TAU
    };
    for (mode, expected) in modes.iter().zip([
        exact(4.73004, 4000.0),
        exact(4.73004, 9000.0),
        exact(7.8532, 4000.0),
        exact(7.8532, 9000.0),
    ]) {
        assert_near("frequency", mode.frequency, expected, 0.01);
    }
}
