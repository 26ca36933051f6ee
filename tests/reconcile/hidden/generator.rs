//! Hides an effect in the readings of a frame.
//!
//! The generator is seeded and has separate physics, so that the search does not invert its own formulas. The influence
//! matrices, gauges and load columns come from a base frame. Runs, loads, noise, background and effect are new.
//!
//! The messy background has 1 % of gain scatter and 1 degree of angle scatter, which is the model error that the job
//! declares. In addition, each influence coefficient differs by a fraction of a percent, as on another mesh.

use super::drawn::draw_normal;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainbridge::reconcile::effect::{Member, StrainEffect, library};
use strainbridge::reconcile::strain::{
    PayloadWeight, StrainFrame, WheelForces, angle_scatter, predict,
};

/// Case with a hidden effect.
pub struct Hidden {
    /// Case as the analyst has it.
    pub frame: StrainFrame,
    /// Effect ids with places, or `none`, or `unknown`.
    pub truth: Vec<String>,
    /// Root mean square of the effect on the readings, divided by the noise.
    pub signal: f64,
}

/// Quality of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Background {
    /// Exact.
    Clean,
    /// Gains, angles and coefficients have the errors stated above.
    Messy,
    /// Same errors as `Messy`, and noise of 1.5 times the stated noise.
    Noisy,
}

/// Effects with five sizes each.
pub const EFFECTS: [(&str, [f64; 5]); 26] = [
    ("lateral_wheel_loads", [0.1, 0.2, 0.4, 0.8, 1.5]),
    ("thermal_uniform", [2.0, 5.0, 10.0, 18.0, 30.0]),
    ("thermal_gradient", [1.0, 2.0, 4.0, 8.0, 12.0]),
    ("zero_drift", [5.0, 10.0, 20.0, 40.0, 80.0]),
    ("sign_flip", [1.0, 1.0, 1.0, 1.0, 1.0]),
    ("gauge_gain", [0.7, 0.85, 1.15, 1.3, 2.0]),
    ("gauge_swap", [1.0, 1.0, 1.0, 1.0, 1.0]),
    ("gauge_angle", [5.0, 10.0, 15.0, 30.0, 90.0]),
    ("payload_offset", [0.05, 0.1, 0.2, 0.35, 0.5]),
    ("unaccounted_mass", [50.0, 100.0, 250.0, 500.0, 900.0]),
    ("rail_stiffness", [5.0, 10.0, 15.0, 20.0, 30.0]),
    ("global_scale", [3.0, 5.0, 8.0, 12.0, 20.0]),
    ("payload_gravity_missing", [1.0, 1.0, 1.0, 1.0, 1.0]),
    ("uneven_ground", [0.3, 0.6, 1.0, 2.0, 4.0]),
    ("dead_channel", [1.0, 1.0, 1.0, 1.0, 1.0]),
    ("saturated_channel", [0.3, 0.4, 0.5, 0.6, 0.7]),
    ("zero_drift_creep", [10.0, 20.0, 40.0, 60.0, 80.0]),
    ("zero_drift_wander", [10.0, 20.0, 40.0, 60.0, 80.0]),
    ("lateral_that_repeats", [0.2, 0.4, 0.8, 1.3, 2.0]),
    ("wheel_scale", [3.0, 5.0, 8.0, 12.0, 25.0]),
    ("run_exchange", [1.0, 1.0, 1.0, 1.0, 1.0]),
    ("run_record", [0.05, 0.1, 0.2, 0.4, 0.8]),
    ("card_gain", [0.8, 0.9, 1.1, 1.2, 1.5]),
    ("gain_drift", [0.05, 0.1, 0.2, 0.3, 0.5]),
    ("cross_sensitivity", [0.05, 0.1, 0.2, 0.3, 0.5]),
    ("intermittent_channel", [1.0, 1.0, 1.0, 1.0, 1.0]),
];

