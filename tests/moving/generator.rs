//! Simulates quarter trucks and rear trucks with one hidden effect on a random road. It uses no code of the vehicle
//! models.
//!
//! A spring, a damper and the hidden effect connect each wheel to a sprung body. Tyres are springs and dampers that
//! only push.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

pub const RATE_HZ: f64 = 500.0;
const SUBSTEPS: usize = 4;
pub const G: f64 = 9.81;

/// Errors that are present in addition to the hidden effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Background {
    /// Sensor noise only.
    Clean,
    /// Gain errors of 1 %, clock errors of 0.4 ms, and a weak roll coupling that is not measured.
    Messy,
}

/// Measured vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Layout {
    Front,
    FrontAccelerationsOnly,
    Pair,
    Rear,
}

/// Case: records of both roads, and their true effect.
pub struct Case {
    pub layout: Layout,
    pub background: Background,
    pub truth: String,
    pub channel: Option<String>,
    /// Names of channels and their samples.
    pub data: Vec<(String, Vec<f64>)>,
    pub hold_out: Vec<(String, Vec<f64>)>,
    pub terms: Vec<String>,
    pub noise: [f64; 2],
    /// Mass of the measured body.
    pub sprung: f64,
    /// Linear rate of the spring that has the effect.
    pub spring: f64,
    pub rate_hz: f64,
}

pub struct Dice(ChaCha8Rng);

impl Dice {
    pub fn from_seed(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }
    pub fn draw_between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }
    pub fn draw_normal(&mut self) -> f64 {
        (0..12).map(|_| self.0.random::<f64>()).sum::<f64>() - 6.0
    }
    pub fn pick(&mut self, n: usize) -> usize {
        ((self.0.random::<f64>() * n as f64) as usize).min(n - 1)
    }
}

/// Force law of one suspension.
#[derive(Clone, Debug)]
struct Law {
    k: f64,
    c: f64,
    k3: f64,
    /// Coefficients of the square of the stretch, and of the stretch times its magnitude.
    k2: f64,
    kp: f64,
    friction: f64,
    fade: f64,
    stop: f64,
    gap: f64,
    /// Side of the stop: 0 both, 1 compression, 2 rebound.
    stop_side: usize,
    ca: f64,
    /// Effects outside the library.
    modulation: f64,
    modulation_hz: f64,
    memory_k: f64,
    memory_s: f64,
    drag: f64,
    /// Free play to each side.
    play: f64,
    /// Share of the stiffness that changes over the record, and the duration of the change.
    drift: f64,
    drift_s: f64,
}

struct Machine {
    sprung: Vec<f64>,
    unsprung: Vec<f64>,
    hangs_on: Vec<usize>,
    laws: Vec<Law>,
    tyre_k: Vec<f64>,
    tyre_c: Vec<f64>,
    statics: Vec<f64>,
    roll: f64,
    axle: f64,
    mass_step: Option<(f64, f64)>,
}

impl Machine {
    fn rates(&self, y: &[f64], road: &[[f64; 2]], t: f64) -> (Vec<f64>, Vec<f64>) {
        let (s, u) = (self.sprung.len(), self.unsprung.len());
        let n = s + u;
        let mut out = vec![0.0; y.len()];
        out[..n].copy_from_slice(&y[n..2 * n]);
        let mut force = vec![0.0; n];
        let mut tyres = Vec::with_capacity(u);
        for w in 0..u {
            let (b, i) = (self.hangs_on[w], s + w);
            let (d, v) = (y[b] - y[i], y[n + b] - y[n + i]);
            let l = &self.laws[w];
            let drifted = l.drift * (t / l.drift_s).min(1.0);
            let wave = l.modulation * (std::f64::consts::TAU * l.modulation_hz * t).sin();
            let stiffness = l.k * (1.0 + wave + drifted);
            let over = match l.stop_side {
                0 => (d - l.gap).max(0.0) + (d + l.gap).min(0.0),
                1 => (d + l.gap).min(0.0),
                _ => (d - l.gap).max(0.0),
            };
            let x = y[2 * n + w];
            out[2 * n + w] = if l.memory_s > 0.0 {
                (d - x) / l.memory_s
            } else {
                0.0
            };
            let pull = stiffness * (d - d.clamp(-l.play, l.play))
                + l.c * v
                + l.k3 * d * d * d
                + l.k2 * d * d
                + l.kp * d * d.abs()
                + l.friction * (v / l.fade).tanh()
                + l.stop * over
                + l.ca * v.abs()
                + l.memory_k * (d - x)
                + l.drag * v * v.abs();
            let tyre = (self.statics[w]
                + self.tyre_k[w] * (road[w][0] - y[i])
                + self.tyre_c[w] * (road[w][1] - y[n + i]))
                .max(0.0);
            tyres.push(tyre);
            force[b] -= pull;
            force[i] += pull + tyre - self.statics[w];
        }
        if s == 1 && u == 2 {
            // A beam between the axles of a bogie.
            let pull = self.axle * (y[1] - y[2]);
            force[1] -= pull;
            force[2] += pull;
        }
        if s == 2 {
            let pull = self.roll * (y[0] - y[1]);
            force[0] -= pull;
            force[1] += pull;
            let pull = self.axle * (y[2] - y[3]);
            force[2] -= pull;
            force[3] += pull;
        }
        for b in 0..n {
            let mut m = if b < s {
                self.sprung[b]
            } else {
                self.unsprung[b - s]
            };
            if let (0, Some((at, change))) = (b, self.mass_step)
                && t >= at
            {
                m += change;
                // The weight of the added mass acts too.
                force[0] -= change * G;
            }
            out[n + b] = force[b] / m;
        }
        (out, tyres)
    }
}

