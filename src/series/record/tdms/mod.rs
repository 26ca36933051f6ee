//! TDMS of National Instruments: channels sampled together, read anywhere from their segments.
//!
//! A segment lists objects that changed and holds their samples, channel after channel or interleaved; [`segments`] reads the lists,
//! this file the samples. Channels of `DAQmx` raw data and scalings other than lines and polynomials are refused by name.

mod clock;
mod fault;
mod segments;
mod stamp;
#[cfg(test)]
mod tests;

use super::column::{Column, seconds_in};
use super::reader::{BLOCK, Block, Bytes, OtherChannel, Pick, RecordReader, Sink, Times};
use super::simultaneous_channels::{Sampling, sampled_together};
use super::time_unit::single_rounding_s;
use crate::series::error::SeriesError;
use clock::{check_clocks, check_restarts, is_over_time, samplings};
use fault::read_error;
use segments::{Channel, Kind, Value, channels_of};
use stamp::Stamp;

/// Samples a piece.
const PIECE: usize = 65_536;

/// Returns whether the bytes begin as TDMS.
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
    /// Group of each column.
    groups: Vec<String>,
    others: Vec<OtherChannel>,
}

/// Coefficients of the polynomial that scales stored numbers to values.
type Scale = Vec<f64>;

impl Tdms {
    /// Returns the channels that were sampled at equal times: the `wanted` channels and all channels sampled with them. Without `wanted` channels, it
    /// is the group with most numbers.
    ///
    /// # Errors
    /// A file that can't be read, channels of a kind that is not read, wanted channels that were sampled at other times.
    pub(super) fn new(bytes: Bytes, wanted: &[String]) -> Result<Self, SeriesError> {
        let (all, texts): (Vec<Channel>, Vec<Channel>) = channels_of((*bytes).as_ref())?
            .into_iter()
            .partition(|c| c.kind != Kind::Text);
        let (all, spectra) = over_time(all, wanted)?;
        let samplings = samplings(&all, (*bytes).as_ref());
        let named = all.iter().zip(&samplings);
        let named: Vec<(&str, Sampling)> = named.map(|(c, s)| (c.name.as_str(), *s)).collect();
        let Some((main, together)) = sampled_together(&named, wanted)? else {
            return Err(SeriesError::Empty);
        };
        check_clocks(&all, &together, main, (*bytes).as_ref())?;
        let names: Vec<String> = all.iter().map(|c| c.name.clone()).collect();
        let (mut columns, mut channels, mut time) = (Vec::new(), Vec::new(), None);
        let (mut groups, mut others) = (Vec::new(), Vec::new());
        let sampled = all.into_iter().zip(together).zip(&samplings);
        for (at, ((c, together), sampling)) in sampled.enumerate() {
            let is_times = main.times == Some(at);
            if !(together || is_times) || c.kind == Kind::Time && !is_times {
                others.push(describe_other_channel(&c, Some(sampling.step_s)));
                continue;
            }
            check_restarts(&c)?;
            let scale = scale_of(&c)?;
            if is_times {
                time = Some((c, scale));
                continue;
            }
            // A name that two groups share gets its group as a prefix.
            let twice = names.iter().filter(|n| **n == c.name).count() > 1;
            let name = if twice {
                format!("{}/{}", c.group, c.name)
            } else {
                c.name.clone()
            };
            let unit = c.unit();
            columns.push(Column::of_channel(&name, unit));
            groups.push(c.group.clone());
            channels.push((c, scale));
        }
        others.extend(
            texts
                .iter()
                .chain(&spectra)
                .map(|c| describe_other_channel(c, None)),
        );
        let samples = main.samples;
        let mut file = Self {
            bytes,
            columns,
            channels,
            time: None,
            times: Times::None {
                samples: Some(samples),
            },
            samples,
            groups,
            others,
        };
        match time {
            Some((c, scale)) => file.set_time(c, scale)?,
            None if main.step_s > 0.0 => {
                file.times = Times::Even {
                    start_s: main.start_s,
                    step_s: main.step_s,
                    samples,
                    unit_stated: main.unit_stated,
                }
            }
            None => {}
        }
        Ok(file)
    }

