//! Uses the library as another program would: files in memory, no folder, no terminal.

use std::fmt::Write;
use std::sync::Arc;
use strainbridge::host::context::{Files, InMemory};
use strainbridge::host::store::Memory;
use strainbridge::reconcile::Verdict;
use strainbridge::report::command::{RecordFolder, Report, finish, save};
use strainbridge::workflow::place::Plan;
use strainbridge::workflow::reconcile::extended_job;
use strainbridge::workflow::recover::{Block, RecordHead, RecordSink, Samples, recover_into};
use strainbridge::{Context, Fault, Job, Severity, place, reconcile, recover, sensitivity};

/// Returns a free strip of plates along x, 11 by 2 grids 20 mm apart, 2 mm thick.
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
mesh_error = false
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
        .with_file("strip.bdf", strip())
        .with_file("job.toml", JOB)
}

#[test]
fn a_rule_that_leaves_no_place_is_named() {
    let candidates = "[candidates]\nclear_of = { loads = 1000.0 }\n";
    let files = files().with_file("clear.toml", format!("{JOB}{candidates}"));
    let job = Job::read("clear.toml", &files).unwrap();
    let faults = place(&job, &Context::new(&files)).err().unwrap();
    let printed = faults.to_string();
    assert!(
        printed.contains("`clear_of` loads = 1000 leaves 0 of"),
        "{printed}"
    );
    for (rules, named) in [
        (
            "boxes = [[[900, 901], [0, 1], [0, 1]]]\n",
            "`boxes` leaves 0 of 10",
        ),
        (
            "elements = [3, 4]\nexclude_elements = \"1 THRU 5\"\n",
            "`exclude_elements` leaves 0 of 2",
        ),
        (
            "exclude_properties = [1]\nelements = [2]\n",
            "`exclude_properties` leaves 0 of 1",
        ),
        // Fewer places than gauges: the message names the rule that excludes most places.
        (
            "elements = [2]\nsurfaces = [\"top\"]\nangle_step_deg = 180\n",
            "`elements` leaves 1 of 10",
        ),
    ] {
        let files = files
            .clone()
            .with_file("rule.toml", format!("{JOB}[candidates]\n{rules}"));
        let job = Job::read("rule.toml", &files).unwrap();
        let faults = place(&job, &Context::new(&files)).err().unwrap();
        let printed = faults.to_string();
        let rule = named.split(" leaves").next().unwrap();
        assert!(printed.contains(named), "{printed}");
        assert!(
            printed.contains(&format!("widen or delete {rule}")),
            "{printed}"
        );
    }
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
    // The efficiency bound is a share. A layout that is proved to be the best reaches the upper bound.
    assert!(plan.efficiency_bound > 0.0 && plan.efficiency_bound <= 1.0 + 1e-12);
    assert!(plan.log_det <= plan.upper_bound + 1e-9);
    assert!(plan.findings.worst_severity() < Some(Severity::Error));
    // In a second call, the stored solution gives the same layout.
    let again = place(&job, &context).unwrap();
    assert_eq!(plan.gauges, again.gauges);
    assert!(again.notes.iter().any(|n| n.contains("stored")));
}

