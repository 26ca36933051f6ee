//! The header of an RPC III file.

use std::collections::BTreeMap;
use std::fmt;

/// Bytes of a header record.
pub(super) const RECORD: usize = 128;
/// Bytes of the key of an entry.
pub(super) const KEY: usize = 32;
/// Bytes of a block.
pub(super) const BLOCK: usize = 512;
/// Maximum number of blocks of a header. It is four times the limit of the format, because some programs exceed that limit.
const MOST_BLOCKS: usize = 1024;

/// One channel.
#[derive(Clone, Debug, PartialEq)]
pub struct RpcChannel {
    /// Name `DESC.CHAN_n`. It is `n` if the file has none.
    pub name: String,
    /// Unit `UNITS.CHAN_n`.
    pub unit: String,
    /// Value of one count. It is 1 for reals.
    pub scale: f64,
}

/// Storage of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Numbers {
    Int16,
    Float32,
}

impl Numbers {
    pub(super) fn width(self) -> usize {
        match self {
            Self::Int16 => 2,
            Self::Float32 => 4,
        }
    }
}

/// Header before the samples, checked against the size of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// Channels in file order.
    pub channels: Vec<RpcChannel>,
    /// Time between samples, s.
    pub dt: f64,
    /// Number of samples of each channel.
    pub samples: usize,
    pub(super) per_group: usize,
    pub(super) start: usize,
    pub(super) numbers: Numbers,
    pub(super) big_endian: bool,
}

/// Errors of an RPC file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RpcError {
    /// The bytes end too early.
    Cut {
        /// Bytes in the file.
        found: usize,
        /// Bytes needed.
        expected: usize,
    },
    /// A required key is missing, or its value is impossible.
    Value {
        /// The key.
        key: String,
        /// Value, or `absent`.
        found: String,
        /// Description of a valid value.
        expected: &'static str,
    },
    /// A kind of file that is not read.
    Kind {
        /// The key.
        key: &'static str,
        /// Value in the header.
        found: String,
    },
}

impl RpcError {
    /// Returns the message and the remedy.
    pub fn parts(&self) -> (String, &'static str) {
        match self {
            Self::Cut { found, expected } => (
                format!("the file ends after {found} bytes, its header promises {expected}"),
                "copy it again",
            ),
            Self::Value {
                key,
                found,
                expected,
            } => (
                format!("`{key}` is {found}, expected {expected}"),
                "write the file again",
            ),
            Self::Kind { key, found } => (
                format!("`{key}` = `{found}` is not read"),
                "export a time history of integers or reals",
            ),
        }
    }
}

impl fmt::Display for RpcError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (wrong, remedy) = self.parts();
        write!(f, "{wrong}: {remedy}")
    }
}

impl std::error::Error for RpcError {}

/// Returns whether the bytes begin as an RPC III file.
pub fn is_rpc(bytes: &[u8]) -> bool {
    let value = bytes.get(KEY..RECORD).map(text).unwrap_or_default();
    let key = bytes.get(..KEY).map(text).unwrap_or_default();
    key == "FORMAT" && (value.starts_with("BINARY") || value == "ASCII")
}

/// Returns the text up to the first zero byte, trimmed: UTF-8, else Latin-1.
pub(super) fn text(bytes: &[u8]) -> String {
    let bytes = bytes.split(|b| *b == 0).next().unwrap_or_default();
    match std::str::from_utf8(bytes) {
        Ok(t) => t.trim().to_owned(),
        Err(_) => bytes
            .iter()
            .map(|b| char::from(*b))
            .collect::<String>()
            .trim()
            .to_owned(),
    }
}

struct Params(BTreeMap<String, String>);

impl Params {
    fn get(&self, key: &str) -> Option<&str> {
        self.0
            .get(key)
            .map(String::as_str)
            .filter(|v| !v.is_empty())
    }

    fn value_error(&self, key: &str, expected: &'static str) -> RpcError {
        RpcError::Value {
            key: key.to_owned(),
            found: self
                .get(key)
                .map_or("absent".to_owned(), |v| format!("`{v}`")),
            expected,
        }
    }

    /// A whole number above zero.
    fn count(&self, key: &str) -> Result<usize, RpcError> {
        self.whole_number(key)
            .filter(|n| *n > 0)
            .ok_or_else(|| self.value_error(key, "a whole number above 0"))
    }

    /// A whole number, which some programs write with a decimal point.
    fn whole_number(&self, key: &str) -> Option<usize> {
        let x = self.real_number(key)?;
        (x >= 0.0 && x.fract() == 0.0 && x < 1e15).then_some(x as usize)
    }

    fn real_number(&self, key: &str) -> Option<f64> {
        self.get(key)?.parse::<f64>().ok().filter(|x| x.is_finite())
    }
}

