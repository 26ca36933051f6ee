//! `identify` on one record in all formats of loggers and their programs. The parameters equal those of the plain
//! table.

use serde_json::Value;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use strainbridge::series::{binary, rpc};

const NAMES: [&str; 3] = ["a_body", "a_wheel", "f_wheel"];
const G: f64 = 9.80665;

/// Returns times in s and samples of the quarter truck of the examples, m/s2 and N.
fn record() -> (Vec<f64>, [Vec<f64>; 3]) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/quarter_truck/data.csv");
    let text = std::fs::read_to_string(path).unwrap();
    let (mut times, mut columns) = (Vec::new(), [const { Vec::new() }; 3]);
    for line in text.lines().skip(1) {
        let v: Vec<f64> = line.split(',').map(|x| x.parse().unwrap()).collect();
        times.push(v[0]);
        (0..3).for_each(|c| columns[c].push(v[c + 1]));
    }
    (times, columns)
}

/// Returns the same samples in g and kN.
fn in_g(columns: &[Vec<f64>; 3]) -> [Vec<f64>; 3] {
    let factors = [1.0 / G, 1.0 / G, 1e-3];
    [0, 1, 2].map(|c| columns[c].iter().map(|v| v * factors[c]).collect())
}

fn table(
    head: &str,
    times: &[f64],
    columns: &[Vec<f64>; 3],
    [between, point]: [&str; 2],
) -> String {
    let mut out = format!("{head}\n");
    for (i, t) in times.iter().enumerate() {
        let [a, b, c] = [0, 1, 2].map(|k| columns[k][i]);
        let row = format!("{t:.3}|{a:.9}|{b:.9}|{c:.9}");
        let _ = writeln!(out, "{}", row.replace('.', point).replace('|', between));
    }
    out
}

/// Returns exit code, result and messages of `identify` on a record in `file`, without a held-out record.
fn identify(dir: &Path, file: &str, bytes: &[u8]) -> (Option<i32>, Value, String) {
    std::fs::create_dir_all(dir).unwrap();
    std::fs::write(dir.join(file), bytes).unwrap();
    let job = format!(
        "units = \"m-kg-s\"\n[vehicle]\nmodel = \"front2\"\nterms = [\"k_s\", \"c_s\"]\ndata = \"{file}\"\nband_hz = [0.7, 20.0]\n"
    );
    std::fs::write(dir.join("job.toml"), job).unwrap();
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(["identify", dir.join("job.toml").to_str().unwrap(), "--json"])
        .output()
        .unwrap();
    let printed = String::from_utf8_lossy(&done.stderr).into_owned();
    let result = serde_json::from_slice(&done.stdout).unwrap_or(Value::Null);
    (done.status.code(), result, printed)
}

fn folder(name: &str) -> PathBuf {
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&dir);
    dir
}

#[test]
fn every_format_of_a_record_gives_the_parameters_of_the_plain_table() {
    let dir = folder("identify_formats");
    let (times, si) = record();
    let of_g = in_g(&si);
    let commas = [",", "."];
    let plain = table("t,a_body,a_wheel,f_wheel", &times, &si, commas);
    let (code, expected, printed) = identify(&dir, "plain.csv", plain.as_bytes());
    assert_eq!(code, Some(0), "{printed}");
    let ms: Vec<f64> = times.iter().map(|t| 1e3 * t).collect();
    let german = "Zeit [ms];a_body;a_wheel;f_wheel\n;g;g;kN";
    let german = table(german, &ms, &of_g, [";", ","]);
    let utf16: Vec<u8> = [0xff, 0xfe]
        .into_iter()
        .chain(german.encode_utf16().flat_map(u16::to_le_bytes))
        .collect();
    let squared = "time [s],a_body [m/s\u{b2}],a_wheel [m/s\u{b2}],f_wheel [N]";
    let squared = table(squared, &times, &si, commas);
    // Encoding as on Windows: every character of this table is one byte of Latin 1.
    let latin: Vec<u8> = squared.chars().map(|c| c as u8).collect();
    let powers = "time [s],a_body (m/s^2),a_wheel (m/s^2),f_wheel (N)";
    let powers = table(powers, &times, &si, commas);
    let mut files: Vec<(&str, Vec<u8>, f64)> = vec![
        ("german.csv", german.into_bytes(), 1e-6),
        ("utf16.csv", utf16, 1e-6),
        ("squared.csv", squared.into_bytes(), 1e-6),
        ("latin.csv", latin, 1e-6),
        ("powers.csv", powers.into_bytes(), 1e-6),
        // 32-bit reals have seven digits, of which five remain after two integrations.
        ("record.bin", binary_record(&si, &times), 1e-4),
        // Sixteen bits: 1/32767 of full scale.
        ("record.rsp", rpc3(&of_g, &times), 1e-2),
        ("record.tdms", tdms(&of_g, &times), 1e-6),
        ("record.uff", uff(&of_g, &times), 1e-6),
    ];
    #[cfg(feature = "parquet")]
    files.push(("record.parquet", parquet(&of_g, &times), 1e-4));
    #[cfg(feature = "mdf")]
    files.push(("record.mf4", mdf4(&of_g, &times), 1e-6));
    #[cfg(all(feature = "xlsx", feature = "report"))]
    files.push(("record.xlsx", xlsx(&of_g, &times), 1e-6));
    for (file, bytes, tolerance) in files {
        let (code, found, printed) = identify(&dir, file, &bytes);
        assert_eq!(code, Some(0), "{file}: {printed}");
        let lists = [&expected, &found].map(|r| r["parameters"].as_array().unwrap().clone());
        assert_eq!(lists[0].len(), 4);
        for (a, b) in lists[0].iter().zip(&lists[1]) {
            assert_eq!(a["name"], b["name"], "{file}");
            let [a, b, sigma] =
                [&a["value"], &b["value"], &a["sigma"]].map(|v| v.as_f64().unwrap());
            assert!(
                (a - b).abs() < tolerance * a.abs() + 0.02 * sigma * tolerance,
                "{file}: {a} {b}"
            );
        }
    }
}