/// Discrepancies that no effect of the library describes.
pub const UNMODELLED: [&str; 7] = [
    "hysteresis",
    "hardening",
    "unknown_load",
    "one_run",
    "cross_talk",
    "warm_spot",
    "loose_joint",
];

fn pick<T: Copy>(rng: &mut ChaCha8Rng, from: &[T]) -> T {
    from[rng.random_range(0..from.len())]
}

/// Returns the wheel forces on flat ground in the base case. They are linear in the payload and its moment, by least
/// squares for each wheel.
fn flat_ground(base: &StrainFrame) -> Vec<[f64; 2]> {
    let n_l = base.n_loads();
    (0..n_l)
        .map(|l| {
            let (mut a, mut b, mut c, mut p, mut q) = (0.0, 0.0, 0.0, 0.0, 0.0);
            for r in 0..base.n_runs() {
                let [m, x, _] = base.payload[r];
                let f = base.loads[r * n_l + l];
                (a, b, c) = (a + m * m, b + m * m * x, c + m * m * x * x);
                (p, q) = (p + m * f, q + m * x * f);
            }
            let det = a * c - b * b;
            [(p * c - q * b) / det, (a * q - b * p) / det]
        })
        .collect()
}

/// Returns a case with the given effect and size. The effect is `none`, one of [`UNMODELLED`], or several joined by
/// `+`.
pub fn hide(
    base: &StrainFrame,
    effect: &str,
    size: f64,
    background: Background,
    seed: u64,
) -> Hidden {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (n_g, n_l) = (base.n_gauges(), base.n_loads());
    let n_r = base.n_runs();
    let n_c = base.n_columns();
    let mut frame = base.clone();
    frame.noise = pick(&mut rng, &[1.0, 1.5, 2.0]);
    frame.load_noise = 0.06;
    frame.payload_weight = PayloadWeight::InModel;
    frame.wheel_forces = WheelForces::Measured;
    frame.model_rel = if background != Background::Clean {
        0.01
    } else {
        0.0
    };
    if background != Background::Clean {
        // The tolerance that the job declares.
        frame.scatter.push(angle_scatter(&frame, 1.0));
    }
    let flat = flat_ground(base);
    let mut loads = vec![0.0; n_r * n_l];
    for r in 0..n_r {
        let mass = pick(
            &mut rng,
            &[0.0, 1500.0, 2400.0, 3700.0, 5500.0, 6800.0, 8000.0],
        );
        let x = rng.random_range(-0.4..0.45);
        frame.payload[r] = [mass, x, 0.0];
        for l in 0..n_l {
            loads[r * n_l + l] = mass * (flat[l][0] + x * flat[l][1]);
        }
    }
    // The analyst's model, and the truth with other gains, angles and coefficients.
    frame.loads = loads;
    let mut truth = frame.clone();
    if background != Background::Clean {
        let angles: Vec<f64> = (0..n_g).map(|_| draw_normal(&mut rng)).collect();
        for (g, angle) in angles.iter().enumerate() {
            let gain = 1.0 + 0.01 * draw_normal(&mut rng);
            let facts = &frame.gauges[g];
            let (drawn, glued) = (
                facts.angle_deg.to_radians(),
                (facts.angle_deg + angle).to_radians(),
            );
            for c in 0..n_c {
                let at = g * n_c + c;
                if let Some(t) = frame.tensors[g].get(c) {
                    truth.influence[at] +=
                        strain_at_angle(*t, glued, facts) - strain_at_angle(*t, drawn, facts);
                }
                truth.influence[at] *= gain * (1.0 + 0.001 * draw_normal(&mut rng));
            }
        }
    }
    let clean = predict(&truth, &[]);
    let mut parts: Vec<String> = Vec::new();
    let mut readings = clean.clone();
    for one in effect.split('+') {
        // Without a size, the fourth of the five sizes.
        let usual = EFFECTS.iter().find(|e| e.0 == one).map_or(1.0, |e| e.1[3]);
        let size = if size.is_nan() { usual } else { size };
        apply(
            one,
            size,
            &mut rng,
            &mut frame,
            &mut truth,
            &mut readings,
            &mut parts,
        );
    }
    let expected = predict(&frame, &[]);
    let difference: f64 = readings
        .iter()
        .zip(&expected)
        .map(|(a, b)| (a - b).powi(2))
        .sum::<f64>()
        / readings.len() as f64;
    let signal = difference.sqrt() / frame.noise;
    let true_noise = if background == Background::Noisy {
        1.5 * frame.noise
    } else {
        frame.noise
    };
    for v in &mut readings {
        *v += true_noise * draw_normal(&mut rng);
    }
    if frame.wheel_forces == WheelForces::Measured {
        for f in &mut frame.loads {
            *f += frame.load_noise * draw_normal(&mut rng);
        }
    }
    frame.observations.values = readings;
    if parts.is_empty() {
        parts.push("none".into());
    }
    parts.sort();
    Hidden {
        frame,
        truth: parts,
        signal,
    }
}

