//! Rainflow counting by four points, sample by sample.

/// A sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Number of the sample in the record.
    pub at: usize,
    /// Value of the point.
    pub value: f64,
}

/// A counted cycle (`count` 1) or half cycle (0.5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cycle {
    /// First reversal of the cycle.
    pub from: Point,
    /// Value of the second reversal of the cycle.
    pub to: Point,
    /// Count of the cycle: 1, or 0.5 for a half cycle.
    pub count: f64,
}

impl Cycle {
    /// Returns the range: largest minus smallest value.
    pub fn range(&self) -> f64 {
        (self.to.value - self.from.value).abs()
    }

    /// Returns the mean of both values.
    pub fn mean(&self) -> f64 {
        0.5 * (self.to.value + self.from.value)
    }
}

/// A reversal and its tag, such as the values of other signals at that time.
#[derive(Clone, Debug, PartialEq)]
pub struct Reversal<T> {
    /// The sample.
    pub point: Point,
    /// Tag of the reversal.
    pub tag: T,
}

/// A rainflow count in progress. Its state is the reversals that no cycle has closed yet (the residue, in time order).
///
/// A cycle from B to C closes when the reversal A before it and the one after it, D, reach at least as far. Of reversals of equal value the
/// later counts as the higher. The cycles of a history therefore do not depend on the order in which they are found.
///
/// A count that gets the residues of the parts of a history, in sequence, closes exactly the cycles that the parts could not. Full cycles and
/// the residue's ranges as half cycles are the count of ASTM E1049 ([`Rainflow::finish`]). The half cycles of parts do not add up to the half
/// cycles of the whole; the residues do.
///
/// # Reference
/// C. Amzallag, J.P. Gerey, J.L. Robert, J. Bahuaud, Standardization of the rainflow counting method for fatigue analysis, Int. J. Fatigue
/// 16 (1994) 287-293; ASTM E1049-85, section 5.4.4.
///
/// # Example
/// The history of ASTM E1049, figure 6:
/// ```
/// use std::collections::BTreeMap;
/// use strainbridge::series::rainflow::{Cycle, Point, Rainflow};
///
/// let mut counts: BTreeMap<i32, f64> = BTreeMap::new();
/// let mut add = |c: Cycle| *counts.entry(c.range() as i32).or_default() += c.count;
/// let mut count = Rainflow::default();
/// for (at, value) in [-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0].into_iter().enumerate() {
///     count.push(Point { at, value }, &mut add);
/// }
/// count.finish(&mut add);
/// // Cycles by range, from the table of the standard.
/// assert_eq!(counts, BTreeMap::from([(3, 0.5), (4, 1.5), (6, 0.5), (8, 1.0), (9, 0.5)]));
/// ```
#[derive(Clone, Debug)]
pub struct Rainflow<T = ()> {
    open: Vec<Reversal<T>>,
    /// The latest sample; it is a reversal if the next sample changes direction.
    latest: Option<Point>,
}

/// Receiver of the reversals and cycles of a count in progress.
pub(super) trait Listener<T> {
    /// Returns the tag of a sample that is now a reversal.
    fn tag(&mut self, point: Point) -> T;
    /// Receives a closed cycle by its two reversals, which the count then drops.
    fn add_cycle(&mut self, from: &Reversal<T>, to: &Reversal<T>);
}

/// Listener from two functions: tag of a reversal, closed cycle.
struct FunctionListener<F, G>(F, G);

impl<T, F: FnMut(Point) -> T, G: FnMut(&Reversal<T>, &Reversal<T>)> Listener<T>
    for FunctionListener<F, G>
{
    #[inline(always)]
    fn tag(&mut self, point: Point) -> T {
        (self.0)(point)
    }

    #[inline(always)]
    fn add_cycle(&mut self, from: &Reversal<T>, to: &Reversal<T>) {
        (self.1)(from, to);
    }
}

impl<T> Default for Rainflow<T> {
    fn default() -> Self {
        Self {
            open: Vec::new(),
            latest: None,
        }
    }
}

impl<T> Rainflow<T> {
    /// Takes the next sample. A value that is not finite is ignored.
    #[inline(always)]
    pub(super) fn push_tagged(&mut self, point: Point, listener: &mut impl Listener<T>) {
        if !point.value.is_finite() {
            return;
        }
        let Some(latest) = self.latest else {
            let tag = listener.tag(point);
            self.open.push(Reversal { point, tag });
            self.latest = Some(point);
            return;
        };
        if point.value == latest.value {
            return;
        }
        // The present rise or fall began at the last open reversal.
        let began = self.open.last().map_or(latest.value, |r| r.point.value);
        if (point.value > latest.value) != (latest.value > began) && latest.value != began {
            let tag = listener.tag(latest);
            self.reversal(Reversal { point: latest, tag }, listener);
        }
        self.latest = Some(point);
    }

