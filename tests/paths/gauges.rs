//! Compares gauges of a job with closed forms: directions in cylindrical systems, second pairs, names, corrections,
//! reference states, grids.

use strainbridge::host::context::InMemory;
use strainbridge::{Context, Job, place, recover, sensitivity, study};

/// Returns a square plate of 4 by 4 elements of 10 mm, 2 mm thick, with its middle at the origin.
///
/// The cylindrical coordinate system 7 is there. A force of 2,000 N along x on each 10 mm of two edges gives 100 MPa,
/// so the strain along x is `100 / E` everywhere.
fn plate() -> String {
    let mut deck = String::from(
        "SOL 101\nCEND\nSUBCASE 3\n LOAD = 5\nSUBCASE 4\n SPC = 1\nSUBCOM 6\n LOAD = 5\n SUBSEQ = 2.,0.\n\
         SUBCOM 7\n SUBSEQ = 2.,0.\nSUBCASE 8\n ANALYSIS = MODES\n LOAD = 5\nBEGIN BULK\nPARAM,INREL,-2\n\
         CORD2C,7,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n",
    );
    let grid = |i: u32, j: u32| 1 + i + 5 * j;
    for j in 0..5 {
        for i in 0..5 {
            let [x, y] = [i, j].map(|k| 10.0 * f64::from(k) - 20.0);
            deck += &format!("GRID,{},,{x:.1},{y:.1},0.\n", grid(i, j));
        }
        // Each grid of an element takes half of the force of the element.
        let force = if j == 0 || j == 4 { 1000.0 } else { 2000.0 };
        let [left, right] = [grid(0, j), grid(4, j)];
        for set in [2, 5] {
            let force = if set == 5 { 7.0 * force } else { force };
            deck += &format!("FORCE,{set},{left},,{force:.1},-1.,0.,0.\n");
            deck += &format!("FORCE,{set},{right},,{force:.1},1.,0.,0.\n");
        }
    }
    for j in 0..4 {
        for i in 0..4 {
            let corners = [
                grid(i, j),
                grid(i + 1, j),
                grid(i + 1, j + 1),
                grid(i, j + 1),
            ];
            let corners = corners.map(|g| g.to_string()).join(",");
            deck += &format!("CQUAD4,{},1,{corners}\n", 1 + i + 4 * j);
        }
    }
    deck + "PSHELL,1,1,2.,1,,1\nMAT1,1,200000.,,.25,7.85-9\nENDDATA\n"
}

const HEAD: &str = "units = \"mm-t-s\"\n[model]\ndeck = \"plate.bdf\"\nsupport = \"free\"\n[[load]]\nname = \"P\"\nload_set = 2\n";
/// Strain along x and y under the load set: 2,000 N on each 10 mm of 2 mm.
const EX: f64 = 100.0 / 200_000.0;
const EY: f64 = -0.25 * EX;

fn files(job: &str) -> InMemory {
    InMemory::default()
        .with_file("plate.bdf", plate())
        .with_file("job.toml", format!("{HEAD}{job}"))
}

/// Returns names and readings under the load, strain.
fn readings(files: &InMemory) -> Vec<(String, f64)> {
    let job = Job::read("job.toml", files).unwrap();
    let s = sensitivity(&job, &Context::new(files)).unwrap();
    let s = &s.prepared.sensitivity;
    s.gauges
        .iter()
        .cloned()
        .zip(s.values.column(0).iter().copied())
        .collect()
}

/// Returns the faults of reading or preparing the job, as text.
fn collect_job_faults(files: &InMemory) -> String {
    let faults: strainbridge::Faults = match Job::read("job.toml", files) {
        Ok(job) => sensitivity(&job, &Context::new(files)).err().unwrap(),
        Err(faults) => faults,
    };
    faults.iter().map(|f| format!("{f}\n")).collect()
}

/// Rounding error of the solution of a small plate.
const ROUNDING: f64 = 1e-9 * EX;

