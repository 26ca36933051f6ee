//! Compares the sensitivity of strain to the stiffness of some shells with solutions of the changed model.

use crate::mesh::Bulk;
use strainbridge::fe::shell_frame::ShellPlace;
use strainbridge::fe::strain_tensor::Surface;
use strainbridge::fe::*;
use strainbridge::model::{MaterialIx, MaterialKind, Model, ShellIx, ShellKind, ShellPropertyIx};

/// Returns a tray: a floor, a side wall, one triangle, and a mass on an RBE3.
pub fn tray() -> Bulk {
    let mut b = Bulk::default();
    b.card("MAT1,1,210000.,,.3,7.85-9");
    b.card("PSHELL,1,1,3.0,1,,1");
    let ids = b.patch(8, 6, |u, v| {
        let across = 300.0 * v;
        [
            400.0 * u,
            across.min(200.0),
            (across - 200.0).max(0.0) + 10.0 * u * v,
        ]
    });
    let top = b.grid([25.0, -40.0, 5.0]);
    b.tria([ids[0][0], ids[1][0], top]);
    let point = b.grid([200.0, 100.0, 120.0]);
    b.card(&format!(
        "RBE3,901,,{point},123456,1.0,123,{},{},\n,{},{}",
        ids[3][1], ids[3][3], ids[5][1], ids[5][3]
    ));
    b.card(&format!("CONM2,902,{point},,2.-4"));
    b.hold("123", [ids[0][0], ids[0][6], ids[8][0]]);
    b
}

/// Returns the model with the moduli of some shells multiplied by a factor.
pub fn scale_moduli(model: &Model, shells: &[usize], factor: f64) -> Model {
    let mut out = model.clone();
    let mut material = out.materials[0];
    let MaterialKind::Isotropic { e, g, .. } = &mut material.kind else {
        panic!("MAT1 is isotropic");
    };
    *e *= factor;
    *g *= factor;
    material.id = 1000;
    out.materials.push(material);
    let own = MaterialIx(out.materials.len() as u32 - 1);
    let mut property = out.shell_properties[0].clone();
    let ShellKind::Homogeneous {
        membrane,
        bending,
        shear,
        coupling,
        ..
    } = &mut property.kind
    else {
        panic!("PSHELL is homogeneous");
    };
    for m in [membrane, bending, shear, coupling].into_iter().flatten() {
        *m = own;
    }
    property.id = 1000;
    out.shell_properties.push(property);
    let own = ShellPropertyIx(out.shell_properties.len() as u32 - 1);
    for &s in shells {
        out.shells[s].property = own;
    }
    out
}

fn strain_of_term(case: &CaseResult, t: &StrainTerm) -> f64 {
    let i = t.shell.us();
    let strain = match t.place {
        ShellPlace::Centre => case.shells.centre[i][t.surface.ix()],
        ShellPlace::Corner(k) => case.shells.corners[i][k][t.surface.ix()],
    };
    strain.iter().zip(t.coefficient).map(|(e, c)| e * c).sum()
}

