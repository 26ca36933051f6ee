//! Records from other programs, read piece by piece.

use crate::python::read_by;
use serde_json::Value;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;
use strainbridge::series::record::{Evenness, Options, Record, open_record};

const NAMES: [&str; 3] = ["P01", "P02", "P03"];

fn options() -> Options {
    Options {
        wanted: NAMES.map(str::to_owned).to_vec(),
        ..Options::default()
    }
}

fn rows(record: &Record, columns: &[Option<usize>]) -> Vec<f64> {
    let mut out = Vec::new();
    for piece in 0..record.n_pieces() {
        let read = record.read(piece, columns, &mut |block| {
            assert_eq!(block.first * columns.len(), out.len());
            out.extend_from_slice(block.values);
            ControlFlow::Continue(())
        });
        read.unwrap();
    }
    out
}

#[test]
fn records_that_nptdms_pyuff_asammdf_and_pandas_write_hold_the_samples_they_were_given() {
    let dir = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("loggers");
    let _ = std::fs::remove_dir_all(&dir);
    std::fs::create_dir_all(&dir).unwrap();
    let Some(written) = read_by("write_loggers.py", &[dir.to_str().unwrap()]) else {
        return;
    };
    let expected: Vec<Vec<f64>> = NAMES
        .iter()
        .map(|n| {
            let list = written["columns"][n].as_array().unwrap();
            list.iter().map(|v| v.as_f64().unwrap()).collect()
        })
        .collect();
    let n = expected[0].len();
    let files: Vec<&str> = written["files"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(Value::as_str)
        .collect();
    assert_eq!(files.len(), 21);
    for file in files {
        if file.ends_with("mf4") && !cfg!(feature = "mdf") {
            continue;
        }
        let bytes = std::fs::read(dir.join(file)).unwrap();
        let record = open_record(Arc::new(bytes.clone()), &options())
            .unwrap_or_else(|e| panic!("{file}: {e}"));
        let clock = &record.clock;
        assert!(
            (clock.rate_hz / 500.0 - 1.0).abs() < 1e-6,
            "{file}: {}",
            clock.rate_hz
        );
        assert_eq!(
            (clock.samples, clock.n_gaps, clock.evenness),
            (n, 0, Evenness::Even),
            "{file}"
        );
        let place = |name: &&str| record.columns().iter().position(|c| c.name == **name);
        let columns: Vec<Option<usize>> = NAMES.iter().map(place).collect();
        assert!(
            columns.iter().all(Option::is_some),
            "{file}: {:?}",
            record.columns()
        );
        for c in columns.iter().flatten() {
            assert_eq!(record.columns()[*c].unit, "um/m", "{file}");
        }
        let values = rows(&record, &columns);
        assert_eq!(values.len(), 3 * n, "{file}");
        // Half a count of .01, 32-bit reals of about two hundred, twelve digits of text.
        let allowed = match file {
            "counts.mf4" => 0.00501,
            "scaled.tdms" => 0.00501,
            // Half of the last bit of a 16-bit real up to 256.
            "half.parquet" => 0.0625,
            _ => 1e-9,
        };
        for (i, row) in values.chunks_exact(3).enumerate() {
            for (k, v) in row.iter().enumerate() {
                assert!(
                    (v - expected[k][i]).abs() <= allowed,
                    "{file} {i} {k}: {v} {}",
                    expected[k][i]
                );
            }
        }
        // A record cut at any place gives a fault when it is opened or read, not a shorter record. A text table may end
        // with any line.
        for part in 1..10 {
            let cut = bytes.get(..bytes.len() * part / 10).unwrap().to_vec();
            let Ok(record) = open_record(Arc::new(cut), &options()) else {
                continue;
            };
            let read = (0..record.n_pieces())
                .try_for_each(|p| record.read(p, &[Some(0)], &mut |_| ControlFlow::Continue(())));
            let text = file.ends_with("csv");
            assert!(
                text || read.is_err(),
                "{file} cut at {part}0 % is {} samples",
                record.clock.samples
            );
        }
    }
}
