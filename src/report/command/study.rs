//! Report files and console output of `study`.

use super::{Report, write_page};
use crate::estimate::NORMAL_95;
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::host::words::count_of;
use crate::report::console::{Console, ConsoleTable};
use crate::report::csv_cell;
use crate::report::figure::{Ends, IntervalRow, intervals};
use crate::report::page::{KeyNumber, Page, Section, figure_section, table_section};
use crate::units::{Quantity, half_width, number, percent, plus_minus};
use crate::workflow::study::{LayoutGauge, LayoutGauges, LayoutStudy, StudiedLayout, StudiedLoad};

impl Report for Outcome<LayoutStudy> {
    const FILES: &'static [&'static str] =
        &["result.json", "report.html", "study.csv", "layouts.csv"];

    fn write(&self, out: &mut Output) -> Result<(), Faults> {
        let loads = self.study.first().map_or(&[][..], |row| &row.loads);
        let mut columns: Vec<(String, &str)> = COLUMNS.map(|c| (c.to_owned(), "")).to_vec();
        for l in loads {
            columns.push((format!("{}.bias", l.name), &l.unit));
            columns.push((format!("{}.sigma", l.name), &l.unit));
            columns.push((format!("{}.coverage", l.name), ""));
        }
        let header: Vec<String> = columns.iter().map(|c| csv_cell(&c.0).into()).collect();
        out.declare("study.csv", columns.iter().map(|(c, u)| (c.as_str(), *u)));
        out.write("study.csv", |w| {
            writeln!(w, "{}", header.join(","))?;
            for row in &self.study {
                writeln!(w, "{}", line(row))?;
            }
            Ok(())
        })?;
        let length = self.job.units.unit(Quantity::Length).name;
        let of_layouts = LAYOUT_COLUMNS.map(|(c, u)| (c, if u == "L" { length } else { u }));
        out.declare("layouts.csv", of_layouts);
        out.write("layouts.csv", |w| {
            writeln!(w, "{}", LAYOUT_COLUMNS.map(|c| c.0).join(","))?;
            for layout in &self.layouts {
                for gauge in &layout.chosen {
                    writeln!(w, "{}", gauge_line(layout, gauge))?;
                }
            }
            Ok(())
        })?;
        write_page(out, self)
    }

    fn page(&self) -> Option<Page> {
        Some(page(self))
    }

    fn key_numbers(&self) -> Vec<KeyNumber> {
        let rows = || {
            let all = self.study.iter();
            all.filter_map(|r| Some((r.mean_relative_rms?, r)))
        };
        let best = rows().min_by(|a, b| a.0.total_cmp(&b.0));
        let worst = rows().max_by(|a, b| a.0.total_cmp(&b.0));
        let words = |(error, r): (f64, &StudiedLayout), which: &str| {
            let meaning = format!("{which} mean error: {} {}, {}", r.layout, r.gauges, r.error);
            KeyNumber::new(percent(error), meaning)
        };
        let mut numbers = Vec::new();
        numbers.extend(best.map(|b| words(b, "smallest")));
        numbers.extend(worst.map(|w| words(w, "largest")));
        numbers.push(KeyNumber::new(
            self.study.len().to_string(),
            "layouts and errors compared",
        ));
        let trials = self.job.study.as_ref().map_or(0, |s| s.trials);
        numbers.push(KeyNumber::new(trials.to_string(), "trials each"));
        numbers
    }

    fn console(&self) -> Console {
        let loads = self.study.first().map_or(&[][..], |row| &row.loads);
        let half = |l: &StudiedLoad| NORMAL_95 * value_or_nan(l.sigma);
        let row = |r: &StudiedLayout| {
            let mut cells = vec![
                r.layout.clone(),
                r.gauges.to_string(),
                r.error.clone(),
                number(100.0 * value_or_nan(r.mean_relative_rms)),
            ];
            cells.extend(wanted_loads(r).map(|l| plus_minus(value_or_nan(l.bias), half(l))));
            cells
        };
        let mut head = ["layout", "gauges", "error", "mean error, %"]
            .map(str::to_owned)
            .to_vec();
        let heads = loads.iter().filter(|l| l.wanted);
        head.extend(heads.map(|l| format!("{}, {}", l.name, l.unit)));
        let title = "Error of the loads: bias ± half width of the 95 % interval";
        let by_layout = ConsoleTable {
            title: title.to_owned(),
            head,
            rows: self.study.iter().map(row).collect(),
        };
        // Range from the best to the worst layout, used if the loads have no separate columns.
        let of_load = |load: &StudiedLoad| {
            let all = self.study.iter().flat_map(|r| &r.loads);
            let halves = all.filter(|l| l.name == load.name).map(half);
            let halves: Vec<f64> = halves.filter(|h| h.is_finite()).collect();
            let least = halves.iter().copied().fold(f64::NAN, f64::min);
            let most = halves.iter().copied().fold(f64::NAN, f64::max);
            let range = match self.study.len() {
                1 => half_width(least),
                _ => {
                    let most = half_width(most);
                    format!("{} to {}", half_width(least), most.trim_start_matches("± "))
                }
            };
            vec![load.name.clone(), format!("{range} {}", load.unit)]
        };
        let rows = loads.iter().filter(|l| l.wanted).map(of_load).collect();
        let layouts = count_of(self.study.len(), "layout");
        let title = format!("Error of each load in {layouts}: half width of the 95 % interval");
        let by_load = ConsoleTable::new(title, &["load", "± 95 %"], rows);
        let next = format!(
            "choose a layout, then run `strainbridge place {}`",
            self.job.file
        );
        Console::new(by_layout, Some("study.csv"))
            .or(by_load)
            .next(next)
    }
}

