use crate::series::error::SeriesError;
use crate::series::record::{Options, OtherChannel, Record, open_record};
use std::sync::Arc;

/// Seconds from 1904 to 2026-05-01 12:00:00.
const NOON: i64 = 2_082_844_800 + 20_574 * 86_400 + 43_200;

enum Property {
    Real(f64),
    Text(&'static str),
    /// Timestamp as seconds since 1904 and a fraction.
    Time(i64, f64),
}

enum Samples {
    Reals(Vec<f64>),
    /// Timestamp as seconds since 1904.
    Times(Vec<f64>),
}

use Property as P;

struct Channel {
    path: &'static str,
    properties: Vec<(&'static str, Property)>,
    samples: Samples,
}

fn channel(path: &'static str, properties: Vec<(&'static str, Property)>) -> Channel {
    let samples = Samples::Reals((0..200).map(f64::from).collect());
    Channel {
        path,
        properties,
        samples,
    }
}

fn stamp(seconds: i64, fraction: f64) -> Vec<u8> {
    let fraction = (fraction * 2_f64.powi(64)) as u64;
    [fraction.to_le_bytes(), seconds.to_le_bytes()].concat()
}

fn text(t: &str) -> Vec<u8> {
    [&(t.len() as u32).to_le_bytes()[..], t.as_bytes()].concat()
}

/// Returns a file of one segment.
fn file(channels: &[Channel]) -> Vec<u8> {
    let mut head = (channels.len() as u32).to_le_bytes().to_vec();
    let mut raw = Vec::new();
    for c in channels {
        head.extend(text(c.path));
        let (kind, n) = match &c.samples {
            Samples::Reals(v) => (10_u32, v.len()),
            Samples::Times(v) => (0x44, v.len()),
        };
        for word in [20_u32, kind, 1] {
            head.extend(word.to_le_bytes());
        }
        head.extend((n as u64).to_le_bytes());
        match &c.samples {
            Samples::Reals(v) => v.iter().for_each(|v| raw.extend(v.to_le_bytes())),
            Samples::Times(v) => v.iter().for_each(|v| {
                raw.extend(stamp(v.floor() as i64, v - v.floor()));
            }),
        }
        head.extend((c.properties.len() as u32).to_le_bytes());
        for (key, value) in &c.properties {
            head.extend(text(key));
            let (kind, bytes) = match value {
                P::Real(v) => (10_u32, v.to_le_bytes().to_vec()),
                P::Text(t) => (0x20, text(t)),
                P::Time(s, f) => (0x44, stamp(*s, *f)),
            };
            head.extend(kind.to_le_bytes());
            head.extend(bytes);
        }
    }
    let mut out = b"TDSm".to_vec();
    out.extend(14_u32.to_le_bytes());
    out.extend(4713_u32.to_le_bytes());
    out.extend(((head.len() + raw.len()) as u64).to_le_bytes());
    out.extend((head.len() as u64).to_le_bytes());
    [out, head, raw].concat()
}

fn open(channels: &[Channel], wanted: &[&str]) -> Result<Record, SeriesError> {
    let options = Options {
        wanted: wanted.iter().map(|w| (*w).to_owned()).collect(),
        ..Options::default()
    };
    open_record(Arc::new(file(channels)), &options)
}

/// Returns two channels at 100 Hz. The second one starts later.
fn pair(offset_s: f64, start: (i64, f64)) -> [Channel; 2] {
    let clock = |offset, start: (i64, f64)| {
        vec![
            ("wf_increment", P::Real(0.01)),
            ("wf_start_offset", P::Real(offset)),
            ("wf_start_time", P::Time(start.0, start.1)),
        ]
    };
    [
        channel("/'g'/'P1'", clock(0.0, (NOON, 0.25))),
        channel("/'g'/'P2'", clock(offset_s, start)),
    ]
}

#[test]
fn channels_that_begin_at_other_times_are_not_read_as_simultaneous() {
    let same = open(&pair(0.0, (NOON, 0.25)), &["P1", "P2"]).unwrap();
    assert_eq!((same.columns().len(), same.clock.samples), (2, 200));
    // Accepted: a converter that lags by a hundredth of a step, and an offset that compensates the start.
    assert!(open(&pair(0.0, (NOON, 0.2501)), &["P1", "P2"]).is_ok());
    assert!(open(&pair(-0.5, (NOON, 0.75)), &["P1", "P2"]).is_ok());
    for (offset, start) in [
        (0.05, (NOON, 0.25)),
        (0.0, (NOON + 2, 0.25)),
        (0.0, (NOON, 0.26)),
        (-0.01, (NOON, 0.25)),
    ] {
        let apart = open(&pair(offset, start), &["P1", "P2"]);
        assert!(
            matches!(apart.err(), Some(SeriesError::Apart { .. })),
            "{offset}"
        );
        // Only the channels of one clock are read.
        let one = open(&pair(offset, start), &["P2"]).unwrap();
        assert_eq!(one.columns().len(), 1);
        assert_eq!(one.columns()[0].name, "P2");
    }
}

#[test]
fn a_channel_of_times_counts_in_its_unit_or_in_points_of_time() {
    let mut times = channel("/'g'/'Time'", vec![("unit_string", P::Text("ms"))]);
    times.samples = Samples::Reals((0..200).map(|i| f64::from(i) * 10.0).collect());
    let record = open(&[times, channel("/'g'/'P1'", Vec::new())], &["P1"]).unwrap();
    assert!((record.clock.rate_hz - 100.0).abs() < 1e-9);
    assert!(record.is_time_unit_stated());
    let mut stamps = channel("/'g'/'when'", Vec::new());
    let at = |i: i32| NOON as f64 + f64::from(i) / 64.0;
    stamps.samples = Samples::Times((0..200).map(at).collect());
    let record = open(&[stamps, channel("/'g'/'P1'", Vec::new())], &["P1"]).unwrap();
    assert!((record.clock.rate_hz - 64.0).abs() < 1e-6);
    assert_eq!(record.clock.epoch_s, Some(20_574.5 * 86_400.0));
    assert_eq!(record.columns().len(), 1);
}

#[test]
fn each_group_has_its_own_channel_of_times() {
    let times = |path, first: f64| {
        let mut c = channel(path, vec![("unit_string", P::Text("s"))]);
        c.samples = Samples::Reals((0..200).map(|i| first + f64::from(i) * 0.01).collect());
        c
    };
    let groups = |first| {
        [
            times("/'a'/'Time'", 0.0),
            channel("/'a'/'P1'", Vec::new()),
            times("/'b'/'Time'", first),
            channel("/'b'/'P2'", Vec::new()),
        ]
    };
    assert!(open(&groups(0.0), &["P1", "P2"]).is_ok());
    let apart = open(&groups(3.0), &["P1", "P2"]);
    assert!(matches!(apart.err(), Some(SeriesError::Apart { .. })));
    let second = open(&groups(3.0), &["P2"]).unwrap();
    assert!((second.clock.start_s - 3.0).abs() < 1e-12);
}

#[test]
fn channels_at_other_times_and_channels_without_samples_are_listed_by_group() {
    let clock = |step| {
        vec![
            ("wf_increment", P::Real(step)),
            ("unit_string", P::Text("V")),
        ]
    };
    let mut slow = channel("/'slow'/'battery'", clock(1.0));
    slow.samples = Samples::Reals(vec![24.0; 3]);
    let mut empty = channel("/'notes'/'remark'", Vec::new());
    empty.samples = Samples::Reals(Vec::new());
    let list = [channel("/'strain'/'P1'", clock(0.01)), slow, empty];
    let record = open(&list, &[]).unwrap();
    let names: Vec<&str> = record.columns().iter().map(|c| c.name.as_str()).collect();
    assert_eq!((names, record.group(0)), (vec!["P1"], "strain"));
    let other = |group: &str, name: &str, unit: &str, samples, rate_hz| OtherChannel {
        group: group.into(),
        name: name.into(),
        unit: unit.into(),
        samples,
        rate_hz,
    };
    let expected = [
        other("slow", "battery", "V", 3, Some(1.0)),
        other("notes", "remark", "", 0, None),
    ];
    assert_eq!(record.other_channels(), expected);
}

/// Returns a channel of a waveform with 10 units between its samples.
fn waveform(path: &'static str, more: Vec<(&'static str, Property)>) -> Channel {
    let mut properties = vec![("wf_increment", P::Real(10.0))];
    properties.extend(more);
    channel(path, properties)
}

