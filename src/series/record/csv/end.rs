//! Whether the last line of a table is whole.

use super::text::{Encoding, field_end};

/// Lines before the last line that show how its last field is written.
const TELLING: usize = 8;

/// Returns the start of the last line if that line may be cut within its last field: `131.9` cut is `131.`, `131` or nothing. Such a line has no end
/// of line although other lines have one.
///
/// A last field with as many characters after the point as the fields before it is complete. Other code refuses a line with fewer fields than the
/// line before. If the file has only two lines, the first may be the header. The two lines then give no information.
pub fn unsure_end(bytes: &[u8]) -> Option<usize> {
    let (start, lines) = last_lines(bytes);
    let (last, before) = lines.split_first()?;
    let previous = before.first().filter(|_| before.len() > 1)?;
    let blank = last.iter().all(|b| b.is_ascii_whitespace());
    if blank || last.first() == Some(&b'#') || matches!(last.last(), Some(b'\r' | b'\n')) {
        return None;
    }
    let delimiter = delimiter_of(previous);
    let (n, own) = last_field(last, delimiter);
    if n < last_field(previous, delimiter).0 {
        return None;
    }
    // With only a few rows, the first line may be the header.
    let rows = before.get(..before.len().min(TELLING) - 1)?;
    let alike = |line: &Vec<u8>| {
        let (fields, field) = last_field(line, delimiter);
        fields == n && after_point(field) == after_point(own)
    };
    let whole = after_point(own) != Some(0) && after_point(own).is_some() && rows.iter().all(alike);
    // A delimiter ends every line.
    let closed = own.is_empty() && rows.iter().all(|r| last_field(r, delimiter) == (n, own));
    (!whole && !closed).then_some(start)
}

/// Returns whether the last line, which [`unsure_end`] has found, is certainly cut. Its last number then lacks a part that the other numbers of its
/// column have. The part may be digits after the point (`has_fewer_digits`), the point or the exponent (`lacks_a_part`).
pub fn is_cut(bytes: &[u8]) -> bool {
    if unsure_end(bytes).is_none() {
        return false;
    }
    let (_, lines) = last_lines(bytes);
    let [last, rows @ .., _] = lines.as_slice() else {
        return false;
    };
    let Some(previous) = rows.first() else {
        return false;
    };
    let delimiter = delimiter_of(previous);
    let own = last_field(last, delimiter).1;
    !own.is_empty()
        && (has_fewer_digits(own, rows, delimiter) || lacks_a_part(own, rows, delimiter))
}

/// Returns whether every column of `rows` has its number of characters after the point, and the last number `own` has fewer.
fn has_fewer_digits(own: &[u8], rows: &[Vec<u8>], delimiter: u8) -> bool {
    /// Least count of numbers. One of ten ends in a zero, which a person leaves out: so many have equal digits by chance once in seventy.
    const NUMBERS: usize = 40;
    let Some(previous) = rows.first() else {
        return false;
    };
    let expected: Vec<Option<usize>> = (fields(previous, delimiter).iter())
        .map(|f| after_point(f))
        .collect();
    let is_alike = |row: &Vec<u8>| {
        let found = fields(row, delimiter);
        found.len() == expected.len()
            && found
                .iter()
                .zip(&expected)
                .all(|(f, e)| after_point(f) == *e)
    };
    let is_shorter = match expected.last() {
        Some(Some(digits)) => after_point(own).unwrap_or(0) < *digits,
        _ => false,
    };
    let numbers = rows.len() * expected.iter().flatten().filter(|d| **d > 0).count();
    is_shorter && numbers >= NUMBERS && rows.iter().all(is_alike)
}

/// Whether the last number `own` lacks the point, the exponent or a part of the exponent that all numbers of its column have. Lost digits after the
/// point change a value little, but lost characters before it change the value completely.
fn lacks_a_part(own: &[u8], rows: &[Vec<u8>], delimiter: u8) -> bool {
    /// Smallest number of rows to compare with.
    const ROWS: usize = 5;
    /// Digits after the point that a number has by chance all zero, and not written, once in a hundred.
    const DIGITS: usize = 2;
    if rows.len() < ROWS {
        return false;
    }
    let column: Vec<&[u8]> = rows.iter().map(|r| last_field(r, delimiter).1).collect();
    let after: Option<Vec<usize>> = column.iter().map(|f| after_point(f)).collect();
    let exponents: Option<Vec<usize>> = column.iter().map(|f| exponent(f)).collect();
    if let Some(characters) = exponents {
        let least = characters.iter().copied().min().unwrap_or(0);
        return exponent(own).is_none_or(|n| n < least);
    }
    // A program that writes `12.0` always writes a point.
    let always = column.iter().any(|f| f.ends_with(b".0"));
    after_point(own).is_none()
        && exponent(own).is_none()
        && after.is_some_and(|all| always || all.iter().all(|d| *d >= DIGITS))
}

