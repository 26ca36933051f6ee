//! Tables 6.1, 6.8, 6.9: readings from the analyst's model itself.

use crate::gauges::*;
use crate::world::*;
use strainbridge::fe::{LoadCase, Relief, SolveOptions, UnitLoad, solve_cases};
use strainbridge::gauge::gauge_reading;
use strainbridge::model::GridIx;
use strainbridge::study::{ErrorKind, PoolGauge, StudyError, StudySpec, TrueLoad, study_layout};

#[test]
fn table_6_1_reactions_of_a_separately_supported_solution_come_back_to_1e_5() {
    // Springs to ground under the hubs and three more fixed dofs. This solution has no inertia relief.
    let rate = 4.0e4;
    let mut extra = format!("GRAV,7,,{GRAVITY},0.,0.,-1.\n");
    for (i, g) in WHEELS.iter().enumerate() {
        extra += &format!("CELAS2,{},{rate},{g},3\n", 991_001 + i);
    }
    extra += "SPC1,5,12,900001\nSPC1,5,2,900005\nENDDATA";
    let text = deck_text(45.0, Frame::Shell, true, PAYLOAD_TONNES).replace("ENDDATA", &extra);
    let held = model_of(&text);
    let case = LoadCase {
        subcase: 1,
        label: String::new(),
        loads: vec![UnitLoad::Set(7)],
        spc: Some(5),
        mpc: None,
        relief: Relief::None,
    };
    let (solution, _) = solve_cases(&held, &[case], &SolveOptions::default()).unwrap();
    let standing = &solution.cases[0];
    let truth: Vec<f64> = WHEELS
        .iter()
        .map(|g| -rate * standing.displacement[grid(&held, *g).us()][2])
        .collect();
    let gauges = best_ten();
    let y: Vec<f64> = gauges
        .iter()
        .map(|g| gauge_reading(g, standing).unwrap())
        .collect();
    let s = sensitivity(gauges, &vertical_load_cases(analyst_truck()));
    let errors = percent(&solve_least_squares(&s.values, &y), &truth);
    println!("6.1: largest error {:.2e} %", largest_value(&errors));
    // Measured 9e-8 %.
    assert!(largest_value(&errors) < 1.8e-7, "{errors:?}");
}

#[test]
fn the_wheels_of_the_loaded_truck_carry_its_weight_and_share_it_as_the_levers_state() {
    let truck = analyst_truck();
    let r = truck.reactions();
    let weight = truck.model.weight();
    assert!((r.iter().sum::<f64>() / (weight.mass * GRAVITY) - 1.0).abs() < 1e-9);
    // The camelback turns about its pivot. Middle and rear axle share the load as 25 to 23 inches (Table A.1), except
    // for rods and leaf ends.
    let (middle, rear) = (r[2] + r[3], r[4] + r[5]);
    assert!(
        (middle / rear / (25.0 / 23.0) - 1.0).abs() < 0.05,
        "{middle} {rear}"
    );
    let wheels: Vec<GridIx> = WHEELS.iter().map(|w| grid(&truck.model, *w)).collect();
    let x = |i: usize| truck.model.grids[wheels[i].us()].x.x;
    let moment: f64 = (0..6).map(|i| r[i] * x(i)).sum();
    assert!((moment / (weight.mass * GRAVITY * weight.cg.x) - 1.0).abs() < 1e-9);
}

fn pool(gauges: &[strainbridge::gauge::Gauge]) -> Vec<PoolGauge> {
    let s = sensitivity(gauges, &vertical_load_cases(analyst_truck()));
    (0..gauges.len())
        .map(|g| PoolGauge {
            row: s.values.row(g).iter().copied().collect(),
            turned: None,
            slope: None,
        })
        .collect()
}

#[test]
fn tables_6_8_and_6_9_noise_in_proportion_at_ten_gauges() {
    let gauges = best_ten();
    let spec = StudySpec {
        truth: analyst_truck()
            .reactions()
            .into_iter()
            .map(TrueLoad::Known)
            .collect(),
        prior: vec![None; 6],
        sizes: None,
        noise: MICRO,
        trials: 2000,
        seed: 1,
    };
    for (size, limit) in [(0.05, 2.5), (0.10, 5.0)] {
        let row = study_layout(
            &pool(gauges),
            &[(0..10).collect()],
            StudyError {
                kind: ErrorKind::RelativeUniform,
                size,
            },
            &spec,
        );
        let errors: Vec<f64> = row
            .sigma
            .iter()
            .zip(&spec.truth)
            .map(|(s, t)| 100.0 * s / t.size())
            .collect();
        println!(
            "6.8/6.9: noise {size}: sd {errors:.2?} %, mean {:.2}, coverage {:.3?}",
            mean(&errors),
            row.coverage
        );
        assert!(mean(&errors) < limit, "{errors:?}");
    }
    // With noise as stated, the intervals have the stated coverage.
    let row = study_layout(
        &pool(gauges),
        &[(0..10).collect()],
        StudyError {
            kind: ErrorKind::AbsoluteNormal,
            size: 1.0,
        },
        &spec,
    );
    println!("6.8/6.9: coverage {:.4?}", row.coverage);
    assert!((mean(&row.coverage) - 0.95).abs() < 0.015, "{row:?}");
}
