use super::csv::Csv;
use super::*;
use crate::series::error::SeriesError;
use std::ops::ControlFlow;
use std::sync::Arc;

fn open(text: &str) -> Result<Record, SeriesError> {
    Record::new(
        Box::new(Csv::new(Arc::new(text.as_bytes().to_vec()))?),
        None,
        None,
    )
}

/// Returns all samples of all columns, row by row.
fn rows(record: &Record) -> Vec<Vec<f64>> {
    let k = record.columns().len();
    let picks: Vec<Option<usize>> = (0..k).map(Some).collect();
    let mut out: Vec<Vec<f64>> = Vec::new();
    for piece in 0..record.n_pieces() {
        let mut next = record.span(piece).0;
        let read = record.read(piece, &picks, &mut |block| {
            assert_eq!(block.first, next);
            next += block.rows;
            out.extend(block.values.chunks_exact(k).map(<[f64]>::to_vec));
            ControlFlow::Continue(())
        });
        read.unwrap();
        assert_eq!(next, record.span(piece).1, "piece {piece}");
    }
    assert_eq!(out.len(), record.clock.samples);
    out
}

#[test]
fn tables_as_loggers_write_them_are_one_record() {
    let utf16: Vec<u8> =
        "\u{feff}Time [s];P01 [µm/m];P02\r\n0,0;1,5;-2\r\n0,1;2,5;#NV\r\n0,2;3,5;4\r\n"
            .encode_utf16()
            .flat_map(u16::to_le_bytes)
            .collect();
    let bare: Vec<u16> = "time;P01 [µm/m];P02\n0,0;1,5;-2\n0,1;2,5;\n0,2;3,5;4\n"
        .encode_utf16()
        .collect();
    let low_first: Vec<u8> = bare.iter().flat_map(|u| u.to_le_bytes()).collect();
    let high_first: Vec<u8> = bare.iter().flat_map(|u| u.to_be_bytes()).collect();
    let texts: [&[u8]; 16] = [
        // Plain CSV; byte order mark and CRLF; quoted, as pandas writes with QUOTE_ALL; decimal comma and tabs.
        b"time,P01 [um/m],P02\n0.0,1.5,-2\n0.1,2.5,NaN\n0.2,3.5,4\n",
        b"\xef\xbb\xbfTime,P01 [um/m],P02\r\n0.0,1.5,-2\r\n0.1,2.5,\r\n0.2,3.5,4\r\n",
        b"\"time\",\"P01 [um/m]\",\"P02\"\n\"0.0\",\"1.5\",\"-2\"\n\"0.1\",\"2.5\",\"\"\n\"0.2\",\"3.5\",\"4\"\n",
        b"time [s]\tP01 (um/m)\tP02\n0,0\t1,5\t-2\n0,1\t2,5\t#N/A\n0,2\t3,5\t4\n",
        // A row of units below the names; lines of a measuring program before them; a semicolon at the end of each line.
        b"Time;P01;P02\ns;um/m;\n0,0;1,5;-2\n0,1;2,5;\n0,2;3,5;4\n",
        b"Measured by 7\nRate: 10 Hz\n\nTime  1 - default sample rate [s]\tP01 [um/m]\tP02\n0.0\t1.5\t-2\n0.1\t2.5\t\n0.2\t3.5\t4\n",
        b"time;P01 [um/m];P02;\n0,0;1,5;-2;\n0,1;2,5;;\n0,2;3,5;4;\n",
        // Milliseconds stated as the unit; a date in a column without a name, as pandas writes its index; UTF-16.
        b"time [ms],P01 [um/m],P02\n0,1.5,-2\n100,2.5,n/a\n200,3.5,4\n",
        b",P01 [um/m],P02\n2026-05-01 12:00:00.0,1.5,-2\n2026-05-01 12:00:00.1,2.5,\n2026-05-01 12:00:00.2,3.5,4\n",
        &utf16,
        // UTF-16 without a byte order mark. Date and time in two columns, across midnight. Time of day, also with twelve hours. A date whose day
        // can't be a month.
        &low_first,
        &high_first,
        b"Date,Time,P01 [um/m],P02\n2026-05-01,23:59:59.9,1.5,-2\n2026-05-02,00:00:00.0,2.5,\n2026-05-02,00:00:00.1,3.5,4\n",
        b"Time,P01 [um/m],P02\n11:59:59.9,1.5,-2\n12:00:00.0,2.5,\n12:00:00.1,3.5,4\n",
        b"Time;P01 [um/m];P02\n12:59:59.9 PM;1.5;-2\n1:00:00.0 PM;2.5;\n1:00:00.1 PM;3.5;4\n",
        b"Time,P01 [um/m],P02\n5/31/2026 11:59:59.9 AM,1.5,-2\n5/31/2026 12:00:00.0 PM,2.5,\n5/31/2026 12:00:00.1 PM,3.5,4\n",
    ];
    for text in texts {
        let shown = String::from_utf8_lossy(text);
        let reader = Csv::new(Arc::new(text.to_vec())).unwrap_or_else(|e| panic!("{e} in {shown}"));
        let record =
            Record::new(Box::new(reader), None, None).unwrap_or_else(|e| panic!("{e} in {shown}"));
        let names: Vec<&str> = record.columns().iter().map(|c| c.name.as_str()).collect();
        assert_eq!(names, ["P01", "P02"], "{shown}");
        assert!(
            ["um/m", "µm/m"].contains(&record.columns()[0].unit.as_str()),
            "{shown}"
        );
        assert!(
            (record.clock.rate_hz - 10.0).abs() < 1e-5,
            "{} {shown}",
            record.clock.rate_hz
        );
        assert_eq!(record.clock.evenness, Evenness::Even, "{shown}");
        assert_eq!((record.clock.rows, record.clock.n_gaps), (3, 0), "{shown}");
        let rows = rows(&record);
        assert_eq!(
            (rows[0][0], rows[0][1], rows[2][0], rows[2][1]),
            (1.5, -2.0, 3.5, 4.0),
            "{shown}"
        );
        assert!(rows[1][0] == 2.5 && rows[1][1].is_nan(), "{shown}");
    }
}

