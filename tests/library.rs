//! The library asked as a program of somebody else's would: files in memory, no folder, no terminal.

use strainbridge::app::context::InMemory;
use strainbridge::app::recover::recover_runs;
use strainbridge::app::store::Memory;
use strainbridge::{Context, Job, Severity, place, sensitivity};

/// A free strip of plates along x, 11 by 2 grids 20 mm apart, 2 mm thick.
fn strip() -> String {
    let mut deck = String::from("SOL 101\nCEND\nBEGIN BULK\n");
    for i in 0..11 {
        for j in 0..2 {
            let id = 1 + i + 100 * j;
            deck += &format!(
                "GRID,{id},,{:.1},{:.1},0.\n",
                20.0 * f64::from(i),
                20.0 * f64::from(j)
            );
        }
    }
    for i in 0..10 {
        let (a, b) = (1 + i, 2 + i);
        deck += &format!("CQUAD4,{},1,{a},{b},{},{}\n", 1 + i, b + 100, a + 100);
    }
    deck + "PSHELL,1,1,2.,1,,1\nMAT1,1,210000.,,.3,7.85-9\nENDDATA\n"
}

const JOB: &str = r#"
units = "mm-t-s"
[model]
deck = "strip.bdf"
[[load]]
name = "left"
grid = 1
component = "FZ"
expected = 10.0
[[load]]
name = "middle"
grid = 6
component = "FZ"
expected = 10.0
[placement]
gauges = 4
"#;

fn files() -> InMemory {
    InMemory::default()
        .with("strip.bdf", strip())
        .with("job.toml", JOB)
}

#[test]
fn a_layout_comes_as_a_value_with_its_certificate() {
    let files = files();
    let job = Job::read("job.toml", &files).unwrap();
    let kept = Memory::default();
    let context = Context::new(&files).store(&kept);
    let plan = place(&job, &context).unwrap();
    assert_eq!(plan.gauges.len(), 4);
    for gauge in &plan.gauges {
        let length: f64 = gauge.direction.iter().map(|v| v * v).sum();
        assert!((length - 1.0).abs() < 1e-9, "a direction is a unit vector");
    }
    // The certificate is a share; what is proved the best has nothing above it.
    assert!(plan.efficiency_bound > 0.0 && plan.efficiency_bound <= 1.0 + 1e-12);
    assert!(plan.log_det <= plan.upper_bound + 1e-9);
    assert!(plan.findings.worst() < Some(Severity::Error));
    // Asked again, the kept solution gives the same layout.
    let again = place(&job, &context).unwrap();
    assert_eq!(plan.gauges, again.gauges);
    assert!(again.notes.iter().any(|n| n.contains("kept")));
}

/// What is planned and what is recovered from readings without error are the same covariance, asked twice.
#[test]
fn the_planned_sigma_is_the_recovered_one_at_the_expected_loads() {
    let errors = "noise_microstrain = 1.0\nmodel_uncertainty_rel = 0.02\n";
    let plan = files().with(
        "plan.toml",
        format!("{JOB}spacing = 15.0\nangle_tolerance_deg = 2.0\n{errors}"),
    );
    let job = Job::read("plan.toml", &plan).unwrap();
    let placed = place(&job, &Context::new(&plan)).unwrap();
    let s = &placed.sensitivity;
    let mut job = JOB.split("[placement]").next().unwrap().to_owned();
    let (mut head, mut row) = ("run".to_owned(), "R1".to_owned());
    for (i, g) in placed.gauges.iter().enumerate() {
        let [x, y, z] = g.direction;
        job += &format!(
            "[[gauge]]\nname = \"{}\"\nelement = {}\nsurface = \"{}\"\ndirection = [{x}, {y}, {z}]\n",
            g.name, g.element, g.surface
        );
        head += &format!(",{}", g.name);
        // Ten of both loads, in microstrain.
        row += &format!(",{}", 1e7 * (s.values[(i, 0)] + s.values[(i, 1)]));
    }
    job += &format!("[measured]\nstrain = \"strain.csv\"\n{errors}");
    let files = files()
        .with("recover.toml", job)
        .with("strain.csv", format!("{head}\n{row}\n"));
    let job = Job::read("recover.toml", &files).unwrap();
    let got = recover_runs(&job, &Context::new(&files)).unwrap();
    assert_eq!(got.loads.len(), 2);
    for (planned, got) in placed.load_sigma.iter().zip(&got.loads) {
        let value = got.value;
        assert!((value - 10.0).abs() < 1e-6, "{value}");
        // Only the chi-square of readings without error could differ, and it widens nothing.
        let ratio = got.sigma / planned.sigma;
        assert!((ratio - 1.0).abs() < 0.01, "{} {ratio}", planned.name);
        assert!(planned.sigma_as_glued.unwrap() > planned.sigma);
    }
}

#[test]
fn s_is_linear_in_the_size_of_the_unit_load() {
    let files = files().with(
        "doubled.toml",
        JOB.replace("expected", "applied = 2.0\nexpected"),
    );
    let ask = |name: &str| {
        let job = Job::read(name, &files).unwrap();
        sensitivity(&job, &Context::new(&files)).unwrap()
    };
    let (one, two) = (ask("job.toml"), ask("doubled.toml"));
    let (a, b) = (
        &one.prepared.sensitivity.values,
        &two.prepared.sensitivity.values,
    );
    let largest = a.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    // S is per unit of the load: rounding of one factor and two substitutions.
    assert!(
        a.iter()
            .zip(b.iter())
            .all(|(x, y)| (x - y).abs() < 1e-12 * largest)
    );
}

#[test]
fn faults_come_with_file_line_and_remedy() {
    let files = InMemory::default().with("job.toml", "units = \"furlong\"\n");
    let faults = Job::read("job.toml", &files).unwrap_err();
    let first = faults.first().unwrap();
    assert_eq!((first.file.as_str(), first.line), ("job.toml", Some(1)));
    assert!(!first.remedy.is_empty());
}
