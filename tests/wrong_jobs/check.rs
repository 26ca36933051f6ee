//! `check JOB` agrees with the commands. It reports what a command refuses or cannot rely on, and refuses nothing that
//! the commands read.

use super::copies::copy_example;
use std::path::Path;
use std::process::Command;

/// Job for loads from a fleet record with a given S.
const RECORD: &str = "units = \"m-kg-s\"\nreport_units = { force = \"kN\", moment = \"kN m\" }\n\
                      [sensitivity]\nfile = \"s_wheels.csv\"\nper = { force = \"kN\" }\n\
                      [measured]\nstrain = \"A_2026-05-01.csv\"\nnoise_microstrain = 0.1\n";

/// Returns exit code and output of a command on a job.
fn ask(command: &str, job: &Path) -> (i32, String) {
    let mut asked = Command::new(env!("CARGO_BIN_EXE_strainbridge"));
    asked.arg(command).arg(job);
    if command != "check" {
        asked.arg("--out").arg(job.with_extension(command));
    }
    let done = asked.output().unwrap();
    let printed = [done.stdout, done.stderr].concat();
    // Further lines of a finding are indented.
    let printed = String::from_utf8_lossy(&printed).replace("\n    ", " ");
    (done.status.code().unwrap(), printed)
}

/// Name of a damage, and the change of a file.
type Damage<'a> = (&'a str, &'a dyn Fn(&str) -> Vec<u8>);

