//! Streams a record of 41 channels: reads and discards it piece by piece, and recovers six loads from it.
//!
//! Run: `cargo bench --bench stream`. The record is a million samples of f32 in memory; the ratio of both times is valid for any length.

use strainbridge::linalg::Matrix;
use strainbridge::recovery::history::{Filter, SampleLoads};
use strainbridge::recovery::{ErrorModel, Sums, Widening};
use strainbridge::sensitivity::{Load, Sensitivity};
use strainbridge::series::binary::{Header, read_header, read_samples, write_header};

fn main() {
    divan::main();
}

const GAUGES: usize = 41;
const LOADS: usize = 6;
const SAMPLES: usize = 1_000_000;
/// Number of samples in a piece, as in the command.
const PIECE: usize = 512;

fn record() -> Vec<u8> {
    let names: Vec<String> = (0..GAUGES).map(|g| format!("G{g}")).collect();
    let mut bytes = Vec::new();
    write_header(&mut bytes, &names, SAMPLES as u64, 0.0, 0.002, 1e-6).unwrap();
    for i in 0..SAMPLES * GAUGES {
        bytes.extend_from_slice(&((i % 977) as f32 * 0.1).to_le_bytes());
    }
    bytes
}

fn each_piece(h: &Header, bytes: &[u8], mut with: impl FnMut(&[f64])) {
    let columns: Vec<Option<usize>> = (0..GAUGES).map(Some).collect();
    let mut values = Vec::new();
    for from in (0..h.samples).step_by(PIECE) {
        values.clear();
        read_samples(
            h,
            bytes,
            from,
            (from + PIECE).min(h.samples),
            &columns,
            &mut values,
        );
        with(&values);
    }
}

#[divan::bench]
fn read_and_discard(bencher: divan::Bencher) {
    let bytes = record();
    let h = read_header(&bytes).unwrap();
    bencher.bench_local(|| {
        each_piece(&h, &bytes, |v| {
            divan::black_box(v);
        })
    });
}

#[divan::bench]
fn recover_six_loads(bencher: divan::Bencher) {
    let bytes = record();
    let h = read_header(&bytes).unwrap();
    let s = Sensitivity {
        gauges: h.names.clone(),
        loads: (0..LOADS)
            .map(|l| Load::from_name(format!("L{l}")))
            .collect(),
        values: Matrix::from_fn(GAUGES, LOADS, |g, l| 1e-8 * ((g * 7 + l * 13) % 11) as f64),
        noise: None,
        uncertainty: None,
    };
    let errors = ErrorModel {
        noise: 1e-6,
        model_rel: 0.0,
    };
    let filter = Filter::new(
        &s,
        vec![0.0; GAUGES],
        errors,
        1.0,
        &[1e3; LOADS],
        Widening::none(),
    )
    .unwrap();
    bencher.bench_local(|| {
        let mut loads = SampleLoads::default();
        let mut sums = Sums::new(GAUGES, LOADS);
        each_piece(&h, &bytes, |v| {
            loads.values.clear();
            loads.gaps.clear();
            filter.apply(v, h.unit, &mut loads, &mut sums);
        });
        sums.missing.whole
    });
}
