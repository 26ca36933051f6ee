//! Report files and console output of `payload`.

use super::{Report, write_page};
use crate::estimate::NORMAL_95;
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::model::{Model, Vec3};
use crate::payload::{WeighedRun, Weighing};
use crate::report::console::{Console, ConsoleTable};
use crate::report::csv_cell;
use crate::report::figure::{Ends, IntervalRow, intervals};
use crate::report::page::{KeyNumber, Page, Paper, Section, figure_section, table_section};
use crate::report::scene::{Arrow, ArrowSet, Twist, scene_of_job, scene_section};
use crate::units::{MICROSTRAIN, factor, number, plus_minus};
use crate::workflow::payload::{WeighedPayload, WeighedPayloads};

/// Columns of payload.csv with their quantity.
const PAYLOAD: [(&str, &str); 10] = [
    ("run", ""),
    ("force", "force"),
    ("force.low", "force"),
    ("force.high", "force"),
    ("mass", "mass"),
    ("x", "length"),
    ("y", "length"),
    ("x.sigma", "length"),
    ("y.sigma", "length"),
    ("refused", ""),
];

/// Columns of by_gauge.csv with their quantity.
const BY_GAUGE: [(&str, &str); 6] = [
    ("run", ""),
    ("gauge", ""),
    ("net_microstrain", "microstrain"),
    ("estimate", "force"),
    ("sigma", "force"),
    ("used", ""),
];

impl Report for Outcome<WeighedPayloads> {
    const FILES: &'static [&'static str] =
        &["result.json", "report.html", "payload.csv", "by_gauge.csv"];

    fn write(&self, out: &mut Output) -> Result<(), Faults> {
        let units = &self.job.report_units;
        let unit = |quantity: &'static str| match quantity {
            "force" => units.force.name,
            "mass" => units.mass.name,
            "length" => units.length.name,
            other => other,
        };
        out.declare("payload.csv", PAYLOAD.map(|(c, q)| (c, unit(q))));
        out.write("payload.csv", |w| {
            writeln!(w, "{}", PAYLOAD.map(|c| c.0).join(","))?;
            for p in &self.payload {
                writeln!(w, "{}", line(p))?;
            }
            Ok(())
        })?;
        out.declare("by_gauge.csv", BY_GAUGE.map(|(c, q)| (c, unit(q))));
        out.write("by_gauge.csv", |w| {
            writeln!(w, "{}", BY_GAUGE.map(|c| c.0).join(","))?;
            for (r, run) in self.weighing.runs.iter().zip(&self.runs) {
                for (g, v) in self.weighing.gauges.iter().enumerate() {
                    let of = |list: &[f64], scale: f64| {
                        let value = list.get(g).filter(|v| v.is_finite());
                        value.map_or(String::new(), |v| (v * scale).to_string())
                    };
                    writeln!(
                        w,
                        "{},{},{},{},{},{}",
                        csv_cell(&r.run),
                        csv_cell(&v.name),
                        of(&run.strain, 1.0 / MICROSTRAIN),
                        of(&r.estimates, 1.0),
                        of(&r.estimate_sigma, 1.0),
                        v.used
                    )?;
                }
            }
            Ok(())
        })?;
        write_page(out, self)
    }

    fn page(&self) -> Option<Page> {
        Some(page(self).on_paper(Paper::Signed))
    }

    fn key_numbers(&self) -> Vec<KeyNumber> {
        let units = &self.job.report_units;
        let weighed = || self.payload.iter().filter(|p| p.refused.is_none());
        let heaviest =
            weighed().max_by(|a, b| value_or_nan(a.force).total_cmp(&value_or_nan(b.force)));
        let mut numbers = Vec::new();
        if let Some(p) = heaviest {
            let run = &p.run;
            let weight = format!("{} {}", p.weight(), units.force.name);
            numbers.push(KeyNumber::new(
                weight,
                format!("weight of the heaviest payload, run {run}"),
            ));
            let half = NORMAL_95 * value_or_nan(p.mass_sigma);
            let mass = format!(
                "{} {}",
                plus_minus(value_or_nan(p.mass), half),
                units.mass.name
            );
            numbers.push(KeyNumber::new(mass, format!("its mass, run {run}")));
        }
        let of = self.payload.len();
        numbers.push(KeyNumber::new(
            format!("{} of {of}", weighed().count()),
            "runs weighed",
        ));
        let gauges = &self.weighing.gauges;
        if !gauges.is_empty() {
            let used = gauges.iter().filter(|g| g.used).count();
            numbers.push(KeyNumber::new(
                format!("{used} of {}", gauges.len()),
                "gauges used",
            ));
        }
        numbers
    }

    fn console(&self) -> Console {
        let units = &self.job.report_units;
        let row = |p: &WeighedPayload| {
            let place = match &p.refused {
                Some(why) => format!("refused: {why}"),
                None => place_in_plan(p.position.map(value_or_nan)),
            };
            vec![
                p.run.clone(),
                p.weight(),
                p.mass.map_or("-".into(), number),
                place,
            ]
        };
        let head = [
            "run".to_owned(),
            format!("weight, {}", units.force.name),
            format!("mass, {}", units.mass.name),
            format!("place, {}", units.length.name),
        ];
        let table = ConsoleTable::new(
            "Payload (± half width of the 95 % interval)",
            &head.each_ref().map(String::as_str),
            self.payload.iter().map(row).collect(),
        );
        Console::new(table, Some("payload.csv")).next(format!(
            "if a payload was weighed too, state its mass in the runs file and run `strainbridge reconcile {}`",
            self.job.file
        ))
    }
}

