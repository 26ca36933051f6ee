//! Compares an answer with the hidden effect.

use super::generator::Hidden;
use strainbridge::reconcile::{Outcome, Verdict};

/// Comparison of the answer with the truth, by kind of effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// All effects and no others. For unmodelled effects, `unknown`. For controls, `none`.
    Hit,
    /// Another effect was identified, and the truth is listed as indistinguishable from it.
    Alias,
    /// Some of the effects and no wrong one.
    Partial,
    /// `none` or `below-detectability`, although there is an effect.
    None,
    /// `unknown` for an effect of the library.
    Unknown,
    /// An effect that is not in the readings.
    False,
}

fn kinds<'a>(ids: impl Iterator<Item = &'a String>) -> Vec<String> {
    let mut out: Vec<String> = ids
        .map(|i| i.split(':').next().unwrap_or(i).to_string())
        .collect();
    out.sort();
    out.dedup();
    out
}

/// Classifies the outcome of a case.
pub fn judge(case: &Hidden, outcome: &Outcome) -> Answer {
    let want = kinds(case.truth.iter());
    let got = match outcome.verdict {
        Verdict::Named => kinds(outcome.effects.iter().map(|e| &e.id)),
        Verdict::Unknown => vec!["unknown".into()],
        _ => vec!["none".into()],
    };
    let rival = || {
        let mut alike = outcome.rivals.iter().filter(|r| r.indistinguishable);
        alike.any(|r| kinds(r.ids.iter()) == want)
    };
    if got == want {
        Answer::Hit
    } else if got == ["unknown"] && want != ["none"] {
        Answer::Unknown
    } else if got == ["none"] {
        Answer::None
    } else if outcome.verdict == Verdict::Named && rival() {
        Answer::Alias
    } else if got.iter().all(|g| want.contains(g)) {
        Answer::Partial
    } else {
        Answer::False
    }
}
