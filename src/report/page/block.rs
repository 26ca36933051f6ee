//! Blocks of a page. All text is plain; each rendering escapes it for its own format.

use super::key_number::KeyNumber;
use crate::finding::Finding;
use crate::report::drawing::card_picture;
use crate::report::drawing::picture::Picture;
use crate::report::figure::Figure;
use crate::report::scene::SceneView;
use crate::workflow::cases::from_folder;
use std::path::Path;

/// A report: title, findings, then the sections.
#[derive(Clone, Debug)]
pub struct Page {
    /// Title: subject of the report in the user's words.
    pub title: String,
    /// Sentence that states the result.
    pub summary: String,
    /// Text that states the kind of report.
    pub lead: String,
    /// Findings in any order. The page shows the worst first.
    pub findings: Vec<Finding>,
    /// Content of the first screen.
    pub first: FirstScreen,
    /// Parts.
    pub sections: Vec<Section>,
    /// Whether the page is also written as `report.pdf`.
    pub paper: Paper,
}

/// Extent of a report on paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Paper {
    /// Nothing.
    None,
    /// The complete report.
    Report,
    /// The complete report, with lines for name, date and signature.
    Signed,
}

impl Page {
    /// Creates a page with `lead` below its title.
    pub fn new(title: &str, lead: &str, findings: &[Finding], sections: Vec<Section>) -> Self {
        Self {
            title: title.to_owned(),
            summary: String::new(),
            lead: lead.to_owned(),
            findings: findings.to_vec(),
            first: FirstScreen::default(),
            sections,
            paper: Paper::None,
        }
    }

    /// Sets the extent of the page on paper.
    pub fn on_paper(self, paper: Paper) -> Self {
        Self { paper, ..self }
    }

    /// Adds the sentence that states the result.
    pub fn with_summary(self, summary: String) -> Self {
        Self { summary, ..self }
    }

    /// Adds the first screen.
    pub fn with_first(self, first: FirstScreen) -> Self {
        Self { first, ..self }
    }

    /// Returns the page for a file in `folder`: paths of linked files are relative to `folder`.
    pub fn with_links_from(mut self, folder: &Path) -> Self {
        for block in self.sections.iter_mut().flat_map(|s| &mut s.blocks) {
            if let Block::Table(t) = block {
                for link in &mut t.links {
                    link.path = from_folder(folder, Path::new(&link.path));
                }
            }
        }
        self
    }

    /// Returns whether the page leads to other reports, which contain their own findings.
    pub(super) fn is_of_cards(&self) -> bool {
        let mut blocks = self.sections.iter().flat_map(|s| &s.blocks);
        blocks.any(|b| matches!(b, Block::Cards(_)))
    }

    /// Returns the findings sorted by severity, the worst first. Findings of one severity keep the order of the stages.
    pub fn worst_first(&self) -> Vec<&Finding> {
        let mut sorted: Vec<&Finding> = self.findings.iter().collect();
        sorted.sort_by_key(|f| std::cmp::Reverse(f.severity));
        sorted
    }
}

/// Content of the first screen in addition to summary, errors and picture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FirstScreen {
    /// Command that computed the result; empty for a page without a first screen.
    pub command: &'static str,
    /// Key numbers.
    pub numbers: Vec<KeyNumber>,
    /// Line over the table.
    pub title: String,
    /// Table of the result.
    pub table: Table,
    /// File of the folder with all rows.
    pub file: Option<&'static str>,
}

/// A titled part of a page.
#[derive(Clone, Debug)]
pub struct Section {
    /// Heading.
    pub title: String,
    /// Content.
    pub blocks: Vec<Block>,
}

impl Section {
    /// Creates a part with these blocks.
    pub fn new(title: impl Into<String>, blocks: Vec<Block>) -> Self {
        Self {
            title: title.into(),
            blocks,
        }
    }
}

/// One part of a section.
#[derive(Clone, Debug)]
pub enum Block {
    /// A paragraph.
    Text(String),
    /// A paragraph whose first part, the first string, is emphasized.
    Stressed(String, String),
    /// A paragraph in the background: explanation of the block above it.
    Note(String),
    /// A table.
    Table(Table),
    /// A figure in two dimensions.
    Figure(Figure),
    /// The model in three dimensions; on paper its outline with the gauges, seen along the axes.
    Scene(SceneView),
    /// Lines as they are, in type of one width.
    Lines(String),
    /// Cards side by side; one alone is as wide as the page.
    Cards(Vec<Card>),
    /// Links of a page to files next to it: link text, path.
    Links(Vec<(String, String)>),
    /// Content for some readers only: collapsed under `summary` on a screen, in full on paper.
    Folded {
        /// Heading that opens the content.
        summary: String,
        /// Content.
        blocks: Vec<Block>,
    },
}

