//! The vehicles that a job can name.

use super::layout::{Body, Link, Measures, Point, Sensor, Shape, Vehicle, Wheel};
use super::term::Term;
use std::collections::BTreeMap;
use std::fmt;

/// Names of the models.
pub const MODELS: [&str; 8] = [
    "front2",
    "rear3",
    "front_pair",
    "half",
    "full2",
    "full3",
    "rig",
    "oscillator",
];

/// Errors in the request for a vehicle.
#[derive(Clone, Debug, PartialEq)]
pub enum PresetError {
    /// An unknown model.
    Model {
        /// Name in the request.
        name: String,
    },
    /// A term that is unknown or fits no link.
    Term {
        /// Text in the request.
        term: String,
        /// The model.
        model: String,
        /// Valid names.
        examples: Vec<String>,
    },
    /// A missing place that the model needs.
    Place {
        /// The model.
        model: String,
        /// The place.
        place: String,
    },
}

impl PresetError {
    /// Returns the message and the remedy.
    pub fn parts(&self) -> (String, String) {
        match self {
            Self::Model { name } => (
                format!("no vehicle model `{name}`"),
                format!("use one of {}", MODELS.join(", ")),
            ),
            Self::Term {
                term,
                model,
                examples,
            } => (
                format!("term `{term}` is not a term of model `{model}`"),
                format!(
                    "write a coefficient such as {}, or an effect such as `cubic_stiffness`",
                    examples.join(", ")
                ),
            ),
            Self::Place { model, place } => (
                format!("model `{model}` needs the place of `{place}`"),
                format!("add `places = {{ {place} = [x, y] }}` to [vehicle]"),
            ),
        }
    }
}

impl fmt::Display for PresetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (wrong, remedy) = self.parts();
        write!(f, "{wrong}: {remedy}")
    }
}

impl std::error::Error for PresetError {}

/// Description of the vehicle in a job.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PresetRequest {
    /// Name of the model.
    pub model: String,
    /// Terms of the links. If the list is empty, every link has a spring and a damper.
    pub terms: Vec<String>,
    /// Places (x, y): of wheels by their corner (`lf`, `front`), of springs (`spring_lf`; else at the wheel), of body
    /// accelerometers (`body_lf`; else at the spring).
    pub places: BTreeMap<String, [f64; 2]>,
    /// Channel names that differ in the file: `a_body` to the name in the file.
    pub channels: BTreeMap<String, String>,
}

/// Returns the vehicle of a request, with its bodies, sensors, wheels and links.
///
/// - `front2`: a_body, a_wheel, f_wheel (thesis 5.1, 5.2); `front_pair`: also `_other`
/// - `rear3`: a_body, a_mid, a_rear, f_mid, f_rear (thesis 5.3 to 5.5)
/// - these with a term on `pitch`: also a_body_next, the body over the next axle
/// - `half`: a_body_front, a_body_rear, a_front, a_rear, f_front, f_rear (pitch)
/// - `full2`, `full3`: a_body_lf .. a_body_rr (three at least), a_lf .., f_lf .. with beam axles (heave, pitch, roll)
/// - `rig`: a_1, a_2, f_1, spring 1 between the masses, spring 2 from mass 2 to ground (thesis 4.1)
/// - `oscillator`: y (displacement), u (force), one mass on a spring to ground
///
/// # Errors
/// [`PresetError`] when the model, a term or a needed place is unknown.
///
/// # Example
/// ```
/// use strainbridge::vehicle::preset::{PresetRequest, vehicle};
///
/// let quarter = PresetRequest { model: "front2".to_owned(), ..PresetRequest::default() };
/// let truck = vehicle(&quarter)?;
/// let names: Vec<String> = truck.parameters().into_iter().map(|p| p.name).collect();
/// // Body, wheel, and a spring and a damper between them.
/// assert_eq!(names, ["m_b", "m_f", "k_s", "c_s"]);
/// // The weights of a link's ends add up to 0: a rigid motion does not stretch it.
/// assert_eq!(truck.links[0].ends.iter().map(|end| end.0).sum::<f64>(), 0.0);
///
/// let unknown = PresetRequest { model: "front5".to_owned(), ..PresetRequest::default() };
/// assert!(vehicle(&unknown).is_err());
/// # Ok::<(), strainbridge::vehicle::preset::PresetError>(())
/// ```
pub fn vehicle(request: &PresetRequest) -> Result<Vehicle, PresetError> {
    let mut v = match request.model.as_str() {
        "front2" => quarter("front2", &["wheel"], &["f"], &["s"]),
        "rear3" => quarter("rear3", &["mid", "rear"], &["m", "r"], &["sm", "sr"]),
        "front_pair" => {
            let mut one = quarter("front_pair", &["wheel"], &["f"], &["s"]);
            join(
                &mut one,
                other_side(quarter("front_pair", &["wheel"], &["f"], &["s"])),
            );
            one
        }
        "half" => half(request),
        "full2" => full_vehicle(request, &["f", "r"])?,
        "full3" => full_vehicle(request, &["f", "m", "r"])?,
        "rig" => rig(),
        "oscillator" => oscillator(),
        other => {
            return Err(PresetError::Model {
                name: other.to_owned(),
            });
        }
    };
    add_terms(&mut v, &request.terms)?;
    let rename = |name: &mut String| {
        if let Some(n) = request.channels.get(name.as_str()) {
            *name = n.clone();
        }
    };
    v.sensors.iter_mut().for_each(|s| rename(&mut s.channel));
    v.wheels.iter_mut().for_each(|w| rename(&mut w.channel));
    Ok(v)
}

