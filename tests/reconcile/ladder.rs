//! Effects hidden in a ladder frame by beam theory. The formulas of the library do not generate the readings.
//!
//! Two simply supported rails carry wheels from below and a payload from above. Strain at a gauge is `M z / (E I)` from
//! the closed form of a beam under a point force. A payload at another place and a rail of another thickness therefore
//! act by exact formulas, and not by the linear signatures in the frame.

use super::hidden::drawn::draw_normal;
use super::hidden::plain_frame;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainbridge::reconcile::strain::{
    GaugeFacts, MassSignature, StiffnessOf, StiffnessSignature, StrainFrame, Wiring, examine,
};
use strainbridge::reconcile::{Observations, Outcome, Verdict};

/// Length of the rails and half the distance between them, m.
const LENGTH: f64 = 8.0;
const HALF: f64 = 0.42;
/// Stations of the axles and of the payload, m.
const AXLES: [f64; 2] = [1.3, 6.4];
const PAYLOAD: f64 = 4.4;
/// Microstrain per kN m at the flange of a rail.
const PER_MOMENT: f64 = 22.0;
/// Zone of the left rail with the uncertain thickness.
const ZONE: [f64; 2] = [1.7, 3.5];
const G: f64 = 9.80665e-3;
const RUNS: usize = 12;
const HELD_OUT: usize = 3;

/// Skips the stations close to the payload. Strain has a kink there, and no gauge is placed there.
fn away_from_payload(x: f64) -> f64 {
    if x < 3.5 { x } else { x + 1.8 }
}

/// Gauge: rail (+1 left), station, share of the flange distance.
struct Site {
    side: f64,
    x: f64,
    z: f64,
}

impl Site {
    /// Strain under an upward force of 1 kN at station `a`, `y` to the left. The rails share it by the lever rule. The
    /// bending moment is `x (L - a) / L` up to the station.
    fn strain_of_vertical_force(&self, a: f64, y: f64) -> f64 {
        let share = 0.5 * (1.0 + self.side * y / HALF);
        let (low, high) = (self.x.min(a), self.x.max(a));
        PER_MOMENT * self.z * share * low * (LENGTH - high) / LENGTH
    }

    /// Strain under a lateral force of 1 kN at station `a`. Both rails bend in the same direction about the vertical
    /// axis, with a third of the strain.
    fn side(&self, a: f64) -> f64 {
        let (low, high) = (self.x.min(a), self.x.max(a));
        PER_MOMENT / 3.0 * self.side * self.z.abs() * low * (LENGTH - high) / LENGTH
    }

    /// Strain under a longitudinal force of 1 kN at the tyre, 0.5 m below the rail. Its moment jumps at station `a`.
    fn strain_of_longitudinal_force(&self, a: f64, y: f64) -> f64 {
        let share = 0.5 * (1.0 + self.side * y / HALF);
        let moment = if self.x < a {
            -self.x / LENGTH
        } else {
            1.0 - self.x / LENGTH
        };
        PER_MOMENT * self.z * share * 0.5 * moment
    }

    fn is_in_zone(&self) -> bool {
        self.side > 0.0 && self.x > ZONE[0] && self.x < ZONE[1]
    }
}

/// Kind of noise.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Noise {
    White,
    /// Student's t with 4 degrees of freedom, scaled to the stated variance.
    Heavy,
    /// Correlation of .8 from run to run, with the stated variance.
    Wandering,
    /// One and a half times the stated noise.
    Larger,
}

/// Error of the model, 2 % as stated.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Errors {
    Nothing,
    /// A gain for each gauge.
    Gauge,
    /// An error of each influence coefficient. Neighbours along a rail have similar errors.
    Coefficient,
}

struct Case {
    frame: StrainFrame,
    /// Effect ids with places. Empty for a control.
    truth: Vec<String>,
}

