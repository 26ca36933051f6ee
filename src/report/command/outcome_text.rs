//! Outcomes on a terminal, in a notebook and in another program.

use super::Report;
use crate::finding::Severity;
use crate::host::outcome::{Answer, Outcome};
use crate::report::console::{Console, LINES, Room, Texts, WIDTH, lay_out};

/// Returns the text of an outcome for a terminal. If there are errors, they are the next step.
pub fn console_of<A: Answer>(outcome: &Outcome<A>) -> Console
where
    Outcome<A>: Report,
{
    let console = outcome.console();
    let error = outcome
        .findings
        .iter()
        .find(|f| f.severity == Severity::Error);
    match error {
        Some(f) => console.next(format!(
            "correct the causes of the errors; `strainbridge explain {}` states cause, limit and remedy",
            f.code
        )),
        None => console,
    }
}

/// Returns table and summary of an outcome as text, for a notebook or another program.
pub fn words<A: Answer>(outcome: &Outcome<A>) -> String
where
    Outcome<A>: Report,
{
    let texts = Texts {
        summary: &outcome.summary(),
        ..Texts::default()
    };
    let room = Room {
        width: WIDTH,
        lines: Some(LINES),
        is_utf8: true,
    };
    let lines = lay_out(&console_of(outcome), &texts, &room).answer;
    lines.join("\n") + "\n"
}
