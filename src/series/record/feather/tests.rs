//! `samples.txt` contains files that pyarrow 25 and polars 1 wrote, in base64. Each line has a name and a file.

use super::Feather;
use crate::series::record::arrow::from_base64;
use crate::series::record::{
    Options, RecordReader, Times, open_record, read_channels, runs_as_csv,
};
use std::sync::Arc;

fn sample(name: &str) -> Vec<u8> {
    let mut lines = include_str!("samples.txt").lines();
    let found = lines.find_map(|l| l.strip_prefix(name)?.strip_prefix(' '));
    from_base64(found.unwrap()).unwrap()
}

fn runs(name: &str) -> String {
    runs_as_csv(Arc::new(sample(name))).unwrap().unwrap()
}

#[test]
fn runs_in_every_compression_are_a_table_of_text() {
    for name in ["runs_lz4", "runs_zstd", "runs_uncompressed"] {
        let expected = "run,P01,P02\nR1,1.5,10\n\"R2, again\",-2,\nR3,0.001,30\n";
        assert_eq!(runs(name), expected, "{name}");
    }
}

#[test]
fn compressed_batches_and_dictionaries_of_texts_are_read_in_order() {
    for name in ["long_lz4", "long_zstd"] {
        let text = runs(name);
        let rows: Vec<&str> = text.lines().skip(1).collect();
        assert_eq!(rows.len(), 600, "{name}");
        for (i, row) in rows.iter().enumerate() {
            let value = 0.25 * (i / 100) as f64;
            assert_eq!(*row, format!("R{},{value}", i % 2), "{name}");
        }
    }
}

#[test]
fn texts_that_polars_writes_are_read_in_place_or_from_their_buffer() {
    let expected = "run,P01\nR1,1.5\na name of more than twelve letters,-2\n,0.001\n";
    assert_eq!(runs("views"), expected);
}

#[test]
fn numbers_of_every_type_have_their_values_and_durations_their_unit() {
    let record = open_record(Arc::new(sample("kinds")), &Options::default()).unwrap();
    assert!(record.is_time_unit_stated());
    assert!((record.clock.rate_hz - 100.0).abs() < 1e-6);
    assert_eq!(record.clock.samples, 12);
    let channels = read_channels(&record).unwrap();
    let of = |name: &str| channels.samples(name).unwrap().to_vec();
    let names: Vec<&str> = record.columns().iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["i8", "u16", "half", "flag", "P01", "u64"]);
    for i in 0..12 {
        let n = i as f64;
        assert_eq!(of("i8")[i], n - 20.0);
        assert_eq!(of("u16")[i], 60_000.0 + n);
        assert_eq!(of("half")[i], 0.5 * n);
        assert_eq!(of("flag")[i], f64::from(u8::from(i % 3 == 0)));
        assert_eq!(of("u64")[i], 2_f64.powi(63) + 2_f64.powi(20) * n);
        match i {
            7 => assert!(of("P01")[i].is_nan()),
            _ => assert_eq!(of("P01")[i], 1.25 * n),
        }
    }
    assert_eq!(record.columns()[4].unit, "um/m");
}

#[test]
fn timestamps_give_the_times_and_their_beginning() {
    let file = Feather::new(Arc::new(sample("dated"))).unwrap();
    let Times::Stored { epoch_s, .. } = file.times() else {
        panic!("no stored times")
    };
    assert_eq!(epoch_s, Some(1_777_636_800.0));
    assert_eq!(
        (file.n_pieces(), file.rows(0), file.rows(1)),
        (2, Some(8), Some(4))
    );
    let record = open_record(Arc::new(sample("dated")), &Options::default()).unwrap();
    assert!((record.clock.rate_hz - 100.0).abs() < 1e-3);
    assert_eq!(runs_as_csv(Arc::new(sample("dated"))), Ok(None));
}

#[test]
fn damaged_files_are_refused_or_read_without_a_panic() {
    for name in [
        "runs_lz4",
        "runs_zstd",
        "runs_uncompressed",
        "views",
        "dated",
    ] {
        let bytes = sample(name);
        for i in 0..bytes.len() {
            for bit in [1, 0x80, 0xff] {
                let mut other = bytes.clone();
                other[i] ^= bit;
                let _ = runs_as_csv(Arc::new(other));
            }
            let cut = bytes[..i].to_vec();
            // A file that begins with fewer bytes is not a Feather file.
            assert!(i < 6 || runs_as_csv(Arc::new(cut)).is_err(), "{name} {i}");
        }
    }
}
