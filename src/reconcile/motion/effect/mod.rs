//! Library of effects. Each file contains one effect, with its candidates for a frame.

mod accel_gain;
mod asymmetric_damper;
mod axle_coupling;
mod bump_stop;
mod channel_swap;
mod clock_drift;
mod coulomb_friction;
mod cubic_stiffness;
mod dead_zone;
mod dropped_samples;
mod hum;
mod low_pass;
mod mass_change;
mod pitch_coupling;
mod places;
mod progressive_leaf;
mod quadratic_damping;
mod quadratic_stiffness;
mod roll_coupling;
mod sign_flip;
mod stiffness_drift;
mod time_offset;
mod viscous_damper;

use super::candidate::Candidate;
use super::design::Design;
use super::frame::MotionFrame;

/// Returns every effect that the record of the frame could show, in a fixed order. If `only` is not empty, these are the effects whose id or family
/// it lists.
pub fn library(frame: &MotionFrame, design: &Design, only: &[String]) -> Vec<Candidate> {
    let motion = &design.motion;
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
        mass_change::candidates(frame, design),
        axle_coupling::candidates(frame),
        roll_coupling::candidates(frame),
        pitch_coupling::candidates(frame),
        accel_gain::candidates(frame),
        time_offset::candidates(frame),
        sign_flip::candidates(frame),
        channel_swap::candidates(frame),
        clock_drift::candidates(frame),
        dropped_samples::candidates(frame),
        low_pass::candidates(frame),
        hum::candidates(frame, motion),
    ] {
        all.extend(list);
    }
    if !only.is_empty() {
        all.retain(|c| only.iter().any(|o| *o == c.id || *o == c.family()));
    }
    all
}
