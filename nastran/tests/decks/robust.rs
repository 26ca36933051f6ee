//! Decks that are cut off or damaged: the reader answers with faults, without a panic, and with limited memory.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use nastran::bdf::{IncludeRequest, LoadedFile, Loader, read_deck, write_deck};

use crate::common;

/// Keeps the files that it has read, so that thousands of readings access the disk once.
#[derive(Default)]
struct Kept(BTreeMap<String, Vec<u8>>);

impl Loader for Kept {
    fn load(&mut self, request: &IncludeRequest) -> Result<LoadedFile, String> {
        for path in request.candidates(|_| None)? {
            if !self.0.contains_key(&path)
                && let Ok(bytes) = std::fs::read(&path)
            {
                self.0.insert(path.clone(), bytes);
            }
            if let Some(bytes) = self.0.get(&path) {
                let bytes = bytes.clone();
                return Ok(LoadedFile {
                    path,
                    bytes,
                    differing_path: None,
                });
            }
        }
        Err("no such file".to_owned())
    }
}

/// Returns every deck file of the set, including included files.
fn files() -> Vec<PathBuf> {
    fn walk(folder: &Path, list: &mut Vec<PathBuf>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                walk(&path, list);
            } else if path
                .extension()
                .is_some_and(|e| ["bdf", "dat", "inc", "blk"].iter().any(|x| e == *x))
            {
                list.push(path);
            }
        }
    }
    let mut list = Vec::new();
    if let Some(folder) = common::cases_folder() {
        walk(&folder, &mut list);
    }
    list.sort();
    list
}

/// Reads a deck and writes it. The written deck must equal the input.
fn survives(path: &Path, bytes: &[u8], loader: &mut Kept) {
    let deck = read_deck(&path.to_string_lossy(), bytes.to_vec(), loader);
    assert_eq!(write_deck(&deck)[0].1, bytes);
    for fault in &deck.faults {
        assert!(!fault.show(&deck.sources).to_string().is_empty());
    }
    for other in &deck.others {
        assert!(!deck.text(other).is_empty());
    }
}

/// Returns the next number of a linear congruential generator (Knuth, MMIX).
fn next(state: &mut u64) -> usize {
    *state = state
        .wrapping_mul(6364136223846793005)
        .wrapping_add(1442695040888963407);
    (*state >> 33) as usize
}

#[test]
fn decks_cut_off_at_any_line_are_read() {
    let mut loader = Kept::default();
    for path in files() {
        let bytes = std::fs::read(&path).unwrap();
        let ends: Vec<usize> = (0..bytes.len()).filter(|&i| bytes[i] == b'\n').collect();
        // Every line of small files, and about as many bytes of large ones.
        let step = (ends.len() * bytes.len() / 4_000_000).max(1);
        for end in ends.iter().step_by(step) {
            survives(&path, &bytes[..*end], &mut loader);
            survives(&path, &bytes[..end.saturating_sub(7)], &mut loader);
        }
    }
}

#[test]
fn decks_with_damaged_bytes_are_read() {
    let mut loader = Kept::default();
    let files = files();
    if files.is_empty() {
        return;
    }
    // Characters with a special meaning in decks.
    let telling = b"$,=*+-.\n\r\t '\"()0987eEdD\0\xff\x80ABINTHRU";
    let mut state = 20_240_501;
    for _ in 0..3_000 {
        let path = &files[next(&mut state) % files.len()];
        let bytes = std::fs::read(path).unwrap();
        // A window of the larger files, including their start in half of the cases.
        let size = bytes.len().min(24_000);
        let start = if next(&mut state).is_multiple_of(2) {
            0
        } else {
            next(&mut state) % (bytes.len() - size + 1)
        };
        let mut piece = bytes[start..start + size].to_vec();
        for _ in 0..1 + next(&mut state) % 40 {
            let at = next(&mut state) % piece.len();
            let byte = telling[next(&mut state) % telling.len()];
            match next(&mut state) % 5 {
                0 => piece.insert(at, byte),
                1 if piece.len() > 1 => {
                    piece.remove(at);
                }
                2 => piece[at] = (next(&mut state) % 256) as u8,
                3 => {
                    let end = (at + 1 + next(&mut state) % 100).min(piece.len());
                    let copy = piece[at..end].to_vec();
                    piece.splice(at..at, copy);
                }
                _ => piece[at] = byte,
            }
        }
        survives(path, &piece, &mut loader);
    }
}

#[test]
fn letters_without_sense_are_read() {
    let mut loader = Kept::default();
    let mut state = 5;
    for _ in 0..300 {
        let size = next(&mut state) % 5_000;
        let bytes: Vec<u8> = (0..size).map(|_| (next(&mut state) % 256) as u8).collect();
        survives(Path::new("noise.bdf"), &bytes, &mut loader);
    }
}