struct Drive {
    sprung: Vec<Vec<f64>>,
    unsprung: Vec<Vec<f64>>,
    tyres: Vec<Vec<f64>>,
}

fn drive(
    m: &Machine,
    (seconds, rate_hz): (f64, f64),
    roughness: f64,
    delay_s: f64,
    dice: &mut Dice,
) -> Drive {
    let every = (RATE_HZ * SUBSTEPS as f64 / rate_hz).round() as usize;
    let (s, u) = (m.sprung.len(), m.unsprung.len());
    let n = s + u;
    let h = 1.0 / (RATE_HZ * SUBSTEPS as f64);
    let steps = (seconds * RATE_HZ) as usize * SUBSTEPS;
    // Each track is white slope with a slow leak, smoothed twice by the footprint. Runge-Kutta needs half steps.
    let lead = (delay_s / h) as usize;
    let track = |dice: &mut Dice| {
        let (mut z, mut z1, mut z2) = (0.0, 0.0, 0.0);
        let half = h / 2.0;
        let mut out: Vec<[f64; 2]> = Vec::with_capacity(2 * (steps + lead) + 4);
        for _ in 0..2 * (steps + lead) + 4 {
            z += -0.6 * z * half + roughness * half.sqrt() * dice.draw_normal();
            z1 += (z - z1) * half / 0.006;
            let rate = (z1 - z2) / 0.006;
            z2 += rate * half;
            out.push([z2, rate]);
        }
        out
    };
    let common = track(dice);
    let roads: Vec<Vec<[f64; 2]>> = (0..u)
        .map(|w| {
            if s == 1 {
                // Wheels behind each other follow the same track with a delay.
                let from = if w == 0 { 2 * lead } else { 0 };
                common[from..].to_vec()
            } else {
                let own = track(dice);
                common
                    .iter()
                    .zip(&own)
                    .map(|(a, b)| [0.6 * a[0] + 0.8 * b[0], 0.6 * a[1] + 0.8 * b[1]])
                    .collect()
            }
        })
        .collect();
    let at = |i: usize| roads.iter().map(|r| r[i]).collect::<Vec<[f64; 2]>>();
    let mut y = vec![0.0; 2 * n + u];
    let mut out = Drive {
        sprung: vec![vec![]; s],
        unsprung: vec![vec![]; u],
        tyres: vec![vec![]; u],
    };
    for i in 0..steps {
        let t = i as f64 * h;
        let (k1, tyres) = m.rates(&y, &at(2 * i), t);
        if i % every == 0 {
            for b in 0..s {
                out.sprung[b].push(k1[n + b]);
            }
            for w in 0..u {
                out.unsprung[w].push(k1[n + s + w]);
                out.tyres[w].push(tyres[w]);
            }
        }
        let add = |k: &[f64], w: f64| {
            y.iter()
                .zip(k)
                .map(|(a, b)| a + w * b)
                .collect::<Vec<f64>>()
        };
        let k2 = m.rates(&add(&k1, h / 2.0), &at(2 * i + 1), t + h / 2.0).0;
        let k3 = m.rates(&add(&k2, h / 2.0), &at(2 * i + 1), t + h / 2.0).0;
        let k4 = m.rates(&add(&k3, h), &at(2 * i + 2), t + h).0;
        for j in 0..y.len() {
            y[j] += h / 6.0 * (k1[j] + 2.0 * (k2[j] + k3[j]) + k4[j]);
        }
    }
    out
}