#[test]
fn a_direction_in_a_cylindrical_system_is_taken_at_the_element() {
    let mut job = String::new();
    for element in 1..=16 {
        for (name, d) in [("r", "[1, 0, 0]"), ("t", "[0, 1, 0]"), ("h", "[1, 1, 0]")] {
            job += &format!(
                "[[gauge]]\nname = \"{name}{element}\"\nelement = {element}\ncid = 7\ndirection = {d}\n"
            );
        }
    }
    for (name, got) in readings(&files(&job)) {
        let n: u32 = name[1..].parse().unwrap();
        let [x, y] = [(n - 1) % 4, (n - 1) / 4].map(|k| 10.0 * f64::from(k) - 15.0);
        let turn = match &name[..1] {
            "r" => 0.0,
            "t" => std::f64::consts::FRAC_PI_2,
            _ => std::f64::consts::FRAC_PI_4,
        };
        let (s, c) = (y.atan2(x) + turn).sin_cos();
        let expected = EX * c * c + EY * s * s;
        assert!(
            (got - expected).abs() < ROUNDING,
            "{name}: {got} {expected}"
        );
    }
}

#[test]
fn the_second_pair_and_the_legs_of_a_rosette_have_the_direction_of_their_place() {
    // Radial directions at (15, 15) and at (-15, 5). The half bridge reads the difference of both strains. The third
    // leg is tangential.
    let job = "[[gauge]]\nname = \"h\"\nelement = 16\nsurface = \"top\"\nelement2 = 9\nsurface2 = \"top\"\ncid = 7\ndirection = [1, 0, 0]\n\
               bridge = \"half-bending\"\n[[gauge]]\nname = \"R\"\nelement = 9\ncid = 7\ndirection = [1, 0, 0]\nrosette = \"rectangular\"\n";
    let got = readings(&files(job));
    let along = |t: f64| EX * t.cos().powi(2) + EY * t.sin().powi(2);
    let [here, there] = [15_f64.atan2(15.0), 5_f64.atan2(-15.0)];
    let eighth = std::f64::consts::FRAC_PI_4;
    let expected = [
        along(here) - along(there),
        along(there),
        along(there + eighth),
        along(there + 2.0 * eighth),
    ];
    for ((name, got), expected) in got.iter().zip(expected) {
        assert!(
            (got - expected).abs() < ROUNDING,
            "{name}: {got} {expected}"
        );
    }
    // On the axis of the system, the radial direction is undefined.
    let centred =
        files("[[gauge]]\nname = \"r\"\nposition = [0, 0, 1]\ncid = 7\ndirection = [1, 0, 0]\n");
    assert!(
        collect_job_faults(&centred).contains("job.toml:8: direction: gauge `r`"),
        "{}",
        collect_job_faults(&centred)
    );
}

#[test]
fn the_second_side_left_out_is_the_opposite_one() {
    let gauge = |keys: &str| {
        format!("[[gauge]]\nname = \"g\"\nelement = 6\nbridge = \"half-bending\"\n{keys}")
    };
    // Half bridges read zero under tension, but the strain of their arms differs.
    let arms = |keys: &str| {
        let files = files(&gauge(keys));
        let job = Job::read("job.toml", &files).unwrap();
        let gauges = sensitivity(&job, &Context::new(&files))
            .unwrap()
            .prepared
            .gauges
            .clone();
        gauges[0].arms.clone()
    };
    for side in ["top", "bottom"] {
        let surface = format!("surface = \"{side}\"\n");
        let plain = arms(&surface);
        assert_eq!(plain.len(), 2);
        assert_eq!(arms(&format!("{surface}element2 = 6\n")), plain);
        let other = if side == "top" { "bottom" } else { "top" };
        assert_eq!(arms(&format!("{surface}surface2 = \"{other}\"\n")), plain);
        let same = collect_job_faults(&files(&gauge(&format!("{surface}surface2 = \"{side}\"\n"))));
        assert!(same.contains("job.toml:8: surface2: gauge `g`"), "{same}");
    }
    let table = |rows: &str| {
        files("[gauges]\nfile = \"g.csv\"\n").with_file(
            "g.csv",
            format!("name,element,surface,bridge,element2,surface2\n{rows}"),
        )
    };
    let job = |rows: &str| Job::read("job.toml", &table(rows)).unwrap();
    let pair = |rows: &str| job(rows).gauges[0].pair.unwrap();
    use strainbridge::fe::strain_tensor::Surface::{Bottom, Top};
    assert_eq!(pair("g,6,bottom,half,7,\n"), (7, None));
    assert_eq!(pair("g,6,,half,7,bottom\n"), (7, Some(Bottom)));
    assert_eq!(pair("g,6,bottom,half,,top\n"), (6, Some(Top)));
    assert!(collect_job_faults(&table("g,6,bottom,,,top\n")).contains("g.csv:2: element2"));
}