#[test]
fn what_is_no_unit_in_brackets_is_part_of_the_name() {
    let split = |header: &str| {
        let c = name_and_unit(header);
        [c.name, c.unit]
    };
    assert_eq!(split("SG1 (left) (um/m)"), ["SG1 (left)", "um/m"]);
    assert_eq!(split("SG1 [3] [mm/m]"), ["SG1 [3]", "mm/m"]);
    assert_eq!(split("stress (N/(mm))"), ["stress", "N/(mm)"]);
    let columns = |text: &str| -> Vec<[String; 2]> {
        let record = open(text).unwrap_or_else(|e| panic!("{e} in {text}"));
        let list = record.columns().iter();
        list.map(|c| [c.name.clone(), c.unit.clone()]).collect()
    };
    // With a row of units below the header, a label stays in the name. A unit of the same quantity in the header takes precedence.
    let below = |header: &str, unit: &str| {
        columns(&format!("time,{header}\ns,{unit}\n0,0.5\n0.1,0.5\n")).remove(0)
    };
    assert_eq!(below("SG1 (left)", "mm/m"), ["SG1 (left)", "mm/m"]);
    assert_eq!(below("SG1 (t)", "[mm/m]"), ["SG1 (t)", "mm/m"]);
    // An equal unit is no problem. Another unit is a contradiction, and the header stays unchanged as the name.
    assert_eq!(below("SG1 [m/m]", "strain"), ["SG1", "m/m"]);
    assert_eq!(below("SG1 [m/m]", "um/m"), ["SG1 [m/m]", "um/m"]);
    assert_eq!(below("F [MN]", "mN"), ["F [MN]", "mN"]);
    assert_eq!(below("SG1 (left)", "-"), ["SG1", "left"]);
    assert_eq!(below("SG1", "mm/m"), ["SG1", "mm/m"]);
    assert_eq!(below("SG1 [-]", "mm/m"), ["SG1", "mm/m"]);
    // Labels of a row of units in the column of times.
    for first in ["unit", "Units", "[-]", "-", ""] {
        let text = format!("time,a\n{first},um/m\n0,1\n0.1,2\n");
        assert_eq!(
            columns(&text),
            [["a".to_owned(), "um/m".to_owned()]],
            "{first}"
        );
    }
}

