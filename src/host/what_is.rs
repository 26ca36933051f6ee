//! Kinds of files by their content, for messages if another kind is expected.

use crate::host::sheet::is_sheet;
use crate::series::record::format_of;

/// First bytes in which a zero shows a binary file.
const HEAD: usize = 1024;
/// First bytes in which a deck has BEGIN and a first card: case control is shorter in all but the longest decks.
const DECK_HEAD: usize = 64 << 10;

/// First bytes of files that no command reads, with the name of their kind.
const SIGNATURES: [(&[u8], &str); 15] = [
    (b"%PDF", "a PDF document"),
    (b"\x89PNG", "a PNG image"),
    (b"\xff\xd8\xff", "a JPEG image"),
    (b"GIF8", "a GIF image"),
    (b"\x1f\x8b", "a gzip archive"),
    (b"BZh91AY&SY", "a bzip2 archive"),
    (b"\x28\xb5\x2f\xfd", "a Zstandard archive"),
    (b"7z\xbc\xaf\x27\x1c", "a 7-Zip archive"),
    (b"\xfd7zXZ", "an xz archive"),
    (b"FEA1", "a Feather file of version 1"),
    (b"\xd0\xcf\x11\xe0", "a document of old Microsoft Office"),
    (b"SQLite format 3", "an SQLite database"),
    (b"\x7fELF", "a program"),
    (b"\xff\xfe", "text in UTF-16"),
    (b"\xfe\xff", "text in UTF-16"),
];

/// Returns whether a file is an OP2: its first record mark is 4 or 8 in either byte order.
pub fn looks_like_op2(bytes: &[u8]) -> bool {
    matches!(bytes.get(..4), Some([4 | 8, 0, 0, 0] | [0, 0, 0, 4 | 8]))
}

/// Returns the kind of a binary file, with its article; `None` for text.
pub(crate) fn binary_kind(bytes: &[u8]) -> Option<&'static str> {
    if let Some(format) = format_of(bytes) {
        return Some(format.words());
    }
    let head = bytes.get(..bytes.len().min(HEAD)).unwrap_or_default();
    if bytes.starts_with(b"PK\x03\x04") {
        let is_sheet = memchr::memmem::find(bytes, b"xl/").is_some();
        return Some(if is_sheet {
            "a spreadsheet (XLSX)"
        } else {
            "a ZIP archive"
        });
    }
    if nastran::h5::is_h5(bytes) {
        return Some("an HDF5 file");
    }
    let mut signatures = SIGNATURES.iter();
    if let Some((_, words)) = signatures.find(|(first, _)| bytes.starts_with(first)) {
        return Some(words);
    }
    if memchr::memmem::find(head, b"<VTKFile").is_some() {
        return Some("a VTK file");
    }
    if looks_like_op2(bytes) {
        return Some("an OP2 file");
    }
    head.contains(&0).then_some("a binary file")
}

/// Returns the kind of a file that is neither a table nor a record, with its article.
pub(crate) fn no_table(bytes: &[u8]) -> Option<&'static str> {
    if is_deck(bytes) {
        return Some("a Nastran deck");
    }
    // A table may be text with two bytes for each character.
    let is_utf16 = bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff");
    let is_read = format_of(bytes).is_some() || is_sheet(bytes) || is_utf16;
    binary_kind(bytes).filter(|_| !is_read)
}

/// Returns whether a file is a Nastran deck, by words that every complete deck contains.
pub(crate) fn is_deck(bytes: &[u8]) -> bool {
    let head = bytes.get(..bytes.len().min(DECK_HEAD)).unwrap_or_default();
    let has = |word: &[u8]| {
        let mut lines = head.split(|b| *b == b'\n');
        lines.any(|l| {
            let l = l.trim_ascii_start();
            l.get(..word.len())
                .is_some_and(|w| w.eq_ignore_ascii_case(word))
        })
    };
    binary_kind(bytes).is_none() && has(b"BEGIN") && (has(b"GRID") || has(b"INCLUDE"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_bytes_of_a_file_show_its_kind() {
        let mut rpc = b"FORMAT".to_vec();
        rpc.resize(32, 0);
        rpc.extend(b"BINARY_IEEE_LITTLE_END");
        rpc.resize(128, 0);
        for (bytes, expected) in [
            (&b"%PDF-1.7"[..], Some("a PDF document")),
            (b"\x1f\x8b\x08", Some("a gzip archive")),
            (b"PK\x03\x04..xl/workbook.xml", Some("a spreadsheet (XLSX)")),
            (b"PK\x03\x04..notes.txt", Some("a ZIP archive")),
            (b"TDSm", Some("a record in TDMS form")),
            (b"PAR1", Some("a Parquet file")),
            (b"ARROW1\0\0", Some("a Feather file")),
            (b"FEA1", Some("a Feather file of version 1")),
            (b"<?xml version=\"1.0\"?>\n<VTKFile>", Some("a VTK file")),
            (b"run,P01\nR1,\x001\n", Some("a binary file")),
            (b"run,P01\nR1,1\n", None),
            (b"$ deck\nGRID,1\n", None),
            (b"", None),
            (&rpc, Some("a record in RPC III form")),
        ] {
            assert_eq!(binary_kind(bytes), expected);
        }
    }

    #[test]
    fn only_files_that_are_no_table_and_no_record_have_a_kind() {
        for bytes in [
            &b"run,P01\nR1,1\n"[..],
            b"TDSm",
            b"PAR1",
            b"ARROW1\0\0",
            b"PK\x03\x04",
            b"\xff\xfer\x00",
        ] {
            assert_eq!(no_table(bytes), None);
        }
        assert_eq!(no_table(b"%PDF-1.7"), Some("a PDF document"));
        let deck = b"CEND\nBEGIN BULK\nGRID,1\n";
        assert_eq!(no_table(deck), Some("a Nastran deck"));
    }

    #[test]
    fn decks_are_known_by_their_bulk_data() {
        assert!(is_deck(
            b"SOL 101\nCEND\nbegin bulk\n grid,1,,0.,0.,0.\nENDDATA\n"
        ));
        assert!(!is_deck(b"time,P01\n0,1\n0.01,2\n"));
    }
}
