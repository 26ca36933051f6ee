//! Report files and console output of `init`.

use super::{Report, write_page};
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::report::console::{Console, ConsoleTable};
use crate::report::page::{Block, KeyNumber, Page, Section};
use crate::report::scene::{scene_of_loads, scene_section};
use crate::workflow::init::{NotProposed, Proposal};

/// Lines of a block: a notebook cuts longer ones.
const LINES: usize = 30;

/// Returns whether a line of a job asks its reader for something.
fn is_open(line: &str) -> bool {
    line.contains("# check") || line.contains("# fill in")
}

fn pieces(lines: &[&str]) -> Vec<Block> {
    let piece = |part: &[&str]| Block::Lines(part.join("\n"));
    lines.chunks(LINES).map(piece).collect()
}

impl Report for Outcome<Proposal> {
    fn write(&self, out: &mut Output) -> Result<(), Faults> {
        out.write_bytes(self.job, self.text.as_bytes())?;
        write_page(out, self)
    }

    fn page(&self) -> Option<Page> {
        let next = self
            .console()
            .next
            .map(|next| Block::Text(format!("Next: {next}.")));
        let mut proposed: Vec<Block> = next.into_iter().collect();
        if !self.loads.is_empty() {
            proposed.push(Block::Stressed("Loads:".into(), self.loads.join(", ")));
        }
        let mut sections = vec![Section::new("Proposal", proposed)];
        if let Some((job, model)) = &self.read {
            sections.push(scene_section("Proposed loads", &scene_of_loads(job, model)));
        }
        let to_check: Vec<&str> = self.text.lines().filter(|l| is_open(l)).collect();
        if !to_check.is_empty() {
            sections.push(Section::new("Yours to check", pieces(&to_check)));
        }
        let lines: Vec<&str> = self.text.lines().collect();
        let whole = Block::Folded {
            summary: format!("{}, {} lines", self.job, lines.len()),
            blocks: pieces(&lines),
        };
        sections.push(Section::new("The job", vec![whole]));
        let lead = "A proposal: correct it before you use it";
        Some(Page::new(self.job, lead, &self.findings, sections))
    }

    fn key_numbers(&self) -> Vec<KeyNumber> {
        vec![
            KeyNumber::new(self.loads.len().to_string(), "loads proposed"),
            KeyNumber::new(
                self.left_out.len().to_string(),
                "loads and subcases left out",
            ),
            KeyNumber::new(self.zones.len().to_string(), "zones of stiffness"),
        ]
    }

    /// Returns a row for each proposed load, then each load that is left out.
    fn result_table(&self) -> ConsoleTable {
        let proposed = self
            .loads
            .iter()
            .map(|name| vec![name.clone(), "proposed".to_owned()]);
        let left_out = self.left_out.iter();
        let left_out = left_out.map(|l| vec![l.name.clone(), format!("left out: {}", l.reason)]);
        ConsoleTable::new(
            "Loads",
            &["load", "in the job"],
            proposed.chain(left_out).collect(),
        )
    }

    fn console(&self) -> Console {
        let row = |l: &NotProposed| vec![l.name.clone(), l.reason.clone()];
        let rows = self.left_out.iter().map(row).collect();
        let table = ConsoleTable::new("Left out of the job", &["load", "reason"], rows);
        let path = self.path.display();
        let step = match (self.placeable, self.purpose) {
            (_, Some(command)) => format!(
                "read {}, correct units and loads, name your files, then run `strainbridge {command} {path}`",
                self.job
            ),
            (true, None) => format!(
                "read {}, correct units and loads, then run `strainbridge place {path}`",
                self.job
            ),
            (false, None) if self.loads.is_empty() && self.inputs.is_empty() => format!(
                "read {}, name your files in it, then run `strainbridge check {path}`",
                self.job
            ),
            (false, None) => format!("correct {} as the findings state", self.job),
        };
        Console::new(table, Some(self.job)).next(step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::outcome::{Findings, Seconds, StatedUnits};
    use crate::report::notebook::piece;

    #[test]
    fn a_notebook_shows_the_whole_job_and_the_lines_that_are_to_be_checked() {
        let rows: Vec<String> = (0..100).map(|i| format!("line_{i} = 1")).collect();
        let open = "units = \"mm-t-s\"   # check: by Young's moduli";
        let outcome = Outcome {
            units: StatedUnits::default(),
            inputs: Vec::new(),
            sources: Vec::new(),
            findings: Findings::default(),
            seconds: Seconds::default(),
            notes: Vec::new(),
            answer: Proposal {
                job: "job.toml",
                loads: vec!["LF.FZ".into(), "RF.FZ".into()],
                left_out: Vec::new(),
                placeable: true,
                text: format!("{open}\n{}\n", rows.join("\n")),
                path: "job.toml".into(),
                zones: Default::default(),
                read: None,
                purpose: None,
            },
        };
        let html = piece(&outcome);
        assert!(rows.iter().all(|r| html.contains(r.as_str())), "{html}");
        assert_eq!(html.matches("# check: by Young").count(), 2);
        assert!(html.contains("LF.FZ, RF.FZ") && html.contains("proposes 2 loads"));
    }
}