#[test]
fn the_unit_of_a_binary_record_is_that_of_a_name_with_a_label() {
    for (header, name, unit) in [
        ("SG1 (left)", "SG1 (left)", "mm/m"),
        ("SG2 [m/m]", "SG2", "m/m"),
        ("SG3", "SG3", "mm/m"),
        ("SG3 [-]", "SG3", "mm/m"),
        // Labels such as top, middle, side, hind: not tonnes, metres, seconds, hours.
        ("SG4 (t)", "SG4 (t)", "mm/m"),
        ("SG4 (m)", "SG4 (m)", "mm/m"),
        ("SG4 (s)", "SG4 (s)", "mm/m"),
        ("SG4 (h)", "SG4 (h)", "mm/m"),
        ("SG4 [3]", "SG4 [3]", "mm/m"),
        ("F [kN]", "F", "kN"),
        ("V (mV/V)", "V", "mV/V"),
    ] {
        let mut bytes = Vec::new();
        let names = [header.to_owned()];
        crate::series::binary::write_header(&mut bytes, &names, 2, 0.0, 0.01, 1e-3).unwrap();
        for v in [0.5_f32; 2] {
            bytes.extend_from_slice(&v.to_le_bytes());
        }
        let record = open_record(Arc::new(bytes), &Options::default()).unwrap();
        let c = &record.columns()[0];
        assert_eq!([&*c.name, &*c.unit], [name, unit], "{header}");
    }
}

#[test]
fn a_record_whose_time_has_two_units_is_refused() {
    for text in [
        "time [s],P01\nms,um/m\n0,1\n1,2\n",
        "P01,time [s]\num/m,ms\n1,0\n2,1\n",
    ] {
        let wrong = open(text).err().map(|e| e.to_string());
        assert!(
            wrong
                .as_deref()
                .is_some_and(|w| w.contains("`s` after the name, and `ms` as the unit")),
            "{wrong:?}"
        );
    }
}

#[test]
fn names_that_are_numbers_and_empty_names_of_row_numbers_are_no_rows() {
    let record = open(",time,14,15\n0,0.0,1,2\n1,0.5,3,4\n").unwrap();
    let names: Vec<&str> = record.columns().iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["14", "15"]);
    assert_eq!(rows(&record), [[1.0, 2.0], [3.0, 4.0]]);
}

#[test]
fn faults_of_a_table_name_their_line() {
    let line = |text: &str| match open(text)
        .err()
        .unwrap_or_else(|| panic!("{text} is taken"))
    {
        SeriesError::Line { line, .. }
        | SeriesError::NotAscending { line, .. }
        | SeriesError::NoTime { line } => line,
        other => panic!("{text}: {other}"),
    };
    // Times out of order, repeated, missing. Line numbers include comments and empty lines.
    assert_eq!(line("time,a\n0,1\n# pause\n2,1\n\n1,1\n3,1\n"), 6);
    assert_eq!(line("time,a\n0,1\n1,1\n1,1\n2,1\n"), 4);
    assert_eq!(line("time,a\n0,1\n,1\n2,1\n"), 3);
    assert_eq!(line("time,a\n0,1\nabc,1\n2,1\n"), 3);
    // Fields other than the time are read later.
    for (text, wrong) in [
        ("time,a\n0,1\n1,x\n2,1\n", 3),
        ("time,a,b\n0,1,2\n1,2\n2,1,2\n", 3),
    ] {
        let record = open(text).unwrap();
        let read = record.read(0, &[Some(0)], &mut |_| ControlFlow::Continue(()));
        assert!(
            matches!(read, Err(SeriesError::Line { line, .. }) if line == wrong),
            "{text}"
        );
    }
    // A time of day that goes back, but not across midnight. A date whose day and month could be exchanged. Line ends of old Macintosh programs.
    assert_eq!(line("time,a\n13:59:59,1\n13:00:00,1\n13:00:01,1\n"), 3);
    assert_eq!(
        line("time,a\n5/1/2026 1:00:00 PM,1\n5/1/2026 1:00:01 PM,1\n"),
        2
    );
    let returns = open("time,a\r0,1\r1,1\r").err().map(|e| e.to_string());
    assert!(returns.is_some_and(|e| e.contains("carriage return")));
    // One sample has a time but no rate.
    assert_eq!(line("time,a\n0,1\n"), 2);
    for text in ["time,a\n", "time,a", ""] {
        assert!(open(text).is_err(), "{text}");
    }
    assert!(matches!(open("time,a\n").err(), Some(SeriesError::Empty)));
    assert!(matches!(
        open("time [kg],a\n0,1\n1,2\n").err(),
        Some(SeriesError::Line { .. })
    ));
}

