//! The library asked as a program of somebody else's would: files in memory, no folder, no terminal.

use strainbridge::app::context::InMemory;
use strainbridge::app::reconcile::extended_job;
use strainbridge::app::recover::recover_runs;
use strainbridge::app::store::Memory;
use strainbridge::reconcile::Verdict;
use strainbridge::{Context, Job, Severity, place, reconcile, sensitivity};

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

/// Twelve gauges under three loads, 14 runs: readings with a repeating scatter below a microstrain, gauge `G05` wired the wrong way round.
fn yard() -> InMemory {
    let at = |g: usize, l: usize| 20.0 * ((1.3 + 0.7 * l as f64) * (g as f64 + 1.0)).sin();
    let load = |r: usize, l: usize| 3.0 + 2.5 * ((2.1 + l as f64) * (r as f64 + 1.0)).cos();
    let names: Vec<String> = (1..=12).map(|g| format!("G{g:02}")).collect();
    let mut s = String::from("gauge,A,B,C\n");
    for (g, name) in names.iter().enumerate() {
        s += &format!("{name},{},{},{}\n", at(g, 0), at(g, 1), at(g, 2));
    }
    let mut strain = format!("run,{}\n", names.join(","));
    let mut runs = String::from("run,A,B,C\n");
    for r in 0..14 {
        runs += &format!("R{r},{},{},{}\n", load(r, 0), load(r, 1), load(r, 2));
        strain += &format!("R{r}");
        for g in 0..12 {
            let sign = if g == 4 { -1.0 } else { 1.0 };
            let told: f64 = (0..3).map(|l| at(g, l) * load(r, l)).sum();
            let scatter = 0.8 * (((r * 5 + g * 3) % 7) as f64 / 3.0 - 1.0);
            strain += &format!(",{:.4}", sign * told + scatter);
        }
        strain.push('\n');
    }
    let job = r#"
title = "yard"
units = "m-kg-s"
[sensitivity]
file = "s.csv"
per = { force = "kN" }
columns = { A = "A", B = "B", C = "C" }
[measured]
strain = "strain.csv"
noise_microstrain = 1.0
hold_out = ["R10", "R11", "R12", "R13"]
[runs]
file = "runs.csv"
units = { force = "kN" }
noise = { force = 0.02 }
[reconcile]
path = "static"
"#;
    InMemory::default()
        .with("job.toml", job)
        .with("s.csv", s)
        .with("strain.csv", strain)
        .with("runs.csv", runs)
}

#[test]
fn what_is_missing_comes_as_a_value_with_the_job_that_has_it() {
    let files = yard();
    let job = Job::read("job.toml", &files).unwrap();
    let mut found = reconcile(&job, &Context::new(&files)).unwrap();
    assert_eq!(found.verdict, Verdict::Named, "{:?}", found.best_attempt);
    assert_eq!(found.effects.len(), 1);
    let effect = &found.effects[0];
    assert_eq!(effect.place.as_deref(), Some("G05"), "{}", effect.id);
    // A turned sign has no parameter: -1 stands for it.
    assert_eq!(effect.size.as_ref().and_then(|s| s.size), Some(-1.0));
    let gap = &found.gap;
    // A twelfth of the readings has twice its size for a residual; what is left is scatter.
    assert!(gap.before > 0.1 && gap.after < 0.05, "{gap:?}");
    let strain = found.strain.as_ref().expect("strain was compared");
    assert!(found.motion.is_none() && found.causes.is_none());
    // The extended model turns the readings of that gauge and no others.
    let extended = found.extended_model.as_ref().expect("a model");
    let now = extended.readings.as_ref().expect("other readings");
    let turned = strain.frame.observations.values.iter().zip(now);
    for (k, (before, after)) in turned.enumerate() {
        let sign = if k % 12 == 4 { -1.0 } else { 1.0 };
        assert_eq!(sign * before, *after, "reading {k}");
    }
    let text = extended_job(&found, "out".as_ref()).unwrap().expect("text");
    assert!(text.contains("strain = \"strain_extended.csv\""), "{text}");
    assert!(text.contains("title = \"yard, with "), "{text}");
    // Its path is known once the folder is.
    assert_eq!(extended.path, extended.name);
    found.answer.put_into("out".as_ref());
    let json = serde_json::to_value(&found.answer).unwrap();
    assert_eq!(json["extended_model"], "out/job_extended.toml");
    assert_eq!(json["verdict"], "named");
    assert_eq!(json["effects"][0]["where"], "G05");
    assert!(json.get("simulation").is_none() && json.get("sits").is_some());
}

#[test]
fn causes_that_changed_together_come_as_rivals_of_the_same_type() {
    let job = r#"
units = "m-kg-s"
[measured]
strain = "strain.csv"
noise_microstrain = 3.0
[runs]
file = "runs.csv"
[reconcile]
path = "static"
causes = { settlement = "lowered", temperature = "air_C" }
"#;
    let files = InMemory::default()
        .with("job.toml", job)
        .with(
            "strain.csv",
            "run,a,b\nbefore,238.59,1.51\nafter,215.19,35.79\n",
        )
        .with("runs.csv", "run,lowered,air_C\nbefore,0,2.0\nafter,1,4.0\n");
    let job = Job::read("job.toml", &files).unwrap();
    let found = reconcile(&job, &Context::new(&files)).unwrap();
    assert_eq!(found.verdict, Verdict::Unknown);
    assert_eq!(found.rivals.len(), 2);
    assert!(found.strain.is_none() && found.motion.is_none());
    assert!(found.best_attempt.is_none() && found.extended_model.is_none());
}

#[test]
fn motion_without_a_vehicle_is_refused() {
    let files = InMemory::default().with(
        "job.toml",
        "units = \"m-kg-s\"\n[reconcile]\npath = \"dynamic\"\n",
    );
    let asked = Job::read("job.toml", &files)
        .and_then(|job| reconcile(&job, &Context::new(&files)).map(|_| ()));
    let faults = asked.unwrap_err();
    assert!(faults.iter().any(|f| f.to_string().contains("vehicle")));
}
