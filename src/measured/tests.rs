use super::gauge_columns::{StrainColumn, find_gauge_columns};
use super::{runs_file, strain_file, strain_table, strain_text};
use crate::host::fault::Faults;
use crate::host::files::Inputs;
use crate::job::read_job;
use crate::job::tests::read_text;
use crate::series::record::{Column, name_and_unit};
use std::path::{Path, PathBuf};

fn shared_folder() -> Option<PathBuf> {
    crate::support::find_shared_path(".")
}

fn jobs_below(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap().flatten() {
        let path = entry.path();
        if path.is_dir() {
            jobs_below(&path, out);
        } else if path.file_name().is_some_and(|n| n == "job.toml") {
            out.push(path);
        }
    }
}

#[test]
fn every_shared_job_is_read_with_all_files_it_names() {
    let Some(shared) = shared_folder() else {
        return;
    };
    let mut jobs = Vec::new();
    jobs_below(&shared, &mut jobs);
    assert!(jobs.len() >= 10, "{jobs:?}");
    for path in jobs {
        let mut inputs = Inputs::new(&crate::host::context::Disk);
        let job =
            read_job(&mut inputs, &path).unwrap_or_else(|f| panic!("{}: {f:?}", path.display()));
        if let Some(m) = &job.measured {
            let wanted = strain_file::wanted_columns(&mut inputs, &job);
            let strain = strain_file::read_strain(&mut inputs, &job, &m.strain, &wanted).unwrap();
            let names: Vec<&String> = job.gauges.iter().map(|g| &g.name).collect();
            assert_eq!(
                strain.gauges.iter().collect::<Vec<_>>(),
                names,
                "{}",
                path.display()
            );
            assert!(strain.n_rows() >= 12);
        }
        if let Some(r) = &job.runs {
            let runs = runs_file::read_runs(&mut inputs, &job, r).unwrap();
            assert!(runs.iter().all(|r| r.loads_si.len() == 6
                && r.payload_mass_kg.is_some()
                && r.payload_x_m.is_some()));
        }
    }
}

#[test]
fn a_runs_file_is_read_in_si_by_the_jobs_names() {
    let Some(shared) = shared_folder() else {
        return;
    };
    let mut inputs = Inputs::new(&crate::host::context::Disk);
    let job = read_job(
        &mut inputs,
        &shared.join("hidden_effects/static/dev-s1/job.toml"),
    )
    .unwrap();
    assert_eq!(
        job.sensitivity.as_ref().unwrap().columns[0],
        ("RR.FZ".into(), "FZ_RR".into()),
        "in the order of the job"
    );
    let text =
        std::fs::read_to_string(shared.join("hidden_effects/static/dev-s1/runs.csv")).unwrap();
    let first: Vec<f64> = text
        .lines()
        .nth(1)
        .unwrap()
        .split(',')
        .skip(1)
        .map(|x| x.parse().unwrap())
        .collect();
    let runs = runs_file::read_runs(&mut inputs, &job, job.runs.as_ref().unwrap()).unwrap();
    assert_eq!(runs[0].payload_mass_kg, Some(first[0]));
    assert_eq!(runs[0].loads_si["RR.FZ"], first[2] * 1e3);
    assert_eq!(runs[0].loads_si["LR.FZ"], first[7] * 1e3);
}

#[test]
fn strain_tables_hold_runs_or_samples() {
    let read = |text: &str| strain_text::strain_from_text("s.csv", text, &[]);
    let s = read("run,G1,G2\nR1,1.5,\nR2,3,4\n").unwrap();
    assert_eq!(
        s.rows,
        strain_table::StrainRows::Runs(vec!["R1".into(), "R2".into()])
    );
    assert!(s.row(0)[1].is_nan());
    let f = read("time;G1\n0;1\n0.1;2\n0.1;3\n").unwrap_err();
    assert_eq!((f[0].line, f[0].field.as_str()), (Some(4), "time"));
    let f = read("run,G1\nR1,1\nR2,2\nR1,3\n").unwrap_err();
    assert_eq!((f[0].line, f[0].field.as_str()), (Some(4), "run"));
    assert!(read("G1\n1\n").is_err() && read("run,G1\n").is_err());
}