/// Returns the header.
///
/// # Errors
/// A file that is cut off, missing or impossible keys, or another kind of file.
pub fn read_header(bytes: &[u8]) -> Result<Header, RpcError> {
    let record = |i: usize| {
        let from = i.checked_mul(RECORD)?;
        let r = bytes.get(from..from.checked_add(RECORD)?)?;
        Some((text(r.get(..KEY)?), text(r.get(KEY..)?)))
    };
    let cut = |expected: usize| RpcError::Cut {
        found: bytes.len(),
        expected,
    };
    let mut params = Params(BTreeMap::new());
    for i in 0..3 {
        let (key, value) = record(i).ok_or_else(|| cut(BLOCK))?;
        params.0.insert(key, value);
    }
    let blocks = params.count("NUM_HEADER_BLOCKS")?;
    let listed = params.count("NUM_PARAMS")?;
    if blocks > MOST_BLOCKS {
        return Err(params.value_error("NUM_HEADER_BLOCKS", "at most 1024"));
    }
    let start = blocks * BLOCK;
    if listed > start / RECORD {
        return Err(params.value_error("NUM_PARAMS", "at most four a block"));
    }
    if start > bytes.len() {
        return Err(cut(start));
    }
    for (key, value) in (3..listed).map_while(record) {
        if !key.is_empty() {
            params.0.insert(key, value);
        }
    }
    of_params(&params, start, bytes.len())
}

fn of_params(params: &Params, start: usize, length: usize) -> Result<Header, RpcError> {
    let big_endian = match params.get("FORMAT") {
        Some("BINARY" | "BINARY_IEEE_LITTLE_END") => false,
        Some("BINARY_IEEE_BIG_END") => true,
        other => return Err(kind("FORMAT", other)),
    };
    let file_type = params.get("FILE_TYPE").unwrap_or("TIME_HISTORY");
    if file_type != "TIME_HISTORY" {
        return Err(kind("FILE_TYPE", Some(file_type)));
    }
    // Half a frame more at the end is refused: no available file shows its layout.
    if params.real_number("HALF_FRAMES").is_some_and(|n| n != 0.0) {
        return Err(kind("HALF_FRAMES", params.get("HALF_FRAMES")));
    }
    let numbers = match params.get("DATA_TYPE").unwrap_or("SHORT_INTEGER") {
        "SHORT_INTEGER" => Numbers::Int16,
        "FLOATING_POINT" => Numbers::Float32,
        other => return Err(kind("DATA_TYPE", Some(other))),
    };
    let dt = params
        .real_number("DELTA_T")
        .filter(|dt| *dt > 0.0)
        .ok_or_else(|| params.value_error("DELTA_T", "a time above 0 s"))?;
    let n = params.count("CHANNELS")?;
    let (per_frame, per_group) = (
        params.count("PTS_PER_FRAME")?,
        params.count("PTS_PER_GROUP")?,
    );
    if per_group % per_frame != 0 {
        return Err(params.value_error("PTS_PER_GROUP", "a multiple of PTS_PER_FRAME"));
    }
    let frames = params
        .whole_number("FRAMES")
        .ok_or_else(|| params.value_error("FRAMES", "a whole number"))?;
    let stored = frames
        .checked_mul(per_frame)
        .ok_or_else(|| params.value_error("FRAMES", "fewer"))?;
    let samples = match params.whole_number("SAMPLES") {
        Some(exact) if exact <= stored => exact,
        Some(_) => return Err(params.value_error("SAMPLES", "at most FRAMES x PTS_PER_FRAME")),
        None => stored,
    };
    let expected = stored
        .div_ceil(per_group)
        .checked_mul(per_group)
        .and_then(|points| points.checked_mul(n))
        .and_then(|points| points.checked_mul(numbers.width()))
        .and_then(|bytes| bytes.checked_add(start))
        .ok_or_else(|| params.value_error("FRAMES", "fewer"))?;
    // Refuse a count of channels that exceeds the keys of the header, before memory is allocated for them.
    if expected > length || n > length {
        return Err(RpcError::Cut {
            found: length,
            expected,
        });
    }
    let channels = (1..=n)
        .map(|i| channel(params, i, numbers))
        .collect::<Result<_, _>>()?;
    Ok(Header {
        channels,
        dt,
        samples,
        per_group,
        start,
        numbers,
        big_endian,
    })
}

fn channel(params: &Params, i: usize, numbers: Numbers) -> Result<RpcChannel, RpcError> {
    let key = |what: &str| format!("{what}.CHAN_{i}");
    let word = |what: &str| params.get(&key(what)).map(str::to_owned);
    let scale = match numbers {
        Numbers::Float32 => 1.0,
        Numbers::Int16 => params
            .real_number(&key("SCALE"))
            .ok_or_else(|| params.value_error(&key("SCALE"), "a number"))?,
    };
    Ok(RpcChannel {
        name: word("DESC").unwrap_or_else(|| i.to_string()),
        unit: word("UNITS").unwrap_or_default(),
        scale,
    })
}

fn kind(key: &'static str, found: Option<&str>) -> RpcError {
    RpcError::Kind {
        key,
        found: found.unwrap_or("absent").to_owned(),
    }
}
