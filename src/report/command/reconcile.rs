//! Files and words of `reconcile`.

use super::reconcile_extended::write_extended;
use super::reconcile_motion::{motion_page, simulated_words, write_motion};
use super::reconcile_strain::{strain_page, write_strain};
use super::{Report, write_page};
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::reconcile::{CauseOutcome, CauseSet};
use crate::report::page::{Page, Paper, table_section};
use crate::vehicle::term::UnitNames;
use crate::workflow::reconcile::{GapFound, Reconciled, effect_in_words};
use std::fmt::Write as _;

impl Report for Outcome<Reconciled> {
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

    fn words(&self) -> String {
        let mut text = format!("verdict: {}\n", self.verdict.word());
        if let Some(causes) = &self.causes {
            text.push_str(&causes_words(causes));
        } else {
            text.push_str(&effects_words(self));
        }
        if let Some(strain) = &self.strain {
            let _ = writeln!(text, "where: {}", strain.sits);
            let _ = writeln!(text, "left: {}", strain.outcome.remains);
        }
        if let Some(motion) = &self.motion {
            let _ = writeln!(text, "where: {}", motion.sits);
            text.push_str(&simulated_words(motion));
            let _ = writeln!(text, "{}", motion.outcome.remains);
        }
        let _ = writeln!(text, "next measurement: {}", self.next_measurement);
        text
    }
}

/// Effects, gap, and what can't be told apart.
fn effects_words(found: &Reconciled) -> String {
    let mut text = String::new();
    for e in &found.effects {
        let _ = writeln!(text, "  {}", effect_in_words(e));
    }
    let gap = &found.gap;
    let percent = |v: Option<f64>| 100.0 * v.unwrap_or(f64::NAN);
    if !gap.before.is_finite() {
        // What remains says why.
        text.push_str("no gap can be stated\n");
        return text;
    }
    let _ = writeln!(
        text,
        "gap on {}: {:.2} % before, {:.2} % after, floor {:.2} %, explained {:.0} %",
        judged_on(gap),
        100.0 * gap.before,
        100.0 * gap.after,
        percent(gap.floor),
        percent(gap.explained_share)
    );
    for r in found.rivals.iter().filter(|r| r.indistinguishable) {
        let _ = writeln!(
            text,
            "  can't be told from: {} (log evidence {:.1} behind)",
            r.id, r.evidence_difference
        );
    }
    text
}

/// What the gap was judged on.
fn judged_on(gap: &GapFound) -> String {
    let runs = gap.strain.map(|s| format!("{} runs", s.basis));
    let record = gap.judged_by.map(|p| p.words().to_owned());
    runs.or(record).unwrap_or_default()
}

fn causes_words(causes: &CauseOutcome) -> String {
    let mut text = String::new();
    for s in &causes.sets {
        let names = match s.names.is_empty() {
            true => "nothing".to_owned(),
            false => s.names.join(" + "),
        };
        let _ = writeln!(
            text,
            "  {names}: log evidence {:.1}, gap {:.2} %",
            s.log_evidence,
            100.0 * s.gap
        );
    }
    text
}

fn causes_page(outcome: &Outcome<Reconciled>, causes: &CauseOutcome) -> Page {
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
