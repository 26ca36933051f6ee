//! What a page shows of a history: by span of samples the smallest, mean and largest of each load.

use super::record::Piece;
use crate::app::strain::LoadUnits;
use crate::recovery::history::Filter;
use crate::report::figure::LoadTrace;

/// Spans of a record at least, where it has so many samples.
const LEAST: usize = 240;
/// Spans at most, an even number: from here on two neighbours become one.
const MOST: usize = 960;

/// Spans so far.
pub(super) struct Spans {
    k: usize,
    /// Spans of each piece.
    per_piece: usize,
    /// Neighbouring spans that are drawn as one.
    together: usize,
    /// Spans in the last entry.
    filled: usize,
    /// By span and load: smallest, sum, largest, count.
    list: Vec<Vec<[f64; 4]>>,
    time: [f64; 2],
}

const NOTHING: [f64; 4] = [f64::INFINITY, 0.0, f64::NEG_INFINITY, 0.0];

impl Spans {
    /// For a record of so many pieces and `k` loads.
    pub(super) fn new(k: usize, pieces: usize) -> Self {
        Self {
            k,
            per_piece: LEAST.div_ceil(pieces.max(1)),
            together: 1,
            filled: 0,
            list: Vec::new(),
            time: [f64::NAN; 2],
        }
    }

    /// Takes the next piece: from its sums where it is one span, else from its loads.
    pub(super) fn add(&mut self, piece: &Piece) {
        if let (Some(first), Some(last)) = (piece.times.first(), piece.times.last()) {
            self.time = [
                if self.time[0].is_nan() {
                    *first
                } else {
                    self.time[0]
                },
                *last,
            ];
        }
        if self.per_piece == 1 {
            let s = &piece.sums;
            let count = s.samples as f64;
            let span = (0..self.k).map(|l| [s.min[l], s.sum[l], s.max[l], count]);
            self.push(span.collect());
            return;
        }
        let samples = piece.times.len().div_ceil(self.per_piece).max(1);
        for part in piece.loads.chunks(samples * self.k.max(1)) {
            let mut span = vec![NOTHING; self.k];
            for f in part.chunks_exact(self.k.max(1)) {
                for (s, v) in span.iter_mut().zip(f).filter(|(_, v)| v.is_finite()) {
                    merge(s, &[*v, *v, *v, 1.0]);
                }
            }
            self.push(span);
        }
    }

    fn push(&mut self, span: Vec<[f64; 4]>) {
        match self.list.last_mut() {
            Some(last) if self.filled < self.together => {
                last.iter_mut().zip(&span).for_each(|(a, b)| merge(a, b));
                self.filled += 1;
            }
            _ => {
                self.list.push(span);
                self.filled = 1;
            }
        }
        if self.list.len() > MOST {
            self.list = self
                .list
                .chunks(2)
                .map(|pair| {
                    let mut one = pair[0].clone();
                    if let Some(two) = pair.get(1) {
                        one.iter_mut().zip(two).for_each(|(a, b)| merge(a, b));
                    }
                    one
                })
                .collect();
            // One more than an even number: the last entry stays alone, as full as it was.
            self.together *= 2;
        }
    }

    /// Traces by load in report units; `rms` loads say how wide the interval of a sample is.
    pub(super) fn traces(
        &self,
        names: &[String],
        units: &[LoadUnits],
        filter: &Filter,
        rms: &[f64],
    ) -> Vec<LoadTrace> {
        let sigma = filter.sigma(rms);
        (0..self.k)
            .map(|l| {
                let factor = units[l].factor;
                let spans = self.list.iter().map(|span| {
                    let [low, sum, high, count] = span[l];
                    if count > 0.0 {
                        [low, sum / count, high].map(|v| v * factor)
                    } else {
                        [f64::NAN; 3]
                    }
                });
                LoadTrace {
                    name: names[l].clone(),
                    unit: units[l].name.clone(),
                    time: self.time,
                    half: crate::recovery::NORMAL_95 * sigma[l] * factor,
                    spans: spans.collect(),
                }
            })
            .collect()
    }
}

/// Adds a span to another.
fn merge(a: &mut [f64; 4], b: &[f64; 4]) {
    *a = [a[0].min(b[0]), a[1] + b[1], a[2].max(b[2]), a[3] + b[3]];
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recovery::history::Sums;

    fn piece(from: usize, values: &[f64]) -> Piece {
        let mut sums = Sums::new(0, 1);
        for v in values {
            sums.samples += 1;
            sums.sum[0] += v;
            sums.min[0] = sums.min[0].min(*v);
            sums.max[0] = sums.max[0].max(*v);
        }
        Piece {
            times: (from..from + values.len()).map(|i| i as f64).collect(),
            loads: values.to_vec(),
            sums,
        }
    }

    #[test]
    fn spans_of_a_long_record_stay_few_and_hold_its_extremes_and_sum() {
        let pieces = 5000;
        let mut spans = Spans::new(1, pieces);
        for p in 0..pieces {
            let v = p as f64;
            spans.add(&piece(2 * p, &[v, -v]));
        }
        assert!(spans.list.len() <= MOST && spans.list.len() > MOST / 4);
        let counts: f64 = spans.list.iter().map(|s| s[0][3]).sum();
        assert_eq!(counts, 10_000.0);
        let high = spans.list.iter().map(|s| s[0][2]).fold(0.0, f64::max);
        assert_eq!(high, 4999.0);
        // In order of time, the largest of each span rises, and all spans but the last hold as many pieces.
        assert!(spans.list.windows(2).all(|w| w[0][0][2] < w[1][0][2]));
        let full = spans.list[0][0][3];
        let inner = &spans.list[..spans.list.len() - 1];
        assert!(inner.iter().all(|s| s[0][3] == full));
        assert_eq!(spans.time, [0.0, 9999.0]);
    }

    #[test]
    fn a_short_record_is_cut_into_spans_and_gaps_are_left_out() {
        let mut spans = Spans::new(1, 1);
        let mut values: Vec<f64> = (0..480).map(f64::from).collect();
        values[0] = f64::NAN;
        values[1] = f64::NAN;
        spans.add(&piece(0, &values));
        assert_eq!(spans.list.len(), LEAST);
        assert_eq!(spans.list[0][0], NOTHING);
        assert_eq!(spans.list[1][0], [2.0, 5.0, 3.0, 2.0]);
    }
}
