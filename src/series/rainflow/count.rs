//! Rainflow counting, sample by sample.

/// A sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Its number in the record.
    pub at: usize,
    /// Its value.
    pub value: f64,
}

/// A counted cycle (`count` 1) or half cycle (0.5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cycle {
    /// The reversal that came first.
    pub from: Point,
    /// The other.
    pub to: Point,
    /// 1 or 0.5.
    pub count: f64,
}

impl Cycle {
    /// Largest less smallest.
    pub fn range(&self) -> f64 {
        (self.to.value - self.from.value).abs()
    }

    /// Middle between both.
    pub fn mean(&self) -> f64 {
        0.5 * (self.to.value + self.from.value)
    }
}

/// A count under way. It remembers the reversals whose ranges are still open, each smaller than the one before it, and nothing else
/// of the record.
///
/// # Reference
/// ASTM E1049-85, section 5.4.4, rainflow counting.
#[derive(Clone, Debug, Default)]
pub struct Rainflow {
    open: Vec<Point>,
    /// The latest sample, which is a reversal where the next one turns back.
    latest: Option<Point>,
}

impl Rainflow {
    /// Takes the next sample; `counted` gets every cycle that closes. A value that is not finite is passed over.
    pub fn push(&mut self, point: Point, counted: &mut impl FnMut(Cycle)) {
        if !point.value.is_finite() {
            return;
        }
        let Some(latest) = self.latest else {
            self.open.push(point);
            self.latest = Some(point);
            return;
        };
        if point.value == latest.value {
            return;
        }
        // The last open reversal is where the present rise or fall began.
        let began = self.open.last().map_or(latest.value, |p| p.value);
        if (point.value - latest.value) * (latest.value - began) < 0.0 {
            self.reversal(latest, counted);
        }
        self.latest = Some(point);
    }

    /// Counts what is left: the last sample is a reversal, and every open range half a cycle.
    pub fn finish(mut self, counted: &mut impl FnMut(Cycle)) {
        if let Some(latest) = self.latest
            && self.open.last() != Some(&latest)
        {
            self.reversal(latest, counted);
        }
        for pair in self.open.windows(2) {
            counted(Cycle {
                from: pair[0],
                to: pair[1],
                count: 0.5,
            });
        }
    }

    fn reversal(&mut self, point: Point, counted: &mut impl FnMut(Cycle)) {
        self.open.push(point);
        while let &[.., a, b, c] = self.open.as_slice() {
            if (c.value - b.value).abs() < (b.value - a.value).abs() {
                break;
            }
            let starts = self.open.len() == 3;
            let count = if starts { 0.5 } else { 1.0 };
            counted(Cycle {
                from: a,
                to: b,
                count,
            });
            if starts {
                self.open.remove(0);
            } else {
                self.open.truncate(self.open.len() - 3);
                self.open.push(c);
            }
        }
    }
}
