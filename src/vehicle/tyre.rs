//! Tyres: springs and dampers between wheels and a road of known height.

use super::layout::{Body, Link, Measures, Point, Sensor, Shape, Vehicle};
use super::term::Term;
use std::collections::BTreeMap;

/// Tyre of a wheel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tyre {
    /// Index of the wheel.
    pub wheel: usize,
    /// Index of the tyre's link.
    pub link: usize,
    /// Channel of the road height under the wheel.
    pub channel: String,
}

/// Adds a tyre to each wheel: a link with stiffness and damping to a road body whose height a channel gives.
///
/// The channel of wheel `f_front` is `z_front`; `names` renames it. The tyre of spring `sf` is the link `tf`, with the parameters `k_tf` and `c_tf`.
/// Returns an empty list and changes nothing if the wheels of the model are not under springs (`rig`, `oscillator`).
///
/// # Example
/// ```
/// use std::collections::BTreeMap;
/// use strainbridge::vehicle::preset::{PresetRequest, vehicle};
/// use strainbridge::vehicle::tyre::add_tyres;
///
/// let mut truck = vehicle(&PresetRequest { model: "front2".to_owned(), ..PresetRequest::default() })?;
/// let tyres = add_tyres(&mut truck, &BTreeMap::new());
/// assert_eq!(tyres[0].channel, "z_wheel");
/// let names: Vec<String> = truck.parameters().into_iter().map(|p| p.name).collect();
/// assert_eq!(names, ["m_b", "m_f", "k_s", "c_s", "k_t", "c_t"]);
/// # Ok::<(), strainbridge::vehicle::preset::PresetError>(())
/// ```
pub fn add_tyres(vehicle: &mut Vehicle, names: &BTreeMap<String, String>) -> Vec<Tyre> {
    let mut plan = Vec::new();
    for (w, wheel) in vehicle.wheels.iter().enumerate() {
        let reaches = |l: &&Link| {
            let of_wheel = |e: &&(f64, Point)| e.1.body == wheel.at.body && e.0 < 0.0;
            l.name.starts_with('s') && l.ends.iter().any(|e| of_wheel(&e))
        };
        let springs = vehicle.links.iter().filter(reaches);
        let nearest = springs.min_by(|a, b| {
            let distance = |l: &Link| {
                let end = l.ends.iter().find(|e| e.1.body == wheel.at.body);
                end.map_or(f64::INFINITY, |e| {
                    (e.1.x - wheel.at.x).hypot(e.1.y - wheel.at.y)
                })
            };
            distance(a).total_cmp(&distance(b))
        });
        let Some(spring) = nearest else {
            return Vec::new();
        };
        plan.push((w, format!("t{}", &spring.name[1..])));
    }
    let road_of = |force: &str, tyre: &str| {
        let named = names.iter().find(|(_, file)| *file == force);
        let plain = named.map_or(force, |(model, _)| model.as_str());
        let corner = plain.strip_prefix("f_").unwrap_or(tyre);
        let channel = format!("z_{corner}");
        names.get(&channel).cloned().unwrap_or(channel)
    };
    let mut out = Vec::new();
    for (w, name) in plan {
        let wheel = vehicle.wheels[w].clone();
        let channel = road_of(&wheel.channel, &name);
        let road = Point {
            body: vehicle.bodies.len(),
            x: 0.0,
            y: 0.0,
        };
        vehicle.bodies.push(Body {
            name: format!("road_{name}"),
            shape: Shape::Witness,
            x: 0.0,
            y: 0.0,
            sprung: false,
        });
        vehicle.sensors.push(Sensor {
            channel: channel.clone(),
            at: road,
            measures: Measures::Displacement,
        });
        out.push(Tyre {
            wheel: w,
            link: vehicle.links.len(),
            channel,
        });
        vehicle.links.push(Link {
            name,
            ends: vec![(1.0, wheel.at), (-1.0, road)],
            terms: vec![Term::Stiffness, Term::Damping],
        });
    }
    out
}