/// The payload of each run as an arrow at its place, the heaviest run first; none where no run gives a place.
fn payload_arrows(found: &Outcome<WeighedPayloads>, model: &Model) -> Vec<ArrowSet> {
    let job = &found.job;
    let length = factor(job.units, job.report_units.length);
    let own = job.payload.as_ref().and_then(|p| p.grid);
    let grid = model.grids.iter().find(|g| Some(g.id) == own);
    let top = || model.grids.iter().map(|g| g.x.z).fold(f64::NAN, f64::max);
    let height = grid.map_or_else(top, |g| g.x.z);
    let arrow = |p: &WeighedPayload| {
        let [x, y] = p.position.map(value_or_nan);
        let value = value_or_nan(p.force);
        let known = x.is_finite() && y.is_finite() && value.is_finite();
        let place = place_in_plan([x, y]);
        known.then(|| Arrow {
            at: Vec3::new(x / length, y / length, height),
            along: Vec3::new(0.0, 0.0, -1.0),
            twist: Twist::Force,
            value,
            label: format!(
                "payload of run {}: {} {} at {place} {}",
                p.run,
                p.weight(),
                p.unit,
                job.report_units.length.name
            ),
        })
    };
    let weighed = found.payload.iter().filter(|p| p.refused.is_none());
    let arrows: Vec<(String, Arrow)> = weighed
        .filter_map(|p| Some((format!("payload of run {}", p.run), arrow(p)?)))
        .collect();
    let all = ArrowSet {
        name: "payload of every run".to_owned(),
        arrows: arrows.iter().map(|a| a.1.clone()).collect(),
    };
    let each = arrows.into_iter().map(|(name, arrow)| ArrowSet {
        name,
        arrows: vec![arrow],
    });
    let mut sets: Vec<ArrowSet> = each.collect();
    if !sets.is_empty() {
        sets.insert(0, all);
    }
    sets
}

/// Both coordinates to one decimal place, four digits of the larger.
fn place_in_plan(place: [f64; 2]) -> String {
    let size = place.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
    match size.is_finite() && size > 0.0 {
        true => {
            let digits = (3 - size.log10().floor() as i32).clamp(0, 6) as usize;
            // Adding 0 turns -0 into 0.
            let unit = 10f64.powi(digits as i32);
            let cell = |v: f64| format!("{:.digits$}", (v * unit).round() / unit + 0.0);
            place.map(cell).join(", ")
        }
        false => place.map(number).join(", "),
    }
}

fn value_or_nan(x: Option<f64>) -> f64 {
    x.unwrap_or(f64::NAN)
}

fn line(p: &WeighedPayload) -> String {
    // A known place has zero spread.
    let spread = p.position_sigma.unwrap_or([p.force.map(|_| 0.0); 2]);
    let numbers = [
        p.force,
        p.force_low,
        p.force_high,
        p.mass,
        p.position[0],
        p.position[1],
        spread[0],
        spread[1],
    ];
    let numbers = numbers.map(|n| n.map_or(String::new(), |v| v.to_string()));
    let refused = p
        .refused
        .as_deref()
        .map_or_else(String::new, |why| csv_cell(why).into_owned());
    format!("{},{},{refused}", csv_cell(&p.run), numbers.join(","))
}

