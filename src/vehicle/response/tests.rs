//! Responses against closed forms, the balance of energy, and values of scipy.

use super::{
    Inputs, PrescribedMotion, Response, ResponseError, ResponseRules, compute_response,
    static_wheel_loads,
};
use crate::vehicle::layout::Vehicle;
use crate::vehicle::preset::{PresetRequest, vehicle};
use crate::vehicle::term::Term;
use crate::vehicle::tyre::add_tyres;
use std::collections::BTreeMap;
use std::f64::consts::PI;

fn model(name: &str, terms: &[&str]) -> Vehicle {
    let request = PresetRequest {
        model: name.to_owned(),
        terms: terms.iter().map(|t| (*t).to_owned()).collect(),
        ..PresetRequest::default()
    };
    vehicle(&request).unwrap()
}

fn inputs_of(rate_hz: f64, v: &Vehicle) -> Inputs {
    Inputs {
        rate_hz,
        forces: vec![None; v.wheels.len()],
        motions: vec![None; v.bodies.len()],
        tyres: vec![None; v.wheels.len()],
    }
}

/// Inputs of a quarter truck on its tyre, driven by the height of the road.
fn on_road(rate_hz: f64, road: Vec<f64>) -> (Vehicle, Inputs) {
    let mut v = model("front2", &[]);
    let tyres = add_tyres(&mut v, &BTreeMap::new());
    let mut inputs = inputs_of(rate_hz, &v);
    inputs.tyres = vec![Some(tyres[0].link)];
    inputs.motions[2] = Some(PrescribedMotion::Displacements(vec![road]));
    (v, inputs)
}

/// m_b, m_f, k_s, c_s, k_t, c_t.
const QUARTER: [f64; 6] = [3200.0, 1400.0, 4.8e5, 5600.0, 2.0e6, 900.0];

fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |m, v| m.max(v.abs()))
}

/// Two masses joined by a spring and damper, constant force P on one of them: the centre of mass moves by P t^2 / (2 (m1 + m2)), and the
/// stretch is that of one oscillator with the reduced mass.
#[test]
fn a_quarter_truck_under_a_constant_force_follows_the_closed_form() {
    let v = model("front2", &["k_s", "c_s"]);
    let [m_b, m_f, k, c] = [3200.0, 1400.0, 4.8e5, 5600.0];
    let (p, rate) = (1e4, 200.0);
    let mut inputs = inputs_of(rate, &v);
    inputs.forces = vec![Some(vec![p; 601])];
    let found =
        compute_response(&v, &[m_b, m_f, k, c], &inputs, &ResponseRules::default()).unwrap();
    assert_eq!((found.steps, found.step_error), (None, 0.0));
    let reduced = m_b * m_f / (m_b + m_f);
    let (w, z) = ((k / reduced).sqrt(), c / (2.0 * (k * reduced).sqrt()));
    assert!((found.fastest_hz - w / (2.0 * PI)).abs() < 1e-9 * w);
    let wd = w * (1.0 - z * z).sqrt();
    let size = p / m_f * reduced / k;
    for i in 0..=600 {
        let t = i as f64 / rate;
        // Stretch = body less wheel; reduced * stretch'' + c stretch' + k stretch = -reduced P / m_f.
        let settled = 1.0 - (-z * w * t).exp() * ((wd * t).cos() + z * w / wd * (wd * t).sin());
        let stretch = -size * settled;
        assert!((found.stretch[0][i] - stretch).abs() < 1e-10 * size, "{i}");
        let centre =
            (m_b * found.displacement[0][0][i] + m_f * found.displacement[1][0][i]) / (m_b + m_f);
        let expected = 0.5 * p * t * t / (m_b + m_f);
        assert!(
            (centre - expected).abs() < 1e-10 * expected.max(size),
            "{i}"
        );
        let force = m_b * found.acceleration[0][0][i] + m_f * found.acceleration[1][0][i];
        assert!((force - p).abs() < 1e-7 * p);
    }
}

