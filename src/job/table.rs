//! A CSV file with the line of every row.

use crate::host::fault::{Fault, FaultList, Faults};
use crate::series::cell::remove_guard;
use crate::series::number::{DecimalMark, number};
use crate::units::{Quantity, largest_size, number as in_words};
use std::collections::HashMap;

/// Header and rows of a CSV file, fields trimmed.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// File as given.
    pub file: String,
    /// Column names.
    pub header: Vec<String>,
    /// Rows: line in the file, fields.
    pub rows: Vec<(u32, Vec<String>)>,
}

/// Reads a table from a CSV text. The delimiter is comma, semicolon or tab: the most frequent one in the header, or the delimiter that a first line
/// `sep=;` states. Lines that start with `#` are comments. If commas don't separate the fields, numbers may have a decimal comma.
///
/// # Errors
/// Rows of another length, an empty file.
pub fn read_table(file: &str, text: &str) -> Result<Table, Faults> {
    let mut whole: Option<Table> = None;
    each_part(file, text, usize::MAX, &mut |part| whole = Some(part))?;
    whole.ok_or_else(|| Faults::from(empty_file_fault(file)))
}

/// Reads a table in parts of `most` rows, because the fields of a long table need many times the memory of its text. `take` gets each part, including
/// a shorter last part. For a table without rows it is called once.
///
/// # Errors
/// Every error of [`read_table`]; `take` may have received rows before a fault was found.
pub fn each_part(
    file: &str,
    text: &str,
    most: usize,
    take: &mut dyn FnMut(Table),
) -> Result<(), Faults> {
    let (stated, text) = match stated_delimiter(text) {
        Some((delimiter, rest)) => (Some(delimiter), rest),
        None => (None, text),
    };
    let first = text
        .lines()
        .find(|l| !l.trim().is_empty() && !l.starts_with('#'))
        .unwrap_or("");
    let most_used = [b',', b';', b'\t']
        .into_iter()
        .max_by_key(|d| (first.bytes().filter(|b| b == d).count(), *d == b','));
    let delimiter = stated.or(most_used).unwrap_or(b',');
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(delimiter)
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .flexible(true)
        .from_reader(text.as_bytes());
    let mut faults = FaultList::new();
    let header: Vec<String> = match reader.headers() {
        Ok(h) => h.iter().map(|s| remove_guard(s).to_owned()).collect(),
        Err(e) => {
            return Err(Faults::from(Fault::new(
                file,
                "header",
                e.to_string(),
                "write a CSV file with a header",
            )));
        }
    };
    if header.iter().all(String::is_empty) {
        return Err(Faults::from(empty_file_fault(file)));
    }
    faults.extend(named_twice(file, &header));
    let mark = DecimalMark::from_delimiter(delimiter);
    let mut part = Table {
        file: file.to_owned(),
        header,
        rows: Vec::new(),
    };
    for record in reader.records() {
        match record {
            Ok(r) => {
                let line = r.position().map_or(0, |p| p.line() as u32);
                let line = line + u32::from(stated.is_some());
                if r.iter().all(str::is_empty) {
                    continue;
                }
                if r.len() != part.header.len() {
                    let wrong = format!(
                        "the row has {} fields, the header has {}",
                        r.len(),
                        part.header.len()
                    );
                    faults.push(Fault::with_line(
                        file,
                        line,
                        "row",
                        wrong,
                        "give every row as many fields as the header",
                    ));
                    continue;
                }
                if part.rows.len() == most {
                    let next = Table {
                        file: part.file.clone(),
                        header: part.header.clone(),
                        rows: Vec::new(),
                    };
                    take(std::mem::replace(&mut part, next));
                }
                part.rows.push((
                    line,
                    r.iter()
                        .map(|s| with_point(remove_guard(s), mark))
                        .collect(),
                ));
            }
            Err(e) => faults.push(Fault::new(file, "row", e.to_string(), "write a CSV file")),
        }
    }
    Faults::check(faults)?;
    take(part);
    Ok(())
}

/// Returns the delimiter that a first line `sep=;` of spreadsheets states, and the text below that line.
fn stated_delimiter(text: &str) -> Option<(u8, &str)> {
    let (line, rest) = text.split_once('\n')?;
    let line = line.trim_start_matches(['\u{feff}', '"', ' ']);
    let (word, delimiter) = line.split_at_checked(4)?;
    let delimiter = delimiter.bytes().next()?;
    let is_stated = word.eq_ignore_ascii_case("sep=") && [b',', b';', b'\t'].contains(&delimiter);
    is_stated.then_some((delimiter, rest))
}

fn empty_file_fault(file: &str) -> Fault {
    let remedy = "write a header and one row for each entry";
    Fault::new(file, "header", "the file is empty", remedy)
}

fn named_twice(file: &str, header: &[String]) -> Vec<Fault> {
    let mut seen = std::collections::HashSet::with_capacity(header.len());
    let twice = header.iter().filter(|name| !seen.insert(*name));
    let fault = |name: &String| {
        let remedy = "give every column a separate name";
        Fault::with_line(file, 1, name, "column named twice", remedy)
    };
    twice.map(fault).collect()
}

