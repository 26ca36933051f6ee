//! An outcome as HTML for a notebook: the blocks of its report without a script. The style applies only to these blocks.
//!
//! Figures are drawn as on paper. The model in three dimensions, long tables and other large content stay in `report.html`.

use super::command::{Report, words};
use super::drawing::picture::Picture;
use super::drawing::{STROKES, pictures, to_svg, views};
use super::figure::Figure;
use super::page::{Block, Page, Section, Table, block_html, reliability};
use super::scene::SceneView;
use crate::host::outcome::{Answer, Outcome};
use maud::{Markup, PreEscaped, html};

const STYLE: &str = include_str!("notebook.css");
/// Rows of a table and lines of a text.
const MOST_ROWS: usize = 40;
/// Pictures of one figure.
const MOST_PICTURES: usize = 4;
/// Bytes of all pictures of a piece, so that a notebook with many stays light.
const MOST_BYTES: usize = 160_000;

/// Returns self-contained HTML: verdict, findings, sections. An outcome without a page gives its console text.
pub fn piece<A: Answer>(outcome: &Outcome<A>) -> String
where
    Outcome<A>: Report,
{
    let page = outcome.page().unwrap_or_else(|| {
        let words = Block::Lines(words(outcome));
        let sections = vec![Section::new("Answer", vec![words])];
        Page::new(A::COMMAND, "", &outcome.findings, sections)
    });
    piece_of(&page.with_summary(outcome.summary()))
}

fn piece_of(page: &Page) -> String {
    let mut room = Room { bytes: MOST_BYTES };
    let sections: Vec<(&str, Vec<Markup>)> = page
        .sections
        .iter()
        .map(|s| (s.title.as_str(), room.blocks(&s.blocks)))
        .collect();
    html! {
        div.strainbridge {
            style { (PreEscaped(STYLE)) }
            h3 { (page.title) }
            @if !page.summary.is_empty() { p { b { (page.summary) } } }
            @if !page.lead.is_empty() { p.muted { (page.lead) } }
            (reliability(&page.worst_first()))
            @for (title, blocks) in &sections {
                h4 { (title) }
                @for b in blocks { (b) }
            }
        }
    }
    .into_string()
}

/// Bytes left for pictures.
struct Room {
    bytes: usize,
}

impl Room {
    fn blocks(&mut self, list: &[Block]) -> Vec<Markup> {
        list.iter().map(|b| self.block(b)).collect()
    }

    fn block(&mut self, b: &Block) -> Markup {
        match b {
            Block::Table(t) => table(t),
            Block::Figure(f) => self.figure(f),
            Block::Scene(s) => self.scene(s),
            Block::Lines(text) => lines(text),
            // A notebook has no files next to it to link to.
            Block::Links(_) => html! {},
            Block::Cards(_) => block_html(b),
            Block::Folded { summary, blocks } => {
                let blocks = self.blocks(blocks);
                html! { details { summary { (summary) } @for b in &blocks { (b) } } }
            }
            Block::Text(_) | Block::Stressed(..) | Block::Note(_) => block_html(b),
        }
    }

    /// The first choice of a figure, the next ones folded.
    fn figure(&mut self, f: &Figure) -> Markup {
        let mut drawn = pictures(f);
        let n = drawn.len();
        drawn.truncate(MOST_PICTURES);
        let shown: Vec<Markup> = drawn
            .iter()
            .map_while(|p| self.picture(p, &f.label))
            .collect();
        let left_out = shown.len() < n || f.choices.len() > f.on_paper;
        html! {
            @for (i, svg) in shown.iter().enumerate() {
                @if i == 0 { (svg) } @else { details { summary { (drawn[i].title) } (svg) } }
            }
            @if !f.caption.is_empty() { p.muted { (f.caption) } }
            @if left_out { (refer_to_report("More of this figure")) }
        }
    }

    /// The outline with the gauges, from the side that shows most.
    fn scene(&mut self, s: &SceneView) -> Markup {
        let first = views(s).into_iter().next();
        let svg = first.and_then(|p| self.picture(&p, "the model with its gauges"));
        let strokes = svg.is_some() && s.marks.iter().any(|m| m.axes.is_some());
        html! {
            @match &svg {
                Some(svg) => (svg),
                None => (refer_to_report("The model in three dimensions")),
            }
            p.muted { (s.caption) @if strokes { " " (STROKES) } }
        }
    }

    /// A picture with its title and caption; `None` if it is too large for the remaining space.
    fn picture(&mut self, p: &Picture, label: &str) -> Option<Markup> {
        let svg = to_svg(p, label);
        self.bytes = self.bytes.checked_sub(svg.0.len())?;
        Some(html! {
            figure {
                @if !p.title.is_empty() { b { (p.title) } }
                (svg)
                @if !p.caption.is_empty() { figcaption { (p.caption) } }
            }
        })
    }
}

fn table(t: &Table) -> Markup {
    let shown = Table {
        head: t.head.clone(),
        rows: t.rows.iter().take(MOST_ROWS).cloned().collect(),
        links: t.links.clone(),
    };
    let n = t.rows.len();
    html! {
        (block_html(&Block::Table(shown)))
        @if n > MOST_ROWS { (refer_to_report(&format!("{} more rows", n - MOST_ROWS))) }
    }
}

fn lines(text: &str) -> Markup {
    let shown: Vec<&str> = text.lines().take(MOST_ROWS).collect();
    let left = text.lines().count() - shown.len();
    html! {
        pre { (shown.join("\n")) }
        @if left > 0 { (refer_to_report(&format!("{left} more lines"))) }
    }
}

fn refer_to_report(what: &str) -> Markup {
    html! { p.muted { (what) ": in report.html, among the files of the command." } }
}

#[cfg(test)]
mod tests;