fn strain_at_angle(
    [exx, eyy, gxy]: [f64; 3],
    angle: f64,
    facts: &strainbridge::reconcile::strain::GaugeFacts,
) -> f64 {
    let (s, c) = angle.sin_cos();
    let shear = if facts.wiring == strainbridge::reconcile::strain::Wiring::Quarter {
        gxy
    } else {
        0.0
    };
    exx * c * c + eyy * s * s + shear * s * c
}

/// Adds the change by `effect` of `size` to `readings`, and records its id.
fn apply(
    effect: &str,
    size: f64,
    rng: &mut ChaCha8Rng,
    frame: &mut StrainFrame,
    truth: &mut StrainFrame,
    readings: &mut [f64],
    parts: &mut Vec<String>,
) {
    let (n_g, n_r, n_c) = (frame.n_gauges(), frame.n_runs(), frame.n_columns());
    let strength = |t: &StrainFrame, g: usize| {
        let p = predict(t, &[]);
        ((0..n_r).map(|r| p[r * n_g + g].powi(2)).sum::<f64>() / n_r as f64).sqrt()
    };
    // A fault of a gauge with tiny readings cannot be found, so the gauge is one of those with larger readings.
    let mut order: Vec<usize> = (0..n_g).collect();
    order.sort_by(|&a, &b| strength(truth, b).total_cmp(&strength(truth, a)));
    let g = order[rng.random_range(0..n_g * 3 / 4)];
    let name = frame.gauges[g].name.clone();
    let sign = pick(rng, &[-1.0, 1.0]);
    let on = |readings: &mut [f64], g: usize, f: &mut dyn FnMut(usize, f64) -> f64| {
        for r in 0..n_r {
            readings[r * n_g + g] = f(r, readings[r * n_g + g]);
        }
    };
    let mut with = |effect: &dyn StrainEffect, parameters: &[f64]| {
        let now = predict(truth, &[Member { effect, parameters }]);
        let before = predict(truth, &[]);
        for (v, (a, b)) in readings.iter_mut().zip(now.iter().zip(&before)) {
            *v += a - b;
        }
    };
    match effect {
        "none" => {}
        "zero_drift" => {
            on(readings, g, &mut |_, v| v + sign * size);
            parts.push(format!("zero_drift:{name}"));
        }
        "zero_drift_creep" => {
            on(readings, g, &mut |r, v| {
                v + sign * size * (r + 1) as f64 / n_r as f64
            });
            parts.push(format!("zero_drift:{name}"));
        }
        "zero_drift_wander" => {
            let mut wanders: Vec<f64> = (0..n_r)
                .map(|_| sign * size * (1.0 + 0.13 * draw_normal(rng)))
                .collect();
            wanders.reverse();
            on(readings, g, &mut |r, v| v + wanders[r]);
            parts.push(format!("zero_drift:{name}"));
        }
        "wheel_scale" => {
            let n_l = frame.n_loads();
            let l = rng.random_range(0..n_l);
            for r in 0..n_r {
                frame.loads[r * n_l + l] *= 1.0 + sign * size / 100.0;
            }
            let load = frame.load_names[l]
                .split('.')
                .next()
                .unwrap_or_default()
                .to_owned();
            parts.push(format!("wheel_scale:{load}"));
        }
        "run_exchange" => {
            // The two runs have different payloads. An exchange of runs with equal payloads has no effect.
            let fit = frame.observations.fit_runs();
            let mass = |r: usize| frame.payload[r][0];
            let a = fit[rng.random_range(0..fit.len())];
            let other = fit.iter().copied().max_by(|&x, &y| {
                (mass(x) - mass(a))
                    .abs()
                    .total_cmp(&(mass(y) - mass(a)).abs())
            });
            let b = other.expect("a second run");
            let n_l = frame.n_loads();
            for l in 0..n_l {
                frame.loads.swap(a * n_l + l, b * n_l + l);
            }
            frame.payload.swap(a, b);
            let runs = &frame.observations.runs;
            parts.push(format!(
                "run_exchange:{}+{}",
                runs[a.min(b)],
                runs[a.max(b)]
            ));
        }
        "run_record" => {
            // A wrong recorded mass, in a run with a payload.
            let loaded: Vec<usize> = frame
                .observations
                .fit_runs()
                .into_iter()
                .filter(|r| frame.payload[*r][0] > 2000.0)
                .collect();
            let r = loaded[rng.random_range(0..loaded.len())];
            frame.payload[r][0] *= 1.0 + size;
            parts.push(format!("run_record:{}", frame.observations.runs[r]));
        }
        "card_gain" => {
            let length = rng.random_range(4..=8);
            let first = rng.random_range(0..n_g - length);
            for h in first..first + length {
                on(readings, h, &mut |_, v| size * v);
            }
            let (a, b) = (
                &frame.gauges[first].name,
                &frame.gauges[first + length - 1].name,
            );
            parts.push(format!("card_gain:{a}-{b}"));
        }
        "gain_drift" => {
            on(readings, g, &mut |r, v| {
                v * (1.0 + sign * size * r as f64 / (n_r - 1) as f64)
            });
            parts.push(format!("gain_drift:{name}"));
        }
        "cross_sensitivity" => {
            let h = if g + 1 < n_g { g + 1 } else { g - 1 };
            let leaks: Vec<f64> = (0..n_r).map(|r| readings[r * n_g + h]).collect();
            on(readings, g, &mut |r, v| v + size * leaks[r]);
            parts.push(format!("cross_sensitivity:{name}"));
        }
        "intermittent_channel" => {
            let open: Vec<bool> = (0..n_r).map(|r| r % 3 == 1).collect();
            on(readings, g, &mut |r, v| if open[r] { 0.0 } else { v });
            parts.push(format!("intermittent_channel:{name}"));
        }
        "lateral_that_repeats" => {
            let all: Vec<f64> = frame.other_loads.iter().map(|_| draw_normal(rng)).collect();
            for r in 0..n_r {
                for (k, (load, pattern)) in frame.other_loads.iter().enumerate() {
                    let usual = match &load[..2] {
                        "FY" => 2.5,
                        "FX" => 1.0,
                        "MX" => 0.9,
                        _ => 0.25,
                    };
                    let a = usual * (all[k] + 0.5 * draw_normal(rng));
                    for h in 0..n_g {
                        readings[r * n_g + h] += size * a * pattern[h];
                    }
                }
            }
            parts.push("lateral_wheel_loads".into());
        }
        "sign_flip" => {
            on(readings, g, &mut |_, v| -v);
            parts.push(format!("sign_flip:{name}"));
        }
        "gauge_gain" => {
            on(readings, g, &mut |_, v| size * v);
            parts.push(format!("gauge_gain:{name}"));
        }
        "dead_channel" => {
            on(readings, g, &mut |_, _| 0.0);
            parts.push(format!("dead_channel:{name}"));
        }
        "saturated_channel" => {
            let top = (0..n_r)
                .map(|r| readings[r * n_g + g].abs())
                .fold(0.0, f64::max);
            on(readings, g, &mut |_, v| v.clamp(-size * top, size * top));
            parts.push(format!("saturated_channel:{name}"));
        }
        "gauge_swap" => {
            let mut h = g;
            while h == g {
                h = order[rng.random_range(0..n_g * 3 / 4)];
            }
            for r in 0..n_r {
                readings.swap(r * n_g + g, r * n_g + h);
            }
            parts.push(format!(
                "gauge_swap:{}+{}",
                frame.gauges[g.min(h)].name,
                frame.gauges[g.max(h)].name
            ));
        }
        "gauge_angle" => {
            let facts = frame.gauges[g].clone();
            let (drawn, glued) = (
                facts.angle_deg.to_radians(),
                (facts.angle_deg + sign * size).to_radians(),
            );
            let mut moved = truth.clone();
            for c in 0..n_c {
                if let Some(t) = frame.tensors[g].get(c) {
                    moved.influence[g * n_c + c] +=
                        strain_at_angle(*t, glued, &facts) - strain_at_angle(*t, drawn, &facts);
                }
            }
            let (now, before) = (predict(&moved, &[]), predict(truth, &[]));
            on(readings, g, &mut |r, v| {
                v + now[r * n_g + g] - before[r * n_g + g]
            });
            parts.push(format!("gauge_angle:{name}"));
        }
        "payload_offset" => {
            let (dx, dy) = (
                sign * size * rng.random::<f64>(),
                size * draw_normal(rng).clamp(-1.5, 1.5),
            );
            for r in 0..n_r {
                let [m, x, _] = frame.payload[r];
                for h in 0..n_g {
                    let b = &truth.influence[h * n_c + n_c - 4..h * n_c + n_c];
                    readings[r * n_g + h] += m * (dx * b[1] + dy * b[2] + (x + dx) * dy * b[3]);
                }
            }
            parts.push("payload_offset".into());
        }
        "unaccounted_mass" => {
            let k = rng.random_range(0..frame.masses.len());
            for r in 0..n_r {
                for h in 0..n_g {
                    readings[r * n_g + h] += size * frame.masses[k].per_kg[h];
                }
            }
            parts.push(format!("unaccounted_mass:{}", frame.masses[k].place));
        }
        "global_scale" => {
            readings
                .iter_mut()
                .for_each(|v| *v *= 1.0 + sign * size / 100.0);
            parts.push("global_scale".into());
        }
        "payload_gravity_missing" => {
            frame.payload_weight = PayloadWeight::Missing;
            parts.push("payload_gravity_missing".into());
        }
        "rail_stiffness" => {
            let mut all = library(frame, &["rail_stiffness".into()]);
            all.retain(|c| c.effect.id() == "rail_stiffness");
            let c = &all[rng.random_range(0..all.len())];
            with(c.effect.as_ref(), &[sign * size]);
            parts.push(format!(
                "rail_stiffness:{}",
                c.effect.place().expect("a zone")
            ));
        }
        "thermal_uniform" | "thermal_gradient" => {
            let pattern = if effect == "thermal_uniform" {
                &frame.thermal_uniform
            } else {
                &frame.thermal_gradient
            };
            let pattern = pattern.clone().expect("a pattern");
            for r in 0..n_r {
                let degrees = size * rng.random_range(-0.5..1.7);
                for h in 0..n_g {
                    readings[r * n_g + h] += degrees * pattern[h];
                }
            }
            parts.push(effect.into());
        }
        "lateral_wheel_loads" => {
            for r in 0..n_r {
                let scrub: Vec<f64> = (0..3).map(|_| 2.5 * draw_normal(rng)).collect();
                for (k, (load, pattern)) in frame.other_loads.iter().enumerate() {
                    let a = match &load[..2] {
                        "FY" => scrub[[0, 1, 2, 2, 1, 0][(k / 5) % 6]] + 0.2 * draw_normal(rng),
                        "FX" => draw_normal(rng),
                        "MX" => 0.9 * draw_normal(rng),
                        _ => 0.25 * draw_normal(rng),
                    };
                    for h in 0..n_g {
                        readings[r * n_g + h] += size * a * pattern[h];
                    }
                }
            }
            parts.push(effect.into());
        }
        "uneven_ground" => {
            frame.wheel_forces = WheelForces::FlatGroundModel;
            for r in 0..n_r {
                // Twist of the ground: every axle rotates, and the sum over each side is constant.
                let twist = [draw_normal(rng), draw_normal(rng)];
                let change = [twist[0], twist[1], -twist[0] - twist[1]];
                for (l, sign) in [-1.0, -1.0, -1.0, 1.0, 1.0, 1.0].into_iter().enumerate() {
                    let axle = [0, 1, 2, 2, 1, 0][l];
                    for h in 0..n_g {
                        readings[r * n_g + h] +=
                            size * sign * change[axle] * truth.influence[h * n_c + l];
                    }
                }
            }
            parts.push(effect.into());
        }
        form => {
            add_unmodelled_effect(form, size, rng, frame, truth, readings, &order);
            parts.push("unknown".into());
        }
    }
}

