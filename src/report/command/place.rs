//! Report files and console output of `place`.

use super::columns::declare_written;
use super::{Report, write_book, write_page};
use crate::estimate::NORMAL_95;
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::report::console::{Console, ConsoleTable};
use crate::report::figure::CountPoint;
use crate::report::page::{KeyNumber, Page, Paper};
use crate::report::scene::{PickTargets, Places, Scene, placed_mark, scene_of};
use crate::report::spreadsheet::gauge_sheets;
use crate::report::strain::{
    HowMany, gauges_csv, gauges_vtu, gluing_page, gluing_sheet_csv, gluing_sheet_md, place_page,
    sensitivity_csv,
};
use crate::strain_chain::LoadSigma;
use crate::units::{half_width, number, percent};
use crate::workflow::place::{CertifiedLayout, InstalledLayout, InstalledQuality};

impl Report for Outcome<CertifiedLayout> {
    const FILES: &'static [&'static str] = &[
        "result.json",
        "report.html",
        "gauges.csv",
        "sensitivity.csv",
        "gluing_sheet.csv",
        "gluing_sheet.md",
        "gluing_sheet.html",
        "gauges.vtu",
    ];

    fn write(&self, out: &mut Output) -> Result<(), Faults> {
        let (s, model, job) = (&self.sensitivity, self.fields.model(), &self.job);
        let length = job.units.unit(crate::units::Quantity::Length).name;
        let grid_length = job.candidates.grid_length;
        out.write("gauges.csv", |w| gauges_csv(w, &self.gauges, grid_length))?;
        declare_written(out, "gauges.csv", |c| {
            let stated = GAUGES.iter().find(|g| g.0 == c).map_or("", |g| g.1);
            unit(stated, length).to_owned()
        })?;
        out.declare("sensitivity.csv", super::sensitivity::columns(job, s));
        out.write("sensitivity.csv", |w| sensitivity_csv(w, s))?;
        out.write("gluing_sheet.csv", |w| {
            gluing_sheet_csv(w, &self.gauges, model, grid_length)
        })?;
        declare_written(out, "gluing_sheet.csv", |c| {
            let stated = GLUING.iter().find(|g| g.0 == c).map_or("", |g| g.1);
            let word = if c.ends_with("microstrain") {
                "microstrain"
            } else {
                stated
            };
            unit(word, length).to_owned()
        })?;
        let sheet = gluing_sheet_md(&job.title, &self.gauges, model, length);
        out.write_bytes("gluing_sheet.md", sheet.as_bytes())?;
        let page = gluing_page(&job.title, &self.gauges, &scene(self));
        out.write_bytes("gluing_sheet.html", page.to_html().as_bytes())?;
        out.write("gauges.vtu", |w| gauges_vtu(w, &self.gauges))?;
        write_page(out, self)?;
        let sheets = gauge_sheets(&self.gauges, model, s, &self.load_sigma, &self.worst_loss);
        write_book(out, self, job, "gauges.xlsx", &sheets)
    }

    fn page(&self) -> Option<Page> {
        let (s, job) = (&self.sensitivity, &self.job);
        let mut scene = scene(self);
        scene.pointing = PickTargets::Places(Places::from_candidates(&job.candidates));
        let page = place_page(
            &job.title,
            &scene,
            &self.gauges,
            s,
            &self.findings,
            &numbers(self),
            &load_sigma(self),
            &how_many(self),
        );
        Some(page.on_paper(Paper::Signed))
    }

    fn key_numbers(&self) -> Vec<KeyNumber> {
        let share = match self.proved {
            true => "100 %".to_owned(),
            // Rounded down: it is a lower bound.
            false => format!("≥ {:.1} %", (1000.0 * self.efficiency_bound).floor() / 10.0),
        };
        let of = |l: &LoadSigma| Some((self.share_of_expected(l)?, l.clone()));
        let shares = self.load_sigma.iter().filter_map(of);
        let widest = shares.max_by(|a, b| a.0.total_cmp(&b.0));
        let mut numbers = vec![
            KeyNumber::new(
                self.gauges.len().to_string(),
                format!(
                    "gauges for {} loads, of {} candidates",
                    self.load_sigma.len(),
                    self.candidates.rows
                ),
            ),
            KeyNumber::new(share, "of the best possible layout, certified"),
        ];
        numbers.extend(widest.map(|(share, l)| {
            let half = half_width(NORMAL_95 * l.sigma());
            KeyNumber::new(
                format!("{half} {}", l.unit),
                format!(
                    "least certain: {}, {} of its expected size",
                    l.name,
                    percent(share)
                ),
            )
        }));
        let worst = &self.worst_loss;
        numbers.push(KeyNumber::new(
            format!("{:.0} %", 100.0 * worst.efficiency_left),
            format!(
                "of the information remains without {}, the most important gauge",
                worst.gauge
            ),
        ));
        numbers
    }

    fn console(&self) -> Console {
        let is_glued = self.load_sigma.iter().any(|l| l.sigma_as_glued.is_some());
        let row = |l: &LoadSigma| {
            let share = self.share_of_expected(l);
            let share = share.map_or("-".into(), |s| format!("{} %", number(100.0 * s)));
            let half = half_width(NORMAL_95 * l.sigma());
            vec![l.name.clone(), half, l.unit.clone(), share]
        };
        let rows: Vec<Vec<String>> = self.load_sigma.iter().map(row).collect();
        let title = match is_glued {
            true => "Loads with these gauges, tolerances of installation included",
            false => "Loads with these gauges",
        };
        let short = |r: &Vec<String>| {
            let [name, half, unit, _] = r.as_slice() else {
                return r.clone();
            };
            vec![name.clone(), format!("{half} {unit}")]
        };
        let compact = rows.iter().map(short).collect();
        let head = ["load", "± 95 %", "unit", "of its expected size"];
        let table = ConsoleTable::new(title, &head, rows);
        let compact = ConsoleTable::new(title, &["load", "± 95 %"], compact);
        let job = &self.job.file;
        let readings = match self.job.measured {
            Some(_) => "write readings to the strain file of the job",
            None => "add [measured] with the strain file to the job",
        };
        Console::new(table, Some("gauges.csv"))
            .or(compact)
            .next(format!(
                "glue by gluing_sheet.html, {readings}, then run `strainbridge recover {job}`"
            ))
    }
}