/// Road z = Z sin(w t): after the transient the body follows the complex frequency response of the quarter truck to 1e-6 of its amplitude.
#[test]
fn a_wavy_road_gives_the_harmonic_response() {
    let [m_b, m_f, k, c, kt, ct] = QUARTER;
    let (rate, f, height) = (500.0, 2.5, 0.01);
    let w = 2.0 * PI * f;
    let road: Vec<f64> = (0..24_000)
        .map(|i| height * (w * i as f64 / rate).sin())
        .collect();
    let (v, inputs) = on_road(rate, road);
    let found = compute_response(&v, &QUARTER, &inputs, &ResponseRules::default()).unwrap();
    // Complex amplitudes by Cramer's rule: [k - m w^2 + i w c] x = b.
    type C = crate::linalg::Complex<f64>;
    let s = C::new(k, w * c);
    let t = C::new(kt, w * ct);
    let a11 = s - m_b * w * w;
    let a22 = s + t - m_f * w * w;
    let b2 = t * height;
    let determinant = a11 * a22 - s * s;
    let (body, wheel) = (s * b2 / determinant, a11 * b2 / determinant);
    let force = t * (C::new(height, 0.0) - wheel);
    let at = |x: C, time: f64| x.re * (w * time).sin() + x.im * (w * time).cos();
    for i in 22_000..24_000 {
        let time = i as f64 / rate;
        let pairs = [
            (found.displacement[0][0][i], at(body, time), body.norm()),
            (found.displacement[1][0][i], at(wheel, time), wheel.norm()),
            (
                found.acceleration[0][0][i],
                -w * w * at(body, time),
                w * w * body.norm(),
            ),
            (
                found.wheels[0].as_ref().unwrap()[i],
                at(force, time),
                force.norm(),
            ),
        ];
        for (n, (got, expected, size)) in pairs.into_iter().enumerate() {
            assert!(
                (got - expected).abs() < 1e-6 * size,
                "{i} {n}: {got} {expected}"
            );
        }
    }
}

/// Work of the wheel force = kinetic + spring energy + energy of the damper, by Simpson's rule on a fine grid.
#[test]
fn energy_is_balanced() {
    let v = model("front2", &["k_s", "c_s"]);
    let [m_b, m_f, k, c] = [3200.0, 1400.0, 4.8e5, 5600.0];
    let rate = 2000.0;
    let pulse = |t: f64| 2e4 * (-((t - 0.4) / 0.05).powi(2)).exp() * (30.0 * t).sin();
    let force: Vec<f64> = (0..=2000).map(|i| pulse(i as f64 / rate)).collect();
    let mut inputs = inputs_of(rate, &v);
    inputs.forces = vec![Some(force.clone())];
    let found =
        compute_response(&v, &[m_b, m_f, k, c], &inputs, &ResponseRules::default()).unwrap();
    let simpson = |of: &dyn Fn(usize) -> f64| -> f64 {
        let weight = |i: usize| match i {
            0 | 2000 => 1.0,
            _ if i % 2 == 1 => 4.0,
            _ => 2.0,
        };
        (0..=2000).map(|i| weight(i) * of(i)).sum::<f64>() / (3.0 * rate)
    };
    let work = simpson(&|i| force[i] * found.velocity[1][0][i]);
    let lost = simpson(&|i| c * found.rate[0][i].powi(2));
    let kinetic =
        0.5 * (m_b * found.velocity[0][0][2000].powi(2) + m_f * found.velocity[1][0][2000].powi(2));
    let spring = 0.5 * k * found.stretch[0][2000].powi(2);
    assert!(
        (work - lost - kinetic - spring).abs() < 1e-6 * work,
        "{work}"
    );
    assert!(lost > 0.1 * work);
}

/// Displacements by scipy.signal.lsim 1.17.1 of the quarter truck, wheel force P = 1e4 sin(2 pi 1.3 t) + 4e3 sin(2 pi 7.1 t). At its 20 kHz the lines
/// between samples follow the force to 4e-7.
#[test]
fn values_of_scipy_lsim_are_reproduced() {
    let v = model("front2", &["k_s", "c_s"]);
    let rate = 500.0;
    let p = |t: f64| 1e4 * (2.0 * PI * 1.3 * t).sin() + 4e3 * (2.0 * PI * 7.1 * t).sin();
    let mut inputs = inputs_of(rate, &v);
    inputs.forces = vec![Some((0..=1000).map(|i| p(i as f64 / rate)).collect())];
    let values = [3200.0, 1400.0, 4.8e5, 5600.0];
    let found = compute_response(&v, &values, &inputs, &ResponseRules::default()).unwrap();
    for (time, body, wheel) in LSIM {
        let i = (time * rate).round() as usize;
        let (b, w) = (found.displacement[0][0][i], found.displacement[1][0][i]);
        assert!((b - body).abs() < 1e-6 * 0.5, "{time}: {b} {body}");
        assert!((w - wheel).abs() < 1e-6 * 0.5, "{time}: {w} {wheel}");
    }
}