fn add_unmodelled_effect(
    which: &str,
    size: f64,
    rng: &mut ChaCha8Rng,
    frame: &StrainFrame,
    truth: &StrainFrame,
    readings: &mut [f64],
    order: &[usize],
) {
    let (n_g, n_r) = (frame.n_gauges(), frame.n_runs());
    let clean = predict(truth, &[]);
    let top = clean.iter().fold(0.0f64, |a, v| a.max(v.abs()));
    let scale = (clean.iter().map(|v| v * v).sum::<f64>() / clean.len() as f64).sqrt();
    match which {
        // A part of the strain of the previous run remains.
        "hysteresis" => {
            for r in 1..n_r {
                for g in 0..n_g {
                    readings[r * n_g + g] +=
                        0.25 * size * (clean[(r - 1) * n_g + g] - clean[r * n_g + g]);
                }
            }
        }
        // Joints that close under load: strain grows less than in proportion.
        "hardening" => {
            for r in 0..n_r {
                let load = (0..n_g)
                    .map(|g| clean[r * n_g + g].abs())
                    .fold(0.0, f64::max)
                    / top;
                for g in 0..n_g {
                    readings[r * n_g + g] *= 1.0 - 0.5 * size * load;
                }
            }
        }
        // A force at an unknown place: one pattern, with another size in every run.
        "unknown_load" => {
            let pattern: Vec<f64> = (0..n_g)
                .map(|_| 0.5 * size * scale * draw_normal(rng))
                .collect();
            for r in 0..n_r {
                let a = draw_normal(rng);
                for g in 0..n_g {
                    readings[r * n_g + g] += a * pattern[g];
                }
            }
        }
        // An event in one run only.
        "one_run" => {
            let r = rng.random_range(0..n_r * 2 / 3);
            for g in 0..n_g {
                readings[r * n_g + g] += size * scale * draw_normal(rng);
            }
        }
        // Crosstalk from the neighbouring channel.
        "cross_talk" => {
            for r in 0..n_r {
                for g in 1..n_g {
                    readings[r * n_g + g] += 0.2 * size * clean[r * n_g + g - 1];
                }
            }
        }
        // Sun on a part of the frame.
        "warm_spot" => {
            let centre = rng.random_range(0.0..n_g as f64);
            for r in 0..n_r {
                let a = 60.0 * size * rng.random_range(-0.3..1.0);
                for g in 0..n_g {
                    readings[r * n_g + g] += a * (-((g as f64 - centre) / 4.0).powi(2)).exp();
                }
            }
        }
        // A few gauges lose contact above a load.
        _ => {
            for &g in order.iter().take(8) {
                for r in 0..n_r {
                    let v = clean[r * n_g + g];
                    readings[r * n_g + g] -= size * v * (v.abs() / scale).min(2.0) * 0.3;
                }
            }
        }
    }
}