/// The planned covariance equals the covariance recovered from readings without error.
#[test]
fn the_planned_sigma_is_the_recovered_one_at_the_expected_loads() {
    let errors = "noise_microstrain = 1.0\nmodel_uncertainty_rel = 0.02\n";
    let loads: Vec<&str> = JOB
        .lines()
        .filter_map(|l| l.strip_prefix("name = "))
        .collect();
    let combination = |name: &str, factor: f64| {
        let [a, b] = [loads[0], loads[1]];
        format!("[[combination]]\nname = \"{name}\"\nterms = {{ {a} = 1, {b} = {factor} }}\n")
    };
    let sums = combination("sum", 1.0) + &combination("difference", -1.0);
    let plan = files().with_file(
        "plan.toml",
        format!("{JOB}spacing = 15.0\nangle_tolerance_deg = 2.0\n{errors}{sums}"),
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
    job += &format!("[measured]\nstrain = \"strain.csv\"\n{errors}{sums}");
    let files = files()
        .with_file("recover.toml", job)
        .with_file("strain.csv", format!("{head}\n{row}\n"));
    let job = Job::read("recover.toml", &files).unwrap();
    let answer = recover(&job, &Context::new(&files)).unwrap();
    let got = answer.runs().unwrap();
    assert_eq!(got.loads.len(), 4);
    assert_eq!(placed.load_sigma.len(), 4);
    let variance = |i: usize| placed.load_sigma[i].sigma.powi(2);
    let (both, each) = (variance(2) + variance(3), variance(0) + variance(1));
    // The variances of sum and difference add up to twice those of the terms.
    assert!((both - 2.0 * each).abs() < 1e-9 * each, "{both} {each}");
    let truths = [10.0, 10.0, 20.0, 0.0];
    for ((planned, got), truth) in placed.load_sigma.iter().zip(&got.loads).zip(truths) {
        let value = got.value;
        assert!((value - truth).abs() < 1e-6, "{value}");
        // Only the chi-square could differ. Readings without error do not widen the intervals.
        let ratio = got.sigma / planned.sigma;
        assert!((ratio - 1.0).abs() < 0.01, "{} {ratio}", planned.name);
        assert!(planned.sigma_as_glued.unwrap() > planned.sigma);
    }
}

/// Installed gauges at the chosen places have the sigmas of the chosen gauges, with and without tolerances.
#[test]
fn an_installed_layout_has_the_sigmas_of_the_same_chosen_one() {
    let all = "angle_tolerance_deg = 2.0\nposition_tolerance = 2.0\ngauge_factor_rel = 0.01\nmodel_uncertainty_rel = 0.05\n";
    for tolerances in [
        all,
        "angle_tolerance_deg = 2.0\n",
        "position_tolerance = 2.0\n",
        "gauge_factor_rel = 0.02\n",
    ] {
        let text = format!("{JOB}spacing = 15.0\nnoise_microstrain = 1.0\n{tolerances}");
        let plan = files().with_file("plan.toml", &*text);
        let job = Job::read("plan.toml", &plan).unwrap();
        let chosen = place(&job, &Context::new(&plan)).unwrap();
        let gauges = chosen.gauges.iter().map(|g| {
            let [x, y, z] = g.direction;
            format!(
                "[[gauge]]\nname = \"{}\"\nelement = {}\nsurface = \"{}\"\ndirection = [{x}, {y}, {z}]\n",
                g.name, g.element, g.surface
            )
        });
        let both = files().with_file("both.toml", text.clone() + &gauges.collect::<String>());
        let job = Job::read("both.toml", &both).unwrap();
        let again = place(&job, &Context::new(&both)).unwrap();
        let installed = again.installed.as_ref().unwrap().quality.as_ref().unwrap();
        assert_eq!(installed.load_sigma.len(), chosen.load_sigma.len());
        for (a, b) in installed.load_sigma.iter().zip(&chosen.load_sigma) {
            // Directions are written with all digits, and the least squares of the loads lose a few.
            let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-6;
            assert!(near(a.sigma, b.sigma), "{tolerances}: {a:?} {b:?}");
            let glued = [a, b].map(|l| l.sigma_as_glued.unwrap());
            assert!(near(glued[0], glued[1]), "{tolerances}: {a:?} {b:?}");
            assert!(glued[0] > a.sigma, "{tolerances}: {a:?}");
        }
    }
}

#[test]
fn faults_come_with_file_line_and_remedy() {
    let files = InMemory::default().with_file("job.toml", "units = \"furlong\"\n");
    let faults = Job::read("job.toml", &files).unwrap_err();
    let first = faults.first().unwrap();
    assert_eq!((first.file.as_str(), first.line), ("job.toml", Some(1)));
    assert!(!first.remedy.is_empty());
}

/// Returns twelve gauges under three loads in 14 runs. Readings have a repeating scatter below a microstrain, and gauge
/// `G05` has reversed polarity.
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
        .with_file("job.toml", job)
        .with_file("s.csv", s)
        .with_file("strain.csv", strain)
        .with_file("runs.csv", runs)
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
    // A reversed sign has no parameter. Its size is reported as -1.
    assert_eq!(effect.size.as_ref().and_then(|s| s.size), Some(-1.0));
    let gap = &found.gap;
    // The residual of a twelfth of the readings is twice their size. Only scatter remains afterwards.
    assert!(gap.before > 0.1 && gap.after < 0.05, "{gap:?}");
    assert!(found.strain.is_some() && found.motion.is_none() && found.causes.is_none());
    // The extended model corrects the channel of that gauge and no other.
    let extended = found.extended_model.as_ref().expect("a model");
    assert!(extended.readings.is_none());
    let [correction] = extended.corrections.as_slice() else {
        panic!("{:?}", extended.corrections)
    };
    assert_eq!(
        (correction.gauge.as_str(), correction.factor),
        ("G05", -1.0)
    );
    let text = extended_job(&found, "out".as_ref()).unwrap().expect("text");
    assert!(
        text.contains("[[correction]]") && text.contains("sign = -1"),
        "{text}"
    );
    assert!(text.contains("title = \"yard, with "), "{text}");
    // The path of the model is known as soon as the folder is known.
    assert_eq!(extended.path, extended.name);
    found.answer.put_into("out".as_ref());
    let json = serde_json::to_value(&found.answer).unwrap();
    assert_eq!(json["extended_model"], "out/job_extended.toml");
    assert_eq!(json["verdict"], "named");
    assert_eq!(json["effects"][0]["where"], "G05");
    assert!(json.get("simulation").is_none() && json.get("sits").is_some());
}

