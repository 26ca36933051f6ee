//! A vehicle seen from the side of mechanics: rigid bodies that heave, pitch and roll, and what joins them.

use super::term::{Quantity, Term, share_done};

/// Small rigid motions of a body. The vertical displacement at (x, y) is q0 + x q_pitch + y q_roll.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// Up and down.
    Heave,
    /// And slope along x.
    HeavePitch,
    /// And slope along y.
    HeaveRoll,
    /// All three.
    HeavePitchRoll,
    /// Up and down as measured: a body beyond the model that a link of it reaches. It has no inertia and no equation.
    Witness,
}

impl Shape {
    /// Returns the functions 1, x, y that apply, at a place.
    pub fn functions(self, x: f64, y: f64) -> Vec<f64> {
        match self {
            Self::Heave | Self::Witness => vec![1.0],
            Self::HeavePitch => vec![1.0, x],
            Self::HeaveRoll => vec![1.0, y],
            Self::HeavePitchRoll => vec![1.0, x, y],
        }
    }

    /// Returns the letters of the functions of the shape: "", "x", "y".
    pub fn letters(self) -> &'static [&'static str] {
        match self {
            Self::Heave | Self::Witness => &[""],
            Self::HeavePitch => &["", "x"],
            Self::HeaveRoll => &["", "y"],
            Self::HeavePitchRoll => &["", "x", "y"],
        }
    }

    /// Returns the number of motions.
    pub fn n(self) -> usize {
        self.letters().len()
    }

    /// Returns the number of inertia parameters: the upper triangle of its inertia.
    pub fn n_inertias(self) -> usize {
        match self {
            Self::Witness => 0,
            _ => self.n() * (self.n() + 1) / 2,
        }
    }
}

/// A rigid body. Its inertia is the integral of phi phi' dm over the functions phi of its shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Suffix of the parameters, such as `b` in `m_b`.
    pub name: String,
    /// Motions of the body.
    pub shape: Shape,
    /// Coordinate x of a body without pitch (an axle), along the vehicle.
    pub x: f64,
    /// Coordinate y of a body without roll, across the vehicle.
    pub y: f64,
    /// Whether springs carry the body.
    pub sprung: bool,
}

/// A point on a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Index of the body.
    pub body: usize,
    /// Coordinate along the vehicle.
    pub x: f64,
    /// Coordinate across the vehicle.
    pub y: f64,
}

/// Quantity that a sensor measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measures {
    /// Vertical acceleration.
    Acceleration,
    /// Vertical displacement.
    Displacement,
}

/// A sensor on a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensor {
    /// Channel name.
    pub channel: String,
    /// Position.
    pub at: Point,
    /// Measured quantity.
    pub measures: Measures,
}

/// A vertical force from outside: the road on a wheel, a shaker.
#[derive(Clone, Debug, PartialEq)]
pub struct Wheel {
    /// Channel name of the wheel force, whether measured or not.
    pub channel: String,
    /// Position.
    pub at: Point,
}

/// A spring and damper. Its stretch d is the sum of weight times displacement over its ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// Suffix of the parameters, such as `s` in `k_s`.
    pub name: String,
    /// Ends with weights: +1 body, -1 wheel.
    pub ends: Vec<(f64, Point)>,
    /// Terms of the force. The force on each end is minus weight times the sum of the terms.
    pub terms: Vec<Term>,
}

/// Bodies, sensors, wheels and links.
#[derive(Clone, Debug, PartialEq)]
pub struct Vehicle {
    /// Name of the model, such as `front2`.
    pub name: String,
    /// Bodies.
    pub bodies: Vec<Body>,
    /// Sensors.
    pub sensors: Vec<Sensor>,
    /// Wheels.
    pub wheels: Vec<Wheel>,
    /// Links.
    pub links: Vec<Link>,
    /// Masses that change during a record.
    pub steps: Vec<MassStep>,
}

/// A mass that joins (or, negative, leaves) a body during a record, at the body's origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassStep {
    /// Body.
    pub body: usize,
    /// Begin of the change, s of the record's time.
    pub at_s: f64,
    /// Duration of the change, s.
    pub over_s: f64,
    /// Acceleration of gravity with which the change enters the balance. It is 0 if the change only adds inertia.
    pub gravity: f64,
}

impl MassStep {
    /// Returns the share of the change that has occurred at a time.
    pub fn share_at(&self, t_s: f64) -> f64 {
        share_done(self.at_s, self.over_s, t_s)
    }
}

/// A parameter of a vehicle.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name, such as `m_b` or `k_s`.
    pub name: String,
    /// Quantity, which gives the unit.
    pub quantity: Quantity,
    /// Whether negative values are physically impossible.
    pub positive: bool,
}

impl Vehicle {
    /// Returns all parameters: inertias body by body (upper triangle by rows), then coefficients link by link, then mass changes.
    pub fn parameters(&self) -> Vec<Parameter> {
        let mut out = Vec::new();
        for body in self.bodies.iter().filter(|b| b.shape != Shape::Witness) {
            let letters = body.shape.letters();
            for i in 0..letters.len() {
                for j in i..letters.len() {
                    let quantity = match (i, j) {
                        (0, 0) => Quantity::Mass,
                        (0, _) => Quantity::FirstMoment,
                        _ => Quantity::Inertia,
                    };
                    let name = format!("m{}{}_{}", letters[i], letters[j], body.name);
                    out.push(Parameter {
                        name,
                        quantity,
                        positive: i == j,
                    });
                }
            }
        }
        for link in &self.links {
            for term in &link.terms {
                out.push(Parameter {
                    name: format!("{}_{}", term.symbol(), link.name),
                    quantity: term.quantity(),
                    positive: term.is_positive(),
                });
            }
        }
        for step in &self.steps {
            let body = self.bodies.get(step.body).map_or("", |b| b.name.as_str());
            out.push(Parameter {
                name: format!("dm_{body}"),
                quantity: Quantity::Mass,
                positive: false,
            });
        }
        out
    }

