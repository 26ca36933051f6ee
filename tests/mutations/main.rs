//! Seeded damage to every kind of input. A reader or a command must end in an answer or an error, without a panic,
//! quickly and with little memory.
//!
//! `STRAINBRIDGE_MUTATIONS` sets their number (`.ci/long`: a million), and `STRAINBRIDGE_FIRST_SEED` the first seed.
//! Every failure is printed with its seed, which is sufficient to reproduce it.

mod folders;
mod samples;
#[path = "../../nastran/tests/support/mod.rs"]
mod support;

use folders::{Folder, folders};
use nastran::bdf::{MemoryLoader, read_deck};
use nastran::results::{ResultsFile, SalvagedFile};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::{Duration, Instant};
use strainbridge::host::context::{Context, InMemory};
use strainbridge::job::Job;
use strainbridge::job::table::read_table;
use strainbridge::measured::strain_file::{read_strain, wanted_columns};
use strainbridge::model::Model;
use strainbridge::series::record::{Options, open_record};

/// Default number of mutations, which takes some seconds.
const USUAL: u64 = 4_000;
/// Longest time of a reader for a file of some kilobytes.
const LONGEST: Duration = Duration::from_secs(20);
/// Memory that a reader may use in addition to four times the size of its file.
const ROOM: usize = 64 << 20;
/// One of this number of mutations is in the folder of a job, which a command reads as a whole.
const COMMANDS: usize = 50;

/// Small generator that is equal on all platforms (splitmix64; Steele, Lea, Flood 2014).
pub struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Returns a random number below `n`.
    pub fn draw_below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }
}

/// Makes one change: a bit, a critical word, a number, a removed or doubled piece, or a cut.
///
/// In large files, half of the changes are near the beginning or the end, where lists and headers are.
pub fn mutate(bytes: &mut Vec<u8>, random: &mut Random) {
    const WORDS: [&[u8]; 20] = [
        &[0; 4],
        &[0xff; 4],
        &[0xff, 0xff, 0xff, 0x7f],
        &[0, 0, 0, 0x80],
        &[0xff; 8],
        &[0, 0, 0, 0, 0, 0, 0xf0, 0x7f],
        b"1e308",
        b"-1e308",
        b"1e-320",
        b"-99999999999",
        b"4294967296",
        b"nan",
        b"inf",
        b"THRU",
        b"\n",
        b",",
        b"\"",
        b"[[",
        b"\r\n\r\n",
        b"=",
    ];
    const NEAR: usize = 4096;
    if bytes.is_empty() {
        return;
    }
    let n = bytes.len();
    let at = match random.draw_below(4) {
        0 if n > NEAR => random.draw_below(NEAR),
        1 if n > NEAR => n - NEAR + random.draw_below(NEAR),
        _ => random.draw_below(n),
    };
    let len = random.draw_below(64.min(n - at));
    match random.draw_below(7) {
        0 | 1 => bytes[at] ^= 1 << random.draw_below(8),
        2 => {
            let word = WORDS[random.draw_below(WORDS.len())];
            let end = (at + word.len()).min(n);
            bytes.splice(at..end, word.iter().copied());
        }
        3 => drop(bytes.drain(at..at + len)),
        4 => {
            let piece = bytes[at..at + len].to_vec();
            let to = random.draw_below(n);
            bytes.splice(to..to, piece);
        }
        5 => number(bytes, at, random),
        _ => bytes.truncate(at),
    }
}

/// Replaces the number in text at or after `at`.
fn number(bytes: &mut Vec<u8>, at: usize, random: &mut Random) {
    const NUMBERS: [&str; 10] = [
        "0",
        "-1",
        "1e300",
        "-1e300",
        "1e-300",
        "2147483648",
        "99999999",
        "1e9",
        ".5",
        "7",
    ];
    let is_digit = |b: &u8| b.is_ascii_digit() || *b == b'.';
    let Some(from) = bytes[at..]
        .iter()
        .take(200)
        .position(is_digit)
        .map(|i| at + i)
    else {
        return;
    };
    let len = bytes[from..].iter().take_while(|b| is_digit(b)).count();
    let new = NUMBERS[random.draw_below(NUMBERS.len())];
    bytes.splice(from..from + len, new.bytes());
}

/// Reader of a file. It returns whether it could read something.
type Reader = fn(&[u8]) -> bool;