const EFFECTS: [&str; 9] = [
    "zero_drift",
    "sign_flip",
    "gauge_gain",
    "gauge_swap",
    "payload_offset",
    "unaccounted_mass",
    "rail_stiffness",
    "thermal_uniform",
    "lateral_wheel_loads",
];

/// Returns a case with `effects`, each with `scale` times its usual size.
fn case(seed: u64, effects: &[&str], scale: f64, noise: Noise, errors: Errors) -> Case {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let n_g = rng.random_range(14..22);
    let sites: Vec<Site> = (0..n_g)
        .map(|g| Site {
            side: if g % 2 == 0 { 1.0 } else { -1.0 },
            // At least three gauges are in the zone. A single gauge could not separate the thickness from a gain.
            x: match g {
                0 | 2 | 4 => rng.random_range(ZONE[0]..ZONE[1]),
                _ => away_from_payload(rng.random_range(0.6..5.6)),
            },
            z: if rng.random_range(0..3) == 0 {
                -0.9
            } else {
                1.0
            },
        })
        .collect();
    let wheels: Vec<[f64; 2]> = AXLES
        .iter()
        .flat_map(|a| [[*a, HALF], [*a, -HALF]])
        .collect();
    let names = ["LF", "RF", "LR", "RR"];
    let n_c = wheels.len() + 4;
    // The analyst's model, with the payload to first order about its nominal place.
    let mut influence = Vec::new();
    let step = 0.05;
    for s in &sites {
        influence.extend(
            wheels
                .iter()
                .map(|w| s.strain_of_vertical_force(w[0], w[1])),
        );
        let payload = |dx: f64, dy: f64| -G * s.strain_of_vertical_force(PAYLOAD + dx, dy);
        let at = payload(0.0, 0.0);
        let by_x = (payload(step, 0.0) - payload(-step, 0.0)) / (2.0 * step);
        let by_y = payload(0.0, 1.0) - at;
        influence.extend([at, by_x, by_y, 0.0]);
    }
    let mut mass = Vec::new();
    for _ in 0..RUNS {
        mass.push([rng.random_range(500.0..8000.0), rng.random_range(-0.4..0.4)]);
    }
    let offset = if effects.contains(&"payload_offset") {
        0.2 * scale
    } else {
        0.0
    };
    let extra = if effects.contains(&"unaccounted_mass") {
        350.0 * scale
    } else {
        0.0
    };
    // The wheels carry the payload at its true place and the extra mass, by the lever rule. Wheel forces are measured.
    let lever = |x: f64| (x - AXLES[0]) / (AXLES[1] - AXLES[0]);
    let mut loads = Vec::new();
    let mut true_loads = Vec::new();
    for [kg, dx] in &mass {
        let rear = lever(PAYLOAD + dx + offset);
        let extra_rear = lever(2.0);
        for (w, _) in wheels.iter().enumerate() {
            let of = |rear: f64| if w < 2 { 1.0 - rear } else { rear };
            let f =
                0.5 * G * (kg * of(rear) + extra * of(extra_rear)) + 0.4 * draw_normal(&mut rng);
            true_loads.push(f);
            loads.push(f + 0.05 * draw_normal(&mut rng));
        }
    }
    let stated = 1.5;
    let rel = if errors == Errors::Nothing { 0.0 } else { 0.02 };
    // Errors of coefficients along a rail: three waves with random amplitudes.
    let waves: Vec<[f64; 7]> = (0..2 * n_c)
        .map(|_| std::array::from_fn(|_| draw_normal(&mut rng)))
        .collect();
    let error = |g: usize, c: usize, own: f64| match errors {
        Errors::Nothing => 0.0,
        Errors::Gauge => rel * own,
        Errors::Coefficient => {
            let w = &waves[2 * c + usize::from(sites[g].side > 0.0)];
            let at = |k: usize| (k as f64 * std::f64::consts::PI * sites[g].x / LENGTH).cos();
            rel * (w[0] + (1..4).map(|k| w[k] * at(k)).sum::<f64>()) / 2.0f64.sqrt() / 1.1
        }
    };
    let gains: Vec<f64> = (0..n_g).map(|_| draw_normal(&mut rng)).collect();
    let warm: Vec<f64> = (0..RUNS)
        .map(|_| 9.0 + 5.0 * draw_normal(&mut rng))
        .collect();
    let scrub: Vec<[f64; 8]> = (0..RUNS)
        .map(|_| std::array::from_fn(|_| draw_normal(&mut rng)))
        .collect();
    let thin = if effects.contains(&"rail_stiffness") {
        1.0 - 0.15 * scale
    } else {
        1.0
    };
    let mut values = vec![0.0; RUNS * n_g];
    for r in 0..RUNS {
        let [kg, dx] = mass[r];
        for (g, s) in sites.iter().enumerate() {
            let mut v = 0.0;
            for (c, w) in wheels.iter().enumerate() {
                v += true_loads[r * 4 + c]
                    * s.strain_of_vertical_force(w[0], w[1])
                    * (1.0 + error(g, c, gains[g]));
            }
            let place = PAYLOAD + dx + offset;
            v -= G * kg * s.strain_of_vertical_force(place, 0.0) * (1.0 + error(g, 4, gains[g]));
            v -= G * extra * s.strain_of_vertical_force(2.0, 0.0);
            if effects.contains(&"lateral_wheel_loads") {
                for (k, a) in AXLES.iter().enumerate() {
                    v += scale * scrub[r][k] * 1.6 * s.side(*a);
                    v += scale * scrub[r][2 + k] * 0.7 * s.strain_of_longitudinal_force(*a, HALF);
                    v += scale * scrub[r][4 + k] * 0.7 * s.strain_of_longitudinal_force(*a, -HALF);
                }
            }
            // Bending stiffness is proportional to thickness. In a statically determinate rail, strain in the zone is
            // inversely proportional to it.
            if s.is_in_zone() {
                v /= thin;
            }
            if effects.contains(&"thermal_uniform") {
                v += 1.3 * scale * warm[r] * (1.0 + 0.2 * s.z);
            }
            values[r * n_g + g] = v;
        }
    }
    let mut truth: Vec<String> = Vec::new();
    let name = |g: usize| format!("G{:02}", g + 1);
    // Gauges with large readings, so that their faults are visible.
    let power = |g: usize| (0..RUNS).map(|r| values[r * n_g + g].powi(2)).sum::<f64>();
    let mut order: Vec<usize> = (0..n_g).collect();
    order.sort_by(|a, b| power(*b).total_cmp(&power(*a)));
    order.truncate(n_g / 2);
    let mut take = |rng: &mut ChaCha8Rng| order.remove(rng.random_range(0..order.len()));
    for effect in effects {
        let all = |values: &mut [f64], g: usize, f: &dyn Fn(f64) -> f64| {
            values
                .iter_mut()
                .skip(g)
                .step_by(n_g)
                .for_each(|v| *v = f(*v));
        };
        match *effect {
            "zero_drift" => {
                let g = take(&mut rng);
                all(&mut values, g, &|v| v + 25.0 * scale);
                truth.push(format!("zero_drift:{}", name(g)));
            }
            "sign_flip" => {
                let g = take(&mut rng);
                all(&mut values, g, &|v| -v);
                truth.push(format!("sign_flip:{}", name(g)));
            }
            "gauge_gain" => {
                let g = take(&mut rng);
                all(&mut values, g, &|v| v * (1.0 + 0.2 * scale));
                truth.push(format!("gauge_gain:{}", name(g)));
            }
            "gauge_swap" => {
                let (a, b) = (take(&mut rng), take(&mut rng));
                (0..RUNS).for_each(|r| values.swap(r * n_g + a, r * n_g + b));
                truth.push(format!("gauge_swap:{}+{}", name(a.min(b)), name(a.max(b))));
            }
            "unaccounted_mass" => truth.push("unaccounted_mass:front".into()),
            "rail_stiffness" => truth.push("rail_stiffness:Z1".into()),
            other => truth.push(other.to_owned()),
        }
    }
    for g in 0..n_g {
        let mut last = draw_normal(&mut rng);
        for r in 0..RUNS {
            let white = draw_normal(&mut rng);
            let unit = match noise {
                Noise::White => white,
                Noise::Larger => 1.5 * white,
                Noise::Heavy => {
                    let chi: f64 = (0..4).map(|_| draw_normal(&mut rng).powi(2)).sum();
                    white / (chi / 4.0).sqrt() / 2.0f64.sqrt()
                }
                Noise::Wandering => {
                    last = 0.8 * last + 0.6 * white;
                    last
                }
            };
            values[r * n_g + g] += stated * unit;
        }
    }
    let observations = Observations {
        channels: (0..n_g).map(name).collect(),
        runs: (0..RUNS).map(|r| format!("R{:02}", r + 1)).collect(),
        values,
        held_out: (0..RUNS).map(|r| r >= RUNS - HELD_OUT).collect(),
    };
    let facts = |(g, s): (usize, &Site)| GaugeFacts {
        name: name(g),
        wiring: Wiring::Quarter,
        angle_deg: 0.0,
        position: Some([s.x, s.side * HALF, 0.1 * s.z]),
    };
    let gauges = sites.iter().enumerate().map(facts).collect();
    let load_names = names.iter().map(|n| format!("{n}.FZ")).collect();
    let zone = |percent: f64| -> Vec<f64> {
        let inverse = 1.0 / (1.0 + 0.01 * percent) - 1.0;
        let cell = |(i, v): (usize, &f64)| {
            if sites[i / n_c].is_in_zone() {
                inverse * v
            } else {
                0.0
            }
        };
        influence.iter().enumerate().map(cell).collect()
    };
    let stiffness = vec![StiffnessSignature {
        of: StiffnessOf::Zone,
        place: "Z1".into(),
        at_percent: [-25.0, -12.0, 12.0].map(|p| (p, zone(p))).to_vec(),
        prior_percent: 15.0,
    }];
    let column = |f: &dyn Fn(&Site) -> f64| sites.iter().map(f).collect::<Vec<f64>>();
    // An extra mass acts on the frame, whose wheel forces are measured.
    let masses = [("front", 2.0), ("rear", 7.1)].map(|(place, a)| MassSignature {
        place: place.into(),
        per_kg: column(&|s| -G * s.strain_of_vertical_force(a, 0.0)),
    });
    let mut other_loads = Vec::new();
    for (name, [a, y]) in names.iter().zip(&wheels) {
        other_loads.push((
            format!("FX_{name}"),
            column(&|s| s.strain_of_longitudinal_force(*a, *y)),
        ));
        other_loads.push((format!("FY_{name}"), column(&|s| 0.5 * s.side(*a))));
    }
    let thermal = column(&|s| 1.3 * (1.0 + 0.2 * s.z));
    let frame = plain_frame(observations, gauges, load_names, influence.clone(), loads);
    Case {
        frame: StrainFrame {
            payload: mass.iter().map(|[kg, dx]| [*kg, *dx, 0.0]).collect(),
            payload_origin: [PAYLOAD, 0.0],
            other_loads,
            thermal_uniform: Some(thermal),
            masses: masses.to_vec(),
            stiffness,
            noise: stated,
            load_noise: 0.05,
            model_rel: rel,
            ..frame
        },
        truth,
    }
}