const CAUSES: &str = r#"
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

#[test]
fn causes_that_changed_together_come_as_alternatives_of_the_same_type() {
    let files = InMemory::default()
        .with_file("job.toml", CAUSES)
        .with_file(
            "strain.csv",
            "run,a,b\nbefore,238.59,1.51\nafter,215.19,35.79\n",
        )
        .with_file("runs.csv", "run,lowered,air_C\nbefore,0,2.0\nafter,1,4.0\n");
    let job = Job::read("job.toml", &files).unwrap();
    let found = reconcile(&job, &Context::new(&files)).unwrap();
    assert_eq!(found.verdict, Verdict::Unknown);
    assert_eq!(found.rivals.len(), 2);
    assert!(found.strain.is_none() && found.motion.is_none());
    assert!(found.best_attempt.is_none() && found.extended_model.is_none());
    // The runs file may contain the loads of a given S.
    let files = files
        .with_file("S.csv", "gauge,F1\na,1\nb,2\n")
        .with_file(
            "job.toml",
            CAUSES.replace("[runs]", "[sensitivity]\nfile = \"S.csv\"\n[runs]"),
        )
        .with_file(
            "runs.csv",
            "run,lowered,air_C,F1,driver\nbefore,0,2.0,1,7\nafter,1,4.0,1,7\n",
        );
    let job = Job::read("job.toml", &files).unwrap();
    let found = reconcile(&job, &Context::new(&files)).unwrap();
    let unread = found.findings.iter().find(|f| f.code == "column-not-read");
    assert!(unread.unwrap().message.ends_with(": `driver`."));
}

#[test]
fn motion_without_a_vehicle_is_refused() {
    let files = InMemory::default().with_file(
        "job.toml",
        "units = \"m-kg-s\"\n[reconcile]\npath = \"dynamic\"\n",
    );
    let asked = Job::read("job.toml", &files)
        .and_then(|job| reconcile(&job, &Context::new(&files)).map(|_| ()));
    let faults = asked.unwrap_err();
    assert!(faults.iter().any(|f| f.to_string().contains("vehicle")));
}

/// Given S with two loads and three gauges, microstrain per N.
const GIVEN: [[f64; 2]; 3] = [[1.0, 0.2], [-0.3, 1.1], [0.8, -0.5]];

const RECOVER: &str = r#"
units = "m-kg-s"
report_units = { force = "kN" }
[sensitivity]
file = "S.csv"
per = { force = "N" }
[[load]]
name = "A"
[[load]]
name = "B"
[[combination]]
name = "both"
terms = { A = 1, B = 1 }
[measured]
strain = "strain.csv"
noise_microstrain = 0.01
"#;

/// Returns the loads of row `i`, N.
fn loads(i: usize) -> [f64; 2] {
    let t = i as f64 * 0.1;
    [100.0 * t.sin(), 50.0 * (0.7 * t).cos()]
}

/// Returns a job and its strain without noise: `rows` runs (`key` is `run`), or samples at 10 Hz (`time`). The `blank`
/// rows lack gauge 2.
fn measured_job(key: &str, rows: usize, blank: std::ops::Range<usize>) -> InMemory {
    let mut table = format!("{key},G1,G2,G3\n");
    for i in 0..rows {
        let [a, b] = loads(i);
        let _ = match key {
            "time" => write!(table, "{}", i as f64 * 0.1),
            _ => write!(table, "R{i}"),
        };
        for (g, row) in GIVEN.iter().enumerate() {
            let _ = match g == 1 && blank.contains(&i) {
                true => write!(table, ","),
                false => write!(table, ",{}", row[0] * a + row[1] * b),
            };
        }
        table.push('\n');
    }
    let mut s = "gauge,A,B\n".to_owned();
    for (g, row) in GIVEN.iter().enumerate() {
        let _ = writeln!(s, "G{},{},{}", g + 1, row[0], row[1]);
    }
    InMemory::default()
        .with_file("S.csv", s)
        .with_file("strain.csv", table)
        .with_file("job.toml", RECOVER)
}

/// Returns the keys of the answer in `result.json`.
fn keys<A: serde::Serialize>(answer: &A) -> Vec<String> {
    let json = serde_json::to_value(answer).unwrap();
    json.as_object().unwrap().keys().cloned().collect()
}

