//! Names and units of channels: headers such as `P01 [um/m]`, rows of units below them, units of a whole file.

use super::time_unit::DAY;
use crate::units::{Quantity, find_unit, microstrain_in};

/// A channel of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name, without the unit.
    pub name: String,
    /// Unit as the file states it. Empty if the file states none.
    pub unit: String,
    /// Header of the channel in the file.
    pub header: Header,
    /// Unit that the file states outside the brackets after the name: in a row below, for the channel, or for all numbers. Empty without such a unit.
    /// If the brackets are part of a name, this is the unit of the column.
    pub stated: String,
}

/// Header of a channel in a file, split at its last bracket.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// The whole header: `SG1 (left)`.
    pub whole: String,
    /// Text before the last bracket: `SG1`.
    pub name: String,
    /// Text in the last bracket, a unit or a label: `left`. Empty without a bracket, or if the format separates units from names.
    pub bracket: String,
}

/// Two units of a column that can't both be right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clash {
    /// Units of one quantity and different size: `SG1 [m/m]` above `um/m`.
    Size,
    /// Units of different quantities: `SG1 [mV/V]` above `um/m`.
    Quantity,
}

/// Further units in tables of strain, and of strain before scaling: not units of time, of strain, or of a job.
const OTHER_UNITS: &[&str] = &[
    "mv/v", "v/v", "uv/v", "µv/v", "mv", "volt", "volts", "kn", "mn", "lbf", "kip", "kgf", "kg",
    "mm", "cm", "pa", "kpa", "mpa", "gpa", "psi", "n/mm2", "n/mm²", "m/s2", "m/s²", "deg", "°",
    "°c", "degc", "°f", "%", "hz", "bar", "counts",
];

impl Header {
    /// A header of a table, split at its last bracket: `SG1 (left) (um/m)` is `SG1 (left)` and `um/m`.
    fn parse(header: &str) -> Self {
        let whole = strip_quotes(header.trim());
        for (open, close) in [('[', ']'), ('(', ')')] {
            if let Some(body) = whole.strip_suffix(close)
                && let Some((name, bracket)) = split_at_bracket(body, open, close)
            {
                return Self {
                    whole: whole.to_owned(),
                    name: name.trim().to_owned(),
                    bracket: bracket.trim().to_owned(),
                };
            }
        }
        Self::from_name(whole)
    }

    /// A name with any content.
    fn from_name(name: &str) -> Self {
        Self {
            whole: name.to_owned(),
            name: name.to_owned(),
            bracket: String::new(),
        }
    }

    /// Returns whether the text in brackets is a unit of time, strain, a quantity that a job may name, or another that such files contain. A single
    /// letter in round brackets is not a unit: `SG1 (t)` is the top gauge.
    pub fn is_unit(&self) -> bool {
        let mut letters = self.bracket.chars();
        let is_letter = letters.next().is_some_and(char::is_alphabetic) && letters.next().is_none();
        let is_label = is_letter && self.whole.ends_with(')');
        !is_label && (!sizes(&self.bracket).is_empty() || is_other_unit(&self.bracket))
    }

    /// Returns whether both headers are equal except for the kind of bracket and blanks before it, as `SG1(left)` and `SG1 (left)`.
    pub fn is_like(&self, other: &Self) -> bool {
        self.name == other.name && self.bracket == other.bracket
    }
}

/// Returns a header without the quotation marks around all of it; one at its beginning alone is part of the name.
fn strip_quotes(header: &str) -> &str {
    let inside = header.strip_prefix('"').and_then(|h| h.strip_suffix('"'));
    inside.map_or(header, str::trim)
}

/// Returns name and unit of a header such as `P01 [um/m]` or `a_body (m/s2)`. The last bracket contains the unit: `SG1 (left) (um/m)`.
pub fn name_and_unit(header: &str) -> Column {
    let header = Header::parse(header);
    let unit = match unit_of_time_name(&header.whole) {
        Some(unit) => unit.to_owned(),
        None => header.bracket.clone(),
    };
    Column {
        name: header.name.clone(),
        unit,
        header,
        stated: String::new(),
    }
}