    /// Returns whether a mass or spring changes during a record.
    pub fn changes(&self) -> bool {
        let mut terms = self.links.iter().flat_map(|l| &l.terms);
        !self.steps.is_empty() || terms.any(Term::is_of_time)
    }

    /// Sets every change of a mass or spring to a single time: `f64::MIN` for a completed change, `f64::MAX` for a change that has not begun.
    pub fn settle_changes(&mut self, time_s: f64) {
        for s in &mut self.steps {
            (s.at_s, s.over_s) = (time_s, 0.0);
        }
        for t in self.links.iter_mut().flat_map(|l| &mut l.terms) {
            if let Term::StiffnessChange { at_s, over_s } = t {
                (*at_s, *over_s) = (time_s, 0.0);
            }
        }
    }

    /// Returns whether a body is only a witness.
    pub fn is_witness(&self, body: usize) -> bool {
        let b = self.bodies.get(body);
        b.is_some_and(|b| b.shape == Shape::Witness)
    }

    /// Returns the indices of the masses of bodies, witnesses left out.
    pub fn masses(&self, bodies: &[usize]) -> Vec<usize> {
        let own = bodies.iter().filter(|&&b| !self.is_witness(b));
        own.map(|&b| self.inertia_index(b, 0, 0)).collect()
    }

    /// Returns whether wheels alone carry the weight of a connected part, and this weight is constant. No link of the part may reach the ground, and
    /// no mass may join or leave it. A link reaches the ground if its weights do not sum to 0: it then depends on the heave of the whole.
    pub fn rests_on_wheels(&self, bodies: &[usize]) -> bool {
        let own = |l: &&Link| l.ends.iter().any(|e| bodies.contains(&e.1.body));
        let heave = |l: &Link| l.ends.iter().map(|e| e.0).sum::<f64>();
        // Weights are small whole numbers, so their sum is exact.
        let grounded = self.links.iter().filter(own).any(|l| heave(l) != 0.0);
        !grounded && self.steps.iter().all(|s| !bodies.contains(&s.body))
    }

    /// Returns the index of the parameter M(i, j) of a body that is not a witness.
    pub fn inertia_index(&self, body: usize, i: usize, j: usize) -> usize {
        let before: usize = self
            .bodies
            .iter()
            .take(body)
            .map(|b| b.shape.n_inertias())
            .sum();
        let (i, j) = (i.min(j), i.max(j));
        let n = self.bodies.get(body).map_or(1, |b| b.shape.n());
        before + i * n - i * (i + 1) / 2 + i + (j - i)
    }

    /// Returns the index of the parameter of a term of a link.
    pub fn term_index(&self, link: usize, term: usize) -> usize {
        let inertias: usize = self.bodies.iter().map(|b| b.shape.n_inertias()).sum();
        inertias
            + self
                .links
                .iter()
                .take(link)
                .map(|l| l.terms.len())
                .sum::<usize>()
            + term
    }

    /// Returns the index of the parameter of a mass change.
    pub fn step_index(&self, step: usize) -> usize {
        self.term_index(self.links.len(), 0) + step
    }

    /// Returns the functions of a point's body at the point.
    pub fn functions(&self, p: &Point) -> Vec<f64> {
        self.bodies
            .get(p.body)
            .map_or(vec![], |b| b.shape.functions(p.x, p.y))
    }

    /// Returns the bodies in groups that links join. Each group is ascending. The groups are in the order of their first body.
    pub fn components(&self) -> Vec<Vec<usize>> {
        let mut group: Vec<usize> = (0..self.bodies.len()).collect();
        for link in &self.links {
            let members: Vec<usize> = link.ends.iter().map(|(_, p)| group[p.body]).collect();
            if let Some(&low) = members.iter().min() {
                group
                    .iter_mut()
                    .filter(|g| members.contains(g))
                    .for_each(|g| *g = low);
            }
        }
        let mut heads: Vec<usize> = group.clone();
        heads.sort_unstable();
        heads.dedup();
        heads
            .iter()
            .map(|h| (0..group.len()).filter(|&i| group[i] == *h).collect())
            .collect()
    }

    /// Returns the part of the vehicle made of the given bodies.
    pub fn part(&self, bodies: &[usize]) -> Self {
        let to = |p: &Point| {
            bodies
                .iter()
                .position(|b| *b == p.body)
                .map(|body| Point { body, ..*p })
        };
        Self {
            name: self.name.clone(),
            bodies: bodies
                .iter()
                .filter_map(|&b| self.bodies.get(b).cloned())
                .collect(),
            sensors: self
                .sensors
                .iter()
                .filter_map(|s| {
                    Some(Sensor {
                        at: to(&s.at)?,
                        ..s.clone()
                    })
                })
                .collect(),
            wheels: self
                .wheels
                .iter()
                .filter_map(|w| {
                    Some(Wheel {
                        at: to(&w.at)?,
                        ..w.clone()
                    })
                })
                .collect(),
            links: self
                .links
                .iter()
                .filter_map(|l| {
                    let ends: Option<Vec<(f64, Point)>> =
                        l.ends.iter().map(|(w, p)| Some((*w, to(p)?))).collect();
                    Some(Link {
                        ends: ends?,
                        ..l.clone()
                    })
                })
                .collect(),
            steps: self
                .steps
                .iter()
                .filter_map(|s| {
                    let body = bodies.iter().position(|b| *b == s.body)?;
                    Some(MassStep { body, ..*s })
                })
                .collect(),
        }
    }
}
