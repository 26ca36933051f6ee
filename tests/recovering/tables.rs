//! Columns of the tables of a job: the program reads a column with an unambiguous meaning, and reports every other
//! column once.

use std::fmt::Write;
use strainbridge::finding::Finding;
use strainbridge::host::context::InMemory;
use strainbridge::{Context, Faults, Job, recover, respond, sensitivity};

/// Square plate of one element, fixed at one side. The x axis of the element is along x.
const PLATE: &str = "SOL 101\nCEND\nSPC = 1\nBEGIN BULK\n\
GRID,1,,0.,0.,0.\nGRID,2,,100.,0.,0.\nGRID,3,,100.,100.,0.\nGRID,4,,0.,100.,0.\n\
CQUAD4,7,1,1,2,3,4\nPSHELL,1,1,2.,1,,1\nMAT1,1,210000.,,.3,7.85-9\n\
SPC1,1,123456,1,4\nENDDATA\n";

fn plate(gauges: &str) -> InMemory {
    let job = "units = \"mm-t-s\"\n[model]\ndeck = \"plate.bdf\"\n\
               [[load]]\nname = \"P\"\ngrid = 2\ncomponent = \"FY\"\n[gauges]\nfile = \"gauges.csv\"\n";
    InMemory::default()
        .with_file("plate.bdf", PLATE)
        .with_file("job.toml", job)
        .with_file("gauges.csv", gauges)
}

/// Returns S of the first gauge and the findings, or the faults.
fn compute_sensitivity(gauges: &str) -> Result<(f64, Vec<Finding>), Faults> {
    let files = plate(gauges);
    let job = Job::read("job.toml", &files)?;
    let found = sensitivity(&job, &Context::new(&files))?;
    let value = found.prepared.sensitivity.values[(0, 0)];
    Ok((value, found.findings.to_vec()))
}

fn find_unread_columns(findings: &[Finding]) -> Vec<&Finding> {
    let of_code = findings.iter().filter(|f| f.code == "column-not-read");
    of_code.collect()
}

/// Several column names state a direction unambiguously. Each of these tables states the same gauge.
#[test]
fn other_names_of_the_columns_of_a_gauge_table_are_read() {
    let (right, _) =
        compute_sensitivity("name,element,surface,dir_x,dir_y,dir_z\nA,7,bottom,1,1,0\n").unwrap();
    let (along_x, _) =
        compute_sensitivity("name,element,surface,dir_x,dir_y,dir_z\nA,7,bottom,1,0,0\n").unwrap();
    assert!((right - along_x).abs() > 0.1 * right.abs());
    for header in [
        "name,element,side,axis_x,axis_y,axis_z",
        "Gauge,Element,Surface,DIR_X,DIR_Y,DIR_Z",
        "gauge,element,surface,dirx,diry,dirz",
        "name,element,surface,direction_x,direction_y,direction_z",
        "name,element,surface,dir x,dir y,dir z",
    ] {
        let (found, findings) =
            compute_sensitivity(&format!("{header}\nA,7,bottom,1,1,0\n")).unwrap();
        assert_eq!(found, right, "{header}");
        assert!(
            find_unread_columns(&findings).is_empty(),
            "{header}: {findings:?}"
        );
    }
    // 45 degrees from the x axis of the element is the diagonal.
    for (header, angle) in [
        ("angle_deg", "45"),
        ("angle [deg]", "45"),
        ("angle_rad", "0.7853981633974483"),
        ("angle [rad]", "0.7853981633974483"),
    ] {
        let text = format!("name,element,surface,{header}\nA,7,bottom,{angle}\n");
        let (found, findings) = compute_sensitivity(&text).unwrap();
        assert!((found / right - 1.0).abs() < 1e-12, "{header}: {found}");
        assert!(
            find_unread_columns(&findings).is_empty(),
            "{header}: {findings:?}"
        );
    }
}

#[test]
fn lengths_in_a_gauge_table_have_the_unit_of_their_header() {
    let (right, _) =
        compute_sensitivity("name,x,y,z,surface,angle_deg\nA,40,60,1,top,30\n").unwrap();
    for (header, row) in [
        ("x [mm],y [mm],z [mm]", "40,60,1"),
        ("x [m],y [m],z [m]", "0.04,0.06,0.001"),
        ("x_m,y_m,z_m", "0.04,0.06,0.001"),
        ("x_m [m],y_m [m],z_m [m]", "0.04,0.06,0.001"),
        ("x_mm,y_mm,z_mm", "40,60,1"),
    ] {
        let (found, _) = compute_sensitivity(&format!(
            "name,{header},surface,angle_deg\nA,{row},top,30\n"
        ))
        .unwrap();
        assert!((found / right - 1.0).abs() < 1e-12, "{header}: {found}");
    }
}