/// Characters of the exponent of a number, its sign among them; `None` where it has none.
fn exponent(field: &[u8]) -> Option<usize> {
    let at = field.iter().rposition(|b| matches!(b, b'e' | b'E'))?;
    let is_number = field.first().is_some_and(|b| !b.is_ascii_alphabetic());
    is_number.then_some(field.len() - at - 1)
}

/// Returns the begin of the last line, and the last lines of the text in reverse order.
fn last_lines(bytes: &[u8]) -> (usize, Vec<Vec<u8>>) {
    let (encoding, begin) = Encoding::detect(bytes);
    let last = last_line(encoding, bytes, bytes.len());
    let mut starts = vec![last];
    while let Some(at) = starts.last().copied().filter(|at| *at > begin)
        && starts.len() <= TELLING
    {
        starts.push(last_line(encoding, bytes, at - encoding.unit()));
    }
    let mut ends = vec![bytes.len()];
    ends.extend(starts.iter().copied());
    let lines = starts.iter().zip(ends).map(|(from, to)| {
        encoding
            .text(bytes.get(*from..to).unwrap_or_default())
            .into_owned()
    });
    (last, lines.collect())
}

/// Returns the delimiter of a line; semicolon and tab precede the comma, which numbers may contain.
fn delimiter_of(line: &[u8]) -> u8 {
    let divides = |d: &u8| line.contains(d);
    [b';', b'\t'].into_iter().find(divides).unwrap_or(b',')
}

/// Returns the begin of the line that ends before `end`.
fn last_line(encoding: Encoding, bytes: &[u8], end: usize) -> usize {
    let unit = encoding.unit();
    let begin = Encoding::detect(bytes).1;
    let text = bytes.get(begin..end).unwrap_or_default();
    match encoding {
        Encoding::Bytes => memchr::memrchr(b'\n', text).map_or(begin, |n| begin + n + 1),
        Encoding::Utf16Le | Encoding::Utf16Be => {
            let mut pairs = text.chunks_exact(unit);
            let is_end = |pair: &[u8]| encoding.lines(pair) == 1;
            pairs
                .rposition(is_end)
                .map_or(begin, |n| begin + unit * (n + 1))
        }
    }
}

/// Number of fields of a line, and the last of them.
fn last_field(line: &[u8], delimiter: u8) -> (usize, &[u8]) {
    let all = fields(line, delimiter);
    (all.len(), all.last().copied().unwrap_or_default())
}

/// The fields of a line.
fn fields(line: &[u8], delimiter: u8) -> Vec<&[u8]> {
    let (mut found, mut rest) = (Vec::new(), line);
    loop {
        let end = field_end(rest, delimiter);
        let (field, after) = rest.split_at_checked(end).unwrap_or((rest, &[]));
        found.push(field.trim_ascii());
        match after.split_first() {
            Some((d, next)) if *d == delimiter => rest = next,
            _ => return found,
        }
    }
}

