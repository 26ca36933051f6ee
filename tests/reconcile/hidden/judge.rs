//! What an answer is worth against what was hidden.

use super::generator::Hidden;
use strainbridge::reconcile::{Outcome, Verdict};

/// The answer against the truth, effects by their kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// All of it and nothing else; for what is unmodelled, `unknown`; for controls, `none`.
    Hit,
    /// A rival was named, and the truth is listed as one that can't be told from it.
    Alias,
    /// Some of it, nothing wrong.
    Partial,
    /// `none` or `below-detectability` where there is something.
    None,
    /// `unknown` for an effect of the library.
    Unknown,
    /// Something that is not there.
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

/// Judges the outcome of a case.
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
