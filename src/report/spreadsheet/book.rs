//! Sheets of plain cells to the bytes of a workbook.

use crate::finding::Finding;
use rust_xlsxwriter::{
    DocProperties, ExcelDateTime, Format, FormatAlign, FormatBorder, Workbook, Worksheet, XlsxError,
};

/// One cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Text.
    Text(String),
    /// A number; one that is not finite is left blank.
    Number(f64),
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}

impl From<u32> for Cell {
    fn from(value: u32) -> Self {
        Self::Number(f64::from(value))
    }
}

/// Sheet of a workbook: a header line, then rows.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Sheet {
    /// Name of the sheet, at most 31 characters.
    pub name: String,
    /// Names of the columns, with the unit if they have one.
    pub columns: Vec<String>,
    /// Rows.
    pub rows: Vec<Vec<Cell>>,
}

impl Sheet {
    /// Creates a sheet without rows.
    pub fn new(name: &str, columns: &[&str]) -> Self {
        Self {
            name: name.to_owned(),
            columns: columns.iter().map(|c| (*c).to_owned()).collect(),
            rows: Vec::new(),
        }
    }
}

/// The unit of one quantity.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitOf {
    /// Quantity, such as `force`.
    pub quantity: &'static str,
    /// Unit, such as `kN`.
    pub unit: String,
}

/// Description of the job in every workbook.
#[derive(Clone, Debug, PartialEq)]
pub struct WorkbookDescription<'a> {
    /// Title of the job.
    pub title: &'a str,
    /// Units of the numbers.
    pub units: &'a [UnitOf],
    /// Findings, in the order given.
    pub findings: &'a [Finding],
}

/// The year that every workbook is dated: the same input gives the same bytes.
const DATED: u16 = 2000;
/// The most UTF-16 units of a cell (ECMA-376, specifications of Excel).
const MOST_TEXT: usize = 32_767;
/// Widest column that is fitted to its text, pixels.
const WIDEST: u32 = 520;

/// Returns the bytes of a workbook: the sheets, then `Units`, then `Findings`.
///
/// # Errors
/// Errors of the writing library, for example two sheets with one name.
pub fn spreadsheet(sheets: &[Sheet], about: &WorkbookDescription) -> Result<Vec<u8>, XlsxError> {
    let mut book = Workbook::new();
    book.set_properties(
        &DocProperties::new()
            .set_title(about.title)
            .set_creation_datetime(&ExcelDateTime::from_ymd(DATED, 1, 1)?),
    );
    for sheet in sheets {
        fill(book.add_worksheet(), sheet)?;
    }
    fill(book.add_worksheet(), &units_sheet(about))?;
    fill(book.add_worksheet(), &findings_sheet(about.findings))?;
    book.save_to_buffer()
}

fn fill(out: &mut Worksheet, sheet: &Sheet) -> Result<(), XlsxError> {
    let head = Format::new()
        .set_bold()
        .set_text_wrap()
        .set_align(FormatAlign::Top)
        .set_border_bottom(FormatBorder::Thin);
    out.set_name(&sheet.name)?;
    for (c, name) in (0_u16..).zip(&sheet.columns) {
        out.write_string_with_format(0, c, shorten_to_cell(name), &head)?;
    }
    for (r, row) in (1_u32..).zip(&sheet.rows) {
        for (c, cell) in (0_u16..).zip(row) {
            match cell {
                Cell::Text(text) => out.write_string(r, c, shorten_to_cell(text))?,
                Cell::Number(x) if x.is_finite() => out.write_number(r, c, *x)?,
                Cell::Number(_) => out,
            };
        }
    }
    out.set_freeze_panes(1, 1)?;
    // Print setup: landscape, fitted to the page width, header row on every page.
    out.set_landscape();
    out.set_print_fit_to_pages(1, 0);
    out.set_repeat_rows(0, 0)?;
    out.set_autofit_max_width(WIDEST);
    out.autofit();
    Ok(())
}

/// Shortens text to the limit of a spreadsheet cell; shortened text ends in two points.
fn shorten_to_cell(text: &str) -> std::borrow::Cow<'_, str> {
    // The limit counts UTF-16 units; a character has at most two of them.
    if text.len() <= MOST_TEXT || text.encode_utf16().count() <= MOST_TEXT {
        return text.into();
    }
    let mut left = MOST_TEXT - 2;
    let kept = text.chars().take_while(|c| {
        let fits = c.len_utf16() <= left;
        left = left.saturating_sub(c.len_utf16());
        fits
    });
    (kept.collect::<String>() + "..").into()
}

fn units_sheet(about: &WorkbookDescription) -> Sheet {
    let mut sheet = Sheet::new("Units", &["quantity", "unit"]);
    sheet.rows = about
        .units
        .iter()
        .map(|u| vec![u.quantity.into(), u.unit.clone().into()])
        .collect();
    sheet
}

fn findings_sheet(findings: &[Finding]) -> Sheet {
    let mut sheet = Sheet::new(
        "Findings",
        &[
            "severity", "code", "subject", "message", "measured", "limit", "remedy",
        ],
    );
    let number = |x: Option<f64>| Cell::Number(x.unwrap_or(f64::NAN));
    sheet.rows = findings
        .iter()
        .map(|f| {
            vec![
                f.severity.name().into(),
                f.code.into(),
                f.subject.clone().into(),
                f.message.clone().into(),
                number(f.measured),
                number(f.limit),
                f.remedy.clone().into(),
            ]
        })
        .collect();
    sheet
}