    /// Uses a channel as the times of all other channels.
    fn set_time(&mut self, c: Channel, mut scale: Scale) -> Result<(), SeriesError> {
        let unit = c.unit().to_owned();
        let is_absolute = c.kind == Kind::Time;
        let mut epoch_s = None;
        if is_absolute {
            let mut first = [f64::NAN];
            c.decode((*self.bytes).as_ref(), 0, 1, first.iter_mut());
            let [first] = first;
            epoch_s = Some(first).filter(|t| t.is_finite());
            scale = vec![-epoch_s.unwrap_or(0.0), 1.0];
        } else {
            let second = seconds_in(&unit).ok_or_else(|| {
                read_error(format!("`{unit}` of `{}` is not a unit of time", c.name))
            })?;
            scale.iter_mut().for_each(|factor| *factor *= second);
        }
        let one = scale.get(1).copied().unwrap_or(1.0).abs();
        self.times = Times::Stored {
            rounding_s: match c.kind {
                Kind::F64 => 0.0,
                Kind::F32 => single_rounding_s(one),
                // Seconds since 1970 in 64 bits are accurate to a quarter of a microsecond.
                Kind::Time => 2.5e-7,
                _ => 0.5 * one,
            },
            epoch_s,
            unit_stated: is_absolute || !unit.is_empty(),
        };
        self.time = Some((c, scale));
        Ok(())
    }
}

/// Splits channels into those over time and those over something else, such as frequency.
///
/// # Errors
/// Wanted channels that are not sampled over time, or a file without any channel over time.
fn over_time(
    all: Vec<Channel>,
    wanted: &[String],
) -> Result<(Vec<Channel>, Vec<Channel>), SeriesError> {
    let (over_time, others): (Vec<Channel>, Vec<Channel>) = all.into_iter().partition(is_over_time);
    let refused = others
        .iter()
        .find(|c| over_time.is_empty() || wanted.contains(&c.name));
    match refused {
        Some(c) => Err(read_error(format!(
            "the samples of `{}` are over {}, which is not time",
            c.name,
            clock::axis(c)
        ))),
        None => Ok((over_time, others)),
    }
}

/// Returns the description of a channel that is not read; `step_s`: time between its samples, s, 0 where it states none.
fn describe_other_channel(c: &Channel, step_s: Option<f64>) -> OtherChannel {
    OtherChannel {
        group: c.group.clone(),
        name: c.name.clone(),
        unit: c.unit().to_owned(),
        samples: c.samples,
        rate_hz: step_s.filter(|s| *s > 0.0).map(|s| 1.0 / s),
    }
}

/// The scaling that a channel's properties state; numbers that its program has scaled need none.
fn scale_of(c: &Channel) -> Result<Scale, SeriesError> {
    let n = c.number("NI_Number_Of_Scales").unwrap_or(0.0);
    if n == 0.0 || c.text("NI_Scaling_Status").is_some_and(|s| s == "scaled") {
        return Ok(vec![0.0, 1.0]);
    }
    let refused = |what: &str| read_error(format!("channel `{}` has a scaling `{what}`", c.name));
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

    fn group(&self, column: usize) -> &str {
        self.groups.get(column).map_or("", String::as_str)
    }

    fn other_channels(&self) -> &[OtherChannel] {
        &self.others
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
            Value::Text(_) | Value::Time(_) => None,
        }
    }

    fn text(&self, key: &str) -> Option<&str> {
        match self.properties.get(key)? {
            Value::Text(t) => Some(t),
            Value::Number(_) | Value::Time(_) => None,
        }
    }

    fn time(&self, key: &str) -> Option<Stamp> {
        match self.properties.get(key)? {
            Value::Time(t) => Some(*t),
            Value::Number(_) | Value::Text(_) => None,
        }
    }

    /// The unit of its values; empty where none is stated.
    fn unit(&self) -> &str {
        let unit = self
            .text("unit_string")
            .or_else(|| self.text("NI_UnitDescription"));
        unit.unwrap_or_default()
    }

    /// Returns whether both hold the same values, as stored.
    fn is_equal(&self, other: &Self, file: &[u8]) -> bool {
        let (mut a, mut b) = ([f64::NAN; BLOCK], [f64::NAN; BLOCK]);
        (0..self.samples).step_by(BLOCK).all(|from| {
            let to = (from + BLOCK).min(self.samples);
            self.decode(file, from, to, a.iter_mut());
            other.decode(file, from, to, b.iter_mut());
            a.iter().take(to - from).eq(b.iter().take(to - from))
        })
    }
}
