//! Two accelerometers exchanged on their way to the logger.

use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::frame::MotionFrame;

pub(super) fn candidates(frame: &MotionFrame) -> Vec<Candidate> {
    let sensors: Vec<String> = frame
        .channels()
        .into_iter()
        .filter(|c| frame.is_sensor(c))
        .collect();
    let mut out = Vec::new();
    for (i, a) in sensors.iter().enumerate() {
        for b in &sensors[i + 1..] {
            let shapes = vec![Change::Swap {
                a: a.clone(),
                b: b.clone(),
            }];
            out.push(Candidate::new(
                "channel_swap",
                Some(&format!("{a}+{b}")),
                shapes,
            ));
        }
    }
    out
}