fn results(bytes: &[u8]) -> bool {
    let Ok(SalvagedFile { file, .. }) = ResultsFile::salvage(bytes, "x.op2") else {
        return false;
    };
    let _ = (file.cards(), file.grid_point_weight());
    let read = (0..file.blocks().len()).filter(|i| file.rows(*i).is_ok());
    read.count() > 0
}

fn deck(bytes: &[u8]) -> bool {
    let deck = read_deck("d.bdf", bytes.to_vec(), &mut MemoryLoader::default());
    let _ = Model::from_deck(&deck);
    deck.faults.is_empty()
}

fn job(bytes: &[u8]) -> bool {
    let files = InMemory::default().with_file("job.toml", bytes);
    Job::read("job.toml", &files).is_ok()
}

fn table(bytes: &[u8]) -> bool {
    read_table("t.csv", &String::from_utf8_lossy(bytes)).is_ok()
}

/// Reads every sample of a record.
fn record(bytes: &[u8]) -> bool {
    let Ok(record) = open_record(Arc::new(bytes.to_vec()), &Options::default()) else {
        return false;
    };
    let picks: Vec<Option<usize>> = (0..record.columns().len()).map(Some).collect();
    (0..record.n_pieces()).all(|piece| {
        let mut rows = 0;
        let read = record.read(piece, &picks, &mut |block| {
            rows += block.rows;
            // A damaged sample rate may result in a huge number of samples.
            if rows > 10_000_000 {
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        });
        read.is_ok()
    })
}

/// Reads a spreadsheet as the runs of a job.
fn runs(bytes: &[u8]) -> bool {
    let job = samples::JOB.replace("s.csv", "s.xlsx");
    let files = InMemory::default()
        .with_file("job.toml", job)
        .with_file("s.xlsx", bytes);
    let Ok(job) = Job::read("job.toml", &files) else {
        return false;
    };
    let mut inputs = strainbridge::host::files::Inputs::new(&files);
    let named = &job.measured.as_ref().unwrap().strain;
    let wanted = wanted_columns(&mut inputs, &job);
    read_strain(&mut inputs, &job, named, &wanted).is_ok()
}

fn samples() -> Vec<(&'static str, Vec<u8>, Reader)> {
    let mut all: Vec<(&str, Vec<u8>, Reader)> = vec![
        ("deck", samples::DECK.into(), deck),
        ("punch", samples::punch(), results),
        ("op2", samples::op2(), results),
        ("h5", samples::h5(), results),
        ("job", samples::JOB.into(), job),
        ("table", samples::TABLE.into(), table),
        ("csv", samples::TABLE.into(), record),
        ("binary record", samples::binary_record(), record),
        ("rpc", samples::rpc3(), record),
        ("tdms", samples::tdms(), record),
        ("uff text", samples::uff(false), record),
        ("uff binary", samples::uff(true), record),
    ];
    #[cfg(feature = "parquet")]
    all.push(("parquet", samples::parquet(), record));
    #[cfg(feature = "mdf")]
    all.extend([
        ("mdf4", samples::mdf4(false), record as Reader),
        ("mdf4 deflated", samples::mdf4(true), record),
    ]);
    #[cfg(all(feature = "report", feature = "xlsx"))]
    all.push(("xlsx", samples::xlsx(), runs));
    // Files of real programs, if present. Of every kind, the smaller files.
    for (path, read) in [
        (
            "nastran/msc_bar_strain/pbarl_bar_100.op2",
            results as Reader,
        ),
        ("nastran/nx_cbush/cbush.op2", results),
        ("nastran/nx_cbush/cbush.pch", results),
        ("nastran/nx_cbush/cbush.dat", deck),
        (
            "nastran/nx_static_shell_bar/static_solid_shell_bar.op2",
            results,
        ),
        (
            "nastran/nx_static_shell_bar/static_solid_shell_bar.h5",
            results,
        ),
    ] {
        if let Some(bytes) = support::bytes(path) {
            all.push((path, bytes, read));
        }
    }
    all
}

#[test]
fn every_sample_is_read_as_long_as_it_is_whole() {
    for (name, bytes, read) in samples() {
        assert!(read(&bytes), "{name}");
    }
}

/// Resets the peak memory to the current memory. If the system does not support it, the peak continues to rise.
fn forget_peak() {
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// Returns the peak memory of this process since the last reset, in bytes, or `None` if the system does not report it.
fn peak() -> Option<usize> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    let kib: usize = line.split_whitespace().next()?.parse().ok()?;
    Some(kib << 10)
}

/// Returns the processor time of this process, or the elapsed time if the system does not report it.
///
/// Processor time does not depend on other load of the machine.
fn read_processor_time() -> Duration {
    static START: std::sync::LazyLock<Instant> = std::sync::LazyLock::new(Instant::now);
    /// Ticks per second, equal on every Linux.
    const TICKS: u64 = 100;
    let ticks = || -> Option<u64> {
        let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
        // User and system time are the 14th and 15th field. The second field is the name in brackets.
        let fields = stat.rsplit_once(')')?.1.split_whitespace();
        let mut times = fields.skip(11);
        Some(times.next()?.parse::<u64>().ok()? + times.next()?.parse::<u64>().ok()?)
    };
    ticks().map_or_else(
        || START.elapsed(),
        |t| Duration::from_millis(1000 / TICKS * t),
    )
}

/// Failure caused by a mutation.
struct Failure {
    seed: u64,
    of: String,
    what: String,
}

/// Writes the damaged bytes of a seed to the file in `STRAINBRIDGE_KEEP`.
fn keep(bytes: &[u8]) {
    if let Ok(path) = std::env::var("STRAINBRIDGE_KEEP") {
        std::fs::write(path, bytes).unwrap();
    }
}

/// Damages a sample or a file of a folder, and reads it. Returns the failure and the time.
fn try_one(
    seed: u64,
    samples: &[(&str, Vec<u8>, Reader)],
    folders: &[Folder],
) -> (Option<Failure>, Duration) {
    let mut random = Random(seed);
    forget_peak();
    let before = peak();
    let start = read_processor_time();
    let (of, size, is_reader, ended) = if random.draw_below(COMMANDS) == 0 && !folders.is_empty() {
        let damaged = folders[random.draw_below(folders.len())].damage_file(&mut random);
        keep(damaged.bytes());
        let ended = std::panic::catch_unwind(|| damaged.run());
        (damaged.to_string(), 0, false, ended)
    } else {
        let (name, original, read) = &samples[random.draw_below(samples.len())];
        let mut bytes = original.clone();
        for _ in 0..=random.draw_below(5) {
            mutate(&mut bytes, &mut random);
        }
        keep(&bytes);
        let ended = std::panic::catch_unwind(|| {
            let _ = read(&bytes);
        });
        ((*name).to_owned(), bytes.len(), true, ended)
    };
    let took = read_processor_time().saturating_sub(start);
    let grown = before
        .zip(peak())
        .map_or(0, |(before, after)| after.saturating_sub(before));
    let what = if let Err(panic) = ended {
        let text = panic.downcast_ref::<String>().cloned();
        let text = text.or_else(|| panic.downcast_ref::<&str>().map(|s| (*s).to_owned()));
        Some(format!("panic: {}", text.unwrap_or_default()))
    } else if took > LONGEST {
        Some(format!("{:.0} s", took.as_secs_f64()))
    } else if is_reader && grown > 4 * size + ROOM {
        Some(format!("{} MB for {size} bytes", grown >> 20))
    } else {
        None
    };
    (what.map(|what| Failure { seed, of, what }), took)
}

#[test]
fn damaged_inputs_end_in_an_answer_or_an_error() {
    const MOST: usize = 50;
    let asked = |name: &str| std::env::var(name).ok().and_then(|n| n.parse().ok());
    let first: u64 = asked("STRAINBRIDGE_FIRST_SEED").unwrap_or(0);
    let wanted: u64 = asked("STRAINBRIDGE_MUTATIONS").unwrap_or(USUAL);
    let (samples, folders) = (samples(), folders());
    let mut slowest = (Duration::ZERO, first);
    let mut failures = Vec::new();
    for seed in first..first + wanted {
        let (failure, took) = try_one(seed, &samples, &folders);
        slowest = slowest.max((took, seed));
        if let Some(f) = failure {
            println!("seed {}, {}: {}", f.seed, f.of, f.what);
            failures.push(f.seed);
        }
        // A signal ends the whole process, so this output limits the possible seeds to a few thousand.
        if (seed + 1) % 10_000 == 0 {
            println!(
                "seeds up to {seed}: {} failures, the slowest {slowest:?}",
                failures.len()
            );
        }
        if failures.len() >= MOST {
            break;
        }
    }
    println!(
        "{wanted} mutations of {} files and {} folders from seed {first}, the slowest {:?} (seed {})",
        samples.len(),
        folders.len(),
        slowest.0,
        slowest.1
    );
    assert!(failures.is_empty(), "seeds {failures:?}");
}
