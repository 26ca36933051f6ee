//! Typst with two files, the template and the data, and the fonts of this program: no network, no clock, no fonts of the machine.

use super::content::{Origin, content};
use super::glyphs::fonts;
use crate::report::page::Page;
use typst::diag::{FileError, FileResult, SourceDiagnostic};
use typst::foundations::{Bytes, Datetime, Duration, Smart};
use typst::syntax::{FileId, RootedPath, Source, VirtualPath, VirtualRoot};
use typst::text::{Font, FontBook};
use typst::utils::LazyHash;
use typst::{Library, LibraryExt, World};
use typst_layout::PagedDocument;
use typst_pdf::PdfOptions;

const TEMPLATE: &str = include_str!("page.typ");

/// Reason why a page can't be drawn. Each is a bug in the program.
#[derive(Debug, thiserror::Error)]
pub enum PdfError {
    /// The name of a file of the template.
    #[error("the template cannot name `{0}`")]
    Name(&'static str),
    /// Typst refuses the template or the data.
    #[error("the layout of the page failed: {0}")]
    Layout(String),
    /// The PDF can't be written.
    #[error("the pages cannot be written as PDF: {0}")]
    Write(String),
}

/// Returns the bytes of `report.pdf` in A4. The same page and origin give the same bytes.
///
/// # Errors
/// An error only if the template is wrong.
pub fn write_pdf(page: &Page, origin: &Origin) -> Result<Vec<u8>, PdfError> {
    let paper = Paper::new(content(page, origin).to_string())?;
    let laid: PagedDocument = typst::compile(&paper)
        .output
        .map_err(|e| PdfError::Layout(sentences(&e)))?;
    let options = PdfOptions {
        creator: Smart::Custom(Some(origin.program.into())),
        ..PdfOptions::default()
    };
    let pdf = typst_pdf::pdf(&laid, &options).map_err(|e| PdfError::Write(sentences(&e)));
    // The cache would only help a second layout of the same page.
    typst::comemo::evict(0);
    pdf
}

fn sentences(faults: &[SourceDiagnostic]) -> String {
    let list: Vec<String> = faults.iter().map(|f| f.message.to_string()).collect();
    list.join("; ")
}

/// Files, fonts and library that Typst can read.
struct Paper {
    library: LazyHash<Library>,
    book: LazyHash<FontBook>,
    template: Source,
    data: (FileId, Bytes),
}

impl Paper {
    fn new(data: String) -> Result<Self, PdfError> {
        Ok(Self {
            library: LazyHash::new(Library::default()),
            book: LazyHash::new(FontBook::from_fonts(fonts())),
            template: Source::new(file("page.typ")?, TEMPLATE.to_owned()),
            data: (file("page.json")?, Bytes::from_string(data)),
        })
    }
}

fn file(name: &'static str) -> Result<FileId, PdfError> {
    let path = VirtualPath::new(name).map_err(|_| PdfError::Name(name))?;
    Ok(RootedPath::new(VirtualRoot::Project, path).intern())
}

fn missing_file(id: FileId) -> FileError {
    FileError::NotFound(id.get().vpath().get_without_slash().into())
}

impl World for Paper {
    fn library(&self) -> &LazyHash<Library> {
        &self.library
    }

    fn book(&self) -> &LazyHash<FontBook> {
        &self.book
    }

    fn main(&self) -> FileId {
        self.template.id()
    }

    fn source(&self, id: FileId) -> FileResult<Source> {
        if id == self.template.id() {
            Ok(self.template.clone())
        } else {
            Err(missing_file(id))
        }
    }

    fn file(&self, id: FileId) -> FileResult<Bytes> {
        if id == self.data.0 {
            Ok(self.data.1.clone())
        } else {
            Err(missing_file(id))
        }
    }

    fn font(&self, index: usize) -> Option<Font> {
        fonts().get(index).cloned()
    }

    fn today(&self, _: Option<Duration>) -> Option<Datetime> {
        None
    }
}
