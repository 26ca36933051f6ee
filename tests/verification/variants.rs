//! Compares variants that are solved with the factor of the base model with solutions that use separate factors.

use crate::adjoint::{scale_moduli, tray};
use strainbridge::fe::shell_frame::ShellPlace;
use strainbridge::fe::*;
use strainbridge::model::{Model, ShellKind, Vec3};

/// Returns the tray with a bush between a bracket and the wall.
fn model() -> Model {
    let mut b = tray();
    let ends = [[20.0, 10.0, 40.0], [20.0, 10.0, 40.0]].map(|x| b.grid(x));
    for (i, end) in ends.iter().enumerate() {
        let held = if i == 0 { "1,2,10,11" } else { "40,41,50,51" };
        b.card(&format!("RBE3,{},,{end},123456,1.0,123,{held}", 910 + i));
    }
    b.card("PBUSH,50,K,2.0+3,3.0+3,1.5+3,4.0+5,4.0+5,4.0+5");
    b.card(&format!("CBUSH,950,50,{},{},,,,0", ends[0], ends[1]));
    b.model()
}

/// Returns the model with thicker shells. They are also heavier, which changes the inertia forces.
fn thicken_shells(model: &Model, factor: f64) -> Model {
    let mut out = model.clone();
    for p in &mut out.shell_properties {
        if let ShellKind::Homogeneous { t, .. } = &mut p.kind {
            *t *= factor;
        }
        p.z = p.z.map(|z| z.map(|z| z * factor));
    }
    for s in out.shells.iter_mut().step_by(3) {
        s.thickness = s.thickness.map(|t| t * factor);
    }
    out
}

fn bush(model: &Model, factor: f64) -> Model {
    let mut out = model.clone();
    out.bushes[0].k = out.bushes[0].k.map(|k| k * factor);
    out
}

fn move_grid(model: &Model) -> Model {
    let mut out = model.clone();
    out.grids[20].x += Vec3::new(3.0, -2.0, 1.0);
    out
}

fn entries(solution: &Solution) -> Vec<f64> {
    let of = |c: &CaseResult| -> Vec<f64> {
        let corners = c.shells.corners.iter().flatten().flatten().flatten();
        let centres = c.shells.centre.iter().flatten().flatten();
        centres
            .chain(corners)
            .copied()
            .filter(|v| v.is_finite())
            .collect()
    };
    solution.cases.iter().flat_map(of).collect()
}

#[test]
fn variants_on_the_factor_of_their_base_are_those_with_factors_of_their_own() {
    let model = model();
    let loads =
        [(3, [300.0, -200.0, 500.0]), (45, [0.0, 700.0, 0.0])].map(|(g, f)| UnitLoad::AtGrid {
            grid: strainbridge::model::GridIx(g),
            force: f.into(),
            moment: [0.0, 1.0e4, 0.0].into(),
        });
    let held = Support {
        spc: Some(1),
        relief: Relief::None,
        by_springs: 0,
    };
    let variants = [
        thicken_shells(&model, 1.1),
        scale_moduli(&model, &[9, 10, 11, 17], 0.5),
        bush(&model, 2.0),
        bush(&model, 0.01),
        // The factor of the base does not help for a cut through the structure or for a moved grid.
        scale_moduli(&model, &[0, 1, 2, 3, 4, 5], 1e-5),
        move_grid(&model),
        model.clone(),
    ];
    for support in [Support::without_spc(&model), held] {
        let options = SolveOptions::default();
        let own = |m: &Model| {
            let solved = solve_unit_loads_on(m, support, &loads, &options).unwrap();
            entries(&solved.0)
        };
        let base = own(&model);
        let read = |_: &Model, s: &Solution| entries(s);
        let all = solve_variants(
            &model,
            support,
            &loads,
            variants.iter().cloned(),
            &options,
            read,
        );
        let all = all.unwrap();
        let size = base.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
        for (i, (got, variant)) in all.iter().zip(&variants).enumerate() {
            let right = own(variant);
            let largest = |a: &[f64], b: &[f64]| {
                a.iter()
                    .zip(b)
                    .fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()))
            };
            let (change, off) = (largest(&right, &base), largest(got, &right));
            assert!(
                i + 1 == variants.len() || change > 1e-4 * size,
                "{i}: {change} of {size}"
            );
            // The limit is 1e-8 in energy, and a single strain may have a larger error. The rounding error of two
            // factors is 1e-10 of the strain.
            assert!(
                off < 1e-6 * change + 1e-9 * size,
                "{i}: {off}, change {change}, size {size}"
            );
        }
    }
}