#[test]
fn a_long_table_in_parts_is_the_whole_table() {
    let rows = (0..25_001).map(|i| format!("R{i},{i},-{i}\n"));
    let text = format!("run,G1,G2\n{}", rows.collect::<String>());
    let s = strain_text::strain_from_text("s.csv", &text, &[]).unwrap();
    assert_eq!(s.n_rows(), 25_001);
    assert!((0..25_001).all(|i| s.row(i) == [i as f64, -(i as f64)]));
}

/// Returns the runs of a table, read for a job with these further lines under `[runs]`.
fn runs_of(table: &str, more: &str) -> Result<Vec<runs_file::RunRow>, Faults> {
    let files = crate::host::context::InMemory::default().with_file("runs.csv", table);
    let text = format!(
        "units = \"m-kg-s\"\nreport_units = {{ force = \"kN\" }}\n[[load]]\nname = \"LF.FZ\"\n[[load]]\nname = \"LF.MX\"\n\
         [calibration]\n[runs]\nfile = \"runs.csv\"\n{more}"
    );
    let job = read_text(&text)?;
    let runs = job.runs.as_ref().unwrap();
    runs_file::read_runs(&mut Inputs::new(&files), &job, runs)
}

#[test]
fn units_of_a_runs_file_stand_in_its_header_or_below_and_contradict_nothing() {
    let si = |table: &str, more: &str| {
        let rows = runs_of(table, more).unwrap_or_else(|f| panic!("{f:?}"));
        assert_eq!(rows.len(), 1);
        ["LF.FZ", "LF.MX"].map(|l| rows[0].loads_si[l])
    };
    let plain = si("run,LF.FZ,LF.MX\nR1,2,3\n", "");
    assert_eq!(plain, [2e3, 3.0]);
    let below = si("run,LF.FZ,LF.MX\n-,N,kN m\nR1,2000,0.003\n", "");
    let in_name = si("run,LF.FZ [N],LF.MX (N*m)\nR1,2000,3\n", "");
    // 0.003 times a thousand is rounded in its last digit.
    assert!(below[0] == 2e3 && (below[1] - 3.0).abs() < 1e-12);
    assert_eq!(in_name, plain);
    let named = "columns = { \"LF.FZ\" = \"axle (front)\" }\n";
    assert_eq!(si("run,axle (front),LF.MX\nR1,2,3\n", named), plain);
    // A unit that the job also states must be the same.
    let stated = "units = { force = \"kN\" }\n";
    assert_eq!(si("run,LF.FZ [kN],LF.MX\nR1,2,3\n", stated), plain);
    let fault = |table: &str, more: &str| runs_of(table, more).unwrap_err().into_list().remove(0);
    let f = fault("run,LF.FZ [N],LF.MX\nR1,2,3\n", stated);
    let message = f.to_string();
    assert!(
        message.starts_with("runs.csv:1: LF.FZ [N]: the column states `N`, the job states `kN`"),
        "{message}"
    );
    let f = fault("run,LF.FZ [kg],LF.MX\nR1,2,3\n", "");
    let message = f.to_string();
    assert!(
        message.contains("`kg` is not a unit of force") && message.contains("kN"),
        "{message}"
    );
}

#[test]
fn labels_rows_of_units_and_noise_of_a_runs_file_are_not_mistaken() {
    let si = |table: &str, more: &str| {
        let rows = runs_of(table, more).unwrap_or_else(|f| panic!("{table}: {f:?}"));
        ["LF.FZ", "LF.MX"].map(|l| rows[rows.len() - 1].loads_si[l])
    };
    let plain = [2e3, 3.0];
    let named = "columns = { \"LF.FZ\" = \"axle (front)\" }\n";
    let below = "run,axle (front),LF.MX\n-,N,N m\nR1,2000,3\n";
    assert_eq!(si(below, named), plain);
    let square = "columns = { \"LF.FZ\" = \"axle [front]\" }\n";
    assert_eq!(si("run,axle [front],LF.MX\nR1,2,3\n", square), plain);
    assert_eq!(si("run,LF.FZ,LF.MX\nunit,N,N m\nR1,2000,3\n", ""), plain);
    // A run without loads is not a row of units.
    let bare = "LF.FZ,LF.MX,run\n,,R0\n2,3,R1\n";
    assert_eq!(si(bare, ""), plain);
    assert_eq!(runs_of(bare, "").unwrap().len(), 2);
    let message = |table: &str, more: &str| runs_of(table, more).unwrap_err()[0].to_string();
    let stated = format!("{named}units = {{ force = \"kN\" }}\n");
    for (table, more, wrong) in [
        (
            below,
            stated.as_str(),
            "the column states `N`, the job states `kN`",
        ),
        (
            "run,LF.FZ,LF.MX\n-,kg,N m\nR1,2,3\n",
            "",
            "`kg` is not a unit of force",
        ),
        (
            "run,LF.FZ [kg],LF.MX\n-,kN,N m\nR1,2,3\n",
            "",
            "`kg` after the name, and `kN` as the unit of the column",
        ),
        // The noise may be in kN, or in N as the column.
        (
            "run,LF.FZ [N],LF.MX\nR1,2000,3\n",
            "noise = { force = 50.0 }\n",
            "runs.noise.force: the unit of 50 may be `kN` or",
        ),
    ] {
        let message = message(table, more);
        assert!(message.contains(wrong), "{message}");
    }
    let both = "units = { force = \"N\" }\nnoise = { force = 50.0 }\n";
    assert_eq!(si("run,LF.FZ [N],LF.MX\nR1,2000,3\n", both), plain);
}