/// Returns the number of characters after the decimal point or comma; `None` for a field without one.
fn after_point(field: &[u8]) -> Option<usize> {
    let at = field.iter().rposition(|b| matches!(b, b'.' | b','))?;
    Some(field.len() - at - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(rows: &[&str]) -> String {
        let mut text = "time,A [um/m],B [um/m]\n".to_owned();
        rows.iter().for_each(|r| text += &format!("{r}\n"));
        text
    }

    #[test]
    fn a_last_number_that_was_cut_is_not_taken_for_whole() {
        let text = table(&["0.00,1.5,130.2", "0.01,1.6,128.4", "0.02,1.7,131.9"]);
        let start = text.rfind("0.02").unwrap();
        assert_eq!(unsure_end(text.as_bytes()), None);
        // Only the line end is missing.
        assert_eq!(unsure_end(&text.as_bytes()[..text.len() - 1]), None);
        for less in 2..=6 {
            let cut = &text.as_bytes()[..text.len() - less];
            assert_eq!(unsure_end(cut), Some(start), "{less}");
        }
        // The last row lacks fields. The reader, not this function, reports this fault.
        let cut = &text.as_bytes()[..text.len() - 7];
        assert_eq!(unsure_end(cut), None);
        let returns = text.replace('\n', "\r\n");
        assert_eq!(unsure_end(&returns.as_bytes()[..returns.len() - 1]), None);
        assert!(unsure_end(&returns.as_bytes()[..returns.len() - 3]).is_some());
    }

    #[test]
    fn a_number_with_fewer_digits_than_all_of_a_printed_table_is_cut_beyond_doubt() {
        let row = |i: usize| format!("R{i},{}", ["1.20"; 7].join(",")) + "\n";
        let rows: String = (0..9).map(row).collect();
        let text = format!("run,A,B,C,D,E,F,G\n{rows}");
        for (less, cut) in [
            (0, false),
            (1, false),
            (2, true),
            (3, true),
            (4, true),
            (5, false),
        ] {
            let bytes = &text.as_bytes()[..text.len() - less];
            assert_eq!(is_cut(bytes), cut, "{less}");
        }
        // Numbers without trailing zeros, then a table of few rows.
        let written = text.replacen("1.20", "1.2", 40);
        assert!(!is_cut(&written.as_bytes()[..written.len() - 2]));
        let few = table(&["0.00,1.5,130.2", "0.01,1.6,128.4", "0.02,1.7,131.9"]);
        assert!(!is_cut(&few.as_bytes()[..few.len() - 2]));
    }

    #[test]
    fn a_number_without_the_point_or_the_exponent_of_its_column_is_cut_beyond_doubt() {
        let table = |column: [&str; 6], last: &str| {
            let rows = column.map(|v| format!("R,{v}")).join("\n");
            format!("run,A\n{rows}\nR,{last}")
        };
        // Each number has as many digits as it needs.
        let free = [
            "1234.25",
            "987.125",
            "1001.03125",
            "-55.75",
            "1200.8125",
            "640.25",
        ];
        for (last, expected) in [
            ("1999", true),
            ("1", true),
            ("-7", true),
            ("1999.", false),
            ("1999.2", false),
            ("", false),
        ] {
            assert_eq!(is_cut(table(free, last).as_bytes()), expected, "{last}");
        }
        // One digit that is never zero proves little. A written trailing zero proves that the point is always written.
        let one = ["1234.2", "987.1", "1001.3", "-55.7", "1200.8", "640.2"];
        assert!(!is_cut(table(one, "19").as_bytes()));
        let written = ["1234.2", "987.1", "1001.0", "-55.7", "1200.8", "640.2"];
        assert!(is_cut(table(written, "19").as_bytes()));
        let powers = "run,A\n".to_owned() + &"R,1.25e-05\n".repeat(6);
        for (last, expected) in [
            ("1.25", true),
            ("1.25e-0", true),
            ("1.25e-", true),
            ("1.5e-05", false),
        ] {
            assert_eq!(
                is_cut(format!("{powers}R,{last}").as_bytes()),
                expected,
                "{last}"
            );
        }
    }

    #[test]
    fn numbers_of_any_length_can_not_be_told_from_cut_ones() {
        let text = table(&["0,1.5,130", "1,1.6,128.45", "2,1.7,131.9"]);
        assert!(unsure_end(&text.as_bytes()[..text.len() - 1]).is_some());
        let semicolons = "run;A;B\nR1;1,5;2,25;\nR2;1,5;2,35;\nR3;1,5;2,45;";
        assert_eq!(unsure_end(semicolons.as_bytes()), None);
        for nothing in ["", "\n", "a", "time,A\n0,1", "# only\n# comments\n# here"] {
            assert_eq!(unsure_end(nothing.as_bytes()), None, "{nothing}");
        }
    }

    #[test]
    fn text_of_two_bytes_a_character_is_judged_alike() {
        let text = table(&["0.00,1.5,130.2", "0.01,1.6,128.4", "0.02,1.7,131."]);
        let mut bytes = vec![0xff, 0xfe];
        text.trim_end()
            .encode_utf16()
            .for_each(|u| bytes.extend(u.to_le_bytes()));
        let start = 2 + 2 * text.rfind("0.02").unwrap();
        assert_eq!(unsure_end(&bytes), Some(start));
        bytes.extend([b'\n', 0]);
        assert_eq!(unsure_end(&bytes), None);
    }
}