/// Returns a table whose times follow a rule. Its only channel is twice the time.
fn table_with_times(n: usize, time: impl Fn(usize) -> f64, digits: usize) -> String {
    let mut text = String::from("time,a\n");
    for i in 0..n {
        let t = time(i);
        text.push_str(&format!("{t:.digits$},{}\n", 2.0 * t));
    }
    text
}

#[test]
fn steps_within_a_fiftieth_are_even_and_those_beyond_are_resampled_and_reported() {
    let jitter =
        |share: f64| move |i: usize| (i as f64 + if i % 2 == 1 { share } else { 0.0 }) * 0.01;
    let even = open(&table_with_times(500, jitter(0.01), 7)).unwrap();
    assert_eq!(even.clock.evenness, Evenness::Even);
    assert_eq!(rows(&even).len(), 500);
    let uneven = open(&table_with_times(500, jitter(0.05), 7)).unwrap();
    let Evenness::Resampled { largest, .. } = uneven.clock.evenness else {
        panic!("5 % is not even")
    };
    // Steps are .95 and 1.05, and the median is one of the two.
    assert!((0.04..0.12).contains(&largest), "{largest}");
    // A straight line stays a straight line: each value is twice its time.
    for (i, row) in rows(&uneven).iter().enumerate() {
        let expected = 2.0 * uneven.clock.time_s(i);
        assert!((row[0] - expected).abs() < 1e-9, "{i} {}", row[0]);
    }
    // Times rounded by printing are not jitter: 128 Hz with three digits.
    let printed = open(&table_with_times(500, |i| i as f64 / 128.0, 3)).unwrap();
    assert_eq!(printed.clock.evenness, Evenness::Even);
    assert!((printed.clock.rate_hz / 128.0 - 1.0).abs() < 1e-3);
}

#[test]
fn missing_samples_are_gaps_and_not_invented() {
    // 100 Hz, without samples 200 to 249 and 300.
    let text = table_with_times(400, |i| i as f64 * 0.01, 3);
    let kept = text
        .lines()
        .enumerate()
        .filter(|(n, _)| !(201..251).contains(n) && *n != 301);
    let kept: Vec<&str> = kept.map(|l| l.1).collect();
    let record = open(&(kept.join("\n") + "\n")).unwrap();
    let clock = &record.clock;
    assert_eq!(
        (clock.samples, clock.rows, clock.missing, clock.n_gaps),
        (400, 349, 51, 2)
    );
    assert_eq!((clock.gaps[0].missing, clock.gaps[1].missing), (50, 1));
    assert!((clock.duration_s() - 4.0).abs() < 1e-9);
    for (i, row) in rows(&record).iter().enumerate() {
        let gone = (200..250).contains(&i) || i == 300;
        assert!(
            if gone {
                row[0].is_nan()
            } else {
                (row[0] - 0.02 * i as f64).abs() < 1e-9
            },
            "{i}"
        );
    }
    // A jump of the time by years is a wrong time, not a gap.
    let far = open("time,a\n0.00,1\n0.01,1\n0.02,1\n900000000.03,1\n");
    assert!(matches!(far.err(), Some(SeriesError::Hole { .. })));
}