/// First columns of study.csv.
const COLUMNS: [&str; 5] = [
    "layout",
    "gauges",
    "error",
    "condition_number",
    "mean_relative_rms",
];

/// Columns of `layouts.csv`, which has a row for each gauge. The columns from `name` on equal the columns of a gauge table. `L` is the job's length
/// unit.
const LAYOUT_COLUMNS: [(&str, &str); 14] = [
    ("layout", ""),
    ("gauges", ""),
    ("name", ""),
    ("element", ""),
    ("surface", ""),
    ("dir_x", ""),
    ("dir_y", ""),
    ("dir_z", ""),
    ("angle_deg", "deg"),
    ("x", "L"),
    ("y", "L"),
    ("z", "L"),
    ("bridge", ""),
    ("grid_length", "L"),
];

fn gauge_line(layout: &LayoutGauges, gauge: &LayoutGauge) -> String {
    let name = csv_cell(&gauge.name);
    let place = gauge.place.as_ref().map_or_else(
        || ",".repeat(10),
        |p| {
            let [d, x] = [p.direction, p.position].map(|v| v.map(|c| c.to_string()).join(","));
            let (element, surface) = (p.element, p.surface);
            format!(
                "{element},{surface},{d},0,{x},{},{}",
                p.bridge, p.grid_length
            )
        },
    );
    format!("{},{},{name},{place}", layout.layout, layout.gauges)
}

fn value_or_nan(x: Option<f64>) -> f64 {
    x.unwrap_or(f64::NAN)
}

fn line(row: &StudiedLayout) -> String {
    let mut cells = vec![
        row.layout.clone(),
        row.gauges.to_string(),
        row.error.clone(),
    ];
    let mut numbers = vec![row.condition_number, row.mean_relative_rms];
    let by_load = row.loads.iter();
    numbers.extend(by_load.flat_map(|l| [l.bias, l.sigma, l.coverage]));
    cells.extend(
        numbers
            .iter()
            .map(|n| n.map_or(String::new(), |v| v.to_string())),
    );
    cells.join(",")
}

