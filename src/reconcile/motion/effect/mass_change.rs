//! Sprung mass that joins or leaves during the record: a step or a ramp, with its weight or its inertia alone.

use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::design::Design;
use crate::reconcile::motion::frame::MotionFrame;
use crate::reconcile::motion::moments::best_steps;
use crate::vehicle::layout::MassStep;

/// Steps tried through the record.
const STEPS: usize = 13;

pub(super) fn candidates(frame: &MotionFrame, design: &Design) -> Vec<Candidate> {
    let v = &frame.vehicle;
    let sprung: Vec<usize> = frame
        .bodies
        .iter()
        .copied()
        .filter(|&b| v.bodies[b].sprung && v.steps.iter().all(|s| s.body != b))
        .collect();
    let (start, length) = (frame.data.start_s, frame.data.duration_s());
    let found = best_steps(frame, design, &sprung);
    sprung
        .iter()
        .zip(found)
        .map(|(&body, found)| {
            // The best times in the record, then the times of a grid.
            let mut shapes: Vec<Change> = found.into_iter().map(Change::Step).collect();
            for gravity in [0.0, frame.gravity] {
                let step = |at_s: f64, over_s: f64| {
                    Change::Step(MassStep {
                        body,
                        at_s,
                        over_s,
                        gravity,
                    })
                };
                for i in 1..=STEPS {
                    let share = 0.1 + 0.8 * i as f64 / (STEPS + 1) as f64;
                    shapes.push(step(start + share * length, 0.0));
                }
                shapes.push(step(start, length));
                for share in [0.1, 0.3, 0.5, 0.7] {
                    shapes.push(step(start + share * length, 0.2 * length));
                }
            }
            let place = (sprung.len() > 1).then(|| v.bodies[body].name.clone());
            Candidate::new("mass_change", place.as_deref(), shapes)
        })
        .collect()
}
