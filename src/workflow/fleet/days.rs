//! The order of days by their names: dates by the calendar, other names by their numbers.

use std::cmp::Ordering;
use std::collections::BTreeSet;

/// In which order a date that does not begin with its year has day and month.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum DayMonthOrder {
    #[default]
    Day,
    Month,
}

/// Order of the days of a fleet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DayOrder {
    /// Compares the numbers in the names, from left to right.
    #[default]
    Numbers,
    /// Compares dates with the day before the month.
    DayFirst,
    /// Compares dates with the month before the day.
    MonthFirst,
}

/// Days whose order is ambiguous.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AmbiguousDays {
    /// Reason why the order is ambiguous.
    pub wrong: String,
    /// Remedy.
    pub remedy: &'static str,
}

/// Date in a name with the year last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Date {
    year: u32,
    /// First and second number before the year.
    two: [u32; 2],
    /// Whether the name determines the order of day and month, by points between the numbers or by the name of the month. The day is then first.
    is_told: bool,
    /// Whether the year has two digits, which may also be the number of a section or a version.
    is_short: bool,
}

impl DayOrder {
    /// Returns the order of days with these names.
    ///
    /// # Errors
    /// Dates that contradict each other. Dates whose day and month could be exchanged with a change of order. A mix of dates and other names.
    pub fn from_names<'a>(names: impl Iterator<Item = &'a str>) -> Result<Self, AmbiguousDays> {
        let names: BTreeSet<&str> = names.collect();
        let dates: Vec<(&str, Option<Date>)> = names.iter().map(|n| (*n, date(n))).collect();
        let of_year_last: Vec<(&str, Date)> = dates
            .iter()
            .filter_map(|(n, d)| Some((*n, (*d)?)))
            .collect();
        let Some((first, _)) = of_year_last.first() else {
            return Ok(Self::Numbers);
        };
        let other = dates
            .iter()
            .find(|d| d.1.is_none() && year_first(d.0).is_none());
        if let Some((other, _)) = other {
            // Names such as `12.11.10` and `12.11.9` are numbers, not dates.
            if of_year_last.iter().all(|(_, d)| d.is_short) {
                return Ok(Self::Numbers);
            }
            return Err(AmbiguousDays {
                wrong: format!(
                    "the order of the days `{first}` and `{other}` is unknown: one is a date, the other is not"
                ),
                remedy: "let {day} in [fleet] file_name contain dates only, or write them with the year first (2026-05-31)",
            });
        }
        let is = |of: [bool; 2]| of_year_last.iter().find(|(_, d)| fits(d) == of);
        match (is([true, false]), is([false, true])) {
            (Some((a, _)), Some((b, _))) => Err(AmbiguousDays {
                wrong: format!(
                    "the days `{a}` and `{b}` have different formats: one has the day before the month, the other the month before the day"
                ),
                remedy: "write dates with the year first (2026-05-31)",
            }),
            (Some(_), None) => Ok(Self::DayFirst),
            (None, Some(_)) => Ok(Self::MonthFirst),
            (None, None) => {
                let order = |first: DayMonthOrder| {
                    let mut list: Vec<&str> = names.iter().copied().collect();
                    list.sort_by(|a, b| by_date(first, a, b));
                    list
                };
                if order(DayMonthOrder::Day) == order(DayMonthOrder::Month) {
                    return Ok(Self::DayFirst);
                }
                Err(AmbiguousDays {
                    wrong: format!(
                        "the day `{first}` may have its day or its month first, and no other day determines which"
                    ),
                    remedy: "write dates with the year first (2026-05-31), or with points if the day is first (31.05.2026)",
                })
            }
        }
    }

    /// Returns which of two days is first.
    pub fn compare(self, a: &str, b: &str) -> Ordering {
        match self {
            Self::Numbers => by_numbers(a, b),
            Self::DayFirst => by_date(DayMonthOrder::Day, a, b),
            Self::MonthFirst => by_date(DayMonthOrder::Month, a, b),
        }
    }
}

/// Whether a date can have its day first, and whether its month.
fn fits(d: &Date) -> [bool; 2] {
    let [a, b] = d.two;
    let is = |day: u32, month: u32| (1..=31).contains(&day) && (1..=12).contains(&month);
    [is(a, b), is(b, a) && !d.is_told]
}

/// Compares names by year, month and day, then by their text.
fn by_date(first: DayMonthOrder, a: &str, b: &str) -> Ordering {
    let key = |name: &str| match date(name) {
        Some(d) => {
            let [x, y] = d.two;
            match first {
                DayMonthOrder::Day => [d.year, y, x],
                DayMonthOrder::Month if d.is_told => [d.year, y, x],
                DayMonthOrder::Month => [d.year, x, y],
            }
        }
        None => year_first(name).unwrap_or_default(),
    };
    key(a).cmp(&key(b)).then_with(|| by_numbers(a, b))
}