/// Columns that the model does not use may have any unit. Used columns must have the unit of their quantity.
#[test]
fn units_of_channels_that_are_not_used_do_not_matter_and_those_of_used_ones_do() {
    let dir = folder("identify_units");
    let (times, si) = record();
    let head = "t [s],a_body [m/s2],a_wheel [m/s2],f_wheel [N]";
    let text = table(head, &times, &si, [",", "."]);
    let with = |name: &str| -> String {
        let rows = text.lines().skip(1).enumerate();
        let rows = rows.map(|(i, l)| format!("{l},{:.4}\n", 21.5 + (0.01 * i as f64).sin()));
        format!("{head},{name}\n{}", rows.collect::<String>())
    };
    let (code, _, printed) = identify(&dir, "other.csv", with("temperature [degC]").as_bytes());
    assert_eq!(code, Some(0), "{printed}");
    for (wrong, expected) in [
        ("a_body [N]", "`N` is not a unit of acceleration"),
        ("a_body [degC]", "`degC` is not a unit of acceleration"),
        ("f_wheel [m/s2]", "`m/s2` is not a unit of force"),
    ] {
        let name = wrong.split(' ').next().unwrap();
        let right = head.split(',').find(|h| h.starts_with(name)).unwrap();
        let text = text.replacen(right, wrong, 1);
        let (code, _, printed) = identify(&dir, "wrong.csv", text.as_bytes());
        assert_eq!(code, Some(2), "{wrong}: {printed}");
        assert!(
            printed.contains(expected) && printed.contains(name),
            "{printed}"
        );
    }
}

fn headers() -> Vec<String> {
    let units = ["g", "g", "kN"];
    (0..3)
        .map(|c| format!("{} [{}]", NAMES[c], units[c]))
        .collect()
}

fn step(times: &[f64]) -> f64 {
    times[1] - times[0]
}

fn rows(columns: &[Vec<f64>; 3]) -> impl FnMut(usize, usize, &mut Vec<f64>) + '_ {
    |from, to, out| out.extend((from..to).flat_map(|i| [0, 1, 2].map(|c| columns[c][i])))
}

fn binary_record(si: &[Vec<f64>; 3], times: &[f64]) -> Vec<u8> {
    let names = ["a_body [m/s2]", "a_wheel [m/s2]", "f_wheel [N]"].map(str::to_owned);
    let n = times.len();
    let mut out = Vec::new();
    binary::write_header(&mut out, &names, n as u64, 0.0, step(times), 1.0).unwrap();
    for i in 0..n {
        (0..3).for_each(|c| out.extend((si[c][i] as f32).to_le_bytes()));
    }
    out
}

fn rpc3(of_g: &[Vec<f64>; 3], times: &[f64]) -> Vec<u8> {
    let targets: Vec<rpc::Target> = (0..3)
        .map(|c| rpc::Target {
            name: NAMES[c].to_owned(),
            unit: ["g", "g", "kN"][c].to_owned(),
            min: of_g[c].iter().copied().fold(f64::INFINITY, f64::min),
            max: of_g[c].iter().copied().fold(f64::NEG_INFINITY, f64::max),
        })
        .collect();
    let mut out = Vec::new();
    rpc::write_rpc(&mut out, &targets, step(times), times.len(), rows(of_g)).unwrap();
    out
}

#[cfg(feature = "parquet")]
fn parquet(of_g: &[Vec<f64>; 3], times: &[f64]) -> Vec<u8> {
    let (names, at) = (headers(), [0.0, step(times)]);
    strainbridge::series::parquet::parquet_bytes(&names, &[], at, times.len(), rows(of_g)).unwrap()
}

