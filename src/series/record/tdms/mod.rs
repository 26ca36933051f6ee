//! TDMS of National Instruments: channels sampled together, read anywhere from their segments.
//!
//! A segment lists objects that changed and holds their samples, channel after channel or interleaved; [`segments`] reads the lists,
//! this file the samples. Channels of `DAQmx` raw data and scalings other than lines and polynomials are refused by name.

mod fault;
mod segments;

use super::column::{Column, is_time};
use super::reader::{BLOCK, Block, Bytes, Pick, RecordReader, Sink, Times};
use crate::series::error::SeriesError;
use fault::broken;
use segments::{Channel, Kind, Value, channels_of};

/// Samples a piece.
const PIECE: usize = 65_536;

/// Whether the bytes begin as TDMS.
pub(super) fn is_tdms(bytes: &[u8]) -> bool {
    bytes.starts_with(b"TDSm")
}

/// A TDMS file as a record.
pub(super) struct Tdms {
    bytes: Bytes,
    columns: Vec<Column>,
    channels: Vec<(Channel, Scale)>,
    time: Option<(Channel, Scale)>,
    times: Times,
    samples: usize,
}

/// What turns stored numbers into values: coefficients of a polynomial.
type Scale = Vec<f64>;

impl Tdms {
    /// The channels of one clock: those of `wanted` (of most numbers, where none is named) and all others as long and as fast.
    ///
    /// # Errors
    /// A file that can't be read, channels of a kind that is not read, wanted channels of another clock.
    pub(super) fn new(bytes: Bytes, wanted: &[String]) -> Result<Self, SeriesError> {
        let all = channels_of((*bytes).as_ref())?;
        // Length and step, by which channels belong together.
        let clock = |c: &Channel| (c.samples, c.number("wf_increment").map(f64::to_bits));
        let weight = |of: &Channel| {
            let same = all.iter().filter(|c| clock(c) == clock(of));
            let asked = same.clone().filter(|c| wanted.contains(&c.name)).count();
            (asked, same.count().saturating_mul(of.samples))
        };
        let Some(main) = all
            .iter()
            .filter(|c| c.samples > 0)
            .max_by_key(|c| weight(c))
        else {
            return Err(SeriesError::Empty);
        };
        let (main_clock, samples) = (clock(main), main.samples);
        let step = main.number("wf_increment").filter(|s| *s > 0.0);
        let start = main.number("wf_start_offset").unwrap_or(0.0);
        let (mut columns, mut channels, mut apart) = (Vec::new(), Vec::new(), Vec::new());
        let mut time = None;
        let names: Vec<String> = all.iter().map(|c| c.name.clone()).collect();
        for c in all {
            if clock(&c) != main_clock {
                if wanted.contains(&c.name) {
                    apart.push(c.name);
                }
                continue;
            }
            let scale = scale_of(&c)?;
            if step.is_none() && time.is_none() && is_time(&c.name, channels.is_empty()) {
                time = Some((c, scale));
                continue;
            }
            // A name that two groups have goes with its group.
            let twice = names.iter().filter(|n| **n == c.name).count() > 1;
            let name = if twice {
                format!("{}/{}", c.group, c.name)
            } else {
                c.name.clone()
            };
            let unit = c
                .text("unit_string")
                .or_else(|| c.text("NI_UnitDescription"));
            columns.push(Column::of_channel(&name, unit.unwrap_or_default()));
            channels.push((c, scale));
        }
        if !apart.is_empty() {
            return Err(SeriesError::Apart { names: apart });
        }
        let times = match (step, &time) {
            (Some(step_s), _) => Times::Even {
                start_s: start,
                step_s,
                samples,
            },
            (None, Some((c, _))) => Times::Stored {
                rounding_s: if c.kind == Kind::F32 {
                    86_400.0 * 6e-8
                } else {
                    0.0
                },
                epoch_s: None,
                unit_stated: c.text("unit_string").is_some_and(|u| !u.is_empty()),
            },
            (None, None) => Times::None {
                samples: Some(samples),
            },
        };
        Ok(Self {
            bytes,
            columns,
            channels,
            time,
            times,
            samples,
        })
    }
}

