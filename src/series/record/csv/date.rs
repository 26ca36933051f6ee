//! Date and time in one field.

/// Seconds since 1970 of a date with a time: `2026-05-01 12:00:00.002`, `2026-05-01T12:00:00,002Z`, `01.05.2026 12:00:00`,
/// `2026/05/01 12:00:00`. A time zone other than `Z` is refused, so are dates whose day and month could be exchanged (`05/01/2026`).
pub fn seconds(field: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(field).ok()?.trim();
    let (date, time) = text.split_once([' ', 'T'])?;
    let (y, m, d) = if let Some((d, rest)) = date.split_once('.') {
        let (m, y) = rest.split_once('.')?;
        (y, m, d)
    } else {
        let mark = if date.contains('/') { '/' } else { '-' };
        let (y, rest) = date.split_once(mark)?;
        let (m, d) = rest.split_once(mark)?;
        (y, m, d)
    };
    if y.len() != 4 {
        return None;
    }
    let whole = |t: &str| {
        (!t.is_empty() && t.len() <= 4 && t.bytes().all(|b| b.is_ascii_digit()))
            .then(|| t.parse::<i64>().ok())?
    };
    let (y, m, d) = (whole(y)?, whole(m)?, whole(d)?);
    if !(1..=12).contains(&m) || !(1..=31).contains(&d) {
        return None;
    }
    let time = time.trim().trim_end_matches('Z');
    let mut parts = time.split(':');
    let (h, min) = (whole(parts.next()?)?, whole(parts.next()?)?);
    let s: f64 = match parts.next() {
        Some(t)
            if t.bytes()
                .all(|b| b.is_ascii_digit() || b == b'.' || b == b',') =>
        {
            t.replace(',', ".").parse().ok()?
        }
        Some(_) => return None,
        None => 0.0,
    };
    if parts.next().is_some() || h > 23 || min > 59 || s >= 61.0 {
        return None;
    }
    Some((days(y, m, d) * 86_400 + h * 3600 + min * 60) as f64 + s)
}

/// Decimals of the seconds.
pub fn decimals(field: &[u8]) -> usize {
    let end = field.trim_ascii();
    let digits = end.rsplit(|b| *b == b':').next().unwrap_or_default();
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
        assert_eq!(decimals(b"2026-05-01 12:00:00.250"), 3);
        for text in [
            "12.5",
            "05/01/2026 12:00:00",
            "2026-13-01 12:00:00",
            "",
            "2026-05-01 25:00",
        ] {
            assert_eq!(seconds(text.as_bytes()), None, "{text}");
        }
    }
}
