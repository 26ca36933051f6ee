//! Places of effects: links of the vehicle, and couplings that it lacks.

use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::frame::MotionFrame;
use crate::series::detrend::rms;
use crate::vehicle::layout::Link;
use crate::vehicle::motion::Motion;
use crate::vehicle::preset::coupling;
use crate::vehicle::term::Term;

/// Returns coupling links, by name, that the vehicle lacks: each as inertia, as spring, and as spring with damper.
pub(super) fn coupling_forms(frame: &MotionFrame, names: &[&str]) -> Vec<Change> {
    let mut out = Vec::new();
    let has = |name: &str| frame.vehicle.links.iter().any(|l| l.name == name);
    for name in names.iter().filter(|n| !has(n)) {
        let Some(link) = coupling(&frame.vehicle, name) else {
            continue;
        };
        let with = |terms: Vec<Term>| {
            Change::Links(vec![Link {
                terms,
                ..link.clone()
            }])
        };
        if !matches!(*name, "bar" | "cross") {
            out.push(with(vec![Term::Inertance]));
        }
        out.push(with(vec![Term::Stiffness]));
        out.push(with(vec![Term::Stiffness, Term::Damping]));
    }
    out
}

/// Returns the links between compared bodies, each with the name of its place; `None` as name if there is only one link.
pub(super) fn links(frame: &MotionFrame) -> Vec<(usize, Option<String>)> {
    let v = &frame.vehicle;
    let own: Vec<usize> = (0..v.links.len())
        .filter(|&l| {
            v.links[l]
                .ends
                .iter()
                .all(|e| frame.bodies.contains(&e.1.body))
        })
        .collect();
    let word = |l: usize| {
        let wheel = v
            .wheels
            .iter()
            .find(|w| v.links[l].ends.iter().any(|e| e.1.body == w.at.body));
        let one = wheel.filter(|w| v.wheels.iter().filter(|o| o.at.body == w.at.body).count() == 1);
        one.and_then(|w| w.channel.split_once('_').map(|p| p.1.to_owned()))
            .unwrap_or_else(|| v.links[l].name.clone())
    };
    own.iter()
        .map(|&l| (l, (own.len() > 1).then(|| word(l))))
        .collect()
}

/// Returns the largest stretch and rms rate of a link.
pub(super) fn extent(motion: &Motion, link: usize) -> (f64, f64) {
    let largest = motion
        .stretch
        .get(link)
        .map_or(0.0, |d| d.iter().fold(0.0f64, |a, d| a.max(d.abs())));
    (largest, motion.rate.get(link).map_or(0.0, |v| rms(v)))
}
