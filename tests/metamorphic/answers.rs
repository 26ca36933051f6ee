//! Numbers in the answers of every command, converted to the base model: tags for ids, and sides, frame and load
//! directions of the base model.

use crate::cards::{Form, deck};
use crate::frame::{Frame, V};
use crate::job::{
    channels, counterpart, job, payload_job, payload_runs, readings, runs_csv, strain_csv,
};
use std::collections::BTreeMap;
use std::path::Path;
use strainbridge::fe::{CaseResult, SolveOptions};
use strainbridge::host::context::InMemory;
use strainbridge::host::store::Memory;
use strainbridge::workflow::solve::SolvedCases;
use strainbridge::{Context, Faults, Job, Outcome, Severity};

/// Numbers by group and item. The numbers of a group have one scale, the largest of them.
#[derive(Default)]
pub struct Answers(pub BTreeMap<String, BTreeMap<String, f64>>);

impl Answers {
    fn insert_value(&mut self, group: impl Into<String>, item: impl Into<String>, value: f64) {
        let of_group = self.0.entry(group.into()).or_default();
        let item = item.into();
        let before = of_group.insert(item.clone(), value);
        assert!(before.is_none(), "two numbers are called {item}");
    }

    /// Returns the answer of a command, and adds the codes of its errors to the numbers.
    fn hear<A>(&mut self, command: &str, answer: Result<Outcome<A>, Faults>) -> Outcome<A> {
        let answer = expect_answer(command, answer);
        let of_command = self.0.entry(format!("{command}: errors")).or_default();
        for f in answer
            .findings
            .iter()
            .filter(|f| f.severity == Severity::Error)
        {
            of_command.insert(f.code.to_string(), 1.0);
        }
        answer
    }

    fn put_vector(&mut self, group: &str, item: &str, v: V) {
        for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
            self.insert_value(group, format!("{item} {axis}"), v[k]);
        }
    }
}

/// Readings by channel of the base model, equal in every model.
#[derive(Clone, Default)]
pub struct Measured {
    readings: Vec<Vec<f64>>,
    payload_readings: Vec<Vec<f64>>,
    wheel_forces: Vec<[f64; 3]>,
}

impl Measured {
    /// Computes the readings from S of the base model.
    pub fn from_base(base: &Frame, form: Form) -> Self {
        let files = deck(&base.control(), base.cards(), form)
            .with_file("job.toml", job(base, ""))
            .with_file("strain.csv", "run\n");
        let cx = Context::new(&files);
        let job = read(&files, "job.toml");
        let sensed = expect_answer("sensitivity", strainbridge::sensitivity(&job, &cx));
        let values = &sensed.prepared.sensitivity.values;
        let s: Vec<Vec<f64>> = values
            .row_iter()
            .map(|r| r.iter().copied().collect())
            .collect();
        let readings = readings(base, &s);
        let has_wheels = base.loads.iter().any(|l| l.name == "W1.FZ");
        let (payload_readings, wheel_forces) = if has_wheels {
            payload_runs(base, &s)
        } else {
            Default::default()
        };
        Self {
            readings,
            payload_readings,
            wheel_forces,
        }
    }
}

/// Commands that a test runs on a model.
#[derive(Clone, Copy, PartialEq)]
pub enum Asked {
    /// All commands.
    All,
    /// All commands except `payload`, whose wheels are in the plane z = 0.
    WithoutPayload,
}

/// Source of the strain of the unit loads.
#[derive(Clone, Copy, PartialEq)]
pub enum Source {
    Solver,
    /// OP2 file with the solution of the solver.
    Results,
}

/// Returns the answers of all commands on a model.
pub fn answers(frame: &Frame, form: Form, measured: &Measured, ask: (Asked, Source)) -> Answers {
    let mut out = Answers::default();
    let mut files = deck(&frame.control(), frame.cards(), form)
        .with_file("strain.csv", strain_csv(frame, &measured.readings))
        .with_file(
            "payload_strain.csv",
            strain_csv(frame, &measured.payload_readings),
        )
        .with_file("runs.csv", runs_csv(frame, &measured.wheel_forces));
    put_deck(&mut out, frame, &solve_deck(&files));
    let mut results = "";
    if ask.1 == Source::Results {
        files = crate::given::with_results(files.with_file("unit.toml", job(frame, "")));
        results = "results = [\"unit.op2\"]\n";
    }
    let mut files = files.with_file("job.toml", job(frame, results));
    let pays = ask.0 == Asked::All && !measured.wheel_forces.is_empty();
    if pays {
        files = files.with_file("payload.toml", payload_job(frame, ""));
    }
    let kept = Memory::default();
    let cx = Context::new(&files).store(&kept);
    let job = read(&files, "job.toml");
    put_sensitivity(&mut out, frame, &job, &cx);
    put_layout(&mut out, frame, &job, &cx);
    put_loads(&mut out, frame, measured, &job, &cx);
    put_stress(&mut out, frame, &job, &cx);
    put_study(&mut out, frame, &job, &cx);
    if pays {
        put_payload(&mut out, frame, &read(&files, "payload.toml"), &cx);
    }
    out
}