fn body(name: &str, shape: Shape, x: f64, y: f64, sprung: bool) -> Body {
    Body {
        name: name.into(),
        shape,
        x,
        y,
        sprung,
    }
}

fn point(body: usize, [x, y]: [f64; 2]) -> Point {
    Point { body, x, y }
}

fn accelerometer(channel: String, at: Point) -> Sensor {
    Sensor {
        channel,
        at,
        measures: Measures::Acceleration,
    }
}

/// A body that heaves over one or more wheels.
fn quarter(name: &str, corners: &[&str], wheels: &[&str], links: &[&str]) -> Vehicle {
    let origin = [0.0, 0.0];
    let mut v = Vehicle {
        name: name.into(),
        bodies: vec![body("b", Shape::Heave, 0.0, 0.0, true)],
        sensors: vec![accelerometer("a_body".into(), point(0, origin))],
        wheels: vec![],
        links: vec![],
        steps: vec![],
    };
    for (i, corner) in corners.iter().enumerate() {
        let p = point(i + 1, origin);
        v.bodies
            .push(body(wheels[i], Shape::Heave, 0.0, 0.0, false));
        v.sensors.push(accelerometer(format!("a_{corner}"), p));
        v.wheels.push(Wheel {
            channel: format!("f_{corner}"),
            at: p,
        });
        v.links.push(Link {
            name: links[i].into(),
            ends: vec![(1.0, point(0, origin)), (-1.0, p)],
            terms: vec![],
        });
    }
    v
}

fn other_side(mut v: Vehicle) -> Vehicle {
    v.bodies.iter_mut().for_each(|b| b.name.push_str("_other"));
    v.sensors
        .iter_mut()
        .for_each(|s| s.channel.push_str("_other"));
    v.wheels
        .iter_mut()
        .for_each(|w| w.channel.push_str("_other"));
    v.links.iter_mut().for_each(|l| l.name.push_str("_other"));
    v
}

fn join(v: &mut Vehicle, mut other: Vehicle) {
    let shift = v.bodies.len();
    other.sensors.iter_mut().for_each(|s| s.at.body += shift);
    other.wheels.iter_mut().for_each(|w| w.at.body += shift);
    other
        .links
        .iter_mut()
        .for_each(|l| l.ends.iter_mut().for_each(|e| e.1.body += shift));
    v.bodies.extend(other.bodies);
    v.sensors.extend(other.sensors);
    v.wheels.extend(other.wheels);
    v.links.extend(other.links);
}