/// A field, a number's decimal comma turned into a point.
fn with_point(field: &str, mark: DecimalMark) -> String {
    if mark == DecimalMark::CommaOrPoint
        && field.contains(',')
        && number(field.as_bytes(), mark).is_some()
    {
        field.replacen(',', ".", 1)
    } else {
        field.to_owned()
    }
}

/// Returns whether a number has a mark between thousands and another before its fraction: `2.497,6` or `2,497.6`.
fn has_thousands(text: &str) -> bool {
    let has = |c: char| text.contains(c);
    let bare: String = text.chars().filter(|c| !matches!(c, '.' | ',')).collect();
    has('.') && has(',') && bare.parse::<f64>().is_ok()
}

impl Table {
    /// Refuses a table that has a header and no rows.
    ///
    /// # Errors
    /// A fault if there is no row.
    pub fn check_rows(&self) -> Result<(), Fault> {
        let remedy = "write one row for each entry";
        match self.rows.is_empty() {
            true => Err(Fault::with_line(
                &*self.file,
                1,
                "rows",
                "the file has a header and no rows",
                remedy,
            )),
            false => Ok(()),
        }
    }

    /// Index of the first of these columns that exists.
    pub fn column(&self, names: &[&str]) -> Option<usize> {
        names
            .iter()
            .find_map(|n| self.header.iter().position(|h| h == n))
    }

    /// Returns faults of names that occur in two rows of a column; `what` states their kind.
    pub fn rows_named_twice(&self, column: usize, what: &str) -> FaultList {
        let mut seen: HashMap<&str, u32> = HashMap::with_capacity(self.rows.len());
        let mut faults = FaultList::new();
        for (line, fields) in &self.rows {
            let name = fields.get(column).map_or("", String::as_str);
            let before = *seen.entry(name).or_insert(*line);
            if before != *line && !name.is_empty() {
                let wrong =
                    format!("{what} `{name}` has a row in line {before} and one in line {line}");
                let remedy = "keep the row that is right";
                faults.push(Fault::with_line(&*self.file, *line, what, wrong, remedy));
            }
        }
        faults
    }

    /// Returns the number in a field. `None` if the field is blank.
    ///
    /// # Errors
    /// A fault if the field is not a finite number.
    pub fn number(&self, row: usize, column: usize) -> Result<Option<f64>, Fault> {
        let Some((line, fields)) = self.rows.get(row) else {
            return Ok(None);
        };
        let text = fields.get(column).map_or("", String::as_str);
        if text.is_empty() {
            return Ok(None);
        }
        match text.parse::<f64>() {
            Ok(x) if x.is_finite() => Ok(Some(x)),
            _ if has_thousands(text) => {
                let name = self.header.get(column).map_or("", String::as_str);
                let wrong = format!("column `{name}`: `{text}` has a mark between thousands");
                let remedy = "write numbers without marks between thousands";
                Err(Fault::with_line(
                    &*self.file,
                    *line,
                    "numbers",
                    wrong,
                    remedy,
                ))
            }
            _ => {
                let name = self.header.get(column).map_or("", String::as_str);
                Err(Fault::with_line(
                    &*self.file,
                    *line,
                    name,
                    format!("`{text}` is not a number"),
                    "write a number with a decimal point; leave the field blank if nothing was measured",
                ))
            }
        }
    }

    /// Returns the standard deviation in a field, converted as in [`Table::size`]. `None` if the field is blank.
    ///
    /// # Errors
    /// A fault if it is not a number, is negative, or is larger than possible for this quantity.
    pub fn sd(
        &self,
        row: usize,
        column: usize,
        of: (Option<Quantity>, f64),
    ) -> Result<Option<f64>, Fault> {
        let sd = self.size(row, column, of)?;
        let Some(v) = sd.filter(|v| *v < 0.0) else {
            return Ok(sd);
        };
        let line = self.rows.get(row).map_or(0, |r| r.0);
        let name = self.header.get(column).map_or("", String::as_str);
        let wrong = format!("a standard deviation of {v} is below zero");
        let remedy = "write its standard deviation, or leave it blank to use `[runs] noise`";
        Err(Fault::with_line(&*self.file, line, name, wrong, remedy))
    }

    /// Returns the number in a field, converted from units of `si` SI units of a quantity of loads or payloads. `None` if the field is blank.
    ///
    /// # Errors
    /// A fault if the field is not a finite number, or is impossible for this quantity.
    pub fn size(
        &self,
        row: usize,
        column: usize,
        (quantity, si): (Option<Quantity>, f64),
    ) -> Result<Option<f64>, Fault> {
        let value = self.number(row, column)?;
        let most = largest_size(quantity);
        match value {
            Some(x) if (x * si).abs() > most => {
                let line = self.rows.get(row).map_or(0, |r| r.0);
                let name = self.header.get(column).map_or("", String::as_str);
                let word = quantity.map_or("factor of a load set", Quantity::word);
                let wrong = format!(
                    "{} is too large for a {word} of a structure: the largest is {} in this unit",
                    in_words(x),
                    in_words(most / si)
                );
                let remedy = "correct the number, or the unit of its column";
                Err(Fault::with_line(&*self.file, line, name, wrong, remedy))
            }
            value => Ok(value),
        }
    }
}
