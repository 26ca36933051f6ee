//! Points in time as TDMS stores them.

/// A point in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Stamp {
    /// Seconds since 1904.
    seconds: i64,
    /// Fractions of 2^-64 s.
    fraction: u64,
}

impl Stamp {
    /// Reads one time stamp. `None` if there are too few bytes.
    pub fn from_bytes(bytes: &[u8], big: bool) -> Option<Self> {
        let (a, b) = bytes.split_first_chunk::<8>()?;
        let b = b.first_chunk::<8>()?;
        Some(match big {
            true => Self {
                seconds: i64::from_be_bytes(*a),
                fraction: u64::from_be_bytes(*b),
            },
            false => Self {
                seconds: i64::from_le_bytes(*b),
                fraction: u64::from_le_bytes(*a),
            },
        })
    }

    /// Returns the seconds from `begin` to this time stamp.
    pub fn seconds_since(self, begin: Self) -> f64 {
        let fraction = self.fraction as f64 - begin.fraction as f64;
        self.seconds.saturating_sub(begin.seconds) as f64 + fraction * 2_f64.powi(-64)
    }

    /// Returns the seconds since 1970.
    pub fn since_1970(self) -> f64 {
        /// 66 years, of which 17 have 366 days.
        const FROM_1904: i64 = (66 * 365 + 17) * 86_400;
        self.seconds_since(Self {
            seconds: FROM_1904,
            fraction: 0,
        })
    }
}