/// Returns x delayed by `delay` samples (Catmull-Rom interpolation).
fn delay_samples(x: &[f64], delay: f64) -> Vec<f64> {
    let n = x.len() as isize;
    let at = |i: isize| x[i.clamp(0, n - 1) as usize];
    (0..n)
        .map(|i| {
            let u = i as f64 - delay;
            let k = u.floor();
            let f = u - k;
            let k = k as isize;
            let (a, b, c, d) = (at(k - 1), at(k), at(k + 1), at(k + 2));
            b + 0.5
                * f
                * (c - a + f * (2.0 * a - 5.0 * b + 4.0 * c - d + f * (3.0 * (b - c) + d - a)))
        })
        .collect()
}

/// Returns a case with a given gain error of a given channel.
pub fn hide_gain(
    layout: Layout,
    channel: &str,
    gain: f64,
    background: Background,
    seed: u64,
) -> Case {
    let exact = Exact {
        gain: Some((channel.to_owned(), gain)),
        ..Exact::default()
    };
    hide_exactly(layout, "accel_gain", 0, background, seed, &exact)
}

/// Returns a case in which the body gains or loses a given share of its mass, with a clean background.
pub fn hide_mass_change(layout: Layout, share: f64, seed: u64) -> Case {
    let exact = Exact {
        mass: Some(share),
        ..Exact::default()
    };
    hide_exactly(layout, "mass_change", 0, Background::Clean, seed, &exact)
}

/// Sizes that are given instead of random.
#[derive(Default)]
struct Exact {
    gain: Option<(String, f64)>,
    mass: Option<f64>,
    rate_hz: Option<f64>,
    /// Force of a cubic term in the same spring as a quadratic term, divided by that of the quadratic term at 20 mm.
    cube: Option<f64>,
}

/// Hides `effect` with a size (0: small, 1: medium, 2: large) in a random truck of `seed`.
pub fn hide(layout: Layout, effect: &str, size: usize, background: Background, seed: u64) -> Case {
    hide_exactly(layout, effect, size, background, seed, &Exact::default())
}

/// Hides a large quadratic term in the springs, and a cubic term with `share` of its force at a stretch of 20 mm.
pub fn hide_square_and_cube(layout: Layout, share: f64, seed: u64) -> Case {
    let exact = Exact {
        cube: Some(share),
        ..Exact::default()
    };
    hide_exactly(
        layout,
        "quadratic_stiffness",
        2,
        Background::Clean,
        seed,
        &exact,
    )
}

/// Returns a control (no hidden effect) sampled at `rate_hz`, which must divide 2,000.
pub fn hide_at(layout: Layout, rate_hz: f64, background: Background, seed: u64) -> Case {
    let exact = Exact {
        rate_hz: Some(rate_hz),
        ..Exact::default()
    };
    hide_exactly(layout, "none", 0, background, seed, &exact)
}