#[test]
fn loads_of_runs_come_as_values_with_intervals_around_the_truth() {
    let files = measured_job("run", 5, 0..0);
    let job = Job::read("job.toml", &files).unwrap();
    let answer = recover(&job, &Context::new(&files)).unwrap();
    let runs = answer.runs().unwrap();
    assert!(answer.record().is_none());
    assert_eq!(runs.loads.len(), 5 * 3);
    for (i, of_run) in runs.loads.chunks(3).enumerate() {
        let [a, b] = loads(i);
        for (load, truth) in of_run.iter().zip([a, b, a + b].map(|v| v * 1e-3)) {
            assert_eq!(
                (load.run.as_str(), load.unit.as_str()),
                (&*format!("R{i}"), "kN")
            );
            assert!(
                (load.value - truth).abs() < 1e-9 && load.low < truth && truth < load.high,
                "{load:?} {truth}"
            );
        }
    }
    assert_eq!(
        keys(&answer.answer),
        [
            "condition_number",
            "condition_number_scaled",
            "gauges",
            "loads",
            "rank",
            "residual_rms_microstrain",
            "runs"
        ]
    );
}

#[test]
fn loads_of_a_record_stay_in_memory_sample_by_sample() {
    let files = measured_job("time", 500, 100..120);
    let job = Job::read("job.toml", &files).unwrap();
    let answer = recover(&job, &Context::new(&files)).unwrap();
    let record = answer.record().unwrap();
    assert_eq!((record.samples, record.gaps), (500, 20));
    assert!((record.sample_rate_hz.unwrap() - 10.0).abs() < 1e-6);
    let history = record.history.as_ref().unwrap();
    let mut widths = Vec::new();
    for (i, row) in history.rows().enumerate() {
        assert!((row.time - i as f64 * 0.1).abs() < 1e-9);
        let [a, b] = loads(i);
        assert_eq!(row.loads.len(), 3);
        for (load, truth) in row.loads.iter().zip([a, b, a + b]) {
            let [value, low, high] = load.unwrap();
            assert!((value - truth * 1e-3).abs() < 1e-9 && low < value && value < high);
        }
        let [_, low, high] = row.loads[0].unwrap();
        widths.push(high - low);
    }
    assert_eq!(widths.len(), 500);
    assert!(
        widths[110] > 1.01 * widths[99],
        "with a gauge less the interval is wider"
    );
    // The samples do not depend on the requested part.
    let (mut all, mut parts) = (Vec::new(), Vec::new());
    history.read(0, 500, &[0, 1, 2], &mut all);
    for from in (0..500).step_by(77) {
        history.read(from, (from + 77).min(500), &[0, 1, 2], &mut parts);
    }
    assert_eq!((history.n_samples(), all.len()), (500, 1500));
    assert_eq!(all, parts);
    let damage = record.damage.as_ref().unwrap();
    let range = all.iter().step_by(3).fold(0.0_f64, |m, v| m.max(v.abs()));
    assert!(damage[0].largest_range <= 2.0 * range + 1e-12 && damage[0].cycles > 5.0);
    assert_eq!(
        keys(&answer.answer),
        [
            "condition_number",
            "condition_number_scaled",
            "csv_every",
            "damage",
            "duration_s",
            "gaps",
            "gauges",
            "loads",
            "rank",
            "residual_rms_microstrain",
            "sample_rate_hz",
            "samples"
        ]
    );
}

/// A gauge without a zero reading has an unknown offset, so its readings are not used as strain.
#[test]
fn a_gauge_that_the_zero_file_lacks_has_no_part_in_the_loads() {
    let mut strain = "run,G1,G2,G3\n".to_owned();
    for i in 0..5 {
        let [a, b] = loads(i);
        let told = GIVEN.map(|row| row[0] * a + row[1] * b);
        let _ = writeln!(strain, "R{i},{},{},{}", told[0], told[1], told[2] + 100.0);
    }
    let job = RECOVER.replace("[measured]\n", "[measured]\nzero = \"zero.csv\"\n");
    let files = measured_job("run", 5, 0..0)
        .with_file("strain.csv", strain)
        .with_file("zero.csv", "run,G1,G2\nparked,0,0\n")
        .with_file("job.toml", job);
    let job = Job::read("job.toml", &files).unwrap();
    let answer = recover(&job, &Context::new(&files)).unwrap();
    assert_eq!(answer.runs().unwrap().loads.len(), 5 * 3);
    for (i, of_run) in answer.runs().unwrap().loads.chunks(3).enumerate() {
        let [a, b] = loads(i).map(|v| v * 1e-3);
        for (load, truth) in of_run.iter().zip([a, b]) {
            // Two gauges and two loads without noise are exact except for rounding.
            assert!((load.value - truth).abs() < 1e-9, "{load:?} {truth}");
        }
    }
    assert!(
        answer
            .findings
            .iter()
            .any(|f| f.code == "gauge-without-strain")
    );
}

