//! The equations of motion of a record, linear in the parameters.

use super::layout::{Point, Vehicle};
use super::motion::Motion;

/// One equation over all samples: sum of parameter times column = target.
#[derive(Clone, Debug, PartialEq)]
pub struct Equation {
    /// Name, such as `body b` or `total`.
    pub name: String,
    /// Parameter indices with their columns, ascending.
    pub columns: Vec<(usize, Vec<f64>)>,
    /// Measured outside force in the equation. It is zero if no force acts.
    pub target: Vec<f64>,
    /// Whether an outside force acts.
    pub driven: bool,
}

/// Returns the equations of every body whose outside forces are all measured, then the equations of the total momentum of the vehicle.
///
/// Each motion of a body gives one equation: M q'' + sum over link ends of weight phi F_link = sum over wheels of phi F_wheel (thesis 5.1 to 5.5 for
/// bodies that only heave).
///
/// The totals are the sum of these equations (heave) and, if the sprung body turns, the moments about y and x. Link forces cancel in a total, and a
/// total in which they do not cancel is left out. Totals need every wheel force. The vehicle should be one piece ([`Vehicle::components`]).
pub fn equations(vehicle: &Vehicle, motion: &Motion) -> Vec<Equation> {
    let measured = |b: usize| {
        vehicle
            .wheels
            .iter()
            .zip(&motion.forces)
            .all(|(w, f)| w.at.body != b || f.is_some())
    };
    let mut out = Vec::new();
    for (b, body) in vehicle
        .bodies
        .iter()
        .enumerate()
        .filter(|(b, _)| measured(*b) && !vehicle.is_witness(*b))
    {
        for (j, letter) in body.shape.letters().iter().enumerate() {
            let mut e = body_equation(vehicle, motion, b, j);
            e.name = format!(
                "body {}{}{letter}",
                body.name,
                if j > 0 { " about " } else { "" }
            );
            out.push(e);
        }
    }
    let grounded = vehicle
        .links
        .iter()
        .any(|l| l.ends.iter().map(|e| e.0).sum::<f64>().abs() > 1e-9);
    if vehicle.bodies.len() > 1
        && !grounded
        && !vehicle.wheels.is_empty()
        && motion.forces.iter().all(Option::is_some)
    {
        let letters = vehicle
            .bodies
            .iter()
            .filter(|b| b.sprung)
            .map(|b| b.shape.letters())
            .max_by_key(|l| l.len())
            .unwrap_or(&[""]);
        let whole = letters
            .iter()
            .filter(|letter| links_cancel(vehicle, letter));
        out.extend(whole.map(|letter| total_equation(vehicle, motion, letter)));
    }
    out.retain(|e| !e.columns.is_empty());
    out
}

/// Whether link forces cancel in the total of a motion. They do not cancel if a spring bears on the frame ahead of its axle, or if a link goes to a
/// witness.
fn links_cancel(vehicle: &Vehicle, letter: &str) -> bool {
    vehicle.links.iter().all(|link| {
        if link.ends.iter().any(|(_, p)| vehicle.is_witness(p.body)) {
            return false;
        }
        let arm = |p: &Point| {
            let own = vehicle.bodies[p.body].shape.letters().contains(&letter);
            match (letter, own) {
                ("", _) => 1.0,
                ("x", true) => p.x,
                ("x", false) => vehicle.bodies[p.body].x,
                (_, true) => p.y,
                (_, false) => vehicle.bodies[p.body].y,
            }
        };
        let (sum, size) = link.ends.iter().fold((0.0, 0.0f64), |(s, m), (w, p)| {
            (s + w * arm(p), m.max((w * arm(p)).abs()))
        });
        sum.abs() <= 1e-9 * size.max(1.0)
    })
}

/// The equation of motion j of body b.
fn body_equation(vehicle: &Vehicle, motion: &Motion, b: usize, j: usize) -> Equation {
    let mut columns: Vec<(usize, Vec<f64>)> = Vec::new();
    for (i, q) in motion.bodies[b].iter().enumerate() {
        columns.push((vehicle.inertia_index(b, i, j), q.clone()));
    }
    for (l, link) in vehicle.links.iter().enumerate() {
        let weight: f64 = link
            .ends
            .iter()
            .filter(|e| e.1.body == b)
            .map(|(w, p)| w * vehicle.functions(p)[j])
            .sum();
        if weight != 0.0 {
            for (t, column) in motion.terms[l].iter().enumerate() {
                columns.push((
                    vehicle.term_index(l, t),
                    column.iter().map(|v| weight * v).collect(),
                ));
            }
        }
    }
    for (i, step) in vehicle.steps.iter().enumerate() {
        if step.body == b && j == 0 {
            columns.push((vehicle.step_index(i), motion.steps[i].clone()));
        }
    }
    let mut target = vec![0.0; motion.n_samples()];
    let mut driven = false;
    for (wheel, force) in vehicle.wheels.iter().zip(&motion.forces) {
        if let (true, Some(force)) = (wheel.at.body == b, force) {
            let phi = vehicle.functions(&wheel.at)[j];
            driven |= phi != 0.0;
            target
                .iter_mut()
                .zip(force)
                .for_each(|(t, f)| *t += phi * f);
        }
    }
    columns.sort_by_key(|c| c.0);
    Equation {
        name: String::new(),
        columns,
        target,
        driven,
    }
}

/// The sum over all bodies of their share in a motion ("" heave, "x" pitch, "y" roll) of the vehicle.
fn total_equation(vehicle: &Vehicle, motion: &Motion, letter: &str) -> Equation {
    let n = motion.n_samples();
    let mut total = Equation {
        name: "total".into(),
        columns: vec![],
        target: vec![0.0; n],
        driven: true,
    };
    if !letter.is_empty() {
        total.name.push_str(" about ");
        total.name.push_str(letter);
    }
    let bodies = vehicle.bodies.iter().enumerate();
    for (b, body) in bodies.filter(|(b, _)| !vehicle.is_witness(*b)) {
        let own = body.shape.letters().iter().position(|l| *l == letter);
        let (j, factor) = match (own, letter) {
            (Some(j), _) => (j, 1.0),
            (None, "x") => (0, body.x),
            (None, _) => (0, body.y),
        };
        let e = body_equation(vehicle, motion, b, j);
        total
            .target
            .iter_mut()
            .zip(&e.target)
            .for_each(|(t, v)| *t += factor * v);
        let (inertias, steps) = (vehicle.term_index(0, 0), vehicle.step_index(0));
        for (p, column) in e
            .columns
            .into_iter()
            .filter(|c| (c.0 < inertias || c.0 >= steps) && factor != 0.0)
        {
            let scaled = column.iter().map(|v| factor * v);
            match total.columns.iter_mut().find(|c| c.0 == p) {
                Some(c) => c.1.iter_mut().zip(scaled).for_each(|(a, v)| *a += v),
                None => total.columns.push((p, scaled.collect())),
            }
        }
    }
    total.columns.sort_by_key(|c| c.0);
    total
}