#[test]
fn labels_and_units_of_gauges_are_distinguished() {
    let read = |text: &str, gauges: &[&str]| {
        let gauges: Vec<String> = gauges.iter().map(|g| (*g).to_owned()).collect();
        strain_text::strain_from_text("s.csv", text, &gauges)
    };
    for gauges in [&["SG1 (left)"][..], &[]] {
        for (text, microstrain) in [
            ("run,SG1 (left)\n-,mm/m\nR1,0.5\n", 500.0),
            ("run,SG1 (left)\nunit,[mm/m]\nR1,0.5\n", 500.0),
            ("run,SG1 (left) (mm/m)\nR1,0.5\n", 500.0),
            ("run,SG1 (left)\nR1,0.5\n", 0.5),
        ] {
            let t = read(text, gauges).unwrap_or_else(|f| panic!("{text}: {f:?}"));
            assert_eq!(t.gauges, ["SG1 (left)"], "{text}");
            assert_eq!(t.microstrain, [microstrain], "{text}");
        }
    }
    // Another column in addition to the column of the gauge.
    let raw = read("run,P01,P01 (raw)\nR1,0.5,7\n", &["P01"]).unwrap();
    assert_eq!(raw.gauges, ["P01", "P01 (raw)"]);
    let two = [
        Column::of_channel("P01", "um/m"),
        Column::of_channel("P01", "raw"),
    ];
    let found = find_gauge_columns("r.mf4", &two, &["P01".to_owned()]).unwrap();
    assert_eq!(of_gauges(&found), [("P01", Some(1.0)), ("P01 [raw]", None)]);
    // These units are not units of strain, whether gauges are known or not.
    for gauges in [&["G1"][..], &[]] {
        for text in [
            "run,G1\n-,mV/V\nR1,1\n",
            "run,G1 (mV/V)\nR1,1\n",
            "run,G1 [mV/V]\nR1,1\n",
        ] {
            let message = read(text, gauges).unwrap_err()[0].to_string();
            assert!(
                message.contains("G1: `mV/V` is not a unit of strain"),
                "{message}"
            );
        }
    }
    let both = read("run,G1 [mV/V]\n-,um/m\nR1,1\n", &["G1"]);
    assert!(both.unwrap_err()[0].wrong.contains("`mV/V`"));
    // A run without a reading is not a row of units.
    let bare = read("G1,run\n,R1\n3,R2\n", &["G1"]).unwrap();
    assert_eq!(
        bare.rows,
        strain_table::StrainRows::Runs(vec!["R1".into(), "R2".into()])
    );
}

fn of_gauges(columns: &[StrainColumn]) -> Vec<(&str, Option<f64>)> {
    let each = columns.iter();
    each.map(|c| (c.name.as_str(), c.microstrain)).collect()
}

/// Returns the names of the columns of a text with this header, and the microstrain of a 1 in each column.
fn columns_of_text(header: &str, gauges: &[String]) -> Result<Vec<(String, f64)>, Faults> {
    let ones = header.split(',').map(|_| ",1").collect::<String>();
    let text = format!("run,{header}\nR1{ones}\n");
    let table = strain_text::strain_from_text("s.csv", &text, gauges)?;
    Ok(table.gauges.into_iter().zip(table.microstrain).collect())
}