pub fn read(files: &InMemory, name: &str) -> Job {
    Job::read(name, files).unwrap_or_else(|e| panic!("{e}"))
}

pub fn expect_answer<A>(command: &str, answer: Result<Outcome<A>, Faults>) -> Outcome<A> {
    answer.unwrap_or_else(|e| panic!("{command}: {e}"))
}

fn solve_deck(files: &InMemory) -> Outcome<SolvedCases> {
    let options = SolveOptions::default();
    let solved = strainbridge::solve_deck(Path::new("frame.bdf"), options, &Context::new(files));
    expect_answer("solve", solved)
}

/// Returns the side of the shell in the base model.
fn base_side(frame: &Frame, tag: u32, top: bool) -> &'static str {
    if top != frame.sides_exchanged(tag) {
        "top"
    } else {
        "bottom"
    }
}

fn put_deck(out: &mut Answers, frame: &Frame, solved: &SolvedCases) {
    let u = frame.units;
    let back = frame.turn.transpose();
    let model = &solved.deck.model;
    for case in &solved.solution.cases {
        let n = case.subcase;
        for (g, d) in model.grids.iter().zip(&case.displacement) {
            let tag = frame.tag(g.id);
            let d = back * V::new(d[0], d[1], d[2]) / u.length;
            out.put_vector(
                &format!("solve: displacement, subcase {n}"),
                &tag.to_string(),
                d,
            );
        }
        put_strain(out, frame, model, case);
    }
    for r in &solved.reactions {
        for grid in &r.grids {
            let force = V::new(grid.force[0], grid.force[1], grid.force[2]) / u.force;
            let group = format!("solve: reactions, subcase {}", r.subcase);
            out.put_vector(&group, &frame.tag(grid.grid).to_string(), back * force);
        }
    }
    let mass = solved.mass.expect("a mass");
    out.insert_value("solve: mass", "kg", mass.mass / u.mass);
    out.put_vector("solve: centre", "mm", back * V::from(mass.cg) / u.length);
}

/// Adds principal strains of shells by side, and strain of bars by point.
fn put_strain(
    out: &mut Answers,
    frame: &Frame,
    model: &strainbridge::model::Model,
    case: &CaseResult,
) {
    let n = case.subcase;
    for (shell, sides) in case.shells.elements.iter().zip(&case.shells.centre) {
        let tag = frame.tag(model.shells[shell.us()].id);
        for (side, [x, y, xy]) in sides.iter().enumerate() {
            let (mean, radius) = ((x + y) / 2.0, ((x - y) / 2.0).hypot(xy / 2.0));
            let side = base_side(frame, tag, side == 1);
            let group = format!("solve: strain of shells, subcase {n}");
            out.insert_value(&group, format!("{tag} {side} largest"), mean + radius);
            out.insert_value(&group, format!("{tag} {side} least"), mean - radius);
        }
    }
    for (beam, stations) in case.beams.elements.iter().zip(&case.beams.stations) {
        let tag = frame.tag(model.beams[beam.us()].id);
        for (at, points) in stations {
            let group = format!("solve: strain of bars, subcase {n}");
            out.insert_value(&group, format!("{tag} {at} C"), points[0]);
            out.insert_value(&group, format!("{tag} {at} D"), points[1]);
        }
    }
}

/// Returns sign and unit of a load of the job. Its value in the base model is `sign * value / unit`.
fn load_of(frame: &Frame, name: &str) -> (f64, f64) {
    let load = frame.loads.iter().find(|l| l.name == name);
    let load = load.unwrap_or_else(|| panic!("load {name}"));
    (frame.component(load).1, frame.load_unit(load))
}

/// Returns the name of a channel in the base model.
fn base_channel(frame: &Frame, name: &str) -> String {
    // The exchange of leg names is its own inverse.
    counterpart(frame, name)
}

fn put_sensitivity(out: &mut Answers, frame: &Frame, job: &Job, cx: &Context) {
    let sensed = out.hear("sensitivity", strainbridge::sensitivity(job, cx));
    let s = &sensed.prepared.sensitivity;
    let named: Vec<String> = s.gauges.iter().map(|g| base_channel(frame, g)).collect();
    let mut sorted = (named.clone(), channels(frame));
    sorted.0.sort();
    sorted.1.sort();
    assert_eq!(sorted.0, sorted.1, "channels");
    for (l, load) in s.loads.iter().enumerate() {
        let (sign, unit) = load_of(frame, &load.name);
        for (g, gauge) in named.iter().enumerate() {
            let value = s.values[(g, l)] * sign * unit;
            out.insert_value(format!("sensitivity: {}", load.name), gauge, value);
        }
    }
    let condition = sensed.conditioning.condition_number_scaled;
    out.insert_value("sensitivity: condition", "", condition.expect("a rank"));
}