impl Column {
    /// Returns a channel of a format that keeps units apart from names.
    pub fn of_channel(name: &str, unit: &str) -> Self {
        let unit = match unit_of_time_name(name) {
            Some(of_name) if unit.is_empty() => of_name,
            _ => unit,
        };
        Self {
            name: name.to_owned(),
            unit: unit.to_owned(),
            header: Header::from_name(name),
            stated: unit.to_owned(),
        }
    }

    /// Returns the column for a file whose numbers are all in one unit. Text in brackets that is not a unit is part of the name, as in `SG1 (left)`.
    pub(super) fn in_file_of(mut self, unit: &str) -> Self {
        if self.header.is_unit() {
            // A unit of strain after the name is the unit of the numbers, whatever the name is.
            self.stated = match microstrain_in(&self.header.bracket) {
                Some(_) => self.header.bracket.clone(),
                None => unit.to_owned(),
            };
            return self;
        }
        if !states_no_unit(&self.header.bracket) {
            self.name.clone_from(&self.header.whole);
        }
        unit.clone_into(&mut self.unit);
        unit.clone_into(&mut self.stated);
        self
    }

    /// Returns whether this column contains the times. `first` states whether it is the first column of its file.
    pub fn is_time(&self, first: bool) -> bool {
        is_time(&self.name, first)
            || self.clash() == Some(Clash::Size) && is_time(&self.header.name, first)
    }

    /// Returns whether this column contains the names of runs. Case does not matter.
    pub fn is_run(&self) -> bool {
        self.name.eq_ignore_ascii_case("run")
    }

    /// Returns the contradiction between the unit in brackets after the name and the unit stated elsewhere, if there is one.
    pub fn clash(&self) -> Option<Clash> {
        if states_no_unit(&self.header.bracket) || states_no_unit(&self.stated) {
            return None;
        }
        match likeness(&self.header.bracket, &self.stated) {
            Likeness::Same => None,
            Likeness::Size => Some(Clash::Size),
            Likeness::None => self.header.is_unit().then_some(Clash::Quantity),
        }
    }

    /// Returns the message about a column whose units clash.
    pub fn clash_words(&self) -> String {
        format!(
            "`{}` after the name, and `{}` as the unit of the column",
            self.header.bracket, self.stated
        )
    }
}

/// Gives a column the unit in the row below its header. If the brackets after the name contain an equal unit, the column keeps this unit. Any other
/// text in these brackets is part of the name, `SG1 (left)`, or a unit that contradicts the unit in the row ([`Column::clash`]).
pub fn take_unit_below(column: &mut Column, below: &str) {
    if states_no_unit(below) {
        return;
    }
    let below = below.trim().trim_matches(['[', ']', '(', ')']);
    below.clone_into(&mut column.stated);
    if !states_no_unit(&column.unit) {
        if likeness(&column.unit, below) == Likeness::Same {
            return;
        }
        column.name.clone_from(&column.header.whole);
    }
    below.clone_into(&mut column.unit);
}

/// Returns whether a field of a row of units states no unit: blank, `-`, or a title of such a row.
pub(super) fn states_no_unit(field: &str) -> bool {
    let word = field.trim().trim_matches(['[', ']', '(', ')']);
    matches!(
        word.to_lowercase().as_str(),
        "" | "-" | "unit" | "units" | "einheit" | "einheiten"
    )
}

/// Returns the text before and after the bracket that a final bracket would close; `N/(mm)` is one unit.
fn split_at_bracket(body: &str, open: char, close: char) -> Option<(&str, &str)> {
    let mut depth = 0_usize;
    for (at, c) in body.char_indices().rev() {
        if c == close {
            depth += 1;
        } else if c == open {
            if depth == 0 {
                let unit = body.get(at..)?.strip_prefix(open)?;
                return Some((body.get(..at)?, unit));
            }
            depth -= 1;
        }
    }
    None
}

