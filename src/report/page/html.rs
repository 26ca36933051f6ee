//! A page as one HTML file: no script from elsewhere, the first screen with summary, errors, picture and table first.

use super::block::{Block, Card, Page};
use super::findings::{FindingsBySeverity, reliability};
use super::summary_screen::{first_screen, notes_and_tests};
use super::table::{list_of_links, table};
use crate::report::drawing::picture::Picture;
use crate::report::drawing::{pictures, to_svg};
use crate::report::figure::scripts;
use maud::{DOCTYPE, Markup, PreEscaped, html};

pub(in crate::report) const STYLE: &str = include_str!("page.css");

impl Page {
    /// Returns `report.html`, which works from the file, without a network.
    pub fn to_html(&self) -> String {
        let content = self.content();
        let scripts = scripts(&content.0);
        html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width,initial-scale=1";
                    title { (self.title) }
                    style { (PreEscaped(STYLE)) }
                    noscript { style { ".controls,.pick,.bar,.tools,.canvas{display:none}" } }
                }
                body {
                    main { (content) }
                    (PreEscaped(scripts))
                }
            }
        }
        .into_string()
    }

    /// The content of the page, without head and scripts.
    pub(in crate::report) fn content(&self) -> Markup {
        let findings = FindingsBySeverity::from_findings(&self.findings);
        let sections = html! {
            @for (i, s) in self.sections.iter().enumerate() {
                section.pair[is_pair(&s.blocks)] id=(format!("s{}", i + 1)) { h2 { (s.title) } @for b in &s.blocks { (block(b)) } }
            }
        };
        html! {
            @if self.is_of_cards() {
                h1 { (self.title) }
                p.summary { b { (self.summary) } }
                p.muted { (self.lead) }
                @if !self.findings.is_empty() { (reliability(&self.worst_first())) }
            } @else {
                (first_screen(self, &findings))
            }
            (sections)
            (notes_and_tests(self, &findings))
        }
    }
}

/// Returns whether figures and a table of the same numbers have room next to each other.
fn is_pair(blocks: &[Block]) -> bool {
    let figures = blocks.iter().any(|b| matches!(b, Block::Figure(_)));
    let tables = blocks.iter().filter(|b| matches!(b, Block::Table(_)));
    figures && tables.count() == 1
}

/// Returns a block as HTML of the page.
pub(in crate::report) fn block(b: &Block) -> Markup {
    match b {
        Block::Text(t) => html! { p { (t) } },
        Block::Stressed(lead, rest) => html! { p { b { (lead) } " " (rest) } },
        Block::Note(t) => html! { p.muted { (t) } },
        Block::Table(t) => table(t, ""),
        Block::Figure(f) => html! {
            (f)
            noscript { @for p in pictures(f) { (picture_html(&p, &f.label)) } }
        },
        Block::Scene(s) => html! {
            (s.markup)
            noscript { p.muted { "Without scripts the model is shown as a still picture at the top of the page." } }
        },
        Block::Lines(t) => html! { pre { (t) } },
        Block::Cards(cards) => html! { div.cards { @for c in cards { (card(c)) } } },
        Block::Links(links) => html! { p.muted { (list_of_links(links)) } },
        Block::Folded { summary, blocks } => html! {
            details { summary { (summary) } @for b in blocks { (block(b)) } }
        },
    }
}

/// A picture that needs no script.
fn picture_html(picture: &Picture, label: &str) -> Markup {
    html! {
        figure.plot {
            @if !picture.title.is_empty() { b { (picture.title) } }
            (to_svg(picture, label))
            @if !picture.caption.is_empty() { figcaption.muted { (picture.caption) } }
        }
    }
}

fn card(c: &Card) -> Markup {
    html! {
        article.card.bad[c.is_bad] {
            h3 { (c.title) }
            @if c.is_bad { p { b { "This result is not reliable." } } }
            @if let Some(p) = &c.picture {
                div.model[p.is_model()] { (to_svg(p, &format!("Picture: {}", c.title))) }
                @if !p.caption.is_empty() { p.muted { (p.caption) } }
            }
            p { (c.text) }
            p.numbers { @for (value, what) in &c.numbers { span { b { (value) } " " (what) } } }
            @if !c.links.is_empty() { p { (list_of_links(&c.links)) } }
        }
    }
}
