//! Damaged OP2 files. Every truncation and thousands of seeded mutations give an error or a partial answer, without a panic.

mod support;

use nastran::op2::Op2;
use nastran::results::SalvagedFile;
use std::path::PathBuf;

/// Returns the files of the shared set up to a size, smallest first.
fn files(largest: u64) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    let Some(shared) = support::find_shared_path("nastran") else {
        return found;
    };
    for folder in std::fs::read_dir(shared).unwrap().flatten() {
        for file in std::fs::read_dir(folder.path())
            .into_iter()
            .flatten()
            .flatten()
        {
            let path = file.path();
            if path.extension().is_some_and(|e| e == "op2")
                && file.metadata().is_ok_and(|m| m.len() <= largest)
            {
                found.push((path.clone(), std::fs::read(&path).unwrap()));
            }
        }
    }
    assert!(!found.is_empty(), "no OP2 in the set");
    found.sort_by_key(|(path, bytes)| (bytes.len(), path.clone()));
    found
}

/// Reads the whole content of a file. Returns the number of rows.
fn read_all(bytes: &[u8]) -> usize {
    let Ok(SalvagedFile { file: op2, .. }) = Op2::salvage(bytes) else {
        return 0;
    };
    let rows = (0..op2.blocks.len())
        .filter_map(|b| op2.rows(b).ok())
        .map(|r| r.len())
        .sum();
    let (cards, _) = op2.cards();
    let _ = op2.grid_point_weight();
    let n: usize = rows;
    n.saturating_add(cards.grids.len())
}

/// Small generator that is equal on all platforms (xorshift; Marsaglia 2003).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn draw_below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }
}

/// Returns the ends of the physical records, in the byte order of the file.
fn record_ends(bytes: &[u8]) -> Vec<usize> {
    let little = matches!(u32::from_le_bytes(bytes[..4].try_into().unwrap()), 4 | 8);
    let (mut at, mut ends) = (0, Vec::new());
    while at + 8 <= bytes.len() {
        let mark = bytes[at..at + 4].try_into().unwrap();
        at += 8 + if little {
            u32::from_le_bytes(mark)
        } else {
            u32::from_be_bytes(mark)
        } as usize;
        ends.push(at);
    }
    ends
}

#[test]
fn a_file_cut_after_any_record_or_within_one_is_read_as_far_as_it_goes() {
    let mut read = 0;
    for (path, bytes) in files(120_000) {
        let whole = read_all(&bytes);
        for end in record_ends(&bytes) {
            for cut in [end, end.saturating_sub(3), end.saturating_sub(9)] {
                let rows = read_all(&bytes[..cut.min(bytes.len())]);
                read += usize::from(rows > 0);
                assert!(
                    rows <= whole,
                    "{}: cut at {cut} gives more than the whole file",
                    path.display()
                );
            }
        }
    }
    assert!(read > 0 || support::find_shared_path("nastran").is_none());
}

#[test]
fn a_large_file_cut_after_any_record_keeps_the_blocks_before_it() {
    let mut kept = 0;
    for (path, bytes) in files(20_000_000) {
        let whole = Op2::read(&bytes).unwrap().blocks.len();
        let ends = record_ends(&bytes);
        let (step, mut before) = (ends.len() / 100 + 1, 0);
        for end in ends.into_iter().step_by(step) {
            let Ok(SalvagedFile { file: op2, .. }) = Op2::salvage(&bytes[..end]) else {
                continue;
            };
            let n = op2.blocks.len();
            assert!(
                n >= before && n <= whole,
                "{}: {n} blocks at {end}",
                path.display()
            );
            before = n;
            kept += n;
            if let Some(last) = n.checked_sub(1) {
                let _ = op2.rows(last);
            }
        }
    }
    assert!(kept > 0 || support::find_shared_path("nastran").is_none());
}

#[test]
fn a_whole_file_is_read_and_a_cut_one_is_not() {
    for (path, bytes) in files(20_000_000) {
        Op2::read(&bytes).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        for percent in (5..100).step_by(5) {
            let cut = &bytes[..bytes.len() * percent / 100];
            assert!(
                Op2::read(cut).is_err(),
                "{} cut at {percent} %",
                path.display()
            );
        }
    }
}

/// Returns the byte ranges of the records of result tables, from one negative key to the next.
fn numbered_records(bytes: &[u8]) -> Vec<(usize, usize)> {
    let little = matches!(u32::from_le_bytes(bytes[..4].try_into().unwrap()), 4 | 8);
    let (mut starts, mut before) = (Vec::new(), 0);
    for end in record_ends(bytes) {
        if end <= bytes.len() && end - before == 12 {
            let word = bytes[before + 4..before + 8].try_into().unwrap();
            let key = if little {
                i32::from_le_bytes(word)
            } else {
                i32::from_be_bytes(word)
            };
            if (-10_000..-2).contains(&key) {
                starts.push(before);
            }
        }
        before = end;
    }
    starts.windows(2).map(|w| (w[0], w[1])).collect()
}

#[test]
fn a_record_that_is_lost_or_is_repeated_is_damage() {
    let (mut tried, mut step) = (0, 0);
    for (path, bytes) in files(120_000) {
        for (from, to) in numbered_records(&bytes) {
            step += 1;
            if step % 7 != 0 {
                continue;
            }
            let lost = [&bytes[..from], &bytes[to..]].concat();
            let twice = [&bytes[..to], &bytes[from..]].concat();
            for damaged in [lost, twice] {
                tried += 1;
                assert!(
                    Op2::read(&damaged).is_err(),
                    "{}: {from} to {to}",
                    path.display()
                );
            }
        }
    }
    println!("{tried} records lost or doubled");
}

#[test]
fn ten_thousand_mutations_end_in_an_error_or_a_partial_answer() {
    let files = files(60_000);
    if files.is_empty() {
        return;
    }
    let mut random = Random(0x0002_2026);
    for i in 0..10_000 {
        let (_, original) = &files[i % files.len()];
        let mut bytes = original.clone();
        for _ in 0..=random.draw_below(6) {
            mutate(&mut bytes, &mut random);
        }
        read_all(&bytes);
    }
}

/// Makes one change: a byte, a word with a critical number, or a removed, doubled or moved piece.
fn mutate(bytes: &mut Vec<u8>, random: &mut Random) {
    const WORDS: [u32; 10] = [
        0,
        1,
        2,
        4,
        8,
        0x7fff_ffff,
        0x8000_0000,
        0xffff_ffff,
        0xffff_fffe,
        584,
    ];
    let n = bytes.len();
    if n < 16 {
        return;
    }
    let at = random.draw_below(n - 8);
    let len = random.draw_below(64.min(n - at));
    match random.draw_below(6) {
        0 | 1 => bytes[at] ^= 1 << random.draw_below(8),
        2 | 3 => {
            let word = WORDS[random.draw_below(WORDS.len())];
            let at = at / 4 * 4;
            bytes[at..at + 4].copy_from_slice(&if random.draw_below(2) == 0 {
                word.to_le_bytes()
            } else {
                word.to_be_bytes()
            });
        }
        4 => drop(bytes.drain(at..at + len)),
        _ => {
            let piece = bytes[at..at + len].to_vec();
            let to = random.draw_below(n);
            bytes.splice(to..to, piece);
        }
    }
}