    /// Takes consecutive samples, of which the first is sample `first` of the record. The result equals [`Rainflow::push_tagged`] for each sample.
    /// `turns` is working memory for as many numbers.
    #[inline(always)]
    pub(super) fn push_block(
        &mut self,
        first: usize,
        values: &[f64],
        turns: &mut [u32],
        listener: &mut impl Listener<T>,
    ) {
        let began = self.open.last().map(|r| r.point.value);
        let under_way = self.latest.zip(began).filter(|(l, b)| l.value != *b);
        let (latest, began) = under_way.unwrap_or((Point { at: 0, value: 0.0 }, 0.0));
        // If every sample rises or falls, a reversal is the sample before a change of direction. The reversals are listed first, in code without
        // branches that depend on the samples, because a processor cannot predict these.
        let (mut n, mut rising, mut before) = (0, latest.value > began, latest.value);
        let mut moves = under_way.is_some();
        for (i, &value) in (0..).zip(values) {
            let rises = value > before;
            if let Some(slot) = turns.get_mut(n) {
                *slot = i;
            }
            n += usize::from(rises != rising);
            moves &= (value != before) & value.is_finite();
            (rising, before) = (rises, value);
        }
        if !moves {
            for (at, &value) in (first..).zip(values) {
                self.push_tagged(Point { at, value }, listener);
            }
            return;
        }
        for &next in turns.iter().take(n) {
            let before = (next as usize).checked_sub(1);
            let point = match before.and_then(|i| Some((first + i, *values.get(i)?))) {
                Some((at, value)) => Point { at, value },
                None => latest,
            };
            let tag = listener.tag(point);
            self.reversal(Reversal { point, tag }, listener);
        }
        if let Some((i, &value)) = values.iter().enumerate().next_back() {
            let at = first + i;
            self.latest = Some(Point { at, value });
        }
    }

    /// Returns the residue: the reversals that are still open and the last sample, in time order.
    pub fn residue(mut self, tag: &mut impl FnMut(Point) -> T) -> Vec<Reversal<T>> {
        if let Some(latest) = self.latest
            && self.open.last().is_none_or(|r| r.point != latest)
        {
            let tag = tag(latest);
            self.open.push(Reversal { point: latest, tag });
        }
        self.open
    }

    /// Returns the latest sample if it is not yet a reversal.
    pub fn latest_sample(&self) -> Option<Point> {
        self.latest
    }

    #[inline(always)]
    fn reversal(&mut self, d: Reversal<T>, listener: &mut impl Listener<T>) {
        while let [.., a, b, c] = self.open.as_slice() {
            let [av, bv, cv, dv] = [a, b, c, &d].map(|r| r.point.value);
            // If values are equal, the later value counts as higher.
            let rise = (cv >= av) & (dv >= bv);
            let fall = (cv < av) & (dv < bv);
            if !(if bv > av { rise } else { fall }) {
                break;
            }
            listener.add_cycle(b, c);
            self.open.truncate(self.open.len() - 2);
        }
        self.open.push(d);
    }
}

impl<T: Clone> Rainflow<T> {
    /// Returns the residue of consecutive histories from the residues of the single histories. `counted` gets the cycles that close across their
    /// borders.
    pub fn join_residues(
        residues: &[Vec<Reversal<T>>],
        counted: &mut impl FnMut(&Reversal<T>, &Reversal<T>),
    ) -> Vec<Reversal<T>> {
        let mut count = Self::default();
        let mut latest: Option<T> = None;
        for r in residues.iter().flatten() {
            let before = |_: Point| latest.clone().unwrap_or_else(|| r.tag.clone());
            let changed = count.latest.is_none_or(|l| l.value != r.point.value);
            count.push_tagged(r.point, &mut FunctionListener(before, &mut *counted));
            // A sample that repeats the latest value is skipped, together with its tag.
            if changed && r.point.value.is_finite() {
                latest = Some(r.tag.clone());
            }
        }
        match latest {
            Some(tag) => count.residue(&mut |_| tag.clone()),
            None => Vec::new(),
        }
    }
}

impl Rainflow {
    /// Takes the next sample. `counted` gets every full cycle that closes. A value that is not finite is ignored.
    pub fn push(&mut self, point: Point, counted: &mut impl FnMut(Cycle)) {
        let closed = |b: &Reversal<()>, c: &Reversal<()>| {
            counted(Cycle {
                from: b.point,
                to: c.point,
                count: 1.0,
            });
        };
        self.push_tagged(point, &mut FunctionListener(|_| (), closed));
    }

    /// Counts the residue by ASTM E1049. The last sample counts as a reversal, and every open range as half a cycle.
    pub fn finish(self, counted: &mut impl FnMut(Cycle)) {
        for cycle in half_cycles(&self.residue(&mut |_| ())) {
            counted(cycle);
        }
    }
}

/// Returns the ranges of a residue as half cycles.
pub fn half_cycles<T>(residue: &[Reversal<T>]) -> impl Iterator<Item = Cycle> {
    residue.windows(2).filter_map(|w| match w {
        [a, b] => Some(Cycle {
            from: a.point,
            to: b.point,
            count: 0.5,
        }),
        _ => None,
    })
}