#[test]
fn the_unit_of_the_axis_of_a_waveform_counts() {
    let unit = |u| vec![("wf_xunit_string", P::Text(u))];
    for (u, step_s) in [("ms", 0.01), ("s", 10.0), ("us", 1e-5)] {
        let record = open(&[waveform("/'g'/'P1'", unit(u))], &["P1"]).unwrap();
        assert!((record.clock.rate_hz * step_s - 1.0).abs() < 1e-12, "{u}");
        assert!(record.is_time_unit_stated());
    }
    // Without a unit they are seconds, unless the job states one.
    let bytes = Arc::new(file(&[waveform("/'g'/'P1'", Vec::new())]));
    for (time_unit_s, rate_hz) in [(None, 0.1), (Some(1e-3), 100.0)] {
        let options = Options {
            time_unit_s,
            ..Options::default()
        };
        let record = open_record(bytes.clone(), &options).unwrap();
        assert!((record.clock.rate_hz / rate_hz - 1.0).abs() < 1e-12);
        assert_eq!(record.is_time_unit_stated(), time_unit_s.is_some());
    }
}

#[test]
fn a_waveform_over_frequency_is_refused_and_left_out_next_to_others() {
    let spectrum = |name, unit| {
        let axis = vec![
            ("wf_xname", P::Text(name)),
            ("wf_xunit_string", P::Text(unit)),
        ];
        waveform("/'g'/'P1'", axis)
    };
    for (name, unit) in [
        ("Frequency", "Hz"),
        ("Frequency", ""),
        ("", "mm"),
        ("Angle", "deg"),
    ] {
        let refused = open(&[spectrum(name, unit)], &["P1"]).err().unwrap();
        assert!(refused.to_string().contains("`P1` are over"), "{refused}");
    }
    for (name, unit) in [("Time", ""), ("Zeit", "s"), ("Relative time", ""), ("", "")] {
        assert!(
            open(&[spectrum(name, unit)], &["P1"]).is_ok(),
            "{name} {unit}"
        );
    }
    let both = [
        spectrum("Frequency", "Hz"),
        waveform("/'g'/'P2'", Vec::new()),
    ];
    let record = open(&both, &["P2"]).unwrap();
    assert_eq!(
        (record.columns().len(), record.other_channels().len()),
        (1, 1)
    );
}