/// Counts samples, and stops after a number of them.
#[derive(Default)]
struct Counter {
    samples: usize,
    most: Option<usize>,
    ended: Option<u64>,
}

impl RecordSink for Counter {
    fn begin(&mut self, head: &Arc<RecordHead>) -> Result<(), Fault> {
        assert_eq!(head.names, ["A", "B", "both"]);
        Ok(())
    }

    fn take(&mut self, blocks: Vec<Block>) -> Result<(), Fault> {
        for block in blocks {
            assert_eq!(block.first, self.samples);
            self.samples += block.times.len();
        }
        match self.most.is_some_and(|most| self.samples > most) {
            true => Err(Fault::new("counter", "samples", "too many", "none")),
            false => Ok(()),
        }
    }

    fn end(&mut self, samples: u64) -> Result<(), Fault> {
        self.ended = Some(samples);
        Ok(())
    }

    fn samples(&self) -> Result<Box<dyn Samples + '_>, Fault> {
        panic!("the job asks for no file that has to read all samples again")
    }
}

#[test]
fn a_sink_of_somebody_else_gets_every_sample_once_and_may_refuse() {
    let job = RECOVER.to_owned() + "[recover]\nfiles = []\n";
    let files = measured_job("time", 20_000, 0..0).with_file("job.toml", job);
    let job = Job::read("job.toml", &files).unwrap();
    let mut sink = Counter::default();
    let answer = recover_into(&job, &Context::new(&files), &mut sink).unwrap();
    assert_eq!((sink.samples, sink.ended), (20_000, Some(20_000)));
    assert!(answer.record().unwrap().history.is_none());
    let mut sink = Counter {
        most: Some(10),
        ..Counter::default()
    };
    let faults = recover_into(&job, &Context::new(&files), &mut sink)
        .err()
        .unwrap();
    assert_eq!(faults.first().unwrap().wrong, "too many");
    assert_eq!(sink.ended, None);
    // Runs are not a record.
    let files = measured_job("run", 5, 0..0);
    let job = Job::read("job.toml", &files).unwrap();
    let mut sink = Counter::default();
    recover_into(&job, &Context::new(&files), &mut sink).unwrap();
    assert_eq!((sink.samples, sink.ended), (0, None));
}

#[test]
fn a_record_kept_in_memory_and_one_written_as_it_comes_give_the_same_files() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("library_record");
    let _ = std::fs::remove_dir_all(&folder);
    let (kept, streamed) = (folder.join("kept"), folder.join("streamed"));
    let files = measured_job("time", 30_000, 17_000..17_010);
    let job = Job::read("job.toml", &files).unwrap();
    let context = Context::new(&files);
    save(&recover(&job, &context).unwrap(), &kept).unwrap();
    let mut sink = RecordFolder::new(&streamed);
    let outcome = recover_into(&job, &context, &mut sink).unwrap();
    assert!(!streamed.join("loads.csv").exists(), "files appear whole");
    let mut out = sink.into_output().unwrap();
    outcome.write(&mut out).unwrap();
    finish(&outcome, out).unwrap();
    let names = |folder| -> Vec<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        let mut names: Vec<String> = entries
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    };
    assert_eq!(names(&kept), names(&streamed));
    for name in ["loads.csv", "loads.bin", "loads.rsp", "rainflow.csv"] {
        let [one, two] = [&kept, &streamed].map(|f| std::fs::read(f.join(name)).unwrap());
        assert!(one == two, "{name}");
    }
    let result = |folder: &std::path::Path| -> serde_json::Value {
        let mut json: serde_json::Value =
            serde_json::from_slice(&std::fs::read(folder.join("result.json")).unwrap()).unwrap();
        json.as_object_mut().unwrap().remove("seconds");
        json
    };
    assert_eq!(result(&kept), result(&streamed));
}