impl Block {
    /// Creates a table with a heading line. If `head` is empty, it has no heading line.
    pub fn table(head: &[&str], rows: Vec<Vec<String>>) -> Self {
        Self::Table(Table {
            head: head.iter().map(|h| (*h).to_owned()).collect(),
            rows,
            links: Vec::new(),
        })
    }

    /// Adds links to files to the cells of a table; returns any other block unchanged.
    pub fn with_links(self, links: Vec<CellLink>) -> Self {
        match self {
            Self::Table(t) => Self::Table(Table { links, ..t }),
            other => other,
        }
    }

    /// Creates a list of names and values without a heading line.
    pub fn pairs(numbers: &[(String, String)]) -> Self {
        let row = |(name, value): &(String, String)| vec![name.clone(), value.clone()];
        Self::table(&[], numbers.iter().map(row).collect())
    }
}

/// Short form of a result: its picture, a sentence, a few numbers, and a link to the report.
#[derive(Clone, Debug)]
pub struct Card {
    /// Heading.
    pub title: String,
    /// Sentence.
    pub text: String,
    /// Numbers, each with its description.
    pub numbers: Vec<(String, String)>,
    /// Link texts and paths of files.
    pub links: Vec<(String, String)>,
    /// Whether the result cannot be relied on.
    pub is_bad: bool,
    pub(in crate::report) picture: Option<Picture>,
}

impl Card {
    /// Returns a card with nothing but a picture.
    pub(in crate::report) fn of_picture(picture: Picture) -> Self {
        Self {
            title: String::new(),
            text: String::new(),
            numbers: Vec::new(),
            links: Vec::new(),
            is_bad: false,
            picture: Some(picture),
        }
    }

    /// Returns the card with its picture replaced by the first picture of a figure.
    pub fn with_figure(self, figure: &Figure) -> Self {
        let picture = card_picture(figure).or(self.picture);
        Self { picture, ..self }
    }

    /// Returns a card with the first picture of a report: the picture of the model, or, if `of_numbers`, of the first figure.
    pub fn of_page(title: impl Into<String>, page: Option<&Page>, of_numbers: bool) -> Self {
        let blocks = || {
            page.iter()
                .flat_map(|p| &p.sections)
                .flat_map(|s| &s.blocks)
        };
        let still = blocks().find_map(|b| match b {
            Block::Scene(s) => Some(s.still.clone()),
            _ => None,
        });
        let figure = blocks().find_map(|b| match b {
            Block::Figure(f) => card_picture(f),
            _ => None,
        });
        let picture = match of_numbers {
            true => figure.or(still),
            false => still.or(figure),
        };
        Self {
            title: title.into(),
            text: String::new(),
            numbers: Vec::new(),
            links: Vec::new(),
            is_bad: false,
            picture,
        }
    }
}

/// A table. All rows are as long as the heading line, if there is one.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Table {
    /// Heading line. Empty for no heading line.
    pub head: Vec<String>,
    /// Cells.
    pub rows: Vec<Vec<String>>,
    /// Cells that lead to a file.
    pub links: Vec<CellLink>,
}

/// A table cell that links to a file. On paper it is plain text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CellLink {
    /// Row, from 0.
    pub row: usize,
    /// Column, from 0.
    pub column: usize,
    /// Path of the file, from the working folder; [`Page::with_links_from`] converts it to a path from the folder of the page.
    pub path: String,
    /// Text shown when the pointer is on the cell.
    pub title: String,
}

/// Returns a section that consists of a table with a note below it.
pub fn table_section(title: &str, head: &[&str], rows: &[Vec<String>], note: &str) -> Section {
    section_with_note(title, Block::table(head, rows.to_vec()), note)
}

/// Returns a section that consists of a figure with a note below it.
pub fn figure_section(title: &str, figure: Figure, note: &str) -> Section {
    section_with_note(title, Block::Figure(figure), note)
}

fn section_with_note(title: &str, block: Block, note: &str) -> Section {
    let mut blocks = vec![block];
    if !note.is_empty() {
        blocks.push(Block::Note(note.to_owned()));
    }
    Section::new(title, blocks)
}