#[test]
fn two_channels_of_one_name_are_refused_with_both_lines() {
    let gauge =
        |name: &str, more: &str| format!("[[gauge]]\nname = \"{name}\"\nelement = 1\n{more}");
    let rosette = "rosette = \"delta\"\n";
    for (first, second) in [
        (gauge("G6", rosette), gauge("G6.a", "")),
        (gauge("G6.c", ""), gauge("G6", rosette)),
        (gauge("G6", ""), gauge("G6", "")),
        (gauge("G6", ""), gauge("g6", "")),
        (gauge("G 6", ""), gauge("G6 ", "")),
    ] {
        let text = collect_job_faults(&files(&format!("{first}{second}")));
        assert!(
            text.contains(": name: ") && text.contains("`job.toml:8`"),
            "{text}"
        );
    }
    let both = files(&format!(
        "[gauges]\nfile = \"g.csv\"\n{}",
        gauge("G6", rosette)
    ))
    .with_file("g.csv", "name,element\nG5,2\nG6.b,2\n");
    let text = collect_job_faults(&both);
    assert!(
        text.contains("g.csv:3: name: channel `G6.b`") && text.contains("`job.toml:10`"),
        "{text}"
    );
    assert_eq!(
        readings(&files(&(gauge("G6", rosette) + &gauge("G6.d", "")))).len(),
        4
    );
}

/// Returns a job with a rosette and two gauges, and their readings under 3 times the load, microstrain.
fn build_measured_job(corrections: &str, change: impl Fn(&str, f64) -> f64) -> InMemory {
    let mut gauges = String::from(
        "[[gauge]]\nname = \"R\"\nelement = 6\ndirection = [1, 0, 0]\nrosette = \"rectangular\"\n",
    );
    for name in ["A", "B"] {
        gauges += &format!("[[gauge]]\nname = \"{name}\"\nelement = 7\ndirection = [1, 0, 0]\n");
    }
    let strain = [
        ("R.a", EX),
        ("R.b", 0.5 * (EX + EY)),
        ("R.c", EY),
        ("A", EX),
        ("B", EX),
    ];
    let (names, row): (Vec<&str>, Vec<String>) = strain
        .map(|(n, e)| (n, change(n, 3e6 * e).to_string()))
        .into_iter()
        .unzip();
    files(&format!(
        "{gauges}[measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 1.0\n{corrections}"
    ))
    .with_file(
        "strain.csv",
        format!("run,{}\nR1,{}\n", names.join(","), row.join(",")),
    )
}

fn recover_first_load(files: &InMemory) -> f64 {
    let job = Job::read("job.toml", files).unwrap();
    let answer = recover(&job, &Context::new(files)).unwrap();
    answer.runs().unwrap().loads[0].value
}

