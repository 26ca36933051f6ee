//! Dates and times of day, in one field or in two.

use crate::series::record::time_unit::DAY;

/// Returns the seconds since 1970 of a date with a time: `2026-05-01 12:00:00.002`, `2026-05-01T12:00:00,002Z`, `01.05.2026 12:00:00`, `2026/05/01
/// 12:00:00`, `5/31/2026 1:05:09 PM`. An offset from UTC (`Z`, `+01:00`, `-0500`, `+01`) is subtracted. Dates whose day and month could be exchanged
/// (`05/01/2026`) are refused.
pub fn seconds(field: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(field).ok()?.trim();
    let (date, time) = text.split_once([' ', 'T'])?;
    let (time, offset_s) = without_offset(time.trim())?;
    Some(days_of(date)? as f64 * DAY + seconds_of_day(time)? - offset_s)
}

/// Splits a time of day into the time and its offset from UTC in seconds; `None` for an offset that cannot be.
fn without_offset(time: &str) -> Option<(&str, f64)> {
    if let Some(time) = time.strip_suffix(['Z', 'z']) {
        return Some((time.trim_end(), 0.0));
    }
    let Some(at) = time.rfind(['+', '-']) else {
        return Some((time, 0.0));
    };
    let (before, offset) = time.split_at(at);
    let (sign, offset) = offset.split_at(1);
    let (hours, minutes) = match (offset.split_once(':'), offset.len()) {
        (Some(parts), _) => parts,
        (None, 4) => offset.split_at_checked(2)?,
        (None, _) => (offset, "0"),
    };
    let (hours, minutes) = (parse_whole_number(hours)?, parse_whole_number(minutes)?);
    let size = (hours <= 14 && minutes < 60).then_some((hours * 3600 + minutes * 60) as f64)?;
    Some((before.trim_end(), if sign == "-" { -size } else { size }))
}

/// Returns whether a field is a date whose day and month could be exchanged, such as `3/1/2026 10:00:00 AM`.
pub fn is_ambiguous(field: &[u8]) -> bool {
    let text = std::str::from_utf8(field).unwrap_or_default().trim();
    let date = text.split([' ', 'T']).next().unwrap_or_default();
    let parts: Vec<&str> = date.split('/').collect();
    matches!(parts[..], [a, b, c] if c.len() == 4 && [a, b].iter().all(|p| parse_whole_number(p).is_some_and(|n| (1..=12).contains(&n))))
}

/// Returns the seconds since 1970 of a date in one field and a time of day in another field.
pub fn parse_date_and_time(one: &[u8], other: &[u8]) -> Option<f64> {
    let date = |field: &[u8]| days_of(std::str::from_utf8(field).ok()?.trim());
    let both =
        |date_in: &[u8], time_in: &[u8]| Some(date(date_in)? as f64 * DAY + of_day(time_in)?);
    both(one, other).or_else(|| both(other, one))
}

/// Returns the seconds since midnight of a time of day with seconds: `12:00:00.002`, `1:05:09 PM`. A time of two numbers is ambiguous, because it may
/// contain hours and minutes or minutes and seconds.
pub fn of_day(field: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(field).ok()?.trim();
    let parts = text.split(':').count();
    (parts == 3).then(|| seconds_of_day(text))?
}

/// Days since 1970.
fn days_of(date: &str) -> Option<i64> {
    let mark = ['.', '/', '-'].into_iter().find(|m| date.contains(*m))?;
    let mut parts = date.split(mark);
    let [a, b, c] = [parts.next()?, parts.next()?, parts.next()?];
    let [x, y, z] = [
        parse_whole_number(a)?,
        parse_whole_number(b)?,
        parse_whole_number(c)?,
    ];
    let (year, month, day) = match (mark, a.len(), c.len()) {
        ('.', _, 4) => (z, y, x),
        ('/' | '-', 4, _) => (x, y, z),
        // The month is known if the other number exceeds 12, or if both are equal.
        ('/', _, 4) if y > 12 => (z, x, y),
        ('/', _, 4) if x > 12 || x == y => (z, y, x),
        _ => return None,
    };
    let is_date = parts.next().is_none() && (1..=12).contains(&month) && (1..=31).contains(&day);
    is_date.then(|| days(year, month, day))
}

