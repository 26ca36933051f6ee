//! Independent simulation of a three-axle truck, which shares no code with the vehicle models.
//!
//! - The rigid body has heave, pitch and roll.
//! - Beam axles have heave and roll. The rear two are attached to the frame near a common trunnion.
//! - Springs are inboard of the wheels and have friction with memory (Dahl).
//! - Tyres can only push.
//! - The road has random waves. Left and right tracks are equal in long waves.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

pub(super) const RATE_HZ: f64 = 500.0;
const SUBSTEPS: usize = 4;
const G: f64 = 9.81;

pub(super) struct Axle {
    pub x: f64,
    /// Place at which the springs support the frame.
    pub seat: f64,
    pub mass: f64,
    pub roll_inertia: f64,
    pub half_track: f64,
    pub half_spring: f64,
    pub k: f64,
    pub c: f64,
    pub friction: f64,
    pub tyre_k: f64,
    pub tyre_c: f64,
}

pub(super) struct Truck {
    pub mass: f64,
    pub roll_inertia: f64,
    pub pitch_inertia: f64,
    pub axles: Vec<Axle>,
}

/// Readings at each corner, axle by axle, left then right.
pub(super) struct Readings {
    pub body: Vec<Vec<f64>>,
    pub hub: Vec<Vec<f64>>,
    pub force: Vec<Vec<f64>>,
    pub lifted_share: f64,
}

pub(super) fn roll_off() -> Truck {
    let axle = |x, seat, mass, half_spring, k, c, friction, tyre_k| Axle {
        x,
        seat,
        mass,
        roll_inertia: 0.9 * mass,
        half_track: 1.02,
        half_spring,
        k,
        c,
        friction,
        tyre_k,
        tyre_c: 2500.0,
    };
    Truck {
        mass: 10_500.0,
        roll_inertia: 9_000.0,
        pitch_inertia: 60_000.0,
        axles: vec![
            axle(2.6, 2.6, 800.0, 0.9, 280e3, 11e3, 300.0, 950e3),
            axle(-1.2, -1.83, 1100.0, 0.9, 520e3, 12e3, 420.0, 1600e3),
            axle(-2.5, -1.87, 1050.0, 0.9, 520e3, 12e3, 420.0, 1600e3),
        ],
    }
}

struct Gauss(ChaCha8Rng);

impl Gauss {
    fn next(&mut self) -> f64 {
        (0..12).map(|_| self.0.random::<f64>()).sum::<f64>() - 6.0
    }
}

/// Height of one track every millimetre-like step `dx`: waves by a random walk with a leak, so that slopes are white.
fn road(length_m: f64, dx: f64, roughness: f64, seed: u64) -> [Vec<f64>; 2] {
    let mut g = Gauss(ChaCha8Rng::seed_from_u64(seed));
    let n = (length_m / dx) as usize + 1;
    let mut tracks = [Vec::with_capacity(n), Vec::with_capacity(n)];
    let (mut common, mut own) = (0.0, [0.0; 2]);
    let mut smooth = [0.0; 2];
    for _ in 0..n {
        // Long waves are common to both tracks (leak over 30 m), short waves differ by track (leak over 2.5 m).
        common += -common * dx / 30.0 + roughness * dx.sqrt() * g.next();
        for s in 0..2 {
            own[s] += -own[s] * dx / 2.5 + 0.3 * roughness * dx.sqrt() * g.next();
            // The tyre's footprint averages over 0.2 m.
            smooth[s] += (common + own[s] - smooth[s]) * dx / 0.2;
            tracks[s].push(smooth[s]);
        }
    }
    tracks
}

fn height(track: &[f64], x: f64, dx: f64) -> f64 {
    let u = (x / dx).max(0.0);
    let i = (u as usize).min(track.len() - 2);
    track[i] + (track[i + 1] - track[i]) * (u - i as f64)
}

/// State: heave, pitch, roll of the body, heave and roll of each axle; their rates; friction states.
type State = Vec<f64>;