/// Counts of answers: exact, nothing wrong, an effect that is not there.
#[derive(Clone, Copy, Debug, Default)]
struct Score {
    exact: usize,
    listed: usize,
    partial: usize,
    open: usize,
    wrong: usize,
}

impl Score {
    fn cases(&self) -> usize {
        self.exact + self.listed + self.partial + self.open + self.wrong
    }

    fn add(&mut self, truth: &[String], outcome: &Outcome) {
        let kind = |id: &String| id.clone();
        let mut want: Vec<String> = truth.iter().map(kind).collect();
        let mut got: Vec<String> = outcome.effects.iter().map(|e| e.id.clone()).collect();
        want.sort();
        got.sort();
        let listed = outcome.rivals.iter().any(|r| {
            let mut ids = r.ids.clone();
            ids.sort();
            r.indistinguishable && ids == want
        });
        let is_open = outcome.verdict != Verdict::Named;
        match (got == want, is_open) {
            (true, _) if outcome.verdict != Verdict::Unknown => self.exact += 1,
            (_, true) => self.open += 1,
            _ if listed => self.listed += 1,
            _ if got.iter().all(|g| want.contains(g)) => self.partial += 1,
            _ => self.wrong += 1,
        }
    }
}

/// Noise and model errors of the controls.
const CONTROLS: [(Noise, Errors); 6] = [
    (Noise::White, Errors::Nothing),
    (Noise::Heavy, Errors::Nothing),
    (Noise::Wandering, Errors::Nothing),
    (Noise::Larger, Errors::Nothing),
    (Noise::White, Errors::Gauge),
    (Noise::White, Errors::Coefficient),
];