/// The model with the gauges.
fn scene(placed: &CertifiedLayout) -> Scene<'_> {
    let marks = placed.gauges.iter().map(placed_mark).collect();
    scene_of(&placed.job, &placed.fields, marks)
}

/// Columns of gauges.csv; `L` is the job's length.
const GAUGES: [(&str, &str); 16] = [
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
    ("angle_from_element_x_deg", "deg"),
    ("angle_seen_deg", "deg"),
    ("leverage", ""),
    ("role", ""),
    ("grid_length", "L"),
];

/// Columns of gluing_sheet.csv with a unit.
const GLUING: [(&str, &str); 11] = [
    ("x", "L"),
    ("y", "L"),
    ("z", "L"),
    ("dx", "L"),
    ("dy", "L"),
    ("dz", "L"),
    ("angle_seen_deg", "deg"),
    ("corner_distances", "L"),
    ("angle_budget_deg", "deg"),
    ("position_budget", "L"),
    ("grid_length", "L"),
];

fn unit<'a>(word: &'a str, length: &'a str) -> &'a str {
    if word == "L" { length } else { word }
}

fn installed_quality(placed: &CertifiedLayout) -> Option<&InstalledQuality> {
    let installed: Option<&InstalledLayout> = placed.installed.as_ref();
    installed?.quality.as_ref()
}

/// Rows of the page's first table.
fn numbers(placed: &CertifiedLayout) -> Vec<(String, String)> {
    let mut out = vec![
        (
            "Efficiency, certified at least".to_owned(),
            if placed.proved {
                "1, proved the best".to_owned()
            } else {
                format!("{:.4}", placed.efficiency_bound)
            },
        ),
        ("log det".to_owned(), format!("{:.4}", placed.log_det)),
        (
            "Condition number, scaled".to_owned(),
            number(placed.sensitivity.condition_number_scaled()),
        ),
    ];
    let worst = &placed.worst_loss;
    out.push((
        format!(
            "Efficiency that remains without {}, the worst loss",
            worst.gauge
        ),
        format!("{:.3}", worst.efficiency_left),
    ));
    let mut row = |name: &str, value: Option<f64>, digits: usize| {
        out.extend(value.map(|v| (name.to_owned(), format!("{v:.digits$}"))));
    };
    row(
        "Least condition number found, scaled",
        placed.least_condition_number_scaled,
        2,
    );
    let own = installed_quality(placed);
    row(
        "Installed: condition number, scaled",
        own.and_then(|q| q.condition_number_scaled),
        2,
    );
    row(
        "Installed: log det (noise alone)",
        own.and_then(|q| q.log_det),
        4,
    );
    out
}

/// Returns rows of load, sigma, sigma for the installed positions, and unit.
fn load_sigma(placed: &CertifiedLayout) -> Vec<Vec<String>> {
    let row = |l: &LoadSigma| {
        let glued = l.sigma_as_glued.map(number).unwrap_or_default();
        vec![l.name.clone(), number(l.sigma), glued, l.unit.clone()]
    };
    placed.load_sigma.iter().map(row).collect()
}

fn how_many(placed: &CertifiedLayout) -> HowMany {
    let point = |p: &crate::workflow::place::CurvePoint| CountPoint {
        gauges: p.gauges,
        efficiency: p.efficiency_bound,
        after_loss: p.worst_loss,
        sigma: p.load_sigma.iter().map(|s| s.sigma).collect(),
    };
    let loads = placed.how_many.first().map_or(&[][..], |p| &p.load_sigma);
    HowMany {
        points: placed.how_many.iter().map(point).collect(),
        loads: loads
            .iter()
            .map(|s| (s.name.clone(), s.unit.clone()))
            .collect(),
    }
}