/// A run of digits or letters of a name.
#[derive(Clone, Copy)]
struct Word<'a> {
    text: &'a str,
    /// Text between this word and the word before it.
    mark: &'a str,
}

/// Returns the words of a name: runs of digits and runs of letters.
fn words(name: &str) -> Vec<Word<'_>> {
    let kind = |c: char| match c {
        c if c.is_ascii_digit() => 1,
        c if c.is_alphabetic() => 2,
        _ => 0,
    };
    let (mut out, mut rest, mut mark) = (Vec::new(), name, "");
    while let Some(first) = rest.chars().next() {
        let end = rest.find(|c| kind(c) != kind(first)).unwrap_or(rest.len());
        let (text, left) = rest.split_at(end);
        if kind(first) == 0 {
            mark = text;
        } else {
            out.push(Word { text, mark });
            mark = "";
        }
        rest = left;
    }
    out
}

/// A number of so many digits.
fn number(text: &str, digits: std::ops::RangeInclusive<usize>) -> Option<u32> {
    let fits = digits.contains(&text.len()) && text.bytes().all(|b| b.is_ascii_digit());
    fits.then(|| text.parse().ok())?
}

/// A year of four digits in which records are made.
fn year(text: &str) -> Option<u32> {
    number(text, 4..=4).filter(|y| (1950..2150).contains(y))
}

/// The number of a month by its English or German name or the first three letters of it.
fn month(text: &str) -> Option<u32> {
    const MONTHS: [&[&str]; 12] = [
        &["jan"],
        &["feb"],
        &["mar", "mär", "mrz"],
        &["apr"],
        &["may", "mai"],
        &["jun"],
        &["jul"],
        &["aug"],
        &["sep"],
        &["oct", "okt"],
        &["nov"],
        &["dec", "dez"],
    ];
    let word = text.to_lowercase();
    let is = |list: &&[&str]| list.iter().any(|m| word.starts_with(m));
    let at = MONTHS
        .iter()
        .position(is)
        .filter(|_| text.chars().count() >= 3)?;
    u32::try_from(at + 1).ok()
}

/// A date in a name.
#[derive(Clone, Copy)]
enum NameDate {
    /// Year, month and day: `2026-05-31`, `20260531`, `2026-May-31`.
    YearFirst([u32; 3]),
    /// `31.05.2026`, `5-31-2026`, `31052026`, `31-May-2026`, `31.05.26`. Two digits are a year behind points alone.
    YearLast(Date),
}

/// The first date in a name.
fn find_date(name: &str) -> Option<NameDate> {
    let words = words(name);
    let at = |i: usize| words.get(i..).unwrap_or_default();
    (0..words.len()).find_map(|i| match at(i) {
        [a, b, c, ..] => of_three(a, b, c).or_else(|| of_one(a)),
        [a, ..] => of_one(a),
        [] => None,
    })
}

fn date(name: &str) -> Option<Date> {
    match find_date(name)? {
        NameDate::YearLast(date) => Some(date),
        NameDate::YearFirst(_) => None,
    }
}

fn year_first(name: &str) -> Option<[u32; 3]> {
    match find_date(name)? {
        NameDate::YearFirst(date) => Some(date),
        NameDate::YearLast(_) => None,
    }
}

fn is_month_and_day(month: u32, day: u32) -> bool {
    (1..=12).contains(&month) && (1..=31).contains(&day)
}

fn of_three(a: &Word, b: &Word, c: &Word) -> Option<NameDate> {
    let by_word = month(b.text);
    let second = || by_word.or_else(|| number(b.text, 1..=2));
    if let Some(y) = year(a.text) {
        let (m, d) = (second()?, number(c.text, 1..=2)?);
        return is_month_and_day(m, d).then_some(NameDate::YearFirst([y, m, d]));
    }
    let points = [b.mark, c.mark] == ["."; 2];
    let divided = b.mark == c.mark && !b.mark.is_empty() || by_word.is_some();
    let long = year(c.text);
    let y = long.or_else(|| Some(2000 + number(c.text, 2..=2).filter(|_| points)?))?;
    let d = Date {
        year: y,
        two: [number(a.text, 1..=2)?, second()?],
        is_told: points || by_word.is_some(),
        is_short: long.is_none(),
    };
    (divided && fits(&d) != [false, false]).then_some(NameDate::YearLast(d))
}