#[test]
fn what_can_not_be_meant_in_a_gauge_table_is_a_fault() {
    for (header, cell, field) in [
        ("angle_deg [rad]", "1", "angle_deg [rad]"),
        ("direction", "1 0 0", "direction"),
        ("grid_length [kN]", "5", "grid_length [kN]"),
        ("x_m [mm]", "5", "x_m [mm]"),
        ("Dir_X,DIRX", "1,1", "DIRX"),
    ] {
        let text = format!("name,element,surface,{header}\nA,7,bottom,{cell}\n");
        let faults = compute_sensitivity(&text).map(|_| ()).unwrap_err();
        let named = |f: &strainbridge::Fault| f.field == field;
        assert!(faults.iter().any(named), "{header}: {faults:?}");
    }
}

/// One warning names all columns that no command reads. It omits columns that `place` writes for information.
#[test]
fn columns_of_a_gauge_table_that_nothing_reads_are_named_once() {
    let text = "name,element,surface,angle_deg,leverage,role,colour,wire\nA,7,bottom,45,0.5,estimate,red,3\n";
    let (_, findings) = compute_sensitivity(text).unwrap();
    let [one] = find_unread_columns(&findings)[..] else {
        panic!("{findings:?}")
    };
    assert_eq!(one.subject, "gauges.csv");
    assert!(one.message.contains("`colour`, `wire`"), "{}", one.message);
    assert!(!one.message.contains("leverage"), "{}", one.message);
    // The `side` of a vehicle is not the side of a shell.
    let (_, findings) = compute_sensitivity("name,element,side,angle_deg\nA,7,left,45\n").unwrap();
    assert!(find_unread_columns(&findings)[0].message.contains("`side`"));
}

#[test]
fn a_gauge_table_without_directions_states_where_its_gauges_point() {
    let (_, findings) = compute_sensitivity("name,element,surface\nA,7,bottom\n").unwrap();
    assert!(findings.iter().any(|f| f.code == "gauges-assumed"));
    let (_, findings) =
        compute_sensitivity("name,element,surface,angle_deg\nA,7,bottom,0\n").unwrap();
    assert!(findings.iter().all(|f| f.code != "gauges-assumed"));
}

/// Returns a job with a given S of two loads and three gauges.
fn build_sensitivity_job(s: &str, runs: Option<&str>, more: &str) -> InMemory {
    let mut strain = "run,G1,G2,G3\n".to_owned();
    for i in 0..5 {
        let (a, b) = (100.0 + f64::from(i), 50.0 - 2.0 * f64::from(i));
        let _ = writeln!(strain, "R{i},{},{},{}", a, b, a + b);
    }
    let job = format!(
        "units = \"m-kg-s\"\n[sensitivity]\nfile = \"S.csv\"\n[[load]]\nname = \"A.FZ\"\n[[load]]\nname = \"B.FZ\"\n\
         [measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 1.0\n{more}"
    );
    let files = InMemory::default()
        .with_file("job.toml", job)
        .with_file("S.csv", s)
        .with_file("strain.csv", strain);
    match runs {
        Some(text) => files.with_file("runs.csv", text),
        None => files,
    }
}

const S: &str = "gauge,A.FZ,B.FZ\nG1,1,0\nG2,0,1\nG3,1,1\n";

fn recover_load_values(files: &InMemory) -> Result<(Vec<f64>, Vec<Finding>), Faults> {
    let job = Job::read("job.toml", files)?;
    let found = recover(&job, &Context::new(files))?;
    let runs = found.runs().unwrap();
    let values = runs.loads.iter().map(|l| l.value).collect();
    Ok((values, found.findings.to_vec()))
}