/// Time, displacement of the body, displacement of the wheel.
const LSIM: [(f64, f64, f64); 4] = [
    (0.25, 0.0370779565, 0.0559085831),
    (0.75, 0.220731181, 0.214833145),
    (1.4, 0.434199072, 0.418877379),
    (2.0, 0.593089515, 0.582977308),
];

/// Thesis 4.4: the acceleration of one body, simulated from the force, gives this force and the motion of the other body back.
#[test]
fn one_acceleration_gives_the_wheel_force_back() {
    for terms in [&["k_s", "c_s"][..], &["k_s", "c_s", "k3_s"][..]] {
        let v = model("front2", terms);
        let values = [3200.0, 1400.0, 4.8e5, 5600.0, 1e8];
        let rate = 1000.0;
        let p =
            |t: f64| 1e4 * (2.0 * PI * 1.3 * t).sin().powi(3) + 4e3 * (2.0 * PI * 6.0 * t).sin();
        let mut forward = inputs_of(rate, &v);
        let force: Vec<f64> = (0..4000).map(|i| p(i as f64 / rate)).collect();
        forward.forces = vec![Some(force.clone())];
        let rules = ResponseRules::default();
        let a = compute_response(&v, &values, &forward, &rules).unwrap();
        let mut backward = inputs_of(rate, &v);
        let recorded = a.acceleration[1].clone();
        backward.motions[1] = Some(PrescribedMotion::Accelerations(recorded));
        let b = compute_response(&v, &values, &backward, &rules).unwrap();
        let back = b.wheels[0].as_ref().unwrap();
        let gap: Vec<f64> = back.iter().zip(&force).map(|(x, y)| x - y).collect();
        assert!(largest(&gap) < 1e-5 * largest(&force), "{}", largest(&gap));
        let body = |r: &Response| r.displacement[0][0].clone();
        let gap: Vec<f64> = body(&a).iter().zip(body(&b)).map(|(x, y)| x - y).collect();
        assert!(largest(&gap) < 1e-5 * largest(&body(&a)));
    }
}

/// The first integral of m q'' + k q + k3 q^3 = P: m v^2 / 2 + k q^2 / 2 + k3 q^4 / 4 = P q.
#[test]
fn a_cubic_spring_keeps_its_energy() {
    let v = model("oscillator", &["k", "k3"]);
    let (m, k, k3, p) = (2.0, 800.0, 5e6, 4.0);
    let mut inputs = inputs_of(400.0, &v);
    inputs.forces = vec![Some(vec![p; 2000])];
    let found = compute_response(&v, &[m, k, k3], &inputs, &ResponseRules::default()).unwrap();
    assert!(found.step_error <= 1e-6 && found.steps.is_some());
    let (x, rate) = (&found.displacement[0][0], &found.velocity[0][0]);
    for (q, s) in x.iter().zip(rate) {
        let energy = 0.5 * m * s * s + 0.5 * k * q * q + 0.25 * k3 * q.powi(4);
        assert!((energy - p * q).abs() < 1e-6 * p * largest(x));
    }
}