fn page(found: &Outcome<LayoutStudy>) -> Page {
    let loads = found.study.first().map_or(&[][..], |row| &row.loads);
    let mut header: Vec<String> = [
        "layout",
        "gauges",
        "error",
        "condition, scaled",
        "mean rms error, %",
    ]
    .map(str::to_owned)
    .to_vec();
    let heads = loads.iter().filter(|l| l.wanted);
    header.extend(heads.map(|l| format!("{}, {}", l.name, l.unit)));
    let rows: Vec<Vec<String>> = found
        .study
        .iter()
        .map(|row| {
            let mut cells = vec![
                row.layout.clone(),
                row.gauges.to_string(),
                row.error.clone(),
                number(value_or_nan(row.condition_number)),
                number(100.0 * value_or_nan(row.mean_relative_rms)),
            ];
            cells.extend(wanted_loads(row).map(|l| {
                let width = NORMAL_95 * value_or_nan(l.sigma);
                format!("{} ± {}", number(value_or_nan(l.bias)), number(width))
            }));
            cells
        })
        .collect();
    let (trials, seed) = found
        .job
        .study
        .as_ref()
        .map_or((0, 0), |s| (s.trials, s.seed));
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    let section = table_section(
        &format!("{trials} trials each, seed {seed}: bias ± half width of the 95 % interval"),
        &header,
        &rows,
        "The same seed gives the same numbers on any machine and any number of threads. Layout `random`: the trials are distributed over 50 layouts.",
    );
    let title = &found.job.title;
    Page::new(
        title,
        "Effect of errors on recovered loads",
        &found.findings,
        vec![errors_by_layout(found), section, gauges_by_layout(found)],
    )
}

/// The gauges of each layout, by name.
fn gauges_by_layout(found: &LayoutStudy) -> Section {
    let row = |l: &LayoutGauges| {
        let names = l.chosen.iter().map(|g| g.name.as_str());
        let names: Vec<&str> = names.collect();
        vec![l.layout.clone(), l.gauges.to_string(), names.join(", ")]
    };
    let rows: Vec<Vec<String>> = found.layouts.iter().map(row).collect();
    table_section(
        "Gauges of each layout",
        &["layout", "gauges", "names"],
        &rows,
        "layouts.csv contains the place of each gauge. A random layout has no list: its errors come from 50 layouts.",
    )
}

/// Root mean square error of each load in percent of its true size, by layout, and the mean over the loads.
fn errors_by_layout(found: &LayoutStudy) -> Section {
    let name = |r: &StudiedLayout| format!("{} {}, {}", r.layout, r.gauges, r.error);
    let of_load = |load: &StudiedLoad| -> (String, Vec<IntervalRow>) {
        let row = |r: &StudiedLayout| {
            let of = r.loads.iter().find(|l| l.name == load.name)?;
            let error = 100.0 * of.relative_rms?;
            Some((name(r), [0.0, error, error]))
        };
        let rows = found.study.iter().filter_map(row).collect();
        (load.name.clone(), rows)
    };
    let mean = |r: &StudiedLayout| {
        let error = 100.0 * r.mean_relative_rms?;
        Some((name(r), [0.0, error, error]))
    };
    let mut groups = vec![(
        "mean of all loads".to_owned(),
        found.study.iter().filter_map(mean).collect(),
    )];
    let first = found.study.first().map_or(&[][..], |row| &row.loads);
    groups.extend(first.iter().filter(|l| l.wanted).map(of_load));
    figure_section(
        "Error by layout",
        intervals(
            &groups,
            "rms error of the load, % of its size",
            Ends::Span,
            "Root mean square error of a load over all trials, by layout and error: shorter bars are better.",
        ),
        "",
    )
}

/// Returns the wanted loads of a layout.
fn wanted_loads(row: &StudiedLayout) -> impl Iterator<Item = &StudiedLoad> {
    row.loads.iter().filter(|l| l.wanted)
}