fn page(found: &Outcome<WeighedPayloads>) -> Page {
    let units = &found.job.report_units;
    let rows: Vec<Vec<String>> = found.payload.iter().map(row).collect();
    let head = [
        "run".to_owned(),
        format!("weight, {}", units.force.name),
        format!("95 %, {}", units.force.name),
        format!("mass, {}", units.mass.name),
        format!("place, {}", units.length.name),
        format!("95 % half axes, {}", units.length.name),
    ];
    let head = head.each_ref().map(String::as_str);
    let mut sections = vec![table_section(
        "Payload",
        &head,
        &rows,
        "The job states the place if it is known. Half axes describe the 95 % region of the place.",
    )];
    if !found.weighing.gauges.is_empty() {
        sections.extend(gauge_sections(&found.weighing, units.force.name));
    }
    let prepared = found.prepared.as_ref();
    if let Some(mut scene) = prepared.and_then(|p| scene_of_job(&found.job, p)) {
        let places = payload_arrows(found, scene.model);
        if !places.is_empty() {
            scene.arrows = places;
        }
        sections.push(scene_section("Model and gauges", &scene));
    }
    Page::new(&found.job.title, "Payload", &found.findings, sections)
}

fn row(p: &WeighedPayload) -> Vec<String> {
    let (Some(force), Some(mass), [Some(x), Some(y)]) = (p.force, p.mass, p.position) else {
        // A refused run shows no numbers.
        let nothing = std::iter::repeat_n(String::new(), 4);
        let cells = [p.run.clone(), "refused".into()].into_iter();
        return cells.chain(nothing).collect();
    };
    let interval = [p.force_low, p.force_high].map(|v| number(value_or_nan(v)));
    vec![
        p.run.clone(),
        number(force),
        interval.join(" to "),
        number(mass),
        format!("{}, {}", number(x), number(y)),
        match &p.region {
            Some(e) => format!(
                "{} x {} at {:.0}°",
                number(e.half_axes[0]),
                number(e.half_axes[1]),
                e.angle_deg.round() + 0.0
            ),
            None => "known".into(),
        },
    ]
}

fn gauge_sections(weighing: &Weighing, force: &str) -> [Section; 2] {
    let gauges = weighing.gauges.iter().enumerate();
    let rows: Vec<Vec<String>> = gauges
        .map(|(g, v)| {
            let of_run = |r: &WeighedRun| number(r.estimates.get(g).copied().unwrap_or(f64::NAN));
            let mut row = vec![v.name.clone()];
            row.extend(weighing.runs.iter().map(of_run));
            row.push(if v.used { "used" } else { "not used" }.into());
            row.push(v.reason.clone());
            row
        })
        .collect();
    let mut header = vec!["gauge".to_owned()];
    header.extend(weighing.runs.iter().map(|r| r.run.clone()));
    header.extend([String::new(), "reason".to_owned()]);
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    let title = format!("Each gauge alone, {force}");
    let alone = table_section(&title, &header, &rows, "");
    let runs: Vec<(String, Vec<IntervalRow>)> = weighing
        .runs
        .iter()
        .map(|r| (r.run.clone(), bars(r, weighing)))
        .collect();
    let together = figure_section(
        "Single gauges and all together",
        intervals(
            &runs,
            force,
            Ends::Interval,
            "Payload from each gauge alone and from all gauges, with 95 % intervals: shorter intervals that overlap are better.",
        ),
        "A gauge alone whose interval is wider than the payload is left out.",
    );
    [alone, together]
}

/// Returns the estimate of each gauge in use, and of all gauges together, with 95 % intervals. Gauges whose sigma exceeds the payload are left out.
fn bars(r: &WeighedRun, weighing: &Weighing) -> Vec<IntervalRow> {
    let used = weighing.gauges.iter().enumerate().filter(|(_, v)| v.used);
    used.filter_map(|(g, v)| {
        let (e, s) = (*r.estimates.get(g)?, *r.estimate_sigma.get(g)?);
        (e.is_finite() && s.is_finite() && s < r.force.abs())
            .then(|| (v.name.clone(), [e - NORMAL_95 * s, e, e + NORMAL_95 * s]))
    })
    .chain(std::iter::once((
        "all".to_owned(),
        [r.interval[0], r.force, r.interval[1]],
    )))
    .collect()
}