/// Symmetric axle and body: equal roads under all wheels give heave alone, the motion of a quarter truck with half of the masses of an axle.
#[test]
fn a_half_vehicle_on_equal_axles_heaves_like_a_quarter_truck() {
    let mut v = model("half", &[]);
    let tyres = add_tyres(&mut v, &BTreeMap::new());
    let rate = 500.0;
    let road: Vec<f64> = (0..1500)
        .map(|i| 0.01 * (1.0 - (2.0 * PI * 1.5 * i as f64 / rate).cos()))
        .collect();
    let mut inputs = inputs_of(rate, &v);
    for tyre in &tyres {
        inputs.tyres[tyre.wheel] = Some(tyre.link);
        let road_body = v.links[tyre.link].ends[1].1.body;
        inputs.motions[road_body] = Some(PrescribedMotion::Displacements(vec![road.clone()]));
    }
    let [m_b, m_f, k, c, kt, ct] = QUARTER;
    // Wheels at x = 0 and x = -1: mass 2 m_b with its centre in the middle, and radius of gyration 0.4.
    let (mass, first) = (2.0 * m_b, -m_b);
    let inertia = 2.0 * m_b * (0.25 + 0.16);
    let names = v.parameters();
    let value = |name: &str| match name {
        "m_b" => mass,
        "mx_b" => first,
        "mxx_b" => inertia,
        "m_f" | "m_r" => m_f,
        "k_sf" | "k_sr" => k,
        "c_sf" | "c_sr" => c,
        "k_tf" | "k_tr" => kt,
        "c_tf" | "c_tr" => ct,
        _ => panic!("{name}"),
    };
    let values: Vec<f64> = names.iter().map(|p| value(&p.name)).collect();
    let rules = ResponseRules::default();
    let half = compute_response(&v, &values, &inputs, &rules).unwrap();
    let (q, one) = on_road(rate, road);
    let quarter = compute_response(&q, &QUARTER, &one, &rules).unwrap();
    let size = largest(&quarter.displacement[0][0]);
    for i in 0..1500 {
        assert!((half.displacement[0][0][i] - quarter.displacement[0][0][i]).abs() < 1e-9 * size);
        assert!(half.displacement[0][1][i].abs() < 1e-9 * size);
    }
}

/// Weight (m_b + m_f) g on the tyre, whatever the stiffness of the springs.
#[test]
fn a_tyre_at_rest_carries_the_weight() {
    let (v, inputs) = on_road(500.0, vec![0.0; 10]);
    let load = static_wheel_loads(&v, &QUARTER, &inputs, 9.81).unwrap();
    assert!((load[0].unwrap() - 4600.0 * 9.81).abs() < 1e-6);
}

#[test]
fn what_cannot_be_simulated_is_an_error() {
    let v = model("front2", &["k_s", "c_s"]);
    let rules = ResponseRules::default();
    let values = [3200.0, 1400.0, 4.8e5, 5600.0];
    let mut slow = inputs_of(30.0, &v);
    slow.forces = vec![Some(vec![1.0; 100])];
    let found = compute_response(&v, &values, &slow, &rules);
    assert!(
        matches!(found, Err(ResponseError::TooCoarse { .. })),
        "{found:?}"
    );
    let mut short = inputs_of(300.0, &v);
    short.forces = vec![Some(vec![1.0])];
    let found = compute_response(&v, &values, &short, &rules);
    assert!(matches!(found, Err(ResponseError::Length { .. })));
    let mut all = inputs_of(300.0, &v);
    let still = || Some(PrescribedMotion::Accelerations(vec![vec![0.0; 10]]));
    all.motions = vec![still(), still()];
    let found = compute_response(&v, &values, &all, &rules);
    assert_eq!(found, Err(ResponseError::NothingFree));
    let mut inputs = inputs_of(300.0, &v);
    inputs.forces = vec![Some(vec![1.0; 10])];
    let found = compute_response(&v, &[-1.0, 1400.0, 4.8e5, 5600.0], &inputs, &rules);
    assert_eq!(found, Err(ResponseError::Inertia("b".to_owned())));
    inputs.forces = vec![Some(vec![1.0; 30_000])];
    let found = compute_response(&v, &[3200.0, 1400.0, -4.8e5, 0.0], &inputs, &rules);
    assert!(matches!(found, Err(ResponseError::Diverged { .. })));
    let mut inert = v.clone();
    inert.links[0].terms.push(Term::Inertance);
    let found = compute_response(&inert, &[3200.0, 1400.0, 1.0, 1.0, 1.0], &inputs, &rules);
    assert_eq!(found, Err(ResponseError::Inertance("s".to_owned())));
}
