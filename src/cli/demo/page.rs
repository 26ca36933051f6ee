//! The page that leads through the story.

use super::chapter::Chapter;
use crate::finding::Severity;
use crate::report::page::{Block, Page, Section};

/// One part a chapter, with links to its report and files.
pub(super) fn page(story: &[Chapter]) -> Page {
    Page::new(
        "The truck story",
        "Strain gauges and a finite element model in, wheel loads with intervals out: every folder holds the job, its tables and its report",
        &[],
        story.iter().map(section).collect(),
    )
}

fn section(c: &Chapter) -> Section {
    let link = |words: &str, file: &str| (words.to_owned(), format!("{}/{file}", c.folder));
    let mut blocks = vec![
        Block::Text(c.words.to_owned()),
        Block::Text(c.step.summary.clone()),
        Block::Links(vec![
            link("report", "report.html"),
            link("result.json", "result.json"),
        ]),
        Block::Note(format!("strainbridge {}", c.command)),
    ];
    let serious = c.step.findings.iter();
    let serious = serious.filter(|f| f.severity >= Severity::Warning).take(4);
    blocks.extend(serious.map(|f| Block::Note(format!("{}: {}", f.code, f.message))));
    Section::new(c.folder, blocks)
}
