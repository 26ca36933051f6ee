//! The library: one effect a file, each a list of candidates for a frame.

mod accel_gain;
mod asymmetric_damper;
mod axle_coupling;
mod bump_stop;
mod channel_swap;
mod coulomb_friction;
mod cubic_stiffness;
mod dead_zone;
mod mass_change;
mod pitch_coupling;
mod progressive_leaf;
mod quadratic_damping;
mod quadratic_stiffness;
mod roll_coupling;
mod sign_flip;
mod stiffness_drift;
mod time_offset;
mod viscous_damper;

use super::candidate::Candidate;
use super::change::Change;
use super::frame::MotionFrame;
use crate::series::detrend::rms;
use crate::vehicle::layout::Link;
use crate::vehicle::motion::Motion;
use crate::vehicle::preset::coupling;
use crate::vehicle::term::Term;

/// Every effect that the frame could show, in a fixed order; `only` keeps the ids (or families) given, all where empty.
pub fn library(frame: &MotionFrame, motion: &Motion, only: &[String]) -> Vec<Candidate> {
    let mut all = Vec::new();
    for list in [
        viscous_damper::candidates(frame),
        cubic_stiffness::candidates(frame),
        quadratic_stiffness::candidates(frame),
        progressive_leaf::candidates(frame),
        coulomb_friction::candidates(frame, motion),
        bump_stop::candidates(frame, motion),
        asymmetric_damper::candidates(frame),
        quadratic_damping::candidates(frame),
        dead_zone::candidates(frame, motion),
        stiffness_drift::candidates(frame),
        mass_change::candidates(frame),
        axle_coupling::candidates(frame),
        roll_coupling::candidates(frame),
        pitch_coupling::candidates(frame),
        accel_gain::candidates(frame),
        time_offset::candidates(frame),
        sign_flip::candidates(frame),
        channel_swap::candidates(frame),
    ] {
        all.extend(list);
    }
    if !only.is_empty() {
        all.retain(|c| only.iter().any(|o| *o == c.id || *o == c.family()));
    }
    all
}

/// Coupling links by name that the vehicle has not, each as inertia, as spring, and as spring with damper.
fn coupling_forms(frame: &MotionFrame, names: &[&str]) -> Vec<Change> {
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

/// Links between compared bodies with the word for their place; none where there is but one.
fn links(frame: &MotionFrame) -> Vec<(usize, Option<String>)> {
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

/// Largest stretch and rms rate of a link.
fn extent(motion: &Motion, link: usize) -> (f64, f64) {
    let largest = motion
        .stretch
        .get(link)
        .map_or(0.0, |d| d.iter().fold(0.0f64, |a, d| a.max(d.abs())));
    (largest, motion.rate.get(link).map_or(0.0, |v| rms(v)))
}