/// Heave and pitch over two axles; without places the wheelbase is the unit of length along x.
fn half(request: &PresetRequest) -> Vehicle {
    let mut v = Vehicle {
        name: "half".into(),
        bodies: vec![body("b", Shape::HeavePitch, 0.0, 0.0, true)],
        sensors: vec![],
        wheels: vec![],
        links: vec![],
        steps: vec![],
    };
    for (i, (corner, letter, x)) in [("front", "f", 0.0), ("rear", "r", -1.0)]
        .into_iter()
        .enumerate()
    {
        let wheel = request.places.get(corner).copied().unwrap_or([x, 0.0]);
        let spring = request
            .places
            .get(&format!("spring_{corner}"))
            .copied()
            .unwrap_or(wheel);
        let sensor = request
            .places
            .get(&format!("body_{corner}"))
            .copied()
            .unwrap_or(spring);
        v.bodies
            .push(body(letter, Shape::Heave, spring[0], 0.0, false));
        v.sensors
            .push(accelerometer(format!("a_body_{corner}"), point(0, sensor)));
        v.sensors
            .push(accelerometer(format!("a_{corner}"), point(i + 1, wheel)));
        v.wheels.push(Wheel {
            channel: format!("f_{corner}"),
            at: point(i + 1, wheel),
        });
        v.links.push(Link {
            name: format!("s{letter}"),
            ends: vec![(1.0, point(0, spring)), (-1.0, point(i + 1, spring))],
            terms: vec![],
        });
    }
    v
}

/// Heave, pitch and roll over beam axles.
fn full_vehicle(request: &PresetRequest, axles: &[&str]) -> Result<Vehicle, PresetError> {
    let mut v = Vehicle {
        name: request.model.clone(),
        bodies: vec![body("b", Shape::HeavePitchRoll, 0.0, 0.0, true)],
        sensors: vec![],
        wheels: vec![],
        links: vec![],
        steps: vec![],
    };
    for (i, axle) in axles.iter().enumerate() {
        let place = |side: &str| {
            let corner = format!("{side}{axle}");
            request
                .places
                .get(&corner)
                .copied()
                .ok_or_else(|| PresetError::Place {
                    model: request.model.clone(),
                    place: corner.clone(),
                })
        };
        let (left, right) = (place("l")?, place("r")?);
        v.bodies.push(body(
            axle,
            Shape::HeaveRoll,
            (left[0] + right[0]) / 2.0,
            0.0,
            false,
        ));
        for (side, wheel) in [("l", left), ("r", right)] {
            let corner = format!("{side}{axle}");
            let spring = request
                .places
                .get(&format!("spring_{corner}"))
                .copied()
                .unwrap_or(wheel);
            let sensor = request
                .places
                .get(&format!("body_{corner}"))
                .copied()
                .unwrap_or(spring);
            v.sensors
                .push(accelerometer(format!("a_body_{corner}"), point(0, sensor)));
            v.sensors
                .push(accelerometer(format!("a_{corner}"), point(i + 1, wheel)));
            v.wheels.push(Wheel {
                channel: format!("f_{corner}"),
                at: point(i + 1, wheel),
            });
            v.links.push(Link {
                name: format!("s{corner}"),
                ends: vec![(1.0, point(0, spring)), (-1.0, point(i + 1, spring))],
                terms: vec![],
            });
        }
    }
    Ok(v)
}

fn rig() -> Vehicle {
    let (one, two) = (point(0, [0.0, 0.0]), point(1, [0.0, 0.0]));
    Vehicle {
        name: "rig".into(),
        bodies: vec![
            body("1", Shape::Heave, 0.0, 0.0, false),
            body("2", Shape::Heave, 0.0, 0.0, true),
        ],
        sensors: vec![
            accelerometer("a_1".into(), one),
            accelerometer("a_2".into(), two),
        ],
        wheels: vec![Wheel {
            channel: "f_1".into(),
            at: one,
        }],
        links: vec![
            Link {
                name: "1".into(),
                ends: vec![(1.0, one), (-1.0, two)],
                terms: vec![],
            },
            Link {
                name: "2".into(),
                ends: vec![(1.0, two)],
                terms: vec![],
            },
        ],
        steps: vec![],
    }
}

fn oscillator() -> Vehicle {
    let p = point(0, [0.0, 0.0]);
    Vehicle {
        name: "oscillator".into(),
        bodies: vec![body("b", Shape::Heave, 0.0, 0.0, true)],
        sensors: vec![Sensor {
            channel: "y".into(),
            at: p,
            measures: Measures::Displacement,
        }],
        wheels: vec![Wheel {
            channel: "u".into(),
            at: p,
        }],
        links: vec![Link {
            name: "s".into(),
            ends: vec![(1.0, p)],
            terms: vec![],
        }],
        steps: vec![],
    }
}

/// Links between bodies that the plain model does not couple. A term that names a link (`k_axle`) adds the link.
pub const COUPLINGS: [&str; 5] = ["axle", "roll", "bar", "cross", "pitch"];