/// A separate group for each channel, as loggers with several modules write them.
#[cfg(feature = "mdf")]
fn mdf4(of_g: &[Vec<f64>; 3], times: &[f64]) -> Vec<u8> {
    let mut file = falcon_mdf::Mf4Writer::new();
    for c in 0..3 {
        let group = file.add_group(times).unwrap();
        let unit = ["g", "g", "kN"][c];
        group.add_channel(NAMES[c], unit, &of_g[c]).unwrap();
    }
    let mut out = Vec::new();
    file.write(&mut out).unwrap();
    out
}

#[cfg(all(feature = "xlsx", feature = "report"))]
fn xlsx(of_g: &[Vec<f64>; 3], times: &[f64]) -> Vec<u8> {
    let mut book = rust_xlsxwriter::Workbook::new();
    let sheet = book.add_worksheet();
    let head = std::iter::once("time [s]".to_owned()).chain(headers());
    for (c, name) in head.enumerate() {
        sheet.write_string(0, c as u16, name).unwrap();
    }
    for (i, t) in times.iter().enumerate() {
        let row = [*t, of_g[0][i], of_g[1][i], of_g[2][i]];
        for (c, v) in row.into_iter().enumerate() {
            sheet.write_number(i as u32 + 1, c as u16, v).unwrap();
        }
    }
    book.save_to_buffer().unwrap()
}

/// TDMS of one segment, with a longer channel of another clock that `identify` does not use.
///
/// # Reference
/// National Instruments, TDMS File Format Internal Structure (2024).
fn tdms(of_g: &[Vec<f64>; 3], times: &[f64]) -> Vec<u8> {
    fn text(out: &mut Vec<u8>, s: &str) {
        out.extend((s.len() as u32).to_le_bytes());
        out.extend(s.as_bytes());
    }
    let noise = vec![0.5; 5 * times.len()];
    let channels = [
        ("vehicle", NAMES[0], "g", step(times), &of_g[0]),
        ("vehicle", NAMES[1], "g", step(times), &of_g[1]),
        ("vehicle", NAMES[2], "kN", step(times), &of_g[2]),
        ("sound", "microphone", "Pa", step(times) / 5.0, &noise),
    ];
    let mut list = (channels.len() as u32).to_le_bytes().to_vec();
    let mut data = Vec::new();
    for (group, name, unit, dt, samples) in channels {
        text(&mut list, &format!("/'{group}'/'{name}'"));
        list.extend([20_u32, 10, 1].iter().flat_map(|w| w.to_le_bytes()));
        list.extend((samples.len() as u64).to_le_bytes());
        list.extend(2_u32.to_le_bytes());
        text(&mut list, "wf_increment");
        list.extend(10_u32.to_le_bytes());
        list.extend(dt.to_le_bytes());
        text(&mut list, "unit_string");
        list.extend(0x20_u32.to_le_bytes());
        text(&mut list, unit);
        data.extend(samples.iter().flat_map(|v| v.to_le_bytes()));
    }
    let mut out = b"TDSm".to_vec();
    out.extend([0b1110_u32, 4713].iter().flat_map(|w| w.to_le_bytes()));
    out.extend(((list.len() + data.len()) as u64).to_le_bytes());
    out.extend((list.len() as u64).to_le_bytes());
    out.extend(list);
    out.extend(data);
    out
}

/// Universal file, data sets 58 as text.
///
/// # Reference
/// SDRC, Universal File Dataset 58 (Function at nodal DOF).
fn uff(of_g: &[Vec<f64>; 3], times: &[f64]) -> Vec<u8> {
    let (n, dt) = (times.len(), step(times));
    let mut out = String::new();
    let axis = |kind: u32, name: &str, unit: &str| {
        format!("{kind:10}{:5}{:5}{:5} {name:<20} {unit:<20}\n", 0, 0, 0)
    };
    for (c, name) in NAMES.iter().enumerate() {
        let unit = ["g", "g", "kN"][c];
        let _ = write!(
            out,
            "    -1\n    58\n{name}\nNONE\nNONE\nNONE\nNONE\n    1{:10}{:5}{:10} {name:>10}{:10}   3 {:>10}{:10}   0\n{:10}{n:10}{:10}{:13.5E}{dt:13.5E}{:13.5E}\n",
            1,
            0,
            0,
            c + 1,
            "NONE",
            0,
            4,
            1,
            0.0,
            0.0
        );
        out.push_str(&axis(17, "Time", "s"));
        out.push_str(&axis(12, name, unit));
        out.push_str(&axis(0, "NONE", "NONE").repeat(2));
        for row in of_g[c].chunks(4) {
            let fields: Vec<String> = row.iter().map(|v| format!("{v:20.11E}")).collect();
            let _ = writeln!(out, "{}", fields.concat());
        }
        out.push_str("    -1\n");
    }
    out.into_bytes()
}
