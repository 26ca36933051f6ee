//! Data for charts of a history of any length: smallest, mean and largest value of each load by span of samples.

use super::sink::Block;

/// Largest number of spans, an even number. At this number two neighbours are merged. It is twice the number of points on a wide screen.
const MOST: usize = 4000;

/// Spans so far, each with the same number of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Spans {
    k: usize,
    /// Samples of a span.
    samples: usize,
    list: Vec<Span>,
}

/// Consecutive samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Span {
    /// Time of the first and the last sample, s.
    pub time: [f64; 2],
    samples: usize,
    /// Smallest value, sum, largest value and count, for each load.
    loads: Vec<[f64; 4]>,
}

impl Span {
    /// Returns the smallest, mean and largest sample of load `l`, job units. NaN if no sample is known.
    pub fn of_load(&self, l: usize) -> [f64; 3] {
        match self.loads.get(l) {
            Some([low, sum, high, count]) if *count > 0.0 => [*low, sum / count, *high],
            _ => [f64::NAN; 3],
        }
    }
}

const NOTHING: [f64; 4] = [f64::INFINITY, 0.0, f64::NEG_INFINITY, 0.0];

impl Spans {
    /// Creates a trace for a record of `k` loads.
    pub(super) fn new(k: usize) -> Self {
        Self {
            k,
            samples: 1,
            list: Vec::new(),
        }
    }

    /// Takes the next samples.
    pub(super) fn add(&mut self, block: &Block) {
        let loads = block.loads.values.chunks_exact(self.k.max(1));
        for (time, f) in block.times.iter().zip(loads) {
            if self.list.last().is_none_or(|s| s.samples == self.samples) {
                if self.list.len() == MOST {
                    self.halve();
                }
                self.list.push(Span {
                    time: [*time; 2],
                    samples: 0,
                    loads: vec![NOTHING; self.k],
                });
            }
            let Some(span) = self.list.last_mut() else {
                continue;
            };
            span.time[1] = *time;
            span.samples += 1;
            for (s, v) in span.loads.iter_mut().zip(f).filter(|(_, v)| v.is_finite()) {
                merge(s, &[*v, *v, *v, 1.0]);
            }
        }
    }

    /// Returns the spans in order of time.
    pub fn list(&self) -> &[Span] {
        &self.list
    }

    /// Returns the time of the first and the last sample; NaN without samples.
    pub(super) fn time(&self) -> [f64; 2] {
        match (self.list.first(), self.list.last()) {
            (Some(first), Some(last)) => [first.time[0], last.time[1]],
            _ => [f64::NAN; 2],
        }
    }

    /// Merges each pair of neighbours.
    fn halve(&mut self) {
        self.samples *= 2;
        self.list = self
            .list
            .chunks(2)
            .map(|pair| {
                let mut one = pair[0].clone();
                if let Some(two) = pair.get(1) {
                    one.time[1] = two.time[1];
                    one.samples += two.samples;
                    one.loads
                        .iter_mut()
                        .zip(&two.loads)
                        .for_each(|(a, b)| merge(a, b));
                }
                one
            })
            .collect();
    }
}

/// Adds a span to another.
fn merge(a: &mut [f64; 4], b: &[f64; 4]) {
    *a = [a[0].min(b[0]), a[1] + b[1], a[2].max(b[2]), a[3] + b[3]];
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recovery::history::SampleLoads;

    fn piece(from: usize, values: &[f64]) -> Block {
        Block {
            first: from,
            times: (from..from + values.len()).map(|i| i as f64).collect(),
            loads: SampleLoads {
                values: values.to_vec(),
                gaps: Vec::new(),
            },
        }
    }

    #[test]
    fn spans_of_a_long_record_stay_few_and_hold_its_extremes_and_sum() {
        let pieces = 9000;
        let mut spans = Spans::new(1);
        for p in 0..pieces {
            let v = p as f64;
            spans.add(&piece(2 * p, &[v, -v]));
        }
        assert!(spans.list.len() <= MOST && spans.list.len() > MOST / 2);
        let counts: f64 = spans.list.iter().map(|s| s.loads[0][3]).sum();
        assert_eq!(counts, 18_000.0);
        let high = spans.list.iter().map(|s| s.loads[0][2]).fold(0.0, f64::max);
        assert_eq!(high, 8999.0);
        // The spans are in the order of time, and the largest value rises from span to span. All spans except the last one have equal numbers of
        // samples.
        assert!(
            spans
                .list
                .windows(2)
                .all(|w| w[0].loads[0][2] < w[1].loads[0][2] && w[0].time[1] < w[1].time[0])
        );
        let inner = &spans.list[..spans.list.len() - 1];
        assert!(inner.iter().all(|s| s.samples == spans.samples));
    }

    #[test]
    fn a_step_in_pieces_of_unlike_length_is_drawn_when_it_happens() {
        // The step is at sample 9,000 of 10,000. The last piece is short, as at the end of a file.
        let values: Vec<f64> = (0..10_000)
            .map(|i| f64::from(u8::from(i >= 9000)))
            .collect();
        let mut spans = Spans::new(1);
        let mut from = 0;
        for part in [4100, 4100, 1800] {
            spans.add(&piece(from, &values[from..from + part]));
            from += part;
        }
        let first = spans.list.iter().find(|s| s.loads[0][2] > 0.5).unwrap();
        let width = spans.samples as f64;
        assert!((first.time[0] - 9000.0).abs() <= width, "{:?}", first.time);
    }

    #[test]
    fn samples_that_are_no_numbers_are_left_out() {
        let mut spans = Spans::new(1);
        spans.add(&piece(0, &[f64::NAN, 2.0, 3.0]));
        assert_eq!(spans.list[0].loads[0], NOTHING);
        assert_eq!(spans.list[1].loads[0], [2.0, 2.0, 2.0, 1.0]);
    }
}
