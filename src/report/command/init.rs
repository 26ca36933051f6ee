//! Files and words of `init`.

use super::Report;
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::report::page::{Block, Page, Section};
use crate::workflow::init::Proposal;

/// Lines of a block: a notebook cuts longer ones.
const LINES: usize = 30;

/// Whether a line of a job asks its reader for something.
fn is_open(line: &str) -> bool {
    line.contains("# check") || line.contains("# fill in")
}

fn pieces(lines: &[&str]) -> Vec<Block> {
    let piece = |part: &[&str]| Block::Lines(part.join("\n"));
    lines.chunks(LINES).map(piece).collect()
}

impl Report for Outcome<Proposal> {
    const FILES: &'static [&'static str] = &["result.json"];

    fn write(&self, out: &mut Output) -> Result<(), Faults> {
        Ok(out.write_bytes(self.job, self.text.as_bytes())?)
    }

    /// What a notebook shows; no file is written of it, for a job is read where it stands.
    fn page(&self) -> Option<Page> {
        let mut proposed = vec![Block::Text(self.words().trim_end().to_owned())];
        if !self.loads.is_empty() {
            proposed.push(Block::Stressed("Loads:".into(), self.loads.join(", ")));
        }
        let mut sections = vec![Section::new("Proposal", proposed)];
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
        Some(Page::new(self.job, "", &self.findings, sections))
    }

    fn words(&self) -> String {
        let path = self.path.display();
        if self.loads.is_empty() && !self.placeable && self.inputs.is_empty() {
            let command = self.purpose.unwrap_or("check");
            return format!(
                "{}: read it, name your files in it, then run `{command} {path}`\n",
                self.job
            );
        }
        let n = self.loads.len();
        let plural = if n == 1 { "" } else { "s" };
        let what = format!("{}: {n} load{plural} proposed", self.job);
        let mut words = match (self.placeable, self.purpose) {
            (true, None) => {
                format!("{what}; read it, correct units and loads, then run `place {path}`\n")
            }
            (_, Some(command)) => format!(
                "{what}; read it, correct units and loads, name your files, then run `{command} {path}`\n"
            ),
            (false, None) => {
                format!("{what}; gauges can't be placed by it as it is: see the findings\n")
            }
        };
        for of_one in self.left_out.chunk_by(|a, b| a.reason == b.reason) {
            /// Names listed at most: the job has all.
            const MOST: usize = 5;
            let names: Vec<&str> = of_one.iter().take(MOST).map(|l| l.name.as_str()).collect();
            let more = match of_one.len().saturating_sub(MOST) {
                0 => String::new(),
                n => format!(" and {n} more"),
            };
            words.push_str(&format!(
                "Left out: {}{more}: {}\n",
                names.join(", "),
                of_one[0].reason
            ));
        }
        words
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
                purpose: None,
            },
        };
        let html = piece(&outcome);
        assert!(rows.iter().all(|r| html.contains(r.as_str())), "{html}");
        assert_eq!(html.matches("# check: by Young").count(), 2);
        assert!(html.contains("LF.FZ, RF.FZ") && html.contains("2 loads proposed"));
        assert!(!html.contains("report.html"), "{html}");
    }
}