#[test]
fn corrections_of_a_rosette_and_of_its_legs_act() {
    let correct = |keys: &str| format!("[[correction]]\n{keys}\n");
    let on = |name: &str| name.starts_with("R.");
    for (keys, change) in [
        (
            "gauge = \"R\"\nsign = -1",
            &(|n: &str, e: f64| if on(n) { -e } else { e }) as &dyn Fn(&str, f64) -> f64,
        ),
        ("gauge = \"R\"\ngain = 1.5", &|n, e| {
            if on(n) { 1.5 * e } else { e }
        }),
        ("gauge = \"R\"\noffset_microstrain = 300", &|n, e| {
            if on(n) { e + 300.0 } else { e }
        }),
        ("gauge = \"R\"\nignore = true", &|n, e| {
            if on(n) { e + 4000.0 } else { e }
        }),
        ("gauge = \"R.b\"\nignore = true", &|n, e| {
            if n == "R.b" { e + 4000.0 } else { e }
        }),
        ("gauge = \"R.c\"\nsign = -1", &|n, e| {
            if n == "R.c" { -e } else { e }
        }),
        ("gauge = \"R\"\nangle_deg = 90", &|n, e| match n {
            "R.a" => 3e6 * EY,
            "R.c" => 3e6 * EX,
            _ => e,
        }),
        ("gauge = \"R.a\"\nangle_deg = 90", &|n, e| {
            if n == "R.a" { 3e6 * EY } else { e }
        }),
        (
            "gauge = \"R.a\"\nexchanged_with = \"R.c\"",
            &|n, e| match n {
                "R.a" => 3e6 * EY,
                "R.c" => 3e6 * EX,
                _ => e,
            },
        ),
    ] {
        let value = recover_first_load(&build_measured_job(&correct(keys), change));
        // Rounding error of readings that are written with all digits.
        assert!((value - 3.0).abs() < 1e-8, "{keys}: {value}");
        let plain = recover_first_load(&build_measured_job("", change));
        assert!((plain - 3.0).abs() > 1e-3, "{keys} has no effect: {plain}");
    }
    for (keys, expected) in [
        ("gauge = \"R\"\nexchanged_with = \"A\"", "one is a rosette"),
        ("gauge = \"R.d\"\nsign = -1", "no gauge `R.d`"),
        ("gauge = \"A.a\"\nsign = -1", "no gauge `A.a`"),
    ] {
        let text = collect_job_faults(&build_measured_job(&correct(keys), |_, e| e));
        assert!(
            text.contains("job.toml:") && text.contains(expected),
            "{text}"
        );
    }
}

#[test]
fn a_reference_subcase_is_that_of_the_deck_where_the_solver_is_built_in() {
    // Subcase 3 is 7 times the load, subcase 7 is twice subcase 3, and the readings are 3 times the load.
    let with = |n: u32| {
        let reference = format!("reference = {n}\n");
        build_measured_job(&reference, |_, e| e)
    };
    for (n, total) in [(3, 10.0), (7, 17.0)] {
        let value = recover_first_load(&with(n));
        assert!((value - total).abs() < 1e-8, "{n}: {value}");
    }
    // Subcase 6 is a combination that states LOAD, and subcase 8 is not a static subcase.
    for n in [1, 4, 6, 8, 9] {
        let files = with(n);
        let job = Job::read("job.toml", &files).unwrap();
        let text = recover(&job, &Context::new(&files))
            .err()
            .unwrap()
            .to_string();
        let why = match n {
            6 => "SUBCOM 6: a combination of subcases can't have a LOAD".to_owned(),
            n => format!("no static subcase {n}"),
        };
        assert!(text.contains(&why), "{text}");
    }
}

#[test]
fn a_placed_grid_reads_the_same_from_the_table_of_gauges() {
    let candidates =
        "[candidates]\nangle_step_deg = 30\ngrid_length = 6.0\n[placement]\ngauges = 3\n";
    let plan = files(candidates);
    let job = Job::read("job.toml", &plan).unwrap();
    let placed = place(&job, &Context::new(&plan)).unwrap();
    let mut table = Vec::new();
    strainbridge::report::strain::gauges_csv(&mut table, &placed.gauges, 6.0).unwrap();
    let again = files("[gauges]\nfile = \"gauges.csv\"\n").with_file("gauges.csv", table);
    assert!(
        Job::read("job.toml", &again)
            .unwrap()
            .gauges
            .iter()
            .all(|g| g.grid_length == 6.0)
    );
    let s = &placed.sensitivity;
    let rows: Vec<(String, f64)> = s
        .gauges
        .iter()
        .cloned()
        .zip(s.values.column(0).iter().copied())
        .collect();
    assert_eq!(readings(&again), rows, "the same bits");
    let long =
        files("[candidates]\nangle_step_deg = 90\ngrid_length = 41.0\n[placement]\ngauges = 3\n");
    let job = Job::read("job.toml", &long).unwrap();
    let text = place(&job, &Context::new(&long)).err().unwrap().to_string();
    assert!(
        text.contains("`grid_length` is 41") && text.contains("40.0000 long"),
        "{text}"
    );
}