/// Returns the number of cases of a kind: `few` by default, `STRAINBRIDGE_TRIALS` in a longer run.
fn trials(few: usize) -> usize {
    let asked = std::env::var("STRAINBRIDGE_TRIALS").ok();
    asked.and_then(|n| n.parse().ok()).unwrap_or(few)
}

/// Returns the effects of a seed: one, two or three, all at different gauges.
fn effects_of(seed: u64) -> Vec<&'static str> {
    let mut rng = ChaCha8Rng::seed_from_u64(1_000_000 + seed);
    let n = 1 + (seed % 3) as usize;
    let mut list = EFFECTS.to_vec();
    (0..n)
        .map(|_| list.remove(rng.random_range(0..list.len())))
        .collect()
}

#[test]
fn controls_of_every_noise_and_background_get_no_name() {
    let n = trials(6);
    let mut wrong = Vec::new();
    for seed in 0..n {
        let (noise, errors) = CONTROLS[seed % CONTROLS.len()];
        let c = case(seed as u64, &[], 1.0, noise, errors);
        let outcome = examine(&c.frame, &[]);
        if outcome.verdict == Verdict::Named {
            let ids: Vec<&str> = outcome.effects.iter().map(|e| e.id.as_str()).collect();
            wrong.push(format!("{seed} {noise:?} {errors:?}: {}", ids.join(" + ")));
        }
    }
    println!("controls: {} of {n} named: {wrong:?}", wrong.len());
    // One in a hundred, as the rule `decisive` requires.
    assert!(wrong.len() * 100 <= n, "{wrong:?}");
}

#[test]
fn effects_of_half_usual_and_twice_the_size_are_named_and_nothing_else() {
    let n = trials(6);
    let mut all = Score::default();
    for seed in 0..n as u64 {
        let effects = effects_of(seed);
        let scale = [1.0, 0.5, 2.0][(seed / 3 % 3) as usize];
        let errors = [Errors::Nothing, Errors::Gauge, Errors::Coefficient][(seed / 9 % 3) as usize];
        let c = case(5_000 + seed, &effects, scale, Noise::White, errors);
        let outcome = examine(&c.frame, &[]);
        let before = all;
        all.add(&c.truth, &outcome);
        if all.exact == before.exact {
            let ids: Vec<&str> = outcome.best_attempt.iter().map(|e| e.id.as_str()).collect();
            println!(
                "{seed} x{scale} {errors:?} {:?} {ids:?} for {:?}",
                outcome.verdict, c.truth
            );
        }
    }
    println!("effects: {all:?} of {}", all.cases());
    assert!(all.wrong * 50 <= n, "{all:?}");
    assert!(10 * (all.exact + all.listed) >= 8 * n, "{all:?}");
}