/// Hours, minutes and seconds (none stated: 0), of twelve hours if `AM` or `PM` follows them.
fn seconds_of_day(time: &str) -> Option<f64> {
    let time = time.trim();
    let half = time
        .len()
        .checked_sub(2)
        .and_then(|at| time.split_at_checked(at));
    let (time, noon) = match half {
        Some((t, m)) if m.eq_ignore_ascii_case("AM") => (t.trim_end(), Some(0)),
        Some((t, m)) if m.eq_ignore_ascii_case("PM") => (t.trim_end(), Some(12)),
        _ => (time, None),
    };
    let mut parts = time.split(':');
    let (hour, minute) = (
        parse_whole_number(parts.next()?)?,
        parse_whole_number(parts.next()?)?,
    );
    let second: f64 = match parts.next() {
        Some(t)
            if t.bytes()
                .all(|b| b.is_ascii_digit() || b == b'.' || b == b',') =>
        {
            t.replace(',', ".").parse().ok()?
        }
        Some(_) => return None,
        None => 0.0,
    };
    let hour = match noon {
        Some(noon) => (1..=12).contains(&hour).then_some(hour % 12 + noon)?,
        None => hour,
    };
    if parts.next().is_some() || hour > 23 || minute > 59 || second >= 61.0 {
        return None;
    }
    Some((hour * 3600 + minute * 60) as f64 + second)
}

/// A whole number of four digits at most.
fn parse_whole_number(text: &str) -> Option<i64> {
    let is_short = !text.is_empty() && text.len() <= 4;
    (is_short && text.bytes().all(|b| b.is_ascii_digit())).then(|| text.parse().ok())?
}

/// Returns the decimals of the seconds.
pub fn decimals(field: &[u8]) -> usize {
    let end = field.trim_ascii();
    let digits = end.splitn(3, |b| *b == b':').last().unwrap_or_default();
    digits
        .iter()
        .position(|b| matches!(b, b'.' | b','))
        .map_or(0, |n| {
            let rest = digits.get(n + 1..).unwrap_or_default();
            rest.iter().take_while(|b| b.is_ascii_digit()).count()
        })
}

/// Days from 1 January 1970 in the Gregorian calendar.
///
/// # Reference
/// H. Hinnant, chrono-compatible low-level date algorithms, `days_from_civil`.
fn days(year: i64, month: i64, day: i64) -> i64 {
    let y = if month <= 2 { year - 1 } else { year };
    let era = y.div_euclid(400);
    let of_era = y - era * 400;
    let of_year = (153 * (month + if month > 2 { -3 } else { 9 }) + 2) / 5 + day - 1;
    era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719_468
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_of_loggers_are_seconds_since_1970() {
        // 1 May 2026 is 20,574 days after 1 January 1970: 56 years of 365 days, 14 leap days, 120 days.
        let noon = f64::from((56 * 365 + 14 + 120) * 86_400 + 43_200);
        for text in [
            "2026-05-01 12:00:00.250",
            "2026-05-01T12:00:00,250Z",
            "01.05.2026 12:00:00.250",
            "2026/05/01 12:00:00.25",
        ] {
            assert_eq!(seconds(text.as_bytes()), Some(noon + 0.25), "{text}");
        }
        for text in [
            "2026-05-01 14:00:00.250+02:00",
            "2026-05-01T07:00:00.25-0500",
            "2026-05-01T13:00:00,25+01",
            "2026-05-02T01:45:00.25 +13:45",
        ] {
            assert_eq!(seconds(text.as_bytes()), Some(noon + 0.25), "{text}");
        }
        assert_eq!(decimals(b"2026-05-01 12:00:00.250+02:00"), 3);
        assert!(is_ambiguous(b"05/01/2026 12:00:00") && is_ambiguous(b"3/1/2026 1:00:00 AM"));
        assert!(!is_ambiguous(b"5/31/2026 1:05:09 PM") && !is_ambiguous(b"12.5"));
        for text in ["5/31/2026 1:05:09.5 PM", "31/5/2026 13:05:09.5"] {
            let may = f64::from((56 * 365 + 14 + 150) * 86_400 + 47_109);
            assert_eq!(seconds(text.as_bytes()), Some(may + 0.5), "{text}");
        }
        assert_eq!(parse_date_and_time(b"2026-05-01", b"12:00:00"), Some(noon));
        assert_eq!(
            parse_date_and_time(b"12:00:00 pm", b"01.05.2026"),
            Some(noon)
        );
        assert_eq!(of_day(b"12:00:30,25 AM"), Some(30.25));
        for text in ["12:30", "13:00:00 PM", "0:00:00 AM", "24:00:00", "1.5"] {
            assert_eq!(of_day(text.as_bytes()), None, "{text}");
        }
        assert_eq!(decimals(b"2026-05-01 12:00:00.250"), 3);
        for text in [
            "12.5",
            "05/01/2026 12:00:00",
            "2026-13-01 12:00:00",
            "",
            "2026-05-01 25:00",
            "2026-05-01 12:00:00+25:00",
            "2026-05-01 12:00:00+",
        ] {
            assert_eq!(seconds(text.as_bytes()), None, "{text}");
        }
    }
}