/// Rows of `turning_points.csv` are the samples of `loads.csv` in which the difference of some load changes its sign.
#[test]
fn turning_points_of_a_record_keep_the_phase_of_its_loads() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("library_turning_points");
    let _ = std::fs::remove_dir_all(&folder);
    let with = |key: &str, share: &str| {
        let files = measured_job(key, 3000, 0..0);
        let path = std::path::Path::new("job.toml");
        let text = strainbridge::host::context::Files::load(&files, path).unwrap();
        let text = String::from_utf8(text.to_vec()).unwrap();
        files.with_file(
            "job.toml",
            format!("{text}[recover]\nturning_points = {share}\n"),
        )
    };
    let table = |share: &str, name: &str| -> Vec<Vec<f64>> {
        let files = with("time", share);
        let job = Job::read("job.toml", &files).unwrap();
        let out = folder.join(share);
        if !out.exists() {
            save(&recover(&job, &Context::new(&files)).unwrap(), &out).unwrap();
        }
        let text = std::fs::read_to_string(out.join(name)).unwrap();
        let row = |l: &str| l.split(',').map(|v| v.parse().unwrap()).collect();
        text.lines().skip(1).map(row).collect()
    };
    // Columns of loads.csv are time, then value, low and high of each load.
    let loads: Vec<Vec<f64>> = table("0.0", "loads.csv")
        .iter()
        .map(|r| {
            [
                &r[..1],
                &r[1..].iter().step_by(3).copied().collect::<Vec<f64>>(),
            ]
            .concat()
        })
        .collect();
    let turns = |i: usize| {
        let step = |a: usize, b: usize, l: usize| loads[b][l] - loads[a][l];
        (1..loads[0].len()).any(|l| step(i - 1, i, l) * step(i, i + 1, l) < 0.0)
    };
    let last = loads.len() - 1;
    let expected: Vec<usize> = (0..=last)
        .filter(|i| [0, last].contains(i) || turns(*i))
        .collect();
    let found = table("0.0", "turning_points.csv");
    assert_eq!(found.len(), expected.len());
    for (row, at) in found.iter().zip(&expected) {
        for (v, e) in row.iter().zip(&loads[*at]) {
            // loads.bin has single precision.
            assert!(
                (v - e).abs() <= 1e-6 * e.abs().max(1e-3),
                "{at}: {row:?} {:?}",
                loads[*at]
            );
        }
    }
    // A gate leaves out no extreme of a load.
    let few = table("0.2", "turning_points.csv");
    assert!(few.len() <= found.len(), "{} {}", few.len(), found.len());
    for l in 1..loads[0].len() {
        let most = |list: &[Vec<f64>]| list.iter().map(|r| r[l]).fold(f64::MIN, f64::max);
        assert!((most(&few) - most(&loads)).abs() <= 1e-6 * most(&loads).abs());
    }
    // Runs have no turning points.
    let files = with("run", "0.0");
    let job = Job::read("job.toml", &files).unwrap();
    let said = recover(&job, &Context::new(&files))
        .map(|_| ())
        .unwrap_err();
    assert!(
        said.to_string().contains("recover.turning_points"),
        "{said}"
    );
}

#[test]
fn wanted_elements_and_picked_lists_are_kept() {
    let picked =
        "[candidates]\nelements = \"1 THRU 8\"\nexclude_elements = [3]\nwanted_elements = [7, 8]\n";
    let job = |more: &str| format!("{JOB}spacing = 15.0\n[candidates]\n{more}");
    let files = files()
        .with_file("picked.toml", picked)
        .with_file("wanted.toml", job("file = \"picked.toml\"\n"))
        .with_file("plain.toml", job("elements = \"1 THRU 8\"\n"))
        .with_file(
            "twice.toml",
            job("file = \"picked.toml\"\nelements = [1]\n"),
        )
        .with_file("odd.toml", job("file = \"odd_list.toml\"\n"))
        .with_file(
            "odd_list.toml",
            "units = \"m-kg-s\"\n[candidates]\nsurfaces = [\"top\"]\n",
        )
        .with_file("none.toml", job("wanted_elements = [99]\n"));
    let plan = |name: &str| {
        let job = Job::read(name, &files).unwrap();
        place(&job, &Context::new(&files))
    };
    let wanted = plan("wanted.toml").unwrap();
    let on: Vec<u32> = wanted.gauges.iter().map(|g| g.element).collect();
    assert_eq!(on.len(), 4);
    assert!(on.contains(&7) && on.contains(&8), "{on:?}");
    assert!(on.iter().all(|e| *e <= 8 && *e != 3), "{on:?}");
    // A requested element cannot improve the layout, and the efficiency bound shows it.
    let free = plan("plain.toml").unwrap();
    assert!(wanted.log_det <= free.upper_bound + 1e-9);
    assert!(wanted.efficiency_bound <= 1.0 + 1e-12);
    let faults = Job::read("twice.toml", &files).unwrap_err().to_string();
    assert!(
        faults.contains("picked.toml:1: candidates.elements: `elements` is in the job too"),
        "{faults}"
    );
    let faults = Job::read("odd.toml", &files).unwrap_err().to_string();
    assert!(
        faults.contains("candidates.surfaces") && faults.contains("units"),
        "{faults}"
    );
    let Err(faults) = plan("none.toml") else {
        panic!("element 99 is not in the deck");
    };
    assert!(faults.to_string().contains("element 99 is not a candidate"));
}