fn put_layout(out: &mut Answers, frame: &Frame, job: &Job, cx: &Context) {
    let placed = out.hear("place", strainbridge::place(job, cx));
    let back = frame.turn.transpose();
    for g in &placed.gauges {
        let tag = frame.tag(g.element);
        let side = base_side(frame, tag, g.surface == "top");
        let direction = back * V::from(g.direction);
        // The direction of an axis has no sign.
        let sign = direction[direction.iamax()].signum();
        out.put_vector("place: axes", &format!("{tag} {side}"), direction * sign);
        let strain = g.expected_microstrain;
        let signs: Vec<f64> = frame.loads.iter().map(|l| frame.component(l).1).collect();
        // The sum over the loads equals that of the base model only if no load has changed its sign.
        if signs.iter().all(|s| *s > 0.0) {
            out.insert_value("place: expected strain", format!("{tag} {side}"), strain);
        }
        out.insert_value("place: sd", format!("{tag} {side}"), g.sd_microstrain);
    }
    for s in &placed.load_sigma {
        out.insert_value(format!("place: sigma of {}", s.name), "", s.sigma);
    }
    let installed = placed.installed.as_ref().and_then(|i| i.quality.as_ref());
    for s in &installed.expect("installed gauges").load_sigma {
        out.insert_value(format!("place: installed sigma of {}", s.name), "", s.sigma);
    }
    out.insert_value("place: bound", "", placed.efficiency_bound);
}

fn put_loads(out: &mut Answers, frame: &Frame, measured: &Measured, job: &Job, cx: &Context) {
    let got = out.hear("recover", strainbridge::recover(job, cx));
    let runs = got.runs().expect("runs");
    for l in &runs.loads {
        let (sign, _) = load_of(frame, &l.name);
        let ends = if sign > 0.0 {
            [l.low, l.high]
        } else {
            [-l.high, -l.low]
        };
        let group = format!("recover: {}", l.name);
        for (word, value) in [
            ("", sign * l.value),
            ("sd", l.sigma),
            ("low", ends[0]),
            ("high", ends[1]),
        ] {
            out.insert_value(&group, format!("{} {word}", l.run), value);
        }
    }
    for g in &runs.gauges {
        let name = base_channel(frame, &g.name);
        out.insert_value("recover: residual", &name, g.residual_rms_microstrain);
        out.insert_value("recover: leverage", &name, g.leverage);
    }
    out.insert_value("recover: residual", "all", runs.residual_rms_microstrain);
    // Residuals are differences of readings, so their rounding error is relative to the readings.
    let readings = measured.readings.iter().flatten();
    let largest = readings.fold(0.0_f64, |m, v| m.max(v.abs()));
    out.insert_value("recover: residual", "largest reading", largest);
}

fn put_stress(out: &mut Answers, frame: &Frame, job: &Job, cx: &Context) {
    let got = out.hear("respond", strainbridge::respond(job, cx));
    for e in &got.elements {
        let tag = frame.tag(e.element);
        let surface = match e.surface.as_str() {
            "top" | "bottom" => base_side(frame, tag, e.surface == "top"),
            point => point,
        };
        let at = e.at.as_deref().unwrap_or_default();
        out.insert_value(
            "respond: stress",
            format!("{tag} {surface} in {at}"),
            e.max_von_mises,
        );
        out.insert_value("respond: sd", format!("{tag} {surface}"), e.sigma);
    }
}

fn put_study(out: &mut Answers, frame: &Frame, job: &Job, cx: &Context) {
    let got = out.hear("study", strainbridge::study(job, cx));
    for row in &got.study {
        for l in &row.loads {
            let (sign, _) = load_of(frame, &l.name);
            let group = format!("study: {}, {}", l.name, row.error);
            out.insert_value(&group, "bias", sign * l.bias.expect("a bias"));
            out.insert_value(&group, "sd", l.sigma.expect("a deviation"));
            let share = format!("study: coverage of {}, {}", l.name, row.error);
            out.insert_value(share, "", l.coverage.expect("a coverage"));
        }
    }
}

fn put_payload(out: &mut Answers, frame: &Frame, job: &Job, cx: &Context) {
    let got = out.hear("payload", strainbridge::payload(job, cx));
    let back = frame.turn.transpose();
    for p in &got.payload {
        assert_eq!(p.refused, None, "{}", p.run);
        let run = &p.run;
        for (what, value) in [
            ("force", p.force),
            ("low", p.force_low),
            ("high", p.force_high),
        ] {
            out.insert_value(
                "payload: force",
                format!("{run} {what}"),
                value.expect("a number"),
            );
        }
        out.insert_value(
            "payload: force",
            format!("{run} sd"),
            p.force_sigma.expect("a deviation"),
        );
        out.insert_value("payload: mass", run, p.mass.expect("a mass"));
        let [x, y] = p.position.map(|c| c.expect("a place"));
        out.put_vector("payload: place", run, back * V::new(x, y, 0.0));
    }
}