#[test]
fn columns_of_a_table_of_s_are_read_or_named_or_refused() {
    let (right, findings) = recover_load_values(&build_sensitivity_job(S, None, "")).unwrap();
    assert!(find_unread_columns(&findings).is_empty(), "{findings:?}");
    // Case and separators do not matter.
    let (found, _) =
        recover_load_values(&build_sensitivity_job(&S.replace("A.FZ", "a_fz"), None, "")).unwrap();
    assert_eq!(found, right);
    // A sign is not a separator.
    let signed = recover_load_values(&build_sensitivity_job(
        &S.replace("A.FZ", "A.FZ-"),
        None,
        "",
    ));
    let faults = signed.map(|_| ()).unwrap_err();
    assert!(
        faults.iter().any(|f| f.wrong.contains("A.FZ")),
        "{faults:?}"
    );
    let more = "gauge,A.FZ,B.FZ,C.FZ\nG1,1,0,9\nG2,0,1,9\nG3,1,1,9\n";
    let (found, findings) = recover_load_values(&build_sensitivity_job(more, None, "")).unwrap();
    assert_eq!(found, right);
    assert!(find_unread_columns(&findings)[0].message.contains("`C.FZ`"));
    // Without the column of load B, the other load would absorb the strain of B.
    let faults = recover_load_values(&build_sensitivity_job(
        "gauge,A.FZ,Z\nG1,1,0\nG2,0,1\nG3,1,1\n",
        None,
        "",
    ));
    let faults = faults.map(|_| ()).unwrap_err();
    assert!(
        faults.iter().any(|f| f.wrong.contains("B.FZ")),
        "{faults:?}"
    );
}

#[test]
fn columns_of_the_runs_file_are_read_or_named() {
    let job = |runs: &str| {
        let files = build_sensitivity_job(
            S,
            Some(runs),
            "[runs]\nfile = \"runs.csv\"\nunits = { force = \"N\", mass = \"kg\", length = \"m\" }\n",
        );
        let job = Job::read("job.toml", &files).unwrap();
        let mut inputs = strainbridge::host::files::Inputs::new(&files);
        let rows = strainbridge::measured::runs_file::read_runs(
            &mut inputs,
            &job,
            job.runs.as_ref().unwrap(),
        );
        (rows.unwrap(), inputs.findings())
    };
    let (right, findings) = job("run,payload_mass,payload_x,A.FZ,B.FZ\nR0,300,2,1,2\n");
    assert!(find_unread_columns(&findings).is_empty());
    for header in [
        "Run,Payload_mass,payload_X,a.fz,b.fz",
        "run,payload mass,PayloadX,A_FZ,B-FZ",
        "run,Payload_mass [kg],payload_X [m],A.FZ [N],B.FZ [N]",
    ] {
        let (found, findings) = job(&format!("{header}\nR0,300,2,1,2\n"));
        assert_eq!(found, right, "{header}");
        assert!(
            find_unread_columns(&findings).is_empty(),
            "{header}: {findings:?}"
        );
    }
    let (_, findings) = job("run,payload_mass,payload_px,A.FZ,driver\nR0,300,2,1,7\n");
    let [one] = find_unread_columns(&findings)[..] else {
        panic!("{findings:?}")
    };
    assert!(
        one.message.contains("`payload_px`, `driver`"),
        "{}",
        one.message
    );
    assert!(
        one.remedy.contains("`payload_px` to `payload_"),
        "{}",
        one.remedy
    );
}

/// A file that the job names must exist, even if the command does not read it.
#[test]
fn a_runs_file_that_is_missing_is_a_fault() {
    let files = build_sensitivity_job(S, None, "[runs]\nfile = \"absent.csv\"\n");
    let faults = recover_load_values(&files).map(|_| ()).unwrap_err();
    let named = |f: &strainbridge::Fault| f.field == "runs.file" && f.line.is_some();
    assert!(faults.iter().any(named), "{faults:?}");
}

#[test]
fn a_job_states_s_once() {
    let text = "units = \"mm-t-s\"\n[model]\ndeck = \"plate.bdf\"\n[[load]]\nname = \"P\"\ngrid = 2\ncomponent = \"FY\"\n\
                [sensitivity]\nfile = \"S.csv\"\n";
    let read = |text: &str| Job::read("job.toml", &InMemory::default().with_file("job.toml", text));
    let faults = read(text).map(|_| ()).unwrap_err();
    let named = |f: &strainbridge::Fault| f.field == "sensitivity" && f.line == Some(8);
    assert!(faults.iter().any(named), "{faults:?}");
    // A calibrated S is used together with its model.
    assert!(read(&format!("{text}covariance = \"calibration.bin\"\n")).is_ok());
}

#[test]
fn columns_of_a_table_of_loads_that_nothing_reads_are_named() {
    let files = plate("name,element,surface,angle_deg\nA,7,bottom,45\n");
    let job = "units = \"mm-t-s\"\n[model]\ndeck = \"plate.bdf\"\n[[load]]\nname = \"P\"\ngrid = 2\ncomponent = \"FY\"\n\
               [respond]\nloads = \"loads.csv\"\n";
    let files = files
        .with_file("job.toml", job)
        .with_file("loads.csv", "run,P,P.low,P.high,Q\nR1,10,9,11,5\n");
    let job = Job::read("job.toml", &files).unwrap();
    let found = respond(&job, &Context::new(&files)).unwrap();
    let list = found.findings.to_vec();
    assert!(
        find_unread_columns(&list)[0].message.ends_with("`Q`."),
        "{list:?}"
    );
}