/// A plan keeps S of the candidates: a narrower choice after a wide one has the bits of a layout that is made alone.
#[test]
fn a_plan_gives_the_layouts_of_the_command_and_new_gauges_take_no_name_that_stays() {
    let job = format!("{JOB}spacing = 15.0\nposition_tolerance = 1.0\n[candidates]\n");
    let picked = |gauges: u32, lists: &str| {
        format!("[candidates]\n{lists}\n[placement]\ngauges = {gauges}\nkeep = [\"P02\"]\n")
    };
    let table = "name,element,surface,dir_x,dir_y,dir_z\nP02,5,top,1,0,0\n";
    let narrow = picked(3, "elements = \"1 THRU 4, 7 THRU 10\"");
    let gauges = "file = \"picked.toml\"\n[gauges]\nfile = \"gauges.csv\"\n";
    let files = files()
        .with_file("wide.toml", job.clone())
        .with_file("narrow.toml", format!("{job}{gauges}"))
        .with_file("picked.toml", narrow.clone())
        .with_file("gauges.csv", table)
        .with_file("stray.toml", format!("{job}file = \"stray_list.toml\"\n"))
        .with_file("stray_list.toml", "[placement]\nspacing = 3.0\n");
    let cx = Context::new(&files);
    let wide = Job::read("wide.toml", &files).unwrap();
    let mut plan = Plan::read(&wide, &cx).unwrap();
    assert_eq!(plan.place(&wide, &cx).unwrap().gauges.len(), 4);
    let by_texts = wide.with_plan_files(&narrow, Some(table)).unwrap();
    let by_plan = plan.place(&by_texts, &cx).unwrap();
    let alone = place(&Job::read("narrow.toml", &files).unwrap(), &cx).unwrap();
    assert_eq!(by_plan.gauges, alone.gauges);
    assert_eq!(by_plan.log_det.to_bits(), alone.log_det.to_bits());
    let names: Vec<&str> = alone.gauges.iter().map(|g| &*g.name).collect();
    assert_eq!(names, ["P01", "P03", "P04"]);

    // The plan has the strain of its own loads.
    let mut other = wide.clone();
    other.loads.reverse();
    let said = plan.place(&other, &cx).map(|_| ()).unwrap_err();
    assert!(
        said.to_string().contains("loads of the job differ"),
        "{said}"
    );

    // Two texts of a layout describe it as it was placed.
    let all: Vec<_> = alone.gauges.iter().map(|g| g.to_job_gauge(0.0)).collect();
    let free = wide.with_plan_files("", None).unwrap();
    let described = plan.evaluate(&free, &all, &alone, &cx).unwrap();
    assert!(
        described
            .gauges
            .iter()
            .zip(&alone.gauges)
            .all(|(a, b)| a.element == b.element)
    );
    let faults = Job::read("stray.toml", &files).unwrap_err().to_string();
    assert!(faults.contains("placement.spacing"), "{faults}");
    assert!(
        wide.with_plan_files("[candidates]\ncolour = 1\n", None)
            .is_err()
    );
    assert!(
        wide.with_plan_files("", Some("name,element\nA,1\nA,2\n"))
            .is_err()
    );
}

/// A gauge with the nominal angle 30 degrees and a correction by 60 reads the same as one with the nominal angle 90.
#[test]
fn a_gauge_that_is_known_to_be_turned_is_turned_in_modes_too() {
    let gauge = |angle: u32| {
        format!(
            "[[gauge]]\nname = \"G\"\nelement = 5\nsurface = \"top\"\ndirection = [1, 0, 0]\nangle_deg = {angle}\n"
        )
    };
    let head = JOB.split("[placement]").next().unwrap();
    let correction = "[[correction]]\ngauge = \"G\"\nangle_deg = 60\n";
    let files = files()
        .with_file("drawn.toml", format!("{head}{}", gauge(90)))
        .with_file("turned.toml", format!("{head}{}{correction}", gauge(30)));
    let strain = |name: &str| -> Vec<f64> {
        let job = Job::read(name, &files).unwrap();
        let modes = strainbridge::modes(&job, 4, &Context::new(&files)).unwrap();
        modes
            .modes
            .iter()
            .map(|m| m.gauge_microstrain[0].unwrap())
            .collect()
    };
    let (drawn, turned) = (strain("drawn.toml"), strain("turned.toml"));
    let size = drawn.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
    assert!(size > 0.0);
    assert_eq!(drawn.len(), turned.len());
    for (a, b) in drawn.iter().zip(&turned) {
        assert!((a - b).abs() < 1e-9 * size, "{a} {b}");
    }
}