/// Returns readings at the centre and at a corner of shells, on both surfaces.
fn readings() -> Vec<Vec<StrainTerm>> {
    let term = |shell: u32, surface, place, coefficient| StrainTerm {
        shell: strainbridge::model::ShellIx(shell),
        surface,
        place,
        coefficient,
    };
    let (bottom, top) = (strain_tensor::Surface::Bottom, strain_tensor::Surface::Top);
    vec![
        vec![term(0, top, ShellPlace::Centre, [1.0, 0.0, 0.0])],
        vec![term(10, bottom, ShellPlace::Corner(2), [0.4, 0.6, 0.2])],
        vec![
            term(17, top, ShellPlace::Centre, [0.5, 0.5, 0.5]),
            term(18, bottom, ShellPlace::Centre, [-0.5, 0.5, 0.5]),
        ],
    ]
}

/// Returns the readings of a solution, by reading and load.
fn read_all(solution: &Solution) -> Vec<f64> {
    let of = |t: &StrainTerm, c: &CaseResult| -> f64 {
        let at = c.shells.elements.iter().position(|s| *s == t.shell);
        let side = t.surface.ix();
        let strain = match t.place {
            ShellPlace::Centre => c.shells.centre[at.unwrap()][side],
            ShellPlace::Corner(k) => c.shells.corners[at.unwrap()][k][side],
        };
        strain.iter().zip(t.coefficient).map(|(e, c)| e * c).sum()
    };
    let all = readings();
    let rows = all.iter().flat_map(|terms| {
        let sum = |c: &CaseResult| terms.iter().map(|t| of(t, c)).sum::<f64>();
        solution.cases.iter().map(sum).collect::<Vec<f64>>()
    });
    rows.collect()
}

#[test]
fn changes_of_readings_are_exact_for_bushes_and_first_order_for_shells() {
    let model = model();
    let loads =
        [(3, [300.0, -200.0, 500.0]), (45, [0.0, 700.0, 0.0])].map(|(g, f)| UnitLoad::AtGrid {
            grid: strainbridge::model::GridIx(g),
            force: f.into(),
            moment: [0.0, 1.0e4, 0.0].into(),
        });
    let held = Support {
        spc: Some(1),
        relief: Relief::None,
        by_springs: 0,
    };
    let steps = [2e-2, 1e-2];
    let variants = [
        bush(&model, 2.0),
        bush(&model, 0.01),
        thicken_shells(&model, 1.0 + steps[0]),
        thicken_shells(&model, 1.0 + steps[1]),
    ];
    for support in [Support::without_spc(&model), held] {
        let options = SolveOptions::default();
        let own = |m: &Model| {
            let solved = solve_unit_loads_on(m, support, &loads, &options).unwrap();
            read_all(&solved.0)
        };
        let base = own(&model);
        let (of, all) = (readings(), variants.iter().cloned());
        let found = reading_changes(&model, support, &loads, &of, all, &options);
        let found = found.unwrap().unwrap();
        let errors: Vec<f64> = found
            .iter()
            .zip(&variants)
            .map(|(got, variant)| {
                let right = own(variant);
                let right: Vec<f64> = right.iter().zip(&base).map(|(a, b)| a - b).collect();
                let largest = right.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
                let off = got.iter().zip(&right).map(|(a, b)| (a - b).abs());
                off.fold(0.0, f64::max) / largest
            })
            .collect();
        // Bushes have rounding errors only.
        assert!(errors[0] < 1e-8 && errors[1] < 1e-8, "{errors:?}");
        // The bending stiffness is proportional to the cube of the thickness. The relative error of first order is a
        // few times the step, and it is proportional to the step.
        assert!(errors[2] < 5.0 * steps[0], "{errors:?}");
        let ratio = errors[2] / errors[3];
        assert!((ratio - 2.0).abs() < 0.1, "{errors:?}");
    }
    // A moved grid is not a mere change of stiffness.
    let none = [move_grid(&model)].into_iter();
    let support = Support::without_spc(&model);
    let options = SolveOptions::default();
    let found = reading_changes(&model, support, &loads, &readings(), none, &options);
    assert_eq!(found.unwrap(), None);
}