/// A table, a binary record and an RPC III file with equal loads give equal stress. The 16 bits of RPC III have a step
/// of 1/32,000 of the largest value.
#[test]
fn loads_of_every_record_format_give_the_stress_of_their_table() {
    let loads = [1.0, -12.5, 40.0, 25.0, 0.0];
    let mut table = "time,P\n".to_owned();
    let mut binary = Vec::new();
    strainbridge::series::binary::write_header(
        &mut binary,
        &["P [kN]".to_owned()],
        5,
        0.0,
        0.1,
        1.0,
    )
    .unwrap();
    for (i, v) in loads.iter().enumerate() {
        let _ = writeln!(table, "{},{v}", i as f64 * 0.1);
        binary.extend_from_slice(&((v / 1000.0) as f32).to_le_bytes());
    }
    let target = strainbridge::series::rpc::Target {
        name: "P".to_owned(),
        unit: "N".to_owned(),
        min: -12.5,
        max: 40.0,
    };
    let mut rpc = Vec::new();
    let next = |from: usize, to: usize, out: &mut Vec<f64>| out.extend(&loads[from..to]);
    strainbridge::series::rpc::write_rpc(&mut rpc, &[target], 0.1, 5, next).unwrap();
    let answer = |name: &str, bytes: &[u8]| {
        let files = plate("name,element,surface,angle_deg\nA,7,bottom,45\n");
        let job = format!(
            "units = \"mm-t-s\"\n[model]\ndeck = \"plate.bdf\"\n[[load]]\nname = \"P\"\ngrid = 2\ncomponent = \"FY\"\n\
             [respond]\nloads = \"{name}\"\n"
        );
        let files = files.with_file("job.toml", job).with_file(name, bytes);
        let job = Job::read("job.toml", &files).unwrap();
        let found = respond(&job, &Context::new(&files)).unwrap();
        (
            found.states,
            found.elements[0].max_von_mises,
            found.elements[0].at.clone(),
        )
    };
    let (states, stress, at) = answer("loads.csv", table.as_bytes());
    assert_eq!((states, at.as_deref()), (5, Some("0.2")));
    for (name, bytes, digits) in [
        ("loads.bin", &binary, 1e-6),
        ("loads.rsp", &rpc, 1.0 / 32_000.0),
    ] {
        let (n, found, at) = answer(name, bytes);
        assert_eq!((n, at), (states, Some("0.2".to_owned())), "{name}");
        assert!(
            (found / stress - 1.0).abs() < digits,
            "{name}: {found} {stress}"
        );
    }
    // A record without a column for the load is refused.
    let files = plate("name,element,surface,angle_deg\nA,7,bottom,45\n");
    let job = "units = \"mm-t-s\"\n[model]\ndeck = \"plate.bdf\"\n[[load]]\nname = \"Q\"\ngrid = 2\ncomponent = \"FY\"\n\
               [respond]\nloads = \"loads.bin\"\n";
    let files = files
        .with_file("job.toml", job)
        .with_file("loads.bin", binary);
    let job = Job::read("job.toml", &files).unwrap();
    let faults = respond(&job, &Context::new(&files))
        .map(|_| ())
        .unwrap_err();
    assert!(
        faults
            .to_string()
            .contains("no column has the name of a load"),
        "{faults}"
    );
}