#[test]
fn the_adjoint_change_is_the_slope_of_solutions_with_some_shells_softer_free_and_held() {
    const STEP: f64 = 1e-3;
    let model = tray().model();
    let corner = model.grids.len() as u32 - 3;
    let loads = [
        UnitLoad::AtGrid {
            grid: strainbridge::model::GridIx(corner),
            force: [300.0, -200.0, 500.0].into(),
            moment: [0.0; 3].into(),
        },
        UnitLoad::AtGrid {
            grid: model
                .grid_ix(model.grids[model.grids.len() - 1].id)
                .unwrap(),
            force: [0.0, 700.0, 0.0].into(),
            moment: [2.0e4, 0.0, 0.0].into(),
        },
    ];
    let term = |shell: u32, surface, place, coefficient| StrainTerm {
        shell: ShellIx(shell),
        surface,
        place,
        coefficient,
    };
    let last = model.shells.len() as u32 - 1;
    let readings = [
        vec![term(9, Surface::Top, ShellPlace::Centre, [1.0, 0.0, 0.0])],
        vec![term(
            20,
            Surface::Bottom,
            ShellPlace::Corner(2),
            [0.3, 0.7, 0.4],
        )],
        // A half bridge with two arms, then a triangle.
        vec![
            term(30, Surface::Top, ShellPlace::Centre, [0.0, 1.0, 0.0]),
            term(31, Surface::Bottom, ShellPlace::Centre, [0.0, -1.0, 0.0]),
        ],
        vec![term(
            last,
            Surface::Top,
            ShellPlace::Centre,
            [0.5, 0.5, 0.5],
        )],
    ];
    let sets: [&[usize]; 3] = [&[9], &[14, 15, 20, 21], &[last as usize, 0, 1]];
    let held = Support {
        spc: Some(1),
        relief: Relief::None,
        by_springs: 0,
    };
    for support in [Support::without_spc(&model), held] {
        let options = SolveOptions::default();
        let adjoint = Adjoint::solve(&model, support, &loads, &readings, &options).unwrap();
        for (set, change) in sets.iter().zip(adjoint.changes(&sets).unwrap()) {
            let at = |factor: f64| {
                let model = scale_moduli(&model, set, factor);
                solve_unit_loads_on(&model, support, &loads, &options)
                    .unwrap()
                    .0
            };
            let [less, more] = [at(1.0 - STEP), at(1.0 + STEP)];
            let mut largest = 0.0_f64;
            let mut worst = 0.0_f64;
            for (r, terms) in readings.iter().enumerate() {
                for l in 0..loads.len() {
                    let of = |s: &Solution| -> f64 {
                        terms.iter().map(|t| strain_of_term(&s.cases[l], t)).sum()
                    };
                    let slope = (of(&more) - of(&less)) / (2.0 * STEP);
                    largest = largest.max(slope.abs());
                    worst = worst.max((slope - change[r * loads.len() + l]).abs());
                }
            }
            // The error of central differences is of second order in the step.
            assert!(
                largest > 1e-9 && worst < 1e-5 * largest,
                "{set:?} {support:?}: {worst:e} of {largest:e}"
            );
        }
    }
}

#[test]
fn a_mesh_divided_in_part_carries_even_strain_exactly() {
    let mut b = Bulk::shell(210_000.0, 0.3, 2.0);
    // A rectangle of skewed quadrilaterals.
    let ids = b.patch(6, 5, |u, v| {
        let (x, y) = (300.0 * u, 200.0 * v);
        let inside = u > 0.0 && u < 1.0 && v > 0.0 && v < 1.0;
        let off = if inside {
            6.0 * (7.0 * u + 3.0 * v).sin()
        } else {
            0.0
        };
        [x + off, y - off, 0.0]
    });
    b.hold("1", ids[0].iter().copied());
    b.hold("2", [ids[0][0]]);
    b.hold("3456", ids.iter().flatten().copied());
    // 10 N/mm along the far edge. The end grids take half a share.
    for (j, grid) in ids[6].iter().enumerate() {
        let share = if j == 0 || j == 5 { 0.5 } else { 1.0 };
        b.force(*grid, [10.0 * 40.0 * share, 0.0, 0.0]);
    }
    let model = b.model();
    let divided = model.shells_near(&[ShellIx(12)], 1);
    let n = divided.iter().filter(|d| **d).count();
    assert_eq!(n, 9, "one shell and those that meet it at a grid");
    let fine = model.refine_shells_at(&divided).unwrap();
    assert_eq!(fine.model.shells.len(), model.shells.len() + 3 * n);
    let case = LoadCase {
        subcase: 1,
        label: String::new(),
        loads: vec![UnitLoad::Set(1)],
        spc: Some(1),
        mpc: fine.model.mpc,
        relief: Relief::None,
    };
    let (solution, _) = solve_cases(&fine.model, &[case], &SolveOptions::default()).unwrap();
    // Plane stress: exx = N / (E t), eyy = -nu exx. The limit 1e-9 is the rounding error of the factor.
    let exx = 10.0 / (210_000.0 * 2.0);
    for (i, centre) in solution.cases[0].shells.centre.iter().enumerate() {
        let trace = centre[0][0] + centre[0][1];
        assert!((trace - 0.7 * exx).abs() < 1e-9 * exx, "shell {i}: {trace}");
    }
}