#[test]
fn a_table_and_a_record_give_one_verdict_on_a_header() {
    let gauges = |list: &[&str]| -> Vec<String> { list.iter().map(|g| (*g).into()).collect() };
    for (header, wanted, expected) in [
        (
            "P01 [um/m],P01 (raw)",
            &["P01"][..],
            Some([("P01", 1.0), ("P01 (raw)", 1.0)]),
        ),
        (
            "P01,P02 [mm/m]",
            &["P01"],
            Some([("P01", 1.0), ("P02", 1e3)]),
        ),
        // The gauge's name contains a bracket, written with or without a blank.
        (
            "SG1(left),SG1(right)",
            &["SG1(left)", "SG1(right)"],
            Some([("SG1(left)", 1.0), ("SG1(right)", 1.0)]),
        ),
        (
            "SG1 (left),SG1 (t)",
            &["SG1(left)", "SG1 (t)"],
            Some([("SG1(left)", 1.0), ("SG1 (t)", 1.0)]),
        ),
        (
            "SG1 (t),SG1 (left)",
            &[],
            Some([("SG1 (t)", 1.0), ("SG1 (left)", 1.0)]),
        ),
        ("P01 (raw),P01 (kN)", &["P01"], None),
        ("P01 [um/m],P01 [mm/m]", &["P01"], None),
    ] {
        let gauges = gauges(wanted);
        let columns: Vec<Column> = header.split(',').map(name_and_unit).collect();
        let of_record = find_gauge_columns("r.csv", &columns, &gauges);
        let of_text = columns_of_text(header, &gauges);
        let Some(expected) = expected else {
            assert!(of_record.is_err() && of_text.is_err(), "{header}");
            continue;
        };
        let of_record = of_record.unwrap_or_else(|f| panic!("{header}: {f:?}"));
        let named = expected.map(|(name, scale)| (name, Some(scale)));
        assert_eq!(of_gauges(&of_record), named, "{header}");
        let of_text = of_text.unwrap_or_else(|f| panic!("{header}: {f:?}"));
        let named = expected.map(|(name, scale)| (name.to_owned(), scale));
        assert_eq!(of_text, named, "{header}");
    }
}

#[test]
fn where_no_gauges_are_known_a_unit_of_anything_else_is_no_strain() {
    for header in ["torque (N m)", "torque (kNm)", "G1 [mV/V]", "way (mm)"] {
        let message = columns_of_text(header, &[]).unwrap_err()[0].to_string();
        assert!(message.contains("is not a unit of strain"), "{message}");
        // A record contains other channels too, which are left out.
        let column = [name_and_unit(header)];
        let found = find_gauge_columns("r.parquet", &column, &[]).unwrap();
        assert_eq!(found[0].microstrain, None, "{header}");
    }
}

#[test]
fn units_that_contradict_each_other_are_faults_of_what_is_asked_for() {
    let read = |text: &str, gauges: &[&str]| {
        let gauges: Vec<String> = gauges.iter().map(|g| (*g).to_owned()).collect();
        strain_text::strain_from_text("s.csv", text, &gauges)
    };
    let text = "run,G1 [m/m],G2 [um/m]\n-,um/m,microstrain\nR1,1,2\n";
    for gauges in [&["G1", "G2"][..], &["G1 [m/m]", "G2"], &[]] {
        let message = read(text, gauges).unwrap_err()[0].to_string();
        let wrong = "G1 [m/m]: `m/m` after the name, and `um/m` as the unit of the column";
        assert!(message.contains(wrong), "{message}");
    }
    let table = read(text, &["G2"]).unwrap();
    assert_eq!(table.gauges[1], "G2");
    assert_eq!(table.microstrain[1], 2.0);
    let message = read("time [s],G1\nms,um/m\n0,1\n1,2\n", &["G1"]).unwrap_err()[0].to_string();
    assert!(
        message.contains("`s` after the name, and `ms` as the unit of the column"),
        "{message}"
    );
    // `MN` and `mN`, or `N` and `kN`, are different units: two units for one column are a fault.
    for [in_name, below] in [["MN", "mN"], ["N", "kN"]] {
        let table = format!("run,LF.FZ [{in_name}],LF.MX\n-,{below},N m\nR1,2,3\n");
        let named = format!("columns = {{ \"LF.FZ\" = \"LF.FZ [{in_name}]\" }}\n");
        for more in ["", &named] {
            let message = runs_of(&table, more).unwrap_err()[0].to_string();
            let wrong =
                format!("`{in_name}` after the name, and `{below}` as the unit of the column");
            assert!(message.contains(&wrong), "{message}");
        }
    }
}

