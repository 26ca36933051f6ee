//! Report files and console output of `reconcile`.

use super::reconcile_extended::write_extended;
use super::reconcile_motion::{motion_page, write_motion};
use super::reconcile_strain::{strain_page, write_strain};
use super::{Report, write_page};
use crate::finding::list_few;
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::reconcile::{CauseOutcome, CauseSet};
use crate::report::console::{Console, ConsoleTable};
use crate::report::page::{KeyNumber, Page, Paper, number, table_section};
use crate::units::percent;
use crate::vehicle::term::UnitNames;
use crate::workflow::reconcile::{GapFound, Reconciliation, effect_in_words};

impl Report for Outcome<Reconciliation> {
    fn write(&self, out: &mut Output) -> Result<(), Faults> {
        write_extended(self, out)?;
        if let Some(strain) = &self.strain {
            write_strain(strain, out)?;
        }
        if let Some(motion) = &self.motion {
            write_motion(motion, &UnitNames::from_system(self.job.units), out)?;
        }
        write_page(out, self)
    }

    fn page(&self) -> Option<Page> {
        let causes = self.causes.as_ref().map(|c| causes_page(self, c));
        let motion = || Some(motion_page(self, self.motion.as_ref()?));
        let strain = || Some(strain_page(self, self.strain.as_ref()?));
        let page = causes.or_else(motion).or_else(strain)?;
        Some(page.on_paper(Paper::Report))
    }

    fn key_numbers(&self) -> Vec<KeyNumber> {
        let gap = &self.gap;
        let mut numbers = Vec::new();
        if gap.before.is_finite() {
            numbers.push(KeyNumber::new(
                percent(gap.before),
                "gap between model and measurement, as given",
            ));
            let floor = gap.floor.filter(|f| f.is_finite());
            let floor =
                floor.map_or_else(String::new, |f| format!(" (noise floor {})", percent(f)));
            let which = match self.named.is_empty() {
                true => "gap with the best attempt",
                false => "gap with the identified cause",
            };
            numbers.push(KeyNumber::new(
                percent(gap.after),
                format!("{which}{floor}"),
            ));
        }
        let runs = self.strain.as_ref().filter(|_| !self.named.is_empty());
        numbers.extend(runs.map(|s| {
            KeyNumber::new(
                format!("{} of 100", s.wins_of_100),
                "resampled run sets agree",
            )
        }));
        let next = self.rivals.iter().find(|r| !r.indistinguishable);
        numbers.extend(next.map(|r| {
            KeyNumber::new(
                number(r.evidence_difference),
                format!("log units to the next explanation, {}", r.id),
            )
        }));
        numbers
    }

    fn console(&self) -> Console {
        let table = match &self.causes {
            Some(causes) => causes_table(causes),
            None => ConsoleTable::of_fields("", &fields(self)),
        };
        Console::new(table, Some("gap.csv")).next(match &self.extended_model {
            Some(extended) => format!(
                "confirm the cause, then use {} in the folder of this result",
                extended.name
            ),
            None => self.next_measurement.clone(),
        })
    }
}

/// Effects, gap, certainty, and what would confirm them, as fields of a terminal.
fn fields(found: &Outcome<Reconciliation>) -> Vec<(&'static str, String)> {
    let mut out: Vec<(&'static str, String)> = Vec::new();
    out.extend(found.effects.iter().map(|e| ("effect", effect_in_words(e))));
    let gap = &found.gap;
    let percent = |v: f64| format!("{} %", number(100.0 * v));
    if gap.before.is_finite() {
        let floor = gap.floor.filter(|f| f.is_finite());
        let floor = floor.map_or_else(String::new, |f| format!(" (noise floor {})", percent(f)));
        let words = format!(
            "{} before, {} after{floor}, on {}",
            percent(gap.before),
            percent(gap.after),
            describe_gap_basis(gap)
        );
        out.push(("gap", words));
    }
    out.extend(confidence(found).map(|words| ("confidence", words)));
    let alike = found.rivals.iter().filter(|r| r.indistinguishable);
    let alike: Vec<&str> = alike.map(|r| r.id.as_str()).collect();
    if !alike.is_empty() {
        out.push(("indistinguishable", list_few(&alike)));
    }
    if let Some(strain) = &found.strain {
        out.push(("place of the gap", strain.sits.clone()));
    }
    if let Some(motion) = &found.motion {
        out.push(("place of the gap", motion.sits.clone()));
    }
    out.extend(found.remains.clone().map(|r| ("residual", r)));
    out.push(("to confirm", found.next_measurement.clone()));
    let changes = found.added.iter();
    out.extend(changes.map(|a| ("correction", format!("{}: {}", a.path, a.new))));
    out
}

/// Returns the confidence in the identified set: resampled runs, and the distance of the next explanation.
fn confidence(found: &Reconciliation) -> Option<String> {
    let runs = found.strain.as_ref().filter(|_| !found.named.is_empty());
    let runs = runs.map(|s| format!("{} of 100 resampled run sets agree", s.wins_of_100));
    let next = found.rivals.iter().find(|r| !r.indistinguishable);
    let next = next.map(|r| {
        let behind = number(r.evidence_difference);
        format!("next explanation {} is {behind} log units behind", r.id)
    });
    let parts: Vec<String> = runs.into_iter().chain(next).collect();
    (!parts.is_empty()).then(|| parts.join("; "))
}

/// Returns the data on which the gap was tested: number of runs, or kind of data of a record (held out, cross-validated, fitted).
fn describe_gap_basis(gap: &GapFound) -> String {
    let runs = gap.strain.map(|s| format!("{} runs", s.basis));
    let record = gap.judged_by.map(|p| p.words().to_owned());
    runs.or(record).unwrap_or_default()
}

fn causes_table(causes: &CauseOutcome) -> ConsoleTable {
    let row = |s: &CauseSet| {
        let names = match s.names.is_empty() {
            true => "no cause".to_owned(),
            false => s.names.join(" + "),
        };
        let gap = format!("{} %", number(100.0 * s.gap));
        vec![names, number(s.log_evidence), gap]
    };
    let rows = causes.sets.iter().map(row).collect();
    ConsoleTable::new("Causes", &["cause", "log evidence", "gap"], rows)
}

fn causes_page(outcome: &Outcome<Reconciliation>, causes: &CauseOutcome) -> Page {
    let evidence = causes.sets.first().map_or(0.0, |b| b.log_evidence);
    let row = |s: &CauseSet| {
        vec![
            s.names.join(" + "),
            format!("{:.1}", evidence - s.log_evidence),
            format!("{:.2} %", 100.0 * s.gap),
        ]
    };
    let rows: Vec<Vec<String>> = causes.sets.iter().map(row).collect();
    let head = ["causes", "log evidence behind", "gap"];
    let section = table_section("Causes", &head, &rows, "");
    let lead = format!(
        "Verdict: {}. Next measurement: {}",
        outcome.verdict.word(),
        outcome.next_measurement
    );
    Page::new(&outcome.job.title, &lead, &outcome.findings, vec![section])
}