fn hide_exactly(
    layout: Layout,
    effect: &str,
    size: usize,
    background: Background,
    seed: u64,
    exact: &Exact,
) -> Case {
    let mut dice = Dice::from_seed(seed);
    let rate_hz = exact.rate_hz.unwrap_or(RATE_HZ);
    let n_wheels = 2;
    let n_sprung = if layout == Layout::Rear { 1 } else { 2 };
    let of = |three: [f64; 3]| three[size];
    let mut m = Machine {
        sprung: vec![],
        unsprung: vec![],
        hangs_on: if n_sprung == 1 {
            vec![0, 0]
        } else {
            vec![0, 1]
        },
        laws: vec![],
        tyre_k: vec![],
        tyre_c: vec![],
        statics: vec![],
        roll: 0.0,
        axle: 0.0,
        mass_step: None,
    };
    let heavy = if n_sprung == 1 { 1.6 } else { 1.0 };
    let first = heavy * dice.draw_between(2600.0, 3400.0);
    for i in 0..n_sprung {
        m.sprung.push(
            first
                * if i == 0 {
                    1.0
                } else {
                    dice.draw_between(0.9, 1.1)
                },
        );
    }
    for w in 0..n_wheels {
        m.unsprung.push(dice.draw_between(900.0, 1300.0));
        m.laws.push(Law {
            k: dice.draw_between(400e3, 530e3),
            c: dice.draw_between(6e3, 10e3),
            k3: 0.0,
            k2: 0.0,
            kp: 0.0,
            friction: 0.0,
            fade: 0.005,
            stop: 0.0,
            gap: 1.0,
            stop_side: 0,
            ca: 0.0,
            modulation: 0.0,
            modulation_hz: 0.0,
            memory_k: 0.0,
            memory_s: 0.0,
            drag: 0.0,
            play: 0.0,
            drift: 0.0,
            drift_s: 64.0,
        });
        m.tyre_k.push(dice.draw_between(1.3e6, 1.5e6));
        m.tyre_c.push(dice.draw_between(2e3, 3e3));
        let carried = if n_sprung == 1 {
            m.sprung[0] / 2.0
        } else {
            m.sprung[w]
        };
        m.statics.push((carried + m.unsprung[w]) * G);
    }
    let roughness = dice.draw_between(0.022, 0.034);
    let mut gain: Vec<(String, f64)> = vec![];
    let mut delay: Vec<(String, f64)> = vec![];
    let names: Vec<&str> = match layout {
        Layout::Rear => vec!["a_body", "a_mid", "a_rear", "f_mid", "f_rear"],
        Layout::FrontAccelerationsOnly => vec!["a_body", "a_wheel"],
        _ => vec!["a_body", "a_wheel", "f_wheel"],
    };
    let link = if layout == Layout::Rear {
        dice.pick(2)
    } else {
        0
    };
    let mut channel = None;
    let mut terms: Vec<String> = match layout {
        Layout::Rear => ["k_sm", "c_sm", "k_sr", "c_sr"].map(String::from).to_vec(),
        _ => ["k_s", "c_s"].map(String::from).to_vec(),
    };
    // Both sides of an axle are equal.
    let laws: Vec<usize> = if n_sprung == 2 {
        vec![0, 1]
    } else {
        vec![link]
    };
    let k = m.laws[link].k;
    let c = m.laws[link].c;
    let mut truth = effect.to_owned();
    for &l in &laws {
        let law = &mut m.laws[l];
        match effect {
            "none" => {}
            "viscous_damper" => {
                let lacking = if layout == Layout::Rear {
                    ["c_sm", "c_sr"][link]
                } else {
                    "c_s"
                };
                terms.retain(|t| t != lacking);
                law.c = of([2e3, 5e3, 9e3]);
            }
            "cubic_stiffness" => law.k3 = of([4e7, 1.2e8, 3.2e8]),
            // Shares of the linear rate at a stretch of 20 mm. A quadratic term that reaches the linear rate would
            // reverse the force.
            "quadratic_stiffness" => {
                law.k2 = of([0.05, 0.1, 0.2]) * k / 0.02;
                law.k3 = exact.cube.unwrap_or(0.0) * law.k2 / 0.02;
            }
            "progressive_leaf" => law.kp = of([0.1, 0.25, 0.5]) * k / 0.02,
            "coulomb_friction" => {
                law.friction = of([150.0, 450.0, 1000.0]);
                law.fade = [0.003, 0.006, 0.01][dice.pick(3)];
            }
            "bump_stop" => {
                law.gap = dice.draw_between(0.018, 0.028);
                law.stop = of([0.3, 0.8, 2.0]) * k;
                law.stop_side = [0, 1, 1][dice.pick(3)];
            }
            "asymmetric_damper" => law.ca = of([0.12, 0.25, 0.45]) * c,
            "modulated_stiffness" => {
                law.modulation = of([0.06, 0.12, 0.25]);
                law.modulation_hz = dice.draw_between(0.1, 1.0);
            }
            "memory" => {
                law.memory_k = of([0.15, 0.3, 0.6]) * k;
                law.memory_s = dice.draw_between(0.03, 0.2);
            }
            "dead_zone" => law.play = of([0.001, 0.002, 0.004]),
            "stiffness_drift" => law.drift = of([0.05, -0.1, 0.25]),
            "quadratic_damping" => {
                law.drag = of([0.3, 0.8, 1.6]) * c / 0.25;
                law.c *= 0.6;
            }
            _ => {}
        }
    }
    match effect {
        "roll_coupling" => m.roll = of([0.06, 0.12, 0.25]) * k,
        "axle_coupling" => m.axle = of([0.06, 0.12, 0.25]) * k,
        "mass_change" => {
            m.mass_step = Some((
                dice.draw_between(15.0, 50.0),
                exact.mass.unwrap_or(of([0.06, -0.12, 0.25])) * m.sprung[0],
            ))
        }
        "accel_gain" => {
            let at = names[dice.pick(if layout == Layout::Rear { 3 } else { 2 })].to_owned();
            let off = of([0.04, 0.08, 0.15]) * if dice.pick(2) == 0 { 1.0 } else { -1.0 };
            let (at, g) = exact.gain.clone().unwrap_or((at, 1.0 + off));
            gain.push((at.clone(), g));
            channel = Some(at);
        }
        "sign_flip" => {
            let at = names[dice.pick(2)].to_owned();
            gain.push((at.clone(), -1.0));
            channel = Some(at);
        }
        "time_offset" => {
            let at = names[dice.pick(names.len())].to_owned();
            delay.push((at.clone(), of([0.003, 0.005, 0.01])));
            channel = Some(at);
        }
        _ => {}
    }
    if background == Background::Messy {
        // A record that includes the other side measures its roll coupling.
        if n_sprung == 2 && layout != Layout::Pair {
            m.roll = dice.draw_between(0.01, 0.03) * k;
        }
        for name in &names {
            let (g, d) = (0.01 * dice.draw_normal(), 0.0004 * dice.draw_normal());
            gain.push(((*name).to_owned(), 1.0 + g.clamp(-0.02, 0.02)));
            delay.push(((*name).to_owned(), d.clamp(-0.0008, 0.0008)));
        }
    }
    let noise = [[0.02, 60.0], [0.04, 100.0]][dice.pick(2)];
    let offsets: Vec<f64> = names.iter().map(|_| 0.05 * dice.draw_normal()).collect();
    let axle_delay = dice.draw_between(0.08, 0.15);
    let record = |seconds: f64, roughness: f64, dice: &mut Dice, changed: bool| {
        let mut machine = Machine {
            mass_step: if changed { m.mass_step } else { None },
            sprung: m.sprung.clone(),
            unsprung: m.unsprung.clone(),
            hangs_on: m.hangs_on.clone(),
            laws: m.laws.clone(),
            tyre_k: m.tyre_k.clone(),
            tyre_c: m.tyre_c.clone(),
            statics: m.statics.clone(),
            ..m
        };
        machine.axle = m.axle;
        if !changed {
            machine.laws.iter_mut().for_each(|l| l.drift = 0.0);
        }
        let run = drive(&machine, (seconds, rate_hz), roughness, axle_delay, dice);
        let signal = |name: &str| -> Vec<f64> {
            match name {
                "a_body" => run.sprung[0].clone(),
                "a_body_other" => run.sprung[1].clone(),
                "a_wheel" | "a_mid" => run.unsprung[0].clone(),
                "a_wheel_other" | "a_rear" => run.unsprung[1].clone(),
                "f_wheel" | "f_mid" => run.tyres[0].clone(),
                _ => run.tyres[1].clone(),
            }
        };
        let mut list: Vec<String> = names.iter().map(|n| (*n).to_owned()).collect();
        if layout == Layout::Pair {
            list.extend(["a_body_other", "a_wheel_other", "f_wheel_other"].map(String::from));
        }
        list.into_iter()
            .map(|name| {
                let force = name.starts_with('f');
                let mut x = signal(&name);
                if !force {
                    x.iter_mut().for_each(|v| *v += G);
                }
                let tau: f64 = delay.iter().filter(|d| d.0 == name).map(|d| d.1).sum();
                if tau != 0.0 {
                    x = delay_samples(&x, tau * rate_hz);
                }
                let g: f64 = gain.iter().filter(|g| g.0 == name).map(|g| g.1).product();
                let at = names.iter().position(|n| *n == name);
                let offset = at.filter(|_| !force).map_or(0.0, |i| offsets[i]);
                let sd = noise[usize::from(force)];
                let samples = x
                    .iter()
                    .map(|v| ((g * v + offset + sd * dice.draw_normal()) * 1e4).round() / 1e4)
                    .collect();
                (name, samples)
            })
            .collect::<Vec<_>>()
    };
    let data = record(64.0, roughness, &mut dice, true);
    let hold_out = record(24.0, roughness * 1.1, &mut dice, false);
    if ["modulated_stiffness", "memory"].contains(&effect) {
        truth = "unknown".into();
    }
    // A coupling between left and right of one axle is one effect, wherever it acts.
    if effect == "axle_coupling" && layout == Layout::Pair {
        truth = "roll_coupling".into();
    }
    Case {
        layout,
        background,
        truth,
        channel,
        data,
        hold_out,
        terms,
        noise,
        sprung: m.sprung[0],
        spring: k,
        rate_hz,
    }
}
