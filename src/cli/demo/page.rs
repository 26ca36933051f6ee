//! The page that leads through the story.

use super::Chapter;
use crate::report::page::{Section, page as frame};
use maud::html;

/// One part a chapter, with links to its report and files.
pub(super) fn page(story: &[Chapter]) -> String {
    let sections = story
        .iter()
        .map(|c| Section {
            title: c.folder.to_owned(),
            body: html! {
                p { (c.words) }
                p.muted {
                    a href=(format!("{}/report.html", c.folder)) { "report" } " · "
                    a href=(format!("{}/result.json", c.folder)) { "result.json" } " · "
                    code { "strainbridge " (c.step.command) }
                }
                @for f in c.step.findings.iter().filter(|f| f.severity >= crate::finding::Severity::Warning).take(4) {
                    p.muted { (f.code) ": " (f.message) }
                }
                @if !c.step.text.is_empty() {
                    pre { (c.step.text.lines().take(14).collect::<Vec<_>>().join("\n")) }
                }
            },
        })
        .collect();
    frame(
        "The truck story",
        "Strain gauges and a finite element model in, wheel loads with intervals out: every folder holds the job, its tables and its report",
        &[],
        sections,
    )
}
