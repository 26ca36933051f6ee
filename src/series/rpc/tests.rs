use super::*;

fn targets() -> Vec<Target> {
    let t = |name: &str, unit: &str, min, max| Target {
        name: name.into(),
        unit: unit.into(),
        min,
        max,
    };
    vec![t("LF.FZ", "kN", -2.0, 5.0), t("still", "kN m", 0.0, 0.0)]
}

/// Number of samples: a full frame and a part of another one.
const N: usize = 3000;

fn sample(i: usize) -> [f64; 2] {
    [1.5 + 3.5 * (i as f64 * 0.01).sin(), 0.0]
}

fn file() -> Vec<u8> {
    let mut bytes = Vec::new();
    let repeated = write_rpc(&mut bytes, &targets(), 0.002, N, |from, to, out| {
        out.extend((from..to).flat_map(sample));
    });
    assert_eq!(repeated.unwrap(), 0);
    bytes
}

#[test]
fn what_is_written_reads_back_to_half_a_count() {
    let bytes = file();
    assert!(is_rpc(&bytes));
    let record = read_rpc(&bytes).unwrap();
    assert_eq!((record.list.len(), record.n_samples()), (2, N));
    assert!((record.rate_hz - 500.0).abs() < 1e-6);
    assert_eq!(record.list[0].name, "LF.FZ");
    assert_eq!(record.list[1].unit, "kN m");
    // The scale is printed with ten digits. At full scale, an error of the last digit is far below one count.
    let half = 0.5 * 5.0 / 32_752.0 * (1.0 + 1e-4);
    for i in 0..N {
        assert!(
            (record.list[0].samples[i] - sample(i)[0]).abs() <= half,
            "{i}"
        );
        assert_eq!(record.list[1].samples[i], 0.0);
    }
}

#[test]
fn any_part_and_order_of_columns_reads_as_the_whole() {
    let bytes = file();
    let h = read_header(&bytes).unwrap();
    let whole = read_rpc(&bytes).unwrap();
    let mut part = Vec::new();
    read_samples(&h, &bytes, 2040, 2060, &[None, Some(1), Some(0)], &mut part);
    assert_eq!(part.len(), 60);
    for (i, row) in part.chunks_exact(3).enumerate() {
        assert!(row[0].is_nan());
        assert_eq!(row[1], whole.list[1].samples[2040 + i]);
        assert_eq!(row[2], whole.list[0].samples[2040 + i]);
    }
}

#[test]
fn a_gap_repeats_the_sample_before_it_and_is_counted() {
    let mut bytes = Vec::new();
    let one = [Target {
        name: "a".into(),
        unit: String::new(),
        min: -4.0,
        max: 4.0,
    }];
    let repeated = write_rpc(&mut bytes, &one, 0.1, 3, |_, _, out| {
        out.extend([4.0, f64::NAN, -4.0]);
    });
    assert_eq!(repeated.unwrap(), 1);
    let read = read_rpc(&bytes).unwrap();
    let expected = [4.0, 4.0, -4.0];
    for (a, b) in read.list[0].samples.iter().zip(expected) {
        assert!((a - b).abs() < 1e-6);
    }
}

/// Returns a header by hand, as the format describes it: groups of two frames, big endian, reals.
#[test]
fn groups_of_several_frames_and_big_endian_reals_are_demultiplexed() {
    let keys = [
        ("FORMAT", "BINARY_IEEE_BIG_END"),
        ("NUM_HEADER_BLOCKS", "4"),
        ("NUM_PARAMS", "13"),
        ("DATA_TYPE", "FLOATING_POINT"),
        ("FILE_TYPE", "TIME_HISTORY"),
        ("DELTA_T", "0.5"),
        ("CHANNELS", "2"),
        ("PTS_PER_FRAME", "2"),
        ("PTS_PER_GROUP", "4"),
        ("FRAMES", "3"),
        ("DESC.CHAN_1", "a"),
        ("UNITS.CHAN_1", "uE"),
        ("DESC.CHAN_2", "b"),
    ];
    let mut bytes = Vec::new();
    for (key, value) in keys {
        let from = bytes.len();
        bytes.extend_from_slice(key.as_bytes());
        bytes.resize(from + 32, 0);
        bytes.extend_from_slice(value.as_bytes());
        bytes.resize(from + 128, b' ');
    }
    bytes.resize(4 * 512, 0);
    for group in 0..2 {
        for channel in 0..2 {
            for i in 0..4 {
                let v = (100 * channel + 4 * group + i) as f32;
                bytes.extend_from_slice(&v.to_be_bytes());
            }
        }
    }
    let record = read_rpc(&bytes).unwrap();
    assert_eq!(record.list[0].samples, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    assert_eq!(
        record.list[1].samples,
        [100.0, 101.0, 102.0, 103.0, 104.0, 105.0]
    );
    assert_eq!(record.list[0].unit, "uE");
}

#[test]
fn cut_and_mutated_files_are_refused_or_read_but_never_panic() {
    let bytes = file();
    for n in (0..bytes.len()).step_by(97) {
        assert!(read_rpc(&bytes[..n]).is_err(), "{n}");
    }
    let mut seed = 7_u64;
    for _ in 0..2000 {
        let mut bad = bytes.clone();
        for _ in 0..3 {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let at = (seed >> 33) as usize % 4096;
            bad[at] = (seed >> 24) as u8;
        }
        let _ = read_rpc(&bad);
    }
}

#[test]
fn a_file_with_half_a_frame_more_is_refused_by_name() {
    let mut bytes = file();
    // Replace the key in the last 128-byte record of the header that contains a key.
    let records = read_header(&bytes).unwrap().start / 128;
    let free = (0..records).rev().find(|i| bytes[128 * i] != 0).unwrap();
    let record = &mut bytes[128 * free..128 * (free + 1)];
    record.fill(0);
    record[..11].copy_from_slice(b"HALF_FRAMES");
    record[32] = b'1';
    let error = read_header(&bytes).unwrap_err().to_string();
    assert!(error.contains("`HALF_FRAMES` = `1`"), "{error}");
}
