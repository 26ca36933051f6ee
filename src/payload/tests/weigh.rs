//! Payload weighing on a truck with six wheels and random gauge responses.

use crate::linalg::Matrix;
use crate::payload::{PayloadModel, PayloadRun, Place, Refusal, WeighSpec, weigh};
use crate::units::MICROSTRAIN;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Positions of the wheels relative to the nominal place of the payload, m.
const ARMS: [[f64; 2]; 6] = [
    [-5.0, -1.0],
    [-5.0, 1.0],
    [0.6, -0.9],
    [0.6, 0.9],
    [1.8, -0.9],
    [1.8, 0.9],
];

struct Lot(ChaCha8Rng);

impl Lot {
    fn draw_normal(&mut self) -> f64 {
        let (u, v): (f64, f64) = (
            self.0.random_range(1e-12..1.0),
            self.0.random_range(0.0..1.0),
        );
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }
    fn draw_uniform(&mut self, low: f64, high: f64) -> f64 {
        self.0.random_range(low..high)
    }
}

/// Returns the reactions of springs of equal rate under a rigid body: `(J'J)^-1 J'`, where J has the rows (1, x, y).
fn floor() -> Matrix {
    let j = Matrix::from_fn(6, 3, |w, k| [1.0, ARMS[w][0], ARMS[w][1]][k]);
    let normal = (j.transpose() * &j).try_inverse().expect("not on a line");
    &j * normal
}

/// Returns a truck whose gauges read 1 to 10 microstrain per kN of each wheel and of the payload.
fn truck(lot: &mut Lot, gauges: usize) -> PayloadModel {
    let wheels = Matrix::from_fn(gauges, 6, |_, _| MICROSTRAIN * lot.draw_uniform(-5.0, 5.0));
    let payload = Matrix::from_fn(gauges, 3, |_, k| {
        MICROSTRAIN * lot.draw_uniform(-5.0, 5.0) * if k == 0 { 1.0 } else { 0.5 }
    });
    PayloadModel {
        gauges: (0..gauges).map(|g| format!("G{g}")).collect(),
        wheels,
        payload,
        floor: Some(floor()),
        calibrated: None,
        noise: None,
        arms: Some(ARMS.to_vec()),
    }
}

fn spec(place: Place) -> WeighSpec {
    WeighSpec {
        place,
        model_rel: 0.0,
        reaction_sigma: 0.1,
        largest: 1e4,
        region: Some([[-3.0, 3.0], [-0.5, 0.5]]),
    }
}

/// Returns a run without errors.
fn exact_run(model: &PayloadModel, force: f64, shift: [f64; 2]) -> PayloadRun {
    let p = [force, force * shift[0], force * shift[1]];
    let floor = model.floor.as_ref().expect("the truck has a floor");
    let reactions: Vec<f64> = (0..6)
        .map(|w| (0..3).map(|k| floor[(w, k)] * p[k]).sum())
        .collect();
    let strain = (0..model.gauges.len())
        .map(|g| {
            (0..3).map(|k| model.payload[(g, k)] * p[k]).sum::<f64>()
                + (0..6)
                    .map(|w| model.wheels[(g, w)] * reactions[w])
                    .sum::<f64>()
        })
        .collect();
    PayloadRun {
        run: "R".into(),
        strain,
        sigma: vec![MICROSTRAIN; model.gauges.len()],
        reactions,
        shift: [0.0; 2],
    }
}

fn add_noise(lot: &mut Lot, mut run: PayloadRun) -> PayloadRun {
    run.strain
        .iter_mut()
        .for_each(|v| *v += MICROSTRAIN * lot.draw_normal());
    run.reactions
        .iter_mut()
        .for_each(|v| *v += 0.1 * lot.draw_normal());
    run
}

#[test]
fn readings_without_error_give_weight_and_place_back_from_each_source() {
    let mut lot = Lot(ChaCha8Rng::seed_from_u64(3));
    let model = truck(&mut lot, 20);
    let run = exact_run(&model, 54.414, [-0.3, 0.12]);
    let strain_alone = PayloadRun {
        reactions: Vec::new(),
        ..run.clone()
    };
    let wheels_alone = PayloadRun {
        strain: Vec::new(),
        sigma: Vec::new(),
        ..run.clone()
    };
    for r in [run, strain_alone, wheels_alone] {
        let w = &weigh(&model, &[r], &spec(Place::Free)).runs[0];
        assert!((w.force - 54.414).abs() < 0.01, "{w:?}");
        assert!(
            (w.shift[0] + 0.3).abs() < 0.01 && (w.shift[1] - 0.12).abs() < 0.01,
            "{w:?}"
        );
        assert_eq!(w.refused, None);
    }
}

