//! Determines whether commas or points are the decimal marks of a table with semicolons or tabs as delimiters, and the mark between thousands.

use super::text::decode_field;
use crate::series::number::{DecimalMark, number};

/// Remedy for an ambiguous decimal mark.
pub const REMEDY: &str = "write numbers without marks between thousands, and all with a decimal point or all with a decimal comma";

/// Numbers of each kind in a column that are enough to test numbers with a mark against numbers without.
const SEVERAL: usize = 2;

/// Returns the decimal mark of the first rows. It is `mark` if no number has a decimal mark. An error contains the wrong row and a message.
pub fn find_decimal_mark(
    rows: &[Vec<&[u8]>],
    mark: DecimalMark,
) -> Result<DecimalMark, (usize, String)> {
    if mark == DecimalMark::Point {
        return Ok(mark);
    }
    let all = rows.iter().enumerate();
    let numbers: Vec<(usize, usize, &[u8])> = all
        .flat_map(|(r, row)| row.iter().enumerate().map(move |(c, f)| (r, c, *f)))
        .filter(|n| number(n.2, mark).is_some_and(f64::is_finite))
        .collect();
    let first = |b: u8| numbers.iter().find(|n| n.2.contains(&b));
    let (comma, point) = (first(b','), first(b'.'));
    if let (Some(a), Some(b)) = (comma, point) {
        let what = format!(
            "`{}` has a decimal comma and `{}` a decimal point, or one of them has a mark between thousands",
            decode_field(a.2),
            decode_field(b.2)
        );
        return Err((a.0.max(b.0), what));
    }
    let has_mark = |n: &&(usize, usize, &[u8])| n.2.contains(&b',') || n.2.contains(&b'.');
    // One fraction that cannot be a thousands group, such as a time of .01, decides.
    let unsure = numbers
        .iter()
        .filter(has_mark)
        .all(|n| may_be_thousands(n.2));
    let n = numbers.iter().map(|n| n.1 + 1).max().unwrap_or(0);
    for column in (0..n).filter(|_| unsure) {
        let of_column = numbers.iter().filter(|n| n.1 == column);
        let (marked, whole): (Vec<_>, Vec<_>) = of_column.partition(has_mark);
        let is_short = |f: &[u8]| f.iter().filter(|b| b.is_ascii_digit()).count() <= 3;
        if marked.len().min(whole.len()) >= SEVERAL
            && whole.iter().all(|n: &&(usize, usize, &[u8])| is_short(n.2))
            && let Some(n) = marked.first()
        {
            return Err((n.0, in_words(n.2)));
        }
    }
    Ok(match (comma, point) {
        (Some(_), _) => DecimalMark::Comma,
        (None, Some(_)) => DecimalMark::Point,
        (None, None) => mark,
    })
}

/// Returns the message about a number with an ambiguous mark.
pub fn in_words(field: &[u8]) -> String {
    format!(
        "`{}` may be a fraction, or a whole number with a mark between thousands",
        decode_field(field)
    )
}

/// Returns whether a mark in a number may separate thousands: one to three digits of which the first is not 0, a mark, three digits.
pub fn may_be_thousands(field: &[u8]) -> bool {
    let bare = field
        .strip_prefix(b"-")
        .or_else(|| field.strip_prefix(b"+"))
        .unwrap_or(field);
    let mut parts = bare.split(|b| matches!(b, b',' | b'.'));
    let (whole, rest) = (parts.next().unwrap_or_default(), parts.next());
    let digits = |f: &[u8]| f.iter().all(u8::is_ascii_digit);
    parts.next().is_none()
        && (1..=3).contains(&whole.len())
        && whole.first() != Some(&b'0')
        && digits(whole)
        && rest.is_some_and(|r| r.len() == 3 && digits(r))
}
