//! Files and words of `payload`.

use super::{Report, write_page};
use crate::estimate::NORMAL_95;
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::payload::{WeighedRun, Weighing};
use crate::report::console::{Console, ConsoleTable};
use crate::report::csv_cell;
use crate::report::figure::{IntervalRow, intervals};
use crate::report::page::{Page, Paper, Section, figure_section, table_section};
use crate::report::scene::{scene_of_job, scene_section};
use crate::units::{MICROSTRAIN, number};
use crate::workflow::payload::{Weighed, WeighedPayload};

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

impl Report for Outcome<Weighed> {
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

    fn console(&self) -> Console {
        let units = &self.job.report_units;
        let row = |p: &WeighedPayload| {
            let place = match &p.refused {
                Some(why) => format!("refused: {why}"),
                None => p.position.map(|x| number(plain(x))).join(", "),
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
        Console::new(table, Some("payload.csv"))
    }
}

fn plain(x: Option<f64>) -> f64 {
    x.unwrap_or(f64::NAN)
}

fn line(p: &WeighedPayload) -> String {
    // A known place has no spread.
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

fn page(found: &Outcome<Weighed>) -> Page {
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
        "The place is that of the job where it is known; half axes are of the region that holds it with 95 %.",
    )];
    if !found.weighing.gauges.is_empty() {
        sections.extend(gauge_sections(&found.weighing, units.force.name));
    }
    let prepared = found.prepared.as_ref();
    if let Some(scene) = prepared.and_then(|p| scene_of_job(&found.job, p)) {
        sections.push(scene_section("Model and gauges", &scene));
    }
    Page::new(&found.job.title, "Payload", &found.findings, sections)
}

fn row(p: &WeighedPayload) -> Vec<String> {
    let (Some(force), Some(mass), [Some(x), Some(y)]) = (p.force, p.mass, p.position) else {
        // What is refused has no numbers to sign for.
        let nothing = std::iter::repeat_n(String::new(), 4);
        let cells = [p.run.clone(), "refused".into()].into_iter();
        return cells.chain(nothing).collect();
    };
    let interval = [p.force_low, p.force_high].map(|v| number(plain(v)));
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
        "Gauges in use and all together",
        intervals(&runs, force),
        "A gauge alone whose interval is wider than the payload is left out.",
    );
    [alone, together]
}

/// What each gauge in use says of a run, and all of them.
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