/// The scaling that a channel's properties state; numbers that its program has scaled need none.
fn scale_of(c: &Channel) -> Result<Scale, SeriesError> {
    let n = c.number("NI_Number_Of_Scales").unwrap_or(0.0);
    if n == 0.0 || c.text("NI_Scaling_Status").is_some_and(|s| s == "scaled") {
        return Ok(vec![0.0, 1.0]);
    }
    let refused = |what: &str| broken(format!("channel `{}` has a scaling `{what}`", c.name));
    if n > 1.0 {
        return Err(refused("of several steps"));
    }
    let number = |key: &str| c.number(&format!("NI_Scale[0]_{key}"));
    match c.text("NI_Scale[0]_Scale_Type") {
        Some("Linear") => match (number("Linear_Y_Intercept"), number("Linear_Slope")) {
            (Some(offset), Some(slope)) => Ok(vec![offset, slope]),
            _ => Err(refused("Linear without numbers")),
        },
        Some("Polynomial") => {
            let count = number("Polynomial_Coefficients_Size")
                .unwrap_or(0.0)
                .clamp(0.0, 32.0);
            (0..count as usize)
                .map(|i| number(&format!("Polynomial_Coefficients[{i}]")))
                .collect::<Option<Vec<f64>>>()
                .filter(|c| !c.is_empty())
                .ok_or_else(|| refused("Polynomial without numbers"))
        }
        other => Err(refused(other.unwrap_or("of no kind"))),
    }
}

impl RecordReader for Tdms {
    fn columns(&self) -> &[Column] {
        &self.columns
    }

    fn times(&self) -> Times {
        self.times
    }

    fn n_pieces(&self) -> usize {
        self.samples.div_ceil(PIECE)
    }

    fn rows(&self, piece: usize) -> Option<usize> {
        Some(self.samples.saturating_sub(piece * PIECE).min(PIECE))
    }

    fn read(&self, piece: usize, picks: &[Pick], sink: &mut Sink) -> Result<(), SeriesError> {
        let begin = piece * PIECE;
        let end = (begin + PIECE).min(self.samples);
        let file: &[u8] = (*self.bytes).as_ref();
        let k = picks.len();
        let mut values = vec![f64::NAN; BLOCK * k];
        for from in (begin..end).step_by(BLOCK) {
            let to = (from + BLOCK).min(end);
            for (j, pick) in picks.iter().enumerate() {
                let slots = values.iter_mut().skip(j).step_by(k.max(1)).take(to - from);
                let channel = match (pick, self.times) {
                    (Pick::Nothing, _) => None,
                    (Pick::Column(c), _) => self.channels.get(*c),
                    (
                        Pick::Time,
                        Times::Even {
                            start_s, step_s, ..
                        },
                    ) => {
                        for (slot, i) in slots.zip(from..) {
                            *slot = start_s + step_s * i as f64;
                        }
                        continue;
                    }
                    (Pick::Time, _) => self.time.as_ref(),
                };
                if let Some((c, scale)) = channel {
                    c.decode(file, from, to, slots);
                    if scale.as_slice() != [0.0, 1.0] {
                        let slots = values.iter_mut().skip(j).step_by(k.max(1)).take(to - from);
                        for v in slots {
                            *v = scale.iter().rev().fold(0.0, |sum, a| sum * *v + a);
                        }
                    }
                }
            }
            let block = Block {
                first: from - begin,
                rows: to - from,
                values: values.get(..(to - from) * k).unwrap_or_default(),
            };
            if sink(block).is_break() {
                break;
            }
        }
        Ok(())
    }
}

impl Channel {
    fn number(&self, key: &str) -> Option<f64> {
        match self.properties.get(key)? {
            Value::Number(v) => Some(*v),
            Value::Text(_) => None,
        }
    }

    fn text(&self, key: &str) -> Option<&str> {
        match self.properties.get(key)? {
            Value::Text(t) => Some(t),
            Value::Number(_) => None,
        }
    }
}
