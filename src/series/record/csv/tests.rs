//! Tables in the formats of measuring programs, written by hand after real exports, and tables with an ambiguous format.

use super::Csv;
use crate::series::error::SeriesError;
use crate::series::record::{Evenness, Record};
use std::ops::ControlFlow;
use std::sync::Arc;

fn open(bytes: &[u8]) -> Result<Record, SeriesError> {
    Record::new(Box::new(Csv::new(Arc::new(bytes.to_vec()))?), None, None)
}

/// Returns the samples of a column.
fn samples(record: &Record, name: &str) -> Result<Vec<f64>, SeriesError> {
    let at = record.columns().iter().position(|c| c.name == name);
    assert!(at.is_some(), "{name}: {:?}", record.columns());
    let mut out = Vec::new();
    for piece in 0..record.n_pieces() {
        record.read(piece, &[at], &mut |block| {
            out.extend_from_slice(block.values);
            ControlFlow::Continue(())
        })?;
    }
    Ok(out)
}

/// Returns the reason for which a table is refused when it is opened or read.
fn refusal(text: &str) -> String {
    let record = match open(text.as_bytes()) {
        Err(e) => return e.to_string(),
        Ok(record) => record,
    };
    let n = record.columns().len();
    let columns: Vec<Option<usize>> = (0..n).map(Some).collect();
    let read = (0..record.n_pieces())
        .try_for_each(|p| record.read(p, &columns, &mut |_| ControlFlow::Continue(())));
    match read {
        Err(e) => e.to_string(),
        Ok(()) => panic!("read: {text}"),
    }
}

const CATMAN: &str = "HBM_CATMAN_DATAFILE_ASCII\t5.2\r\nTest drive, lap 3\r\nChannels\t3\r\n\r\n\
    Time  1 - default sample rate\tSG1\tSG2\r\ns\tµm/m\tµm/m\r\n\
    0,00\t1250,5\t-3,25\r\n0,01\t1251,5\t1.#QNAN\r\n0,02\t1252,5\t-1,25\r\n";

const FAMOS: &str = "\"Zeit\";\"SG1\";\"SG2\"\n\"s\";\"um/m\";\"um/m\"\n\
    0,00;1250,5;-3,25\n0,01;1251,5;-nan(ind)\n0,02;1252,5;-1,25\n";

const DIADEM: &str = "Zeit;SG1;SG2\n[s];[um/m];[um/m]\n\
    0,000000E+00;1,250500E+03;-3,250000E+00\n1,000000E-02;1,251500E+03;NaN\n2,000000E-02;1,252500E+03;-1,250000E+00\n";

const MOTEC: &str = "\"Format\",\"MoTeC CSV File\",,,\"Workbook\",\"\"\n\"Venue\",\"North\",,,\"Worksheet\",\"\"\n\
    \"Log Date\",\"31/05/2026\",,,\"Device\",\"L180\"\n\"Log Time\",\"14:32:11\",,,\"Comment\",\"\"\n\
    \"Sample Rate\",\"100.000\",\"Hz\",,\"Duration\",\"0.030\",\"s\"\n\n\
    \"Time\",\"SG1\",\"SG2\"\n\"s\",\"um/m\",\"um/m\"\n\n\
    \"0.000\",\"1250.5\",\"-3.25\"\n\"0.010\",\"1251.5\",\"\"\n\"0.020\",\"1252.5\",\"-1.25\"\n";

const OF_DAY: &str = "Time;SG1 [um/m];SG2 [um/m]\n09:15:02.000;1250.5;-3.25\n09:15:02.010;1251.5;#N/A\n09:15:02.020;1252.5;-1.25\n";

const DATED: &str = "Date;Time;SG1 [um/m];SG2 [um/m]\n\
    31.05.2026;09:15:02,000;1250,5;-3,25\n31.05.2026;09:15:02,010;1251,5;#NV\n31.05.2026;09:15:02,020;1252,5;-1,25\n";