#[test]
fn intervals_and_regions_cover_as_stated_whatever_the_source() {
    let mut lot = Lot(ChaCha8Rng::seed_from_u64(4));
    let trials = 400;
    for source in 0..3 {
        let (mut held, mut region) = (0, 0);
        for _ in 0..trials {
            let model = truck(&mut lot, 14);
            let truth = (
                lot.draw_uniform(20.0, 90.0),
                [lot.draw_uniform(-1.0, 1.0), lot.draw_uniform(-0.3, 0.3)],
            );
            let mut run = add_noise(&mut lot, exact_run(&model, truth.0, truth.1));
            match source {
                0 => run.reactions.clear(),
                1 => run.strain.clear(),
                _ => {}
            }
            let w = &weigh(&model, &[run], &spec(Place::Free)).runs[0];
            held += usize::from(w.interval[0] < truth.0 && truth.0 < w.interval[1]);
            let d = [w.shift[0] - truth.1[0], w.shift[1] - truth.1[1]];
            let [a, b, _, e] = w.shift_covariance;
            let q = (e * d[0] * d[0] - 2.0 * b * d[0] * d[1] + a * d[1] * d[1]) / (a * e - b * b);
            region += usize::from(q < 5.991);
        }
        // 95 % of 400 is 380 +- 4.4. Gauges that are down-weighted by chance widen the intervals a little.
        assert!(
            (362..=396).contains(&held),
            "source {source}: {held} of {trials}"
        );
        assert!(
            (358..=396).contains(&region),
            "source {source}: {region} of {trials}"
        );
    }
}

#[test]
fn with_a_third_of_the_gauges_bad_weight_and_place_stay_and_the_bad_ones_are_named() {
    let mut lot = Lot(ChaCha8Rng::seed_from_u64(5));
    let trials = 60;
    let (mut held, mut named, mut bad_all, mut good_lost) = (0, 0, 0, 0);
    for trial in 0..trials {
        let model = truck(&mut lot, 21);
        let truth = [(40.0, [0.5, 0.1]), (60.0, [-0.4, -0.2])];
        let runs: Vec<PayloadRun> = truth
            .iter()
            .map(|(f, at)| {
                let mut run = add_noise(&mut lot, exact_run(&model, *f, *at));
                for g in (0..21).filter(|g| (g + trial) % 3 == 0) {
                    run.strain[g] = match g % 4 {
                        0 => -run.strain[g],
                        1 => 0.0,
                        2 => run.strain[g] + 150.0 * MICROSTRAIN,
                        _ => 2.0 * run.strain[g],
                    };
                }
                run.reactions.clear();
                run
            })
            .collect();
        let answer = weigh(&model, &runs, &spec(Place::Free));
        for (w, (f, _)) in answer.runs.iter().zip(truth) {
            held += usize::from(w.interval[0] < f && f < w.interval[1]);
        }
        for (g, v) in answer.gauges.iter().enumerate() {
            let bad = (g + trial) % 3 == 0;
            // An error factor has little effect on a gauge with little strain.
            let loud = runs.iter().any(|r| r.strain[g].abs() > 40.0 * MICROSTRAIN) || g % 4 == 1;
            if bad && loud {
                bad_all += 1;
                named += usize::from(!v.used);
            }
            good_lost += usize::from(!bad && !v.used);
        }
    }
    assert!(held >= 108, "{held} of 120 inside");
    assert!(
        named * 100 >= bad_all * 90,
        "{named} of {bad_all} bad gauges found"
    );
    assert!(
        good_lost * 100 <= trials * 14 * 3,
        "{good_lost} good gauges lost"
    );
}

#[test]
fn a_payload_that_pulls_up_is_refused_with_the_reason() {
    let mut lot = Lot(ChaCha8Rng::seed_from_u64(6));
    let model = truck(&mut lot, 12);
    let mut run = exact_run(&model, -40.0, [0.0, 0.0]);
    for place in [Place::Known, Place::Free] {
        let answer = weigh(&model, std::slice::from_ref(&run), &spec(place));
        assert!(
            matches!(answer.runs[0].refused, Some(Refusal::Negative { .. })),
            "{:?}",
            answer.runs[0]
        );
    }
    run.reactions.clear();
    let answer = weigh(&model, &[run], &spec(Place::Known));
    assert!(
        matches!(answer.runs[0].refused, Some(Refusal::Negative { .. })),
        "{:?}",
        answer.runs[0]
    );
}

#[test]
fn strain_and_wheels_that_disagree_break_equilibrium() {
    let mut lot = Lot(ChaCha8Rng::seed_from_u64(7));
    let model = truck(&mut lot, 15);
    let mut run = add_noise(&mut lot, exact_run(&model, 50.0, [0.2, 0.0]));
    run.strain.iter_mut().for_each(|v| *v *= 1.4);
    let w = &weigh(&model, &[run], &spec(Place::Known)).runs[0];
    assert!(
        matches!(w.refused, Some(Refusal::OutOfBalance { .. })),
        "{w:?}"
    );
}

#[test]
fn a_place_outside_the_region_is_refused() {
    let mut lot = Lot(ChaCha8Rng::seed_from_u64(8));
    let model = truck(&mut lot, 15);
    let run = add_noise(&mut lot, exact_run(&model, 50.0, [0.2, 0.9]));
    let w = &weigh(&model, &[run], &spec(Place::Free)).runs[0];
    assert!(
        matches!(w.refused, Some(Refusal::OutsideRegion { .. })),
        "{w:?}"
    );
}
