//! An outcome in words, on the terminal and in the extended job, the same for both paths.

use crate::app::Session;
use crate::reconcile::{Gap, Rival, Verdict};

/// An effect with its sizes.
pub(super) struct Sized<'a> {
    pub id: &'a str,
    pub size: &'a [f64],
    pub sigma: &'a [f64],
    pub unit: &'a str,
}

impl Sized<'_> {
    /// `rail_stiffness:L4: 14.8 +- 1.1 percent`.
    pub(super) fn in_words(&self) -> String {
        let pairs = self.size.iter().zip(self.sigma);
        let sizes: Vec<String> = pairs
            .map(|(v, s)| format!("{} +- {}", number(*v), number(*s)))
            .collect();
        if sizes.is_empty() {
            self.id.to_owned()
        } else {
            format!("{}: {} {}", self.id, sizes.join(", "), self.unit)
        }
    }
}

/// A number with four figures or so.
fn number(v: f64) -> String {
    if v == 0.0 || (1e-2..1e5).contains(&v.abs()) {
        format!("{v:.3}")
    } else {
        format!("{v:.4e}")
    }
}

/// Says verdict, effects, gap on held-out `data` and what can't be told apart.
pub(super) fn say<'a>(
    session: &mut Session,
    verdict: Verdict,
    effects: impl Iterator<Item = Sized<'a>>,
    gap: &Gap,
    rivals: &[Rival],
    data: &str,
) {
    session.say(format!("verdict: {}", verdict.word()));
    for e in effects {
        session.say(format!("  {}", e.in_words()));
    }
    session.say(format!(
        "gap on {data}: {:.2} % before, {:.2} % after, floor {:.2} %, explained {:.0} %",
        100.0 * gap.before,
        100.0 * gap.after,
        100.0 * gap.floor,
        100.0 * gap.explained_share()
    ));
    for r in rivals.iter().filter(|r| r.indistinguishable) {
        session.say(format!(
            "  can't be told from: {} (log evidence {:.1} behind)",
            r.ids.join(" + "),
            r.evidence_difference
        ));
    }
}