/// Expected result of the command and of `check` on a damaged file.
#[derive(Clone, Copy)]
enum Ends {
    /// Exit code 0, because the change does no damage.
    Right,
    /// Exit code 1 with an error of this code.
    Error(&'static str),
    /// Exit code 2 with a fault that contains these words.
    Fault(&'static str),
}

/// Fails if the command and `check` do not end as stated, with the stated reason, after each damage to `file`.
fn agree(folder: &Path, job: &str, command: &str, file: &str, damages: &[(Damage, Ends)]) {
    assert!(!damages.is_empty());
    let (job, file) = (folder.join(job), folder.join(file));
    let whole = std::fs::read_to_string(&file).unwrap();
    for ((name, damage), ends) in damages {
        let damaged = damage(&whole);
        assert!(
            (damaged == whole.as_bytes()) == (*name == "nothing"),
            "{name}"
        );
        std::fs::write(&file, damaged).unwrap();
        let (code, why) = match ends {
            Ends::Right => (0, String::new()),
            Ends::Error(code) => (1, format!("error [{code}]")),
            Ends::Fault(words) => (2, (*words).to_owned()),
        };
        for asked in [command, "check"] {
            let (done, printed) = ask(asked, &job);
            assert_eq!(done, code, "{name}: {asked}\n{printed}");
            assert!(printed.contains(&why), "{name}: {asked}\n{printed}");
            // A fault names the wrong file.
            let named = file.file_name().unwrap().to_str().unwrap();
            assert!(
                code < 2 || printed.contains(named),
                "{name}: {asked}\n{printed}"
            );
        }
    }
    std::fs::write(&file, whole).unwrap();
}

/// Returns the text with another field in this column of its third line.
fn with_field(text: &str, column: usize, field: &str) -> Vec<u8> {
    let lines = text.lines().enumerate().map(|(i, line)| {
        let mut fields: Vec<&str> = line.split(',').collect();
        if i == 2 {
            fields[column] = field;
        }
        fields.join(",") + "\n"
    });
    lines.collect::<String>().into_bytes()
}

/// Returns the text with all numbers of these columns multiplied by `factor`.
fn times(text: &str, columns: std::ops::Range<usize>, factor: f64) -> Vec<u8> {
    let lines = text.lines().map(|line| {
        let fields = line
            .split(',')
            .enumerate()
            .map(|(i, f)| match f.parse::<f64>() {
                Ok(x) if columns.contains(&i) => (x * factor).to_string(),
                _ => f.to_owned(),
            });
        fields.collect::<Vec<_>>().join(",") + "\n"
    });
    lines.collect::<String>().into_bytes()
}

/// Returns the first lines of a text.
fn lines(text: &str, n: usize) -> Vec<u8> {
    text.split_inclusive('\n')
        .take(n)
        .collect::<String>()
        .into_bytes()
}

#[test]
fn check_reports_the_findings_of_recover_on_a_record() {
    let folder = copy_example("check_record", "fleet");
    std::fs::write(folder.join("job.toml"), RECORD).unwrap();
    let dated = |t: &str| {
        let rows = t.lines().enumerate().map(|(i, line)| match i {
            0 => format!("{line}\n"),
            _ => {
                let (time, rest) = line.split_once(',').unwrap();
                let s: f64 = time.parse().unwrap();
                format!("2026-05-01 12:00:{s:06.3},{rest}\n")
            }
        });
        rows.collect::<String>().into_bytes()
    };
    let damages: [(Damage, Ends); 17] = [
        (("nothing", &|t| t.as_bytes().to_vec()), Ends::Right),
        (("NaN", &|t| with_field(t, 3, "NaN")), Ends::Right),
        (("#N/A", &|t| with_field(t, 3, "#N/A")), Ends::Right),
        (("NA", &|t| with_field(t, 3, "NA")), Ends::Right),
        (("null", &|t| with_field(t, 3, "null")), Ends::Right),
        (("dates", &dated), Ends::Right),
        (
            ("UTF-16", &|t| {
                let units = "\u{feff}".encode_utf16().chain(t.encode_utf16());
                units.flat_map(u16::to_le_bytes).collect()
            }),
            Ends::Right,
        ),
        (
            ("Latin-1", &|t| {
                let text = t.replacen("P01,", "P01 [?m/m],", 1).into_bytes();
                let latin = |b| if b == b'?' { 0xb5 } else { b };
                text.into_iter().map(latin).collect()
            }),
            Ends::Right,
        ),
        (
            ("lines before the header", &|t| {
                format!("Measured by 7\nRate: 20 Hz\n\n{t}").into_bytes()
            }),
            Ends::Right,
        ),
        (
            ("a word", &|t| with_field(t, 3, "abc")),
            Ends::Fault("`abc` in column `P03` is not a number"),
        ),
        (("one row", &|t| lines(t, 2)), Ends::Fault("one sample")),
        (
            ("a header", &|t| lines(t, 1)),
            Ends::Fault("a header and no rows"),
        ),
        (
            ("carriage returns", &|t| t.replace('\n', "\r").into_bytes()),
            Ends::Fault("carriage return alone"),
        ),
        (
            ("milliseconds", &|t| times(t, 0..1, 1000.0)),
            Ends::Error("time-unit-doubtful"),
        ),
        (
            ("strain, not microstrain", &|t| times(t, 1..13, 1e-6)),
            Ends::Error("readings-below-noise"),
        ),
        (
            ("too large", &|t| times(t, 1..13, 1e300)),
            Ends::Error("reading-impossible"),
        ),
        (
            ("one too large", &|t| with_field(t, 3, "1e308")),
            Ends::Error("reading-impossible"),
        ),
    ];
    agree(&folder, "job.toml", "recover", "A_2026-05-01.csv", &damages);
    let twice = |t: &str| {
        let third = t.lines().nth(2).unwrap();
        format!("{t}{third}\n").into_bytes()
    };
    let of_s: [(Damage, Ends); 4] = [
        (
            ("a word in S", &|t| with_field(t, 1, "abc")),
            Ends::Fault("`abc` is not a number"),
        ),
        (
            ("a gauge twice", &twice),
            Ends::Fault("gauge `P02` has a row in line 3 and one in line 14"),
        ),
        (
            ("a load twice", &|t| {
                t.replacen("R.FZ", "L.FZ", 1).into_bytes()
            }),
            Ends::Fault("L.FZ: column named twice"),
        ),
        (
            ("too large for S", &|t| with_field(t, 1, "1e308")),
            Ends::Fault("not finite, or too large"),
        ),
    ];
    agree(&folder, "job.toml", "recover", "s_wheels.csv", &of_s);
}

#[test]
fn the_record_of_a_zero_may_hold_what_a_record_may_hold() {
    let folder = copy_example("check_zero", "fleet");
    let zero = "noise_microstrain = 0.1\nzero = \"zero.csv\"\n";
    let job = RECORD.replace("noise_microstrain = 0.1\n", zero);
    std::fs::write(folder.join("job.toml"), job).unwrap();
    let header: Vec<String> = (1..=12).map(|g| format!(",P{g:02}")).collect();
    let rows: String = (0..20)
        .map(|i| {
            let readings = if i % 2 == 0 { ",0.01" } else { ",-0.01" };
            format!("{}{}\n", f64::from(i) * 0.05, readings.repeat(12))
        })
        .collect();
    let text = format!("time{}\n{rows}", header.concat());
    std::fs::write(folder.join("zero.csv"), text).unwrap();
    let damages: [(Damage, Ends); 5] = [
        (("nothing", &|t| t.as_bytes().to_vec()), Ends::Right),
        (("NaN", &|t| with_field(t, 3, "NaN")), Ends::Right),
        (
            ("lines before the header", &|t| {
                format!("Measured by 7\n\n{t}").into_bytes()
            }),
            Ends::Right,
        ),
        (
            ("a word", &|t| with_field(t, 3, "abc")),
            Ends::Fault("`abc` in column `P03` is not a number"),
        ),
        (
            ("a header", &|t| lines(t, 1)),
            Ends::Fault("a header and no rows"),
        ),
    ];
    agree(&folder, "job.toml", "recover", "zero.csv", &damages);
}

#[test]
fn loads_and_gauges_are_counted_where_they_were_read() {
    let folder = copy_example("check_counted", "fleet");
    std::fs::write(folder.join("job.toml"), RECORD).unwrap();
    let (code, printed) = ask("check", &folder.join("job.toml"));
    assert_eq!(code, 0, "{printed}");
    // The header of s_wheels.csv names three loads, and its rows name twelve gauges.
    assert!(printed.contains("3 loads, 12 gauges"), "{printed}");
}

#[test]
fn check_reports_the_findings_of_identify_on_a_vehicle() {
    let folder = copy_example("check_vehicle", "quarter_truck");
    let twice = |t: &str| {
        let rows: String = t.split_inclusive('\n').skip(1).collect();
        format!("{t}{rows}").into_bytes()
    };
    let unsorted = |t: &str| {
        let mut list: Vec<&str> = t.split_inclusive('\n').collect();
        list.swap(100, 2000);
        list.concat().into_bytes()
    };
    let damages: [(Damage, Ends); 7] = [
        (("nothing", &|t| t.as_bytes().to_vec()), Ends::Right),
        (
            ("repeated", &twice),
            Ends::Fault("out of order or repeated"),
        ),
        (
            ("unsorted", &unsorted),
            Ends::Fault("out of order or repeated"),
        ),
        (
            ("short", &|t| lines(t, 12)),
            Ends::Fault("the record lasts 0.06 s"),
        ),
        (
            ("cut", &|t| t.as_bytes()[..t.len() - 12].to_vec()),
            Ends::Fault("3 fields, the header has 4"),
        ),
        (
            ("a header", &|t| lines(t, 1)),
            Ends::Fault("a header and no rows"),
        ),
        (
            ("a word", &|t| with_field(t, 1, "abc")),
            Ends::Fault("`abc` in column `a_body` is not a number"),
        ),
    ];
    agree(&folder, "identify.toml", "identify", "data.csv", &damages);
}

#[test]
fn check_reports_the_findings_of_respond_and_reconcile_on_runs() {
    let folder = copy_example("check_runs", "frame");
    let job = std::fs::read_to_string(folder.join("respond.toml")).unwrap();
    let loads = job.replace("hottest = 10", "hottest = 10\nloads = \"loads.csv\"");
    std::fs::write(folder.join("loads.toml"), loads).unwrap();
    let header = "run,N.FZ,L.FZ,R.FZ,payload.FZ,payload.MX,payload.MY\n";
    std::fs::write(
        folder.join("loads.csv"),
        format!("{header}a,1,1,1,0,0,0\nb,1,2,3,0,0,0\n"),
    )
    .unwrap();
    let table: [(Damage, Ends); 3] = [
        (("nothing", &|t| t.as_bytes().to_vec()), Ends::Right),
        (
            ("a word", &|t| with_field(t, 2, "abc")),
            Ends::Fault("`abc` is not a number"),
        ),
        (
            ("no load", &|t| t.replacen("R.FZ", "X.FZ", 1).into_bytes()),
            Ends::Fault("no column `R.FZ`"),
        ),
    ];
    agree(&folder, "loads.toml", "respond", "loads.csv", &table);
    let signature: [(Damage, Ends); 3] = [
        (("nothing", &|t| t.as_bytes().to_vec()), Ends::Right),
        (
            ("a word", &|t| with_field(t, 1, "abc")),
            Ends::Fault("`abc` is not a number"),
        ),
        (
            ("a gauge less", &|t| lines(t, 12)),
            Ends::Fault("no row for gauge `P12`"),
        ),
    ];
    agree(
        &folder,
        "reconcile_matrix.toml",
        "reconcile",
        "s_payload.csv",
        &signature,
    );
    // A hypothesis of the user whose table is missing.
    let matrix = std::fs::read_to_string(folder.join("reconcile_matrix.toml")).unwrap();
    let own = "\n[[reconcile.effect]]\nid = \"own\"\nsignature = \"own.csv\"\nprior = 1\n";
    let job = folder.join("own.toml");
    std::fs::write(&job, matrix + own).unwrap();
    for command in ["reconcile", "check"] {
        let (code, printed) = ask(command, &job);
        assert!(
            code == 2 && printed.contains("own.csv"),
            "{command}: {printed}"
        );
    }
}

#[test]
fn a_point_away_from_its_element_is_an_error_that_names_gauge_and_distance() {
    let folder = copy_example("check_point", "frame");
    let job = folder.join("recover.toml");
    let gauges = std::fs::read_to_string(folder.join("gauges.csv")).unwrap();
    let (code, printed) = ask("check", &job);
    assert_eq!(code, 0, "{printed}");
    assert!(gauges.contains(",1125,-430,3,"), "{gauges}");
    let moved = gauges.replacen(",1125,-430,3,", ",112500,-430,3,", 1);
    std::fs::write(folder.join("gauges.csv"), moved).unwrap();
    for command in ["check", "sensitivity"] {
        let (code, printed) = ask(command, &job);
        assert_eq!(code, 1, "{command}: {printed}");
        // The distance from the point to the edge of the element, which is within 125 mm of its middle.
        let at = printed
            .find("is 111")
            .unwrap_or_else(|| panic!("{printed}"));
        assert!(
            printed[..at].contains("gauges.csv:2") && printed.contains("`P01`"),
            "{printed}"
        );
    }
}

#[test]
fn a_layout_that_does_not_determine_its_loads_is_an_error() {
    let folder = copy_example("check_planned", "frame");
    let job = folder.join("place.toml");
    let text = std::fs::read_to_string(&job).unwrap();
    assert_eq!(ask("place", &job).0, 0);
    let noisy = text.replace("noise_microstrain = 0.5", "noise_microstrain = 10000");
    std::fs::write(&job, noisy).unwrap();
    let (code, printed) = ask("place", &job);
    assert_eq!(code, 1, "{printed}");
    assert!(printed.contains("loads-not-determined"), "{printed}");
}

#[test]
fn a_channel_is_not_exchanged_with_itself() {
    let folder = copy_example("check_exchanged", "fleet");
    let own = "[[correction]]\ngauge = \"P01\"\nexchanged_with = \"P01\"\n";
    std::fs::write(folder.join("job.toml"), format!("{RECORD}{own}")).unwrap();
    let (code, printed) = ask("check", &folder.join("job.toml"));
    assert!(
        code == 2 && printed.contains("correction.exchanged_with"),
        "{printed}"
    );
}

#[test]
fn fleet_and_recover_report_a_gauge_without_a_row_of_s_alike() {
    let folder = copy_example("check_no_row", "fleet");
    let s = std::fs::read_to_string(folder.join("s_wheels.csv")).unwrap();
    let less: String = s.split_inclusive('\n').take(12).collect();
    std::fs::write(folder.join("s_wheels.csv"), less).unwrap();
    std::fs::write(folder.join("job.toml"), RECORD).unwrap();
    let (_, printed) = ask("recover", &folder.join("job.toml"));
    assert!(printed.contains("[strain-without-gauge] P12"), "{printed}");
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .current_dir(&folder)
        .args(["fleet", "fleet.toml", "A_2026-05-01.csv", "--out", "out"])
        .output()
        .unwrap();
    let printed = [done.stdout, done.stderr].concat();
    let printed = String::from_utf8_lossy(&printed);
    assert!(printed.contains("strain-without-gauge"), "{printed}");
}

#[test]
fn check_reports_the_faults_of_the_commands_on_a_deck_that_can_not_be_solved_or_glued_on() {
    let folder = copy_example("check_deck", "frame");
    // A hinge connects a bar to the carrier.
    let hinge = "GRID,990,,-300.,-400.,0.\nPBAR,990,1,10.,100.,100.,200.\n\
                 CBAR,990,990,1,990,0.,0.,1.,\n,456\nENDDATA";
    let of_deck: [(Damage, Ends); 2] = [
        (("nothing", &|t| t.as_bytes().to_vec()), Ends::Right),
        (
            ("a mechanism", &|t| {
                t.replacen("ENDDATA", hinge, 1).into_bytes()
            }),
            Ends::Fault("no SPC set is selected, inertia balances the structure as a whole"),
        ),
    ];
    agree(
        &folder,
        "recover.toml",
        "sensitivity",
        "frame.bdf",
        &of_deck,
    );
    agree(&folder, "place.toml", "sensitivity", "frame.bdf", &of_deck);
    let text = std::fs::read_to_string(folder.join("place.toml")).unwrap();
    let held = text.replacen("support = \"free\"", "support = 7", 1);
    std::fs::write(folder.join("held.toml"), held).unwrap();
    // Grid 901 is dependent.
    let all = "SPC1,7,123456,1,THRU,900\nENDDATA";
    let of_support: [(Damage, Ends); 1] = [(
        ("every dof held", &|t| {
            t.replacen("ENDDATA", all, 1).into_bytes()
        }),
        Ends::Error("load-without-strain"),
    )];
    agree(
        &folder,
        "held.toml",
        "sensitivity",
        "frame.bdf",
        &of_support,
    );
    let of_job: [(Damage, Ends); 1] = [(
        ("a property without shells", &|t| {
            t.replacen("properties = [1, 2]", "properties = [77]", 1)
                .into_bytes()
        }),
        Ends::Fault("the model has no property of a shell, bar or solid with the id 77"),
    )];
    agree(&folder, "place.toml", "place", "place.toml", &of_job);
}

/// Returns a table of readings with changed fields. `change` gets row (the header is 0), column and field.
fn readings(text: &str, change: impl Fn(usize, usize, &str) -> String) -> Vec<u8> {
    let lines = text.lines().enumerate().map(|(i, line)| {
        let fields = line.split(',').enumerate().map(|(c, f)| change(i, c, f));
        fields.collect::<Vec<_>>().join(",") + "\n"
    });
    lines.collect::<String>().into_bytes()
}

#[test]
fn check_reports_the_findings_of_recover_on_readings_that_are_no_loads() {
    let folder = copy_example("check_readings", "frame");
    let keep = |f: &str| f.to_owned();
    let damages: [(Damage, Ends); 5] = [
        (("nothing", &|t| t.as_bytes().to_vec()), Ends::Right),
        (
            ("a spike", &|t| {
                readings(t, |i, c, f| match (i, c) {
                    (3, 4) => (f.parse::<f64>().unwrap() * 10.0).to_string(),
                    _ => keep(f),
                })
            }),
            Ends::Error("gauge-suspect"),
        ),
        (
            ("stuck", &|t| {
                readings(t, |i, c, f| match (i, c) {
                    (1.., 5) => "12.34".to_owned(),
                    _ => keep(f),
                })
            }),
            Ends::Error("gauge-silent"),
        ),
        (
            ("dead", &|t| {
                readings(t, |i, c, f| match (i, c) {
                    (1.., 5) => "0".to_owned(),
                    _ => keep(f),
                })
            }),
            Ends::Error("gauge-dead"),
        ),
        (
            ("swapped", &|t| {
                readings(t, |_, _, f| match f {
                    "P01" => "P02".to_owned(),
                    "P02" => "P01".to_owned(),
                    _ => keep(f),
                })
            }),
            Ends::Error("inputs-exchanged"),
        ),
    ];
    agree(&folder, "recover.toml", "recover", "strain.csv", &damages);
}
