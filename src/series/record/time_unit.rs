//! Units of times, recognised by the size of the numbers where the file states none.

/// Rates of records, Hz: without a stated unit of time a rate outside of this range is doubtful.
pub const USUAL_RATES_HZ: [f64; 2] = [0.2, 1e5];
/// Relative error of a rate that its times are read from.
const RATE: f64 = 1e-6;

/// Days since 30 December 1899 that spreadsheets write for the years 2009 to 2064.
const SERIAL_DAYS: [f64; 2] = [4e4, 6e4];
/// Seconds since 1970 at the beginning of 2000 and of 2100.
const THIS_CENTURY_S: [f64; 2] = [946_684_800.0, 4_102_444_800.0];
/// Days from 30 December 1899 to 1970.
const TO_1970: f64 = 25_569.0;
/// Seconds of a day.
pub(super) const DAY: f64 = 86_400.0;
/// Intervals of slow loggers, s.
const SLOW_S: [f64; 5] = [10.0, 15.0, 20.0, 30.0, 60.0];

/// Unit of a column of times, recognised by its size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeUnit {
    /// Days of a spreadsheet.
    SerialDays,
    /// Seconds since 1970.
    EpochSeconds,
    /// Milliseconds since 1970.
    EpochMilliseconds,
    /// Microseconds since 1970.
    EpochMicroseconds,
    /// Nanoseconds since 1970.
    EpochNanoseconds,
}

impl TimeUnit {
    /// Returns the unit of times that begin with `first` and are `step` apart. `None` if their size does not show it.
    pub(super) fn from_times(first: f64, step: f64) -> Option<Self> {
        let within = |x: f64, [from, to]: [f64; 2]| (from..=to).contains(&x);
        if within(first, SERIAL_DAYS) {
            let seconds = step * DAY;
            // Interpreted as seconds, these numbers would imply a far faster logger.
            let slow = SLOW_S.iter().any(|s| (seconds / s - 1.0).abs() < 1e-3);
            return (is_usual(1.0 / seconds) || slow).then_some(Self::SerialDays);
        }
        let since_1970 = [
            Self::EpochSeconds,
            Self::EpochMilliseconds,
            Self::EpochMicroseconds,
            Self::EpochNanoseconds,
        ];
        let of = |unit: &Self| {
            let second = unit.seconds();
            within(first * second, THIS_CENTURY_S) && is_usual(1.0 / (step * second))
        };
        since_1970.into_iter().find(of)
    }

    /// Returns the seconds in one unit.
    pub fn seconds(self) -> f64 {
        match self {
            Self::SerialDays => DAY,
            Self::EpochSeconds => 1.0,
            Self::EpochMilliseconds => 1e-3,
            Self::EpochMicroseconds => 1e-6,
            Self::EpochNanoseconds => 1e-9,
        }
    }

    /// Returns the seconds since 1970 of a time.
    pub(super) fn since_1970(self, time: f64) -> f64 {
        match self {
            Self::SerialDays => (time - TO_1970) * DAY,
            _ => time * self.seconds(),
        }
    }

    /// Returns the name of the unit for messages.
    pub fn words(self) -> &'static str {
        match self {
            Self::SerialDays => "days of a spreadsheet (since 30 December 1899)",
            Self::EpochSeconds => "seconds since 1970",
            Self::EpochMilliseconds => "milliseconds since 1970",
            Self::EpochMicroseconds => "microseconds since 1970",
            Self::EpochNanoseconds => "nanoseconds since 1970",
        }
    }
}

/// Returns the rounding, s, of times stored as 32-bit reals in units of `second` seconds. It is 2^-24 of the last time of a day's record.
pub(super) fn single_rounding_s(second: f64) -> f64 {
    DAY * 6e-8 * second.abs()
}

/// Returns whether records usually have this rate, Hz.
pub fn is_usual(rate_hz: f64) -> bool {
    let [slowest, fastest] = USUAL_RATES_HZ;
    (slowest * (1.0 - RATE)..=fastest * (1.0 + RATE)).contains(&rate_hz)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_recognised_by_their_size_and_step() {
        use TimeUnit as T;
        // 1 May 2026, 12:00 UTC: 20,574.5 days after 1970.
        let noon = 20_574.5 * DAY;
        for (first, step, expected) in [
            (46_143.5, 0.01 / DAY, Some(T::SerialDays)),
            (46_143.5, 1.0 / DAY, Some(T::SerialDays)),
            (46_143.5, 60.0 / DAY, Some(T::SerialDays)),
            // A later record of a long measurement, with times in seconds.
            (46_143.5, 0.001, None),
            (46_143.5, 0.01, None),
            (noon, 0.01, Some(T::EpochSeconds)),
            (noon * 1e3, 10.0, Some(T::EpochMilliseconds)),
            (noon * 1e6, 1e4, Some(T::EpochMicroseconds)),
            (noon * 1e9, 1e7, Some(T::EpochNanoseconds)),
            // Microseconds since a logger was switched on.
            (1.2e9, 1e4, None),
            (0.0, 0.01, None),
            (0.0, 10.0, None),
        ] {
            assert_eq!(T::from_times(first, step), expected, "{first} {step}");
        }
        assert!((T::SerialDays.since_1970(46_143.5) - noon).abs() < 1e-3);
    }

    #[test]
    fn rates_at_the_limits_are_usual() {
        for (rate, usual) in [(0.2, true), (1e5, true), (0.1, false), (2e5, false)] {
            assert_eq!(is_usual(rate), usual, "{rate}");
        }
        assert!(!is_usual(f64::NAN));
    }
}