/// Eight digits.
fn of_one(word: &Word) -> Option<NameDate> {
    let digits = word.text;
    let (begin, end) = digits.split_at_checked(4).filter(|_| digits.len() == 8)?;
    let two = |text: &str| {
        let (a, b) = text.split_at(2);
        Some([number(a, 2..=2)?, number(b, 2..=2)?])
    };
    if let (Some(y), Some([m, d])) = (year(begin), two(end))
        && is_month_and_day(m, d)
    {
        return Some(NameDate::YearFirst([y, m, d]));
    }
    let d = Date {
        year: year(end)?,
        two: two(begin)?,
        is_told: false,
        is_short: false,
    };
    (fits(&d) != [false, false]).then_some(NameDate::YearLast(d))
}

/// Compares runs of digits by their number and other characters as text (`day9` before `day10`).
fn by_numbers(a: &str, b: &str) -> Ordering {
    let (mut x, mut y) = (a.as_bytes(), b.as_bytes());
    loop {
        let digits = |t: &[u8]| t.iter().take_while(|c| c.is_ascii_digit()).count();
        match (digits(x), digits(y)) {
            (0, _) | (_, 0) => match (x.split_first(), y.split_first()) {
                (None, None) => return a.cmp(b),
                (None, _) => return Ordering::Less,
                (_, None) => return Ordering::Greater,
                (Some((p, rx)), Some((q, ry))) if p == q => (x, y) = (rx, ry),
                (Some((p, _)), Some((q, _))) => return p.cmp(q),
            },
            (n, m) => {
                let ((p, rx), (q, ry)) = (x.split_at(n), y.split_at(m));
                let bare = |t: &[u8]| -> Vec<u8> {
                    t.iter().skip_while(|c| **c == b'0').copied().collect()
                };
                let (p, q) = (bare(p), bare(q));
                let order = p.len().cmp(&q.len()).then(p.cmp(&q));
                if order != Ordering::Equal {
                    return order;
                }
                (x, y) = (rx, ry);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sort_names(names: &[&str]) -> Result<Vec<String>, AmbiguousDays> {
        let order = DayOrder::from_names(names.iter().copied())?;
        let mut list: Vec<String> = names.iter().map(|n| (*n).to_owned()).collect();
        list.sort_by(|a, b| order.compare(a, b));
        Ok(list)
    }

    #[test]
    fn days_are_ordered_by_the_calendar_or_by_their_numbers() {
        for days in [
            // Days are ordered as numbers.
            &[
                "1",
                "02",
                "2026-05-01",
                "2026-05-02",
                "day9",
                "day09b",
                "day10",
            ][..],
            &["20260228", "20260301", "20261001"],
            &["2026-05-01_2", "2026-05-01_10", "2026-05-02_1"],
            &["w22", "w23"],
            &["12.11.9", "12.11.10"],
            // Day first: points, month names or a day beyond twelve determine the order.
            &["31.12.2025", "02.01.2026", "01.02.2026"],
            &["30.4.2026 10.15", "30.4.2026 9.15", "1.5.2026"],
            &["31.12.25", "02.01.26", "01.02.26"],
            &["02-11-2025", "13-11-2025", "01-12-2025"],
            &["31122025", "02012026"],
            &["30-Apr-2026", "1-May-2026", "02-Jun-2026"],
            &["day 30Apr2026", "day 1May2026"],
            &["28_Feb_2026", "1_März_2026", "2_Okt_2026"],
            // Month first.
            &["11-30-2025", "01-02-2026", "02-01-2026"],
            &["2026-Feb-11", "2026-Mar-01"],
            // Both orders give the same result.
            &["01-01-2026", "02-02-2026", "03-03-2026"],
            // Dates in both notations with a known order.
            &["31.12.2025", "2026-01-01", "01.02.2026"],
        ] {
            let mut expected: Vec<String> = days.iter().map(|d| (*d).to_owned()).collect();
            if days[0].starts_with("30.4.2026 10") {
                expected.swap(0, 1);
            }
            let mut turned = days.to_vec();
            turned.reverse();
            assert_eq!(sort_names(&turned), Ok(expected));
        }
    }

    #[test]
    fn days_that_nobody_can_order_are_said() {
        for days in [
            &["05-06-2026", "06-05-2026"][..],
            &["05062026", "06052026"],
            &["13-05-2026", "05-13-2026"],
            &["31.05.2026", "day 4"],
        ] {
            let said = sort_names(days).unwrap_err();
            assert!(
                said.wrong.contains(days[0]) || said.wrong.contains(days[1]),
                "{said:?}"
            );
        }
    }
}