#[test]
fn a_name_that_begins_with_a_quotation_mark_keeps_it() {
    let record = open(b"Time,\"\"\"A\"\" front\",B\n0.0,1,2\n0.1,3,4\n").unwrap();
    assert_eq!(samples(&record, "\"A\" front").unwrap(), [1.0, 3.0]);
}

#[test]
fn tables_in_the_manners_of_measuring_programs_are_one_record() {
    let latin: Vec<u8> = CATMAN.chars().map(|c| c as u8).collect();
    let mut files: Vec<(String, Vec<u8>)> = vec![("catman in Latin-1".into(), latin)];
    for (name, text) in [
        ("catman", CATMAN),
        ("FAMOS", FAMOS),
        ("DIAdem", DIADEM),
        ("MoTeC", MOTEC),
        ("time of day", OF_DAY),
        ("date and time", DATED),
    ] {
        files.push((name.into(), text.as_bytes().to_vec()));
        let units = || text.encode_utf16();
        let mut low = vec![0xff, 0xfe];
        units().for_each(|u| low.extend(u.to_le_bytes()));
        let mut high = vec![0xfe, 0xff];
        units().for_each(|u| high.extend(u.to_be_bytes()));
        files.push((format!("{name} in UTF-16, low byte first"), low));
        files.push((format!("{name} in UTF-16, high byte first"), high));
    }
    for (name, bytes) in files {
        let record = open(&bytes).unwrap_or_else(|e| panic!("{name}: {e}"));
        let clock = &record.clock;
        assert_eq!((clock.samples, clock.n_gaps), (3, 0), "{name}");
        assert_eq!(clock.evenness, Evenness::Even, "{name}");
        assert!(
            (clock.rate_hz - 100.0).abs() < 1e-3,
            "{name}: {}",
            clock.rate_hz
        );
        assert!(record.is_time_unit_stated(), "{name}");
        let of = |c: &str| samples(&record, c).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(of("SG1"), [1250.5, 1251.5, 1252.5], "{name}");
        let second = of("SG2");
        assert_eq!((second[0], second[2]), (-3.25, -1.25), "{name}");
        assert!(second[1].is_nan(), "{name}");
        for c in record.columns() {
            assert!(["um/m", "µm/m"].contains(&c.unit.as_str()), "{name}: {c:?}");
        }
    }
}

#[test]
fn numbers_whose_marks_may_be_read_in_two_ways_are_refused_with_their_line() {
    for (text, line, words) in [
        // Thousands with points in a table of decimal commas, and with commas in a table of decimal points. Thousands with blanks and apostrophes.
        (
            "time;A\n0,0;12,5\n0,1;1.250\n0,2;13,5\n",
            "line 3",
            "`1.250`",
        ),
        (
            "time;A\n0.0;12.5\n0.1;1,250\n0.2;13.5\n",
            "line 3",
            "`1,250`",
        ),
        ("time;A\n0,0;1.250,5\n0,1;1.251,5\n", "line 2", "1.250,5"),
        ("time;A\n0,0;1 250,5\n0,1;1 251,5\n", "line 2", "1 250,5"),
        ("time;A\n0.0;1'250.5\n0.1;1'251.5\n", "line 2", "1'250.5"),
        (
            "time,A\n0.0,\"1,250.5\"\n0.1,\"1,251.5\"\n",
            "line 2",
            "1,250.5",
        ),
        // Whole numbers with thousands separators.
        (
            "time [ms];A\n0;998\n1;999\n2;1.000\n3;1.001\n",
            "line 4",
            "`1.000`",
        ),
        (
            "time [ms]\tA\n0\t-998\n1\t-999\n2\t-1,000\n3\t-1,001\n",
            "line 4",
            "`-1,000`",
        ),
    ] {
        let message = refusal(text);
        assert!(
            message.contains(line) && message.contains(words),
            "{text}: {message}"
        );
    }
    // A thousands separator is also refused after the rows that determine the layout.
    let mut long = String::from("time [ms];A\n");
    (0..900).for_each(|i| long.push_str(&format!("{i};{}\n", 100 + i % 800)));
    long.push_str("900;1.050\n");
    let message = refusal(&long);
    assert!(
        message.contains("line 902") && message.contains("`1.050`"),
        "{message}"
    );
    // Three digits after the point are a fraction if other numbers prove it.
    let record = open(b"time;A\n0.000;-1.250\n0.001;12\n0.002;1.375\n0.003;15\n").unwrap();
    assert_eq!(samples(&record, "A").unwrap(), [-1.25, 12.0, 1.375, 15.0]);
}