#[test]
fn segments_that_do_not_follow_each_other_are_refused() {
    // 200 samples at 100 Hz: 2 s.
    let part = |seconds: i64, fraction: f64, step: f64| {
        let clock = vec![
            ("wf_increment", P::Real(step)),
            ("wf_start_time", P::Time(NOON + seconds, fraction)),
        ];
        file(&[channel("/'g'/'P1'", clock)])
    };
    let joined = |second: Vec<u8>| {
        let bytes = [part(0, 0.25, 0.01), second].concat();
        open_record(Arc::new(bytes), &Options::default())
    };
    // An equal start is the start of the channel. A computer clock has a resolution of 16 ms.
    for second in [
        part(0, 0.25, 0.01),
        part(2, 0.25, 0.01),
        part(2, 0.26, 0.01),
    ] {
        assert_eq!(joined(second).unwrap().clock.samples, 400);
    }
    for second in [
        part(100, 0.25, 0.01),
        part(2, 0.5, 0.01),
        part(1, 0.25, 0.01),
    ] {
        let refused = joined(second).err().unwrap().to_string();
        assert!(
            refused.contains("two parts with a time step between them"),
            "{refused}"
        );
    }
    let refused = joined(part(2, 0.25, 0.02)).err().unwrap().to_string();
    assert!(refused.contains("time between samples"), "{refused}");
}

#[test]
fn a_channel_of_times_that_contradicts_the_step_of_the_others_is_refused() {
    let with = |step: f64, unit: &'static str| {
        let mut times = channel("/'g'/'Time'", vec![("unit_string", P::Text(unit))]);
        times.samples = Samples::Reals((0..200).map(|i| f64::from(i) * step).collect());
        open(&[times, waveform("/'g'/'P1'", Vec::new())], &["P1"])
    };
    // 10 s between samples.
    for (step, unit) in [(10.0, "s"), (10.0, ""), (1e4, "ms"), (1e4, "")] {
        let record = with(step, unit).unwrap();
        assert!((record.clock.rate_hz - 0.1).abs() < 1e-12, "{step} {unit}");
    }
    for (step, unit) in [(5.0, "s"), (10.0, "ms"), (20.0, "")] {
        let refused = with(step, unit).err().unwrap().to_string();
        assert!(refused.contains("`wf_increment`"), "{refused}");
    }
}