#[test]
fn a_rate_that_changes_is_reported_with_its_time_and_no_sample_is_called_missing() {
    // Opens a record with `rows[0]` rows at the first rate, then `rows[1]` at the second.
    let open_two = |rows: [usize; 2], hz: [f64; 2], digits: usize| {
        let end = rows[0] as f64 / hz[0];
        let time = |i: usize| match i.checked_sub(rows[0]) {
            None => i as f64 / hz[0],
            Some(after) => end + after as f64 / hz[1],
        };
        let record = open(&table_with_times(rows[0] + rows[1], time, digits)).unwrap();
        (record, end, end + (rows[1] - 1) as f64 / hz[1])
    };
    for (rows_of, hz, digits) in [
        ([1000, 1000], [500.0, 250.0], 3),
        ([1000, 1000], [250.0, 500.0], 3),
        ([5000, 2000], [500.0, 200.0], 4),
        ([300, 3000], [250.0, 1000.0], 3),
        ([200_000, 200_000], [1000.0, 500.0], 3),
    ] {
        let (record, at, end) = open_two(rows_of, hz, digits);
        let clock = &record.clock;
        let change = clock.change.unwrap_or_else(|| panic!("{hz:?}"));
        // The change is located to 20 samples.
        assert!((change.at_s - at).abs() < 20.0 / hz[0] + 1e-9, "{change:?}");
        for (found, given) in change.rates_hz.iter().zip(hz) {
            assert!((found / given - 1.0).abs() < 0.02, "{change:?}");
        }
        // A caller that needs stored samples refuses the record with the reason.
        let refused = crate::series::even_record::check_even(&record).err();
        let message = refused.map_or_else(String::new, |e| e.parts().0);
        assert!(
            message.starts_with("the sample rate changes at"),
            "{message}"
        );
        let fast = hz[0].max(hz[1]);
        assert!(
            (clock.rate_hz / fast - 1.0).abs() < 1e-3,
            "{}",
            clock.rate_hz
        );
        assert_eq!((clock.missing, clock.n_gaps), (0, 0), "{hz:?}");
        assert!(
            (clock.duration_s() - end).abs() < 2.0 / fast + 1e-3 * end,
            "{hz:?}"
        );
        // Times are rounded to `digits`, and the channel is twice the time.
        let rounding = 10f64.powi(-(digits as i32));
        for (i, row) in rows(&record).iter().enumerate() {
            let off = (row[0] - 2.0 * clock.time_s(i)).abs();
            assert!(off < 2.0 * rounding, "{i}: {row:?} {off}");
        }
    }
    // Losing every second sample over 15 samples makes gaps, and is not a change of rate.
    let kept = |i: usize| {
        i as f64
            + if i < 300 {
                0.0
            } else {
                (i - 300).min(15) as f64
            }
    };
    let lossy = open(&table_with_times(1000, |i| kept(i) * 0.002, 3)).unwrap();
    assert_eq!((lossy.clock.change, lossy.clock.missing), (None, 15));
}

/// 300,000 rows are several pieces, so that lines, gaps and uneven steps cross the piece borders.
#[test]
fn pieces_join_without_a_seam() {
    let n = 400_000;
    let even = table_with_times(n, |i| i as f64 * 0.002, 3);
    let record = open(&even).unwrap();
    assert!(record.n_pieces() > 1);
    let read = rows(&record);
    assert!(
        read.iter()
            .enumerate()
            .all(|(i, r)| (r[0] - 0.004 * i as f64).abs() < 1e-9)
    );
    let uneven = table_with_times(n, |i| (i as f64 + 0.05 * ((i * 7) % 5) as f64) * 0.002, 6);
    let record = open(&uneven).unwrap();
    assert!(matches!(record.clock.evenness, Evenness::Resampled { .. }));
    for (i, r) in rows(&record).iter().enumerate() {
        assert!(
            (r[0] - 2.0 * record.clock.time_s(i)).abs() < 1e-8,
            "{i} {}",
            r[0]
        );
    }
    // A line out of order after the first piece is reported with its line number.
    let mut lines: Vec<&str> = even.lines().collect();
    lines.swap(350_000, 350_001);
    let wrong = open(&lines.join("\n")).err();
    assert!(
        matches!(wrong, Some(SeriesError::NotAscending { line: 350_002, .. })),
        "{wrong:?}"
    );
}

#[test]
fn a_wide_table_takes_time_in_proportion_to_its_size() {
    let table = |n: usize| {
        let names: String = (0..n).map(|i| format!(",c{i}")).collect();
        let zeros = ",0".repeat(n);
        format!("time{names}\n0{zeros}\n1{zeros}\n2{zeros}\n")
    };
    // Searching all columns for each column would take hours.
    let record = open(&table(500_000)).unwrap();
    assert_eq!(rows(&record).len(), 3);
}