/// Relation of two texts for units.
#[derive(PartialEq)]
enum Likeness {
    /// Both texts are one unit, such as `m/m` and `strain`.
    Same,
    /// Both units measure one quantity in different sizes, such as `MN` and `mN`.
    Size,
    /// No known relation.
    None,
}

fn likeness(a: &str, b: &str) -> Likeness {
    let (of_a, of_b) = (sizes(a), sizes(b));
    let pairs = of_a.iter().flat_map(|x| of_b.iter().map(move |y| (x, y)));
    let mut likeness = Likeness::None;
    for ((quantity, x), (other, y)) in pairs {
        if quantity == other {
            // Sizes are products of exact numbers. Equal sizes agree except for the last digits.
            if (x - y).abs() <= 1e-12 * x.abs() {
                return Likeness::Same;
            }
            likeness = Likeness::Size;
        }
    }
    match likeness {
        Likeness::None if a.eq_ignore_ascii_case(b) => Likeness::Same,
        other => other,
    }
}

/// Returns the quantities that a text measures as a unit, each with its size; some texts mean several, `us` microstrain and microseconds.
fn sizes(word: &str) -> Vec<(&'static str, f64)> {
    if states_no_unit(word) {
        return Vec::new();
    }
    let time = seconds_in(word).map(|s| ("time", s));
    let strain = microstrain_in(word).map(|m| ("strain", m));
    let of = |quantity| find_unit(quantity, word).map(|u| (u.quantity.word(), u.si));
    let others = Quantity::ALL.into_iter().filter_map(of);
    time.into_iter().chain(strain).chain(others).collect()
}

fn is_other_unit(word: &str) -> bool {
    OTHER_UNITS.contains(&word.to_lowercase().as_str())
}

/// Returns the seconds in a unit of time; no unit means seconds.
pub fn seconds_in(unit: &str) -> Option<f64> {
    match unit.trim().to_lowercase().as_str() {
        "" | "s" | "sec" | "secs" | "second" | "seconds" | "sek" => Some(1.0),
        "ms" | "msec" | "millisecond" | "milliseconds" => Some(1e-3),
        "us" | "µs" | "μs" | "microseconds" => Some(1e-6),
        "ns" | "nanoseconds" => Some(1e-9),
        "min" | "minutes" => Some(60.0),
        "h" | "hours" => Some(3600.0),
        "d" | "day" | "days" => Some(DAY),
        _ => None,
    }
}

/// Returns the unit of time at the end of a name such as `time_ms`; `None` for other names and for seconds, which need no unit.
pub(super) fn unit_of_time_name(name: &str) -> Option<&'static str> {
    let word = name.trim().to_lowercase();
    let unit = ["time_", "t_", "timestamp_"]
        .iter()
        .find_map(|w| word.strip_prefix(w))?;
    ["ms", "us", "ns", "min"].into_iter().find(|u| *u == unit)
}

/// Returns whether a column of this name contains the times. `first` states whether it is the first column of its file.
pub fn is_time(name: &str, first: bool) -> bool {
    let word = name.trim().to_lowercase();
    match word.as_str() {
        "time" | "t" if name != "T" => true,
        "t_s" | "time_s" | "zeit" | "timestamp" | "datetime" | "date_time" | "date time"
        | "date/time" | "datum" | "date" => true,
        _ if unit_of_time_name(&word).is_some() => true,
        // Measuring programs append the name of the clock: `Time  1 - default sample rate`.
        _ => {
            first
                && (name == "T"
                    || ["time ", "zeit ", "datum ", "date ", "timestamp "]
                        .iter()
                        .any(|w| word.starts_with(w)))
        }
    }
}