/// A moment without a moment name is a moment for `reconcile` too. S equals that of `sensitivity` to the last digits.
#[test]
fn reconcile_has_the_s_that_every_command_has() {
    let files = yard();
    let bytes = files.load("job.toml".as_ref()).unwrap();
    let mut text = String::from_utf8_lossy(&bytes).into_owned();
    text = text.replace(
        "[measured]",
        "[[load]]\nname = \"A\"\ngrid = 0\ncomponent = \"MX\"\n[[load]]\nname = \"C\"\n[[load]]\nname = \"B\"\n[measured]",
    );
    text = text.replace(
        "per = { force = \"kN\" }",
        "per = { force = \"kN\", moment = \"N mm\" }",
    );
    text = text.replace(
        "units = { force = \"kN\" }",
        "units = { force = \"kN\", moment = \"N mm\" }",
    );
    let files = files.with_file("job.toml", text);
    let job = Job::read("job.toml", &files).unwrap();
    let context = Context::new(&files);
    let s = sensitivity(&job, &context)
        .unwrap()
        .answer
        .prepared
        .sensitivity;
    let found = reconcile(&job, &context).unwrap().answer;
    let frame = found.strain.unwrap().frame;
    let n_c = frame.n_columns();
    for (g, gauge) in s.gauges.iter().enumerate() {
        let row = frame.gauges.iter().position(|f| f.name == *gauge).unwrap();
        for (l, load) in s.loads.iter().enumerate() {
            let column = frame
                .load_names
                .iter()
                .position(|n| *n == load.name)
                .unwrap();
            // Microstrain per kilonewton (or kN m), compared with strain per newton.
            let asked = frame.influence[row * n_c + column] * 1e-6 / 1e3;
            let had = s.values[(g, l)];
            assert!(
                (asked - had).abs() <= 1e-14 * had.abs(),
                "{gauge} {}",
                load.name
            );
        }
    }
    // The runs file gives the moment in N mm, a millionth of a kN m.
    let a = frame.load_names.iter().position(|n| n == "A").unwrap();
    let stated = 3.0 + 2.5 * (2.1_f64).cos();
    assert!((frame.loads[a] - 1e-6 * stated).abs() < 1e-12);
}

#[test]
fn a_folder_is_verified_by_whoever_can_answer_again() {
    let folder = std::env::temp_dir().join(format!("strainbridge-again-{}", std::process::id()));
    let (kept, anew) = (folder.join("place"), folder.join("anew"));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("job.toml"), JOB).unwrap();
    let deck = folder.join("strip.bdf");
    std::fs::write(&deck, strip()).unwrap();
    let disk = strainbridge::Disk;
    let context = Context::new(&disk);
    let answer = |main: &std::path::Path, out: &std::path::Path| {
        let job = Job::read(main, &disk).unwrap();
        save(&place(&job, &context).unwrap(), out).unwrap();
    };
    answer(&folder.join("job.toml"), &kept);
    let ask = || {
        let again = |made: &strainbridge::workflow::verify::ResultProvenance,
                     main: &std::path::Path| {
            assert_eq!(made.command, "place");
            answer(main, &anew);
            Ok(anew.clone())
        };
        strainbridge::verify(&kept, again, &context).unwrap()
    };
    let same = ask();
    assert!(same.differs.is_empty(), "{:?}", same.differs);
    assert!(same.same.len() > 2 && same.findings.worst_severity().is_none());
    // Twice the stiffness is a different input and gives half the strain.
    std::fs::write(&deck, strip().replace("210000.", "420000.")).unwrap();
    let other = ask();
    let files: Vec<&str> = other.differs.iter().map(|d| d.file.as_str()).collect();
    assert!(files.iter().any(|f| f.ends_with("strip.bdf")), "{files:?}");
    assert!(files.contains(&"result.json"), "{files:?}");
    assert_eq!(other.findings.worst_severity(), Some(Severity::Error));
    std::fs::remove_file(folder.join("job.toml")).unwrap();
    let none = |_: &strainbridge::workflow::verify::ResultProvenance, _: &std::path::Path| {
        Ok(anew.clone())
    };
    let fault = strainbridge::verify(&kept, none, &context).unwrap_err();
    assert!(fault.to_string().contains("is not found"), "{fault}");
    std::fs::remove_dir_all(folder).unwrap();
}

/// Stops the work at the beginning of the solution.
struct StopsAtSolve(strainbridge::stop::Stop);

impl strainbridge::host::context::Progress for StopsAtSolve {
    fn begin(&self, stage: &str) {
        if stage == "solve" {
            self.0.ask();
        }
    }

    fn stop(&self) -> strainbridge::stop::Stop {
        self.0.clone()
    }
}

#[test]
fn work_that_is_stopped_while_it_solves_reports_it_and_blames_no_deck() {
    let files = files();
    let job = Job::read("job.toml", &files).unwrap();
    let stops = StopsAtSolve(strainbridge::stop::Stop::new());
    let context = Context::new(&files).progress(&stops);
    let faults = sensitivity(&job, &context).err().unwrap();
    let first = faults.first().unwrap();
    assert_eq!(
        (first.file.as_str(), first.wrong.as_str()),
        ("work", "stopped")
    );
}