/// Loads in kN give the same stress as the same loads in N. The unit comes from the header, from `result.json` next to
/// the table, or from the notes of a Parquet file.
#[test]
fn loads_in_another_unit_than_the_report_give_the_same_stress() {
    let loads = [1.0, -12.5, 40.0, 25.0, 0.0];
    let table = |head: &str, scale: f64| {
        let rows = loads.iter().enumerate();
        let rows = rows.map(|(i, v)| {
            let v = v * scale;
            format!("{},{v},{},{}\n", i as f64 * 0.1, v - scale, v + scale)
        });
        format!("{head}\n{}", rows.collect::<String>()).into_bytes()
    };
    let result = r#"{"command": "recover", "tables": {"loads.csv": {"time": "s", "P": "kN", "P.low": "kN", "P.high": "kN"}}}"#;
    let notes = [("unit of P".to_owned(), "kN".to_owned())];
    let read = |from: usize, to: usize, out: &mut Vec<f64>| {
        out.extend(loads[from..to].iter().map(|v| 1e-3 * v));
    };
    let parquet = strainbridge::series::parquet::parquet_bytes(
        &["P".to_owned()],
        &notes,
        [0.0, 0.1],
        5,
        read,
    );
    let stress = |name: &str, bytes: Vec<u8>, beside: Option<&str>| {
        let files = plate("name,element,surface,angle_deg\nA,7,bottom,45\n");
        let job = format!(
            "units = \"mm-t-s\"\n[model]\ndeck = \"plate.bdf\"\n[[load]]\nname = \"P\"\ngrid = 2\ncomponent = \"FY\"\n\
             [respond]\nloads = \"out/{name}\"\n"
        );
        let mut files = files
            .with_file("job.toml", job)
            .with_file(format!("out/{name}"), bytes);
        if let Some(text) = beside {
            files = files.with_file("out/result.json", text);
        }
        let job = Job::read("job.toml", &files).unwrap();
        let found = respond(&job, &Context::new(&files)).unwrap();
        found.elements[0].max_von_mises
    };
    let plain = "time,P,P.low,P.high";
    let right = stress("loads.csv", table(plain, 1.0), None);
    for (name, bytes, beside) in [
        (
            "loads.csv",
            table("time,P [kN],P.low [kN],P.high [kN]", 1e-3),
            None,
        ),
        ("loads.csv", table(plain, 1e-3), Some(result)),
        // A unit in the header has priority over the unit in another file.
        (
            "loads.csv",
            table("time,P [N],P.low [N],P.high [N]", 1.0),
            Some(result),
        ),
        ("loads.parquet", parquet.unwrap(), None),
    ] {
        let found = stress(name, bytes, beside);
        assert!(
            (found / right - 1.0).abs() < 1e-6,
            "{name} {beside:?}: {found} {right}"
        );
    }
}

/// Twice the loads give `2^m` times the damage. With intervals of the loads, the damage has an interval. Runs form no
/// cycles.
#[test]
fn fatigue_scales_with_the_power_of_the_loads_and_needs_a_history() {
    let answer = |key: &str, factor: f64, more: &str| {
        let mut table = format!("{key},P,P.low,P.high\n");
        for (i, v) in [1.0, -12.5, 40.0, 25.0, 30.0, 0.0].iter().enumerate() {
            let v = v * factor;
            let _ = writeln!(table, "{i},{v},{},{}", v - 0.5, v + 0.5);
        }
        let files = plate("name,element,surface,angle_deg\nA,7,bottom,45\n");
        let job = format!(
            "units = \"mm-t-s\"\n[model]\ndeck = \"plate.bdf\"\n[[load]]\nname = \"P\"\ngrid = 2\ncomponent = \"FY\"\n\
             [respond]\nloads = \"loads.csv\"\n{more}"
        );
        let files = files
            .with_file("job.toml", job)
            .with_file("loads.csv", table);
        let job = Job::read("job.toml", &files)?;
        respond(&job, &Context::new(&files)).map(|o| o.answer.fatigue)
    };
    let slope = "slope = 4.0\n";
    let [once, twice] = [1.0, 2.0].map(|factor| answer("time", factor, slope).unwrap());
    assert!(!once.is_empty() && once.len() == twice.len());
    for (a, b) in once.iter().zip(&twice) {
        assert!((b.damage / a.damage - 16.0).abs() < 1e-9, "{a:?} {b:?}");
        assert!(a.damage_low < a.damage && a.damage < a.damage_high, "{a:?}");
        assert_eq!(a.angle_deg, b.angle_deg);
    }
    // The share of life is the sum of n / N with N = 2e6 (class / range)^4, and needs the slope.
    assert!(once.iter().all(|f| f.life_share.is_none()));
    let of_class = answer("time", 1.0, "slope = 4.0\nfatigue_class = 71.0\n").unwrap();
    for (a, b) in once.iter().zip(&of_class) {
        let share = a.damage_high / (2e6 * 71.0_f64.powi(4));
        assert!((b.life_share_high.unwrap() / share - 1.0).abs() < 1e-12);
    }
    let printed = answer("time", 1.0, "fatigue_class = 71.0\n");
    let printed = printed.map(|_| ()).unwrap_err().to_string();
    assert!(printed.contains("respond.fatigue_class"), "{printed}");
    let printed = answer("run", 1.0, slope)
        .map(|_| ())
        .unwrap_err()
        .to_string();
    assert!(
        printed.contains("respond.slope") && printed.contains("form no cycles"),
        "{printed}"
    );
}