/// Channel of the body over the next axle.
pub const NEXT: &str = "a_body_next";

/// Adds the body over the next axle as a witness, if the model is of one axle or bogie. `channel` is its accelerometer.
pub fn add_next(v: &mut Vehicle, channel: &str) {
    let of_one = matches!(v.name.as_str(), "front2" | "front_pair" | "rear3");
    if of_one && v.bodies.iter().all(|b| b.shape != Shape::Witness) {
        let at = point(v.bodies.len(), [0.0, 0.0]);
        v.bodies.push(body("next", Shape::Witness, 0.0, 0.0, false));
        v.sensors.push(accelerometer(channel.to_owned(), at));
    }
}

/// Returns a coupling link without terms, or `None` if the model has no link of this name.
///
/// In `front_pair`, `axle` joins the wheels, `roll` the bodies, and `cross` this side's body to the other wheel. `bar` resists unequal stretch of
/// both sides. In `rear3`, `axle` joins mid and rear wheel, and `bar` adds their stretches. `pitch` joins the bodies ([`add_next`]).
///
/// For `pitch`, consider a frame of mass M and pitch inertia J. Its centre of gravity is at distance a behind this axle and b ahead of the next. The
/// inertance between the bodies is b_pitch = (J - M a b) / (a + b)^2, and m_b is the static share, M b / (a + b).
pub fn coupling(v: &Vehicle, name: &str) -> Option<Link> {
    let next = v.bodies.iter().position(|b| b.shape == Shape::Witness);
    let to_next = next.map(|n| [(1.0, 0), (-1.0, n)]);
    let ends: &[(f64, usize)] = match (v.name.as_str(), name) {
        (_, "pitch") => to_next.as_ref()?,
        ("front_pair", "axle") => &[(1.0, 1), (-1.0, 3)],
        ("front_pair", "roll") => &[(1.0, 0), (-1.0, 2)],
        ("front_pair", "bar") => &[(1.0, 0), (-1.0, 1), (-1.0, 2), (1.0, 3)],
        ("front_pair", "cross") => &[(1.0, 0), (-1.0, 3)],
        ("rear3", "axle") => &[(1.0, 1), (-1.0, 2)],
        ("rear3", "bar") => &[(2.0, 0), (-1.0, 1), (-1.0, 2)],
        _ => return None,
    };
    Some(Link {
        name: name.to_owned(),
        ends: ends
            .iter()
            .map(|&(w, b)| (w, point(b, [0.0, 0.0])))
            .collect(),
        terms: vec![],
    })
}

/// Adds terms to the links they name: `k_s` to links `s*`, `cubic_stiffness` to all, `cubic_stiffness:s` to one.
fn add_terms(v: &mut Vehicle, terms: &[String]) -> Result<(), PresetError> {
    if terms.is_empty() {
        v.links
            .iter_mut()
            .for_each(|l| l.terms = vec![Term::Stiffness, Term::Damping]);
        return Ok(());
    }
    let examples: Vec<String> = v
        .links
        .iter()
        .flat_map(|l| [format!("k_{}", l.name), format!("c_{}", l.name)])
        .take(6)
        .collect();
    for text in terms {
        let (kind, place) = if let Some(t) = Term::from_name(text) {
            (Some(t), "")
        } else {
            text.split_once(':')
                .or_else(|| text.split_once('_'))
                .map_or((None, ""), |(k, p)| (Term::from_name(k), p))
        };
        let exact = v.links.iter().any(|l| l.name == place);
        let mut met = false;
        if let Some(kind) = kind {
            for link in &mut v.links {
                let coupling = COUPLINGS.contains(&link.name.as_str());
                let here = if coupling {
                    link.name == place
                } else if exact {
                    link.name == place || link.name == format!("{place}_other")
                } else {
                    link.name.starts_with(place)
                };
                if here {
                    met = true;
                    if !link.terms.contains(&kind) {
                        link.terms.push(kind);
                    }
                }
            }
        }
        if !met && kind.is_some() && place == "pitch" {
            add_next(v, NEXT);
        }
        if let (false, Some(term), Some(mut link)) = (met, kind, coupling(v, place)) {
            link.terms.push(term);
            v.links.push(link);
            met = true;
        }
        if !met {
            return Err(PresetError::Term {
                term: text.clone(),
                model: v.name.clone(),
                examples,
            });
        }
    }
    Ok(())
}