pub(super) fn drive(
    truck: &Truck,
    seconds: f64,
    speed: f64,
    roughness: f64,
    seed: u64,
    noise: [f64; 2],
) -> Readings {
    let dx = 0.05;
    let ahead = 10.0;
    let tracks = road(seconds * speed + 2.0 * ahead, dx, roughness, seed);
    let n_axles = truck.axles.len();
    let n = 3 + 2 * n_axles;
    let corners = 2 * n_axles;
    let h = 1.0 / (RATE_HZ * SUBSTEPS as f64);
    // The truck starts at rest on the level of the road's start.
    let mut y: State = vec![0.0; 2 * n + corners];
    let statics = static_forces(truck);
    let mut out = Readings {
        body: vec![vec![]; corners],
        hub: vec![vec![]; corners],
        force: vec![vec![]; corners],
        lifted_share: 0.0,
    };
    let mut g = Gauss(ChaCha8Rng::seed_from_u64(seed + 1000));
    let mut lifted = 0usize;
    let samples = (seconds * RATE_HZ) as usize;
    for i in 0..samples {
        let t = i as f64 / RATE_HZ;
        let (rates, forces) = rates(truck, &y, t, speed, &tracks, dx, ahead, &statics);
        for c in 0..corners {
            let axle = &truck.axles[c / 2];
            let side = if c % 2 == 0 { 1.0 } else { -1.0 };
            let body = rates[n] + axle.seat * rates[n + 1] + side * axle.half_spring * rates[n + 2];
            let j = n + 3 + 2 * (c / 2);
            let hub = rates[j] + side * axle.half_track * rates[j + 1];
            out.body[c].push(G + body + noise[0] * g.next());
            out.hub[c].push(G + hub + noise[0] * g.next());
            out.force[c].push(forces[c] + noise[1] * g.next());
            lifted += usize::from(forces[c] == 0.0);
        }
        for s in 0..SUBSTEPS {
            let t = t + s as f64 * h;
            let f =
                |y: &State, t: f64| rates_only(truck, y, t, speed, &tracks, dx, ahead, &statics);
            let add =
                |k: &State, w: f64| y.iter().zip(k).map(|(a, b)| a + w * b).collect::<State>();
            let k1 = f(&y, t);
            let k2 = f(&add(&k1, h / 2.0), t + h / 2.0);
            let k3 = f(&add(&k2, h / 2.0), t + h / 2.0);
            let k4 = f(&add(&k3, h), t + h);
            y = (0..y.len())
                .map(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
                .collect();
        }
    }
    out.lifted_share = lifted as f64 / (samples * corners) as f64;
    out
}

/// Static wheel forces (each side of each axle): least change of spring stretch that balances weight and pitch.
fn static_forces(truck: &Truck) -> Vec<f64> {
    // The body settles by s0 + s1 x. The sum of 2 k (s0 + s1 x) is m g, and the moment about the centre of mass is 0.
    let (mut a, mut b, mut c) = (0.0, 0.0, 0.0);
    for axle in &truck.axles {
        a += 2.0 * axle.k;
        b += 2.0 * axle.k * axle.seat;
        c += 2.0 * axle.k * axle.seat * axle.seat;
    }
    let weight = truck.mass * G;
    let det = a * c - b * b;
    let (s0, s1) = (weight * c / det, -weight * b / det);
    truck
        .axles
        .iter()
        .map(|x| x.k * (s0 + s1 * x.seat) + x.mass * G / 2.0)
        .collect()
}

fn rates_only(
    truck: &Truck,
    y: &State,
    t: f64,
    speed: f64,
    tracks: &[Vec<f64>; 2],
    dx: f64,
    ahead: f64,
    statics: &[f64],
) -> State {
    rates(truck, y, t, speed, tracks, dx, ahead, statics).0
}

#[allow(clippy::too_many_arguments)]
fn rates(
    truck: &Truck,
    y: &State,
    t: f64,
    speed: f64,
    tracks: &[Vec<f64>; 2],
    dx: f64,
    ahead: f64,
    statics: &[f64],
) -> (State, Vec<f64>) {
    let n = 3 + 2 * truck.axles.len();
    let mut out = vec![0.0; y.len()];
    let mut forces = Vec::with_capacity(2 * truck.axles.len());
    out[..n].copy_from_slice(&y[n..2 * n]);
    let (mut body_force, mut pitch_moment, mut roll_moment) = (0.0, 0.0, 0.0);
    for (i, axle) in truck.axles.iter().enumerate() {
        let (z, zr) = (3 + 2 * i, 4 + 2 * i);
        let (mut axle_force, mut axle_moment) = (0.0, 0.0);
        for s in 0..2 {
            let side = if s == 0 { 1.0 } else { -1.0 };
            let corner = 2 * i + s;
            let stretch = y[0] + axle.seat * y[1] + side * axle.half_spring * y[2]
                - y[z]
                - side * axle.half_spring * y[zr];
            let rate = y[n] + axle.seat * y[n + 1] + side * axle.half_spring * y[n + 2]
                - y[n + z]
                - side * axle.half_spring * y[n + zr];
            // Dahl friction reaches its full value after about 2 mm of travel.
            let q = y[2 * n + corner];
            out[2 * n + corner] = (rate - rate.abs() * q) / 0.002;
            let pull = axle.k * stretch + axle.c * rate + axle.friction * q;
            let place = ahead + axle.x + speed * t;
            let track = &tracks[s];
            let ground = height(track, place, dx) - height(track, ahead + axle.x, dx);
            let slope = (height(track, place + dx, dx) - height(track, place - dx, dx))
                / (2.0 * dx)
                * speed;
            let wheel = y[z] + side * axle.half_track * y[zr];
            let wheel_rate = y[n + z] + side * axle.half_track * y[n + zr];
            let tyre =
                (statics[i] + axle.tyre_k * (ground - wheel) + axle.tyre_c * (slope - wheel_rate))
                    .max(0.0);
            forces.push(tyre);
            body_force -= pull;
            pitch_moment -= axle.seat * pull;
            roll_moment -= side * axle.half_spring * pull;
            axle_force += pull + tyre - statics[i];
            axle_moment += side * (axle.half_spring * pull + axle.half_track * (tyre - statics[i]));
        }
        out[n + z] = axle_force / axle.mass;
        out[n + zr] = axle_moment / axle.roll_inertia;
    }
    out[n] = body_force / truck.mass;
    out[n + 1] = pitch_moment / truck.pitch_inertia;
    out[n + 2] = roll_moment / truck.roll_inertia;
    (out, forces)
}