#[test]
fn clocks_that_are_set_back_are_refused_and_set_forward_leave_a_gap() {
    // The repeated hour at the end of summer time, and the skipped hour at its start.
    let back = "Time;A\n2026-10-25 02:59:59.0;1.5\n2026-10-25 02:59:59.5;2.5\n2026-10-25 02:00:00.0;3.5\n2026-10-25 02:00:00.5;4.5\n";
    let message = refusal(back);
    assert!(message.contains("line 4"), "{message}");
    let midnight = "Time;A\n23:59:59.0;1.5\n23:59:59.5;2.5\n00:00:00.0;3.5\n00:00:00.5;4.5\n";
    let record = open(midnight.as_bytes()).unwrap();
    assert_eq!((record.clock.n_gaps, record.clock.samples), (0, 4));
    assert!((record.clock.rate_hz - 2.0).abs() < 1e-12);
    let forward = "Time;A\n2026-03-29 01:59:59.0;1.5\n2026-03-29 01:59:59.5;2.5\n2026-03-29 03:00:00.0;3.5\n2026-03-29 03:00:00.5;4.5\n";
    let record = open(forward.as_bytes()).unwrap();
    assert_eq!((record.clock.n_gaps, record.clock.missing), (1, 7200));
    let values = samples(&record, "A").unwrap();
    assert_eq!(values.iter().filter(|v| v.is_finite()).count(), 4);
}

/// The offset from UTC of each row counts: clocks go forward between the second and the third row.
#[test]
fn times_with_an_offset_and_units_in_the_name_of_a_column_are_read() {
    for text in [
        "time,A\n2026-03-29T01:59:59.980+01:00,1\n2026-03-29T01:59:59.990+01:00,2\n2026-03-29T03:00:00.000+02:00,3\n",
        "time,A\n2026-03-29 01:59:59.980-0130,1\n2026-03-29 01:59:59.990-0130,2\n2026-03-29 02:00:00.000-0130,3\n",
        "time_ms,A\n0,1\n10,2\n20,3\n",
        "T_us;A\n0;1\n1e4;2\n2e4;3\n",
    ] {
        let record = open(text.as_bytes()).unwrap_or_else(|e| panic!("{text}: {e}"));
        let rate = record.clock.rate_hz;
        assert!((rate - 100.0).abs() < 1e-2, "{text}: {rate}");
        assert_eq!(samples(&record, "A").unwrap(), [1.0, 2.0, 3.0], "{text}");
    }
    let words = refusal("time,A\n3/1/2026 10:00:00.000 AM,1\n3/1/2026 10:00:00.010 AM,2\n");
    assert!(
        words.contains("an ambiguous order of day and month"),
        "{words}"
    );
    assert!(words.contains("2026-03-01"), "{words}");
}

#[test]
fn a_stated_unit_of_time_that_contradicts_the_header_is_refused() {
    let open = |text: &str, second: f64| {
        let reader = Csv::new(Arc::new(text.as_bytes().to_vec()))?;
        Record::new(Box::new(reader), None, Some(second))
    };
    let rate = |text: &str| open(text, 1e-3).map(|r| r.clock.rate_hz.round());
    for text in [
        "time [s],A\n0,1\n10,2\n20,3\n",
        "time_us,A\n0,1\n10,2\n20,3\n",
    ] {
        let words = rate(text).unwrap_err().to_string();
        assert!(words.contains("`time_unit` of 0.001 s"), "{words}");
    }
    for text in [
        "time,A\n0,1\n10,2\n20,3\n",
        "time [ms],A\n0,1\n10,2\n20,3\n",
    ] {
        assert_eq!(rate(text).unwrap(), 100.0, "{text}");
    }
}