#[test]
fn a_placed_grid_that_reaches_past_the_edge_is_replaced_by_one_that_fits() {
    // A grid of 20 mm along x fits only if its middle is at least 10 mm from the edges at x = -20 and 20. This holds in
    // the columns at x = -5 and 5.
    let keys = "[candidates]\nangle_step_deg = 180\ngrid_length = 20.0\n";
    let plan = files(&format!("{keys}[placement]\ngauges = 4\nspacing = 1.0\n"));
    let job = Job::read("job.toml", &plan).unwrap();
    let placed = place(&job, &Context::new(&plan)).unwrap();
    for g in &placed.gauges {
        let column = (g.element - 1) % 4;
        assert!(column == 1 || column == 2, "element {}", g.element);
    }
    // If no place fits, the message names the keys that help.
    let long =
        files("[candidates]\nangle_step_deg = 180\ngrid_length = 41.0\n[placement]\ngauges = 3\n");
    let job = Job::read("job.toml", &long).unwrap();
    let text = place(&job, &Context::new(&long)).err().unwrap().to_string();
    for part in [
        "lower [candidates] `grid_length` to 40.0000 or less",
        "`exclude_elements`",
    ] {
        assert!(text.contains(part), "{text}");
    }
}

#[test]
fn tables_that_a_job_names_and_that_are_missing_are_faults_of_every_command_on_gauges() {
    let gauge = "[[gauge]]\nname = \"a\"\nelement = 6\n";
    let head = HEAD.replace("[[load]]", "TABLE[[load]]");
    let head = head.replace("load_set = 2\n", "load_set = 2\nexpected = 1.0\n");
    let rest = "[candidates]\nangle_step_deg = 90\n[placement]\ngauges = 1\n\
                [study]\nlayouts = [\"given\"]\ngauges = [1]\ntrials = 10\n";
    for (table, name) in [
        (
            "[measured]\nstrain = \"s.csv\"\n[runs]\nfile = \"none.csv\"\n",
            "none.csv",
        ),
        (
            "[measured]\nstrain = \"s.csv\"\nzero = \"zero.csv\"\n",
            "zero.csv",
        ),
        (
            "[measured]\nstrain = \"s.csv\"\nhold_out = \"held.csv\"\n",
            "held.csv",
        ),
    ] {
        let text = format!("{}{gauge}{rest}", head.replace("TABLE", table));
        let files = InMemory::default()
            .with_file("plate.bdf", plate())
            .with_file("s.csv", "run,a\nR1,1\nR2,2\n")
            .with_file("job.toml", text);
        let cx = Context::new(&files);
        let job = Job::read("job.toml", &files).unwrap();
        for (command, faults) in [
            ("sensitivity", sensitivity(&job, &cx).err()),
            ("place", place(&job, &cx).err()),
            ("study", study(&job, &cx).err()),
            ("recover", recover(&job, &cx).err()),
        ] {
            let text = faults.map(|f| f.to_string()).unwrap_or_default();
            let is_named = text.contains(name) && text.contains("no such file");
            assert!(is_named, "{command} {name}: {text}");
        }
    }
}

#[test]
fn a_direction_of_a_gauge_on_a_bar_is_taken_at_its_station() {
    // A bar along y at x = 20. The tangential direction of the system is along the bar only in its middle.
    let bar = "CBAR,99,9,10,20,1.,0.,0.\nPBAR,9,1,10.,10.,10.,10.\n,1.,0.,-1.,0.\nENDDATA\n";
    let with = |station: f64| {
        let job = format!(
            "[[gauge]]\nname = \"b\"\nelement = 99\npoint = \"C\"\nstation = {station}\ncid = 7\ndirection = [0, 1, 0]\n"
        );
        files(&job).with_file("plate.bdf", plate().replace("ENDDATA\n", bar))
    };
    assert_eq!(readings(&with(0.5)).len(), 1);
    assert!(collect_job_faults(&with(0.25)).contains("a direction across the axis"));
}