#[test]
fn a_record_of_ours_and_rpc_iii_are_read_in_pieces() {
    let names = ["A [kN]".to_owned(), "B [kN]".to_owned()];
    let n = 40_000;
    let mut bytes = Vec::new();
    crate::series::binary::write_header(&mut bytes, &names, n as u64, 5.0, 0.01, 1.0).unwrap();
    for i in 0..n {
        for k in 0..2 {
            bytes.extend_from_slice(&((2 * i + k) as f32).to_le_bytes());
        }
    }
    let record = open_record(Arc::new(bytes.clone()), &Options::default()).unwrap();
    assert_eq!((record.clock.start_s, record.clock.samples), (5.0, n));
    assert_eq!(
        (
            record.columns()[1].name.as_str(),
            record.columns()[1].unit.as_str()
        ),
        ("B", "kN")
    );
    assert!(
        rows(&record)
            .iter()
            .enumerate()
            .all(|(i, r)| r[..] == [2.0 * i as f64, 2.0 * i as f64 + 1.0])
    );
    let wrong = Options {
        declared_hz: Some(90.0),
        ..Options::default()
    };
    assert!(matches!(
        open_record(Arc::new(bytes), &wrong).err(),
        Some(SeriesError::Rate { .. })
    ));
}

#[cfg(feature = "parquet")]
#[test]
fn parquet_is_read_by_parts_of_row_groups() {
    use crate::series::parquet::parquet_bytes;
    let names = ["A [kN]".to_owned(), "B".to_owned()];
    let n = 600_000;
    let bytes = parquet_bytes(&names, &[], [0.5, 0.01], n, |from, to, out| {
        out.extend(
            (from..to).flat_map(|i| [i as f64, if i == 7 { f64::NAN } else { -(i as f64) }]),
        );
    })
    .unwrap();
    let record = open_record(Arc::new(bytes.clone()), &Options::default()).unwrap();
    assert_eq!((record.clock.samples, record.clock.start_s), (n, 0.5));
    assert!((record.clock.rate_hz - 100.0).abs() < 1e-6);
    for (i, r) in rows(&record).iter().enumerate() {
        assert_eq!(r[0], i as f64);
        assert!(
            if i == 7 {
                r[1].is_nan()
            } else {
                r[1] == -(i as f64)
            },
            "{i}"
        );
    }
    for cut in [0, 4, 100, bytes.len() / 2, bytes.len() - 1] {
        let cut = bytes.get(..cut).unwrap().to_vec();
        assert!(open_record(Arc::new(cut), &Options::default()).is_err());
    }
}

/// A damaged file gives a fault or another record, and never a panic.
#[test]
fn mutated_files_do_not_panic() {
    let mut seed = 7_u64;
    let mut next = move || {
        seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize
    };
    let mut files: Vec<Vec<u8>> = vec![
        table_with_times(50, |i| i as f64 * 0.01, 3).into_bytes(),
        b"Time;P01;P02\ns;um/m;\n0,0;1,5;-2\n0,1;2,5;\n0,2;3,5;4\n".to_vec(),
        b",P01\n2026-05-01 12:00:00.0,1.5\n2026-05-01 12:00:00.1,2.5\n".to_vec(),
    ];
    #[cfg(feature = "parquet")]
    files.push(
        crate::series::parquet::parquet_bytes(&["a".into()], &[], [0.0, 0.1], 100, |f, t, out| {
            out.extend((f..t).map(|i| i as f64));
        })
        .unwrap(),
    );
    for file in &mut files {
        for _ in 0..400 {
            let mut bytes = file.clone();
            for _ in 0..1 + next() % 4 {
                let at = next() % bytes.len();
                match next() % 3 {
                    0 => bytes[at] = next() as u8,
                    1 => bytes.truncate(at.max(1)),
                    _ => bytes.insert(at, next() as u8),
                }
            }
            if let Ok(record) = open_record(Arc::new(bytes), &Options::default()) {
                let picks: Vec<Option<usize>> = (0..record.columns().len()).map(Some).collect();
                for piece in 0..record.n_pieces() {
                    let mut left = 10_000;
                    let _ = record.read(piece, &picks, &mut |block| {
                        left -= block.rows.min(left);
                        if left == 0 {
                            ControlFlow::Break(())
                        } else {
                            ControlFlow::Continue(())
                        }
                    });
                }
            }
        }
    }
}