#[test]
fn a_column_of_runs_that_is_written_otherwise_is_asked_for() {
    let message = strain_text::strain_from_text("s.csv", "Runs,G1\nR1,2\n", &["G1".to_owned()]);
    let message = message.unwrap_err()[0].to_string();
    assert!(
        message.contains("did you mean `Runs` for `run`?"),
        "{message}"
    );
    let message = runs_of("Runs,LF.FZ\nR1,2\n", "").unwrap_err()[0].to_string();
    assert!(
        message.contains("did you mean `Runs` for `run`?"),
        "{message}"
    );
    let message = strain_text::strain_from_text("s.csv", "a,b\n1,2\n", &[]).unwrap_err();
    assert!(
        !message[0].to_string().contains("did you mean"),
        "{message:?}"
    );
}

#[test]
fn a_row_of_units_determines_which_of_two_columns_holds_a_load() {
    let table = "run,LF.FZ [kN],LF.FZ (raw),LF.MX\n-,kN,V,N m\nR1,2,9,3\n";
    let rows = runs_of(table, "").unwrap();
    assert_eq!(rows[0].loads_si["LF.FZ"], 2e3);
    let twice = "run,LF.FZ [kN],LF.FZ [N],LF.MX\nR1,2,2000,3\n";
    let message = runs_of(twice, "").unwrap_err()[0].to_string();
    assert!(message.contains("two columns contain `LF.FZ`"), "{message}");
}

#[test]
fn a_channel_that_is_ignored_is_not_asked_for_its_unit() {
    let files = crate::host::context::InMemory::default()
        .with_file("s.csv", "run,G1,G2 [mV/V]\nR1,1,2\nR2,2,3\n");
    let job = read_text(
        "units = \"m-kg-s\"\n[model]\ndeck = \"d.bdf\"\n[[load]]\nname = \"a\"\ngrid = 1\ncomponent = \"FZ\"\n[[gauge]]\nname = \"G1\"\nelement = 1\n\
         [[gauge]]\nname = \"G2\"\nelement = 2\n[measured]\nstrain = \"s.csv\"\n\
         [[correction]]\ngauge = \"G2\"\nignore = true\n",
    )
    .unwrap();
    let measured = job.measured.as_ref().unwrap();
    let mut inputs = Inputs::new(&files);
    let wanted = strain_file::wanted_columns(&mut inputs, &job);
    let table = strain_file::read_strain(&mut inputs, &job, &measured.strain, &wanted).unwrap();
    assert_eq!(table.gauges, ["G1", "G2"]);
    assert!(table.row(0)[0] == 1.0 && table.row(0)[1].is_nan());
}

/// Spreadsheets state the delimiter in a first line; the case of `run` does not matter.
#[test]
fn a_table_of_runs_is_read_below_a_line_that_states_its_delimiter() {
    let expected = strain_text::strain_from_text("s.csv", "run,G1,G2\nR1,1.5,2\nR2,-3,4\n", &[]);
    let expected = expected.unwrap();
    for text in [
        "sep=;\nrun;G1;G2\nR1;1.5;2\nR2;-3;4\n",
        "sep=;\r\nRun;G1;G2\r\nR1;1,5;2\r\nR2;-3;4\r\n",
        "SEP=,\nRUN,G1,G2\nR1,1.5,2\nR2,-3,4\n",
        "\"sep=\t\"\nrun\tG1\tG2\nR1\t1.5\t2\nR2\t-3\t4\n",
        "sep=;;\nrun;G1;G2\nR1;1.5;2\nR2;-3;4\n",
    ] {
        let found = strain_text::strain_from_text("s.csv", text, &[]);
        assert_eq!(found.unwrap_or_else(|f| panic!("{text}: {f:?}")), expected);
    }
    let wrong = strain_text::strain_from_text("s.csv", "sep=;\nrun;G1\nR1;1\nR2;x\n", &[]);
    assert_eq!(wrong.unwrap_err()[0].line, Some(4));
}
