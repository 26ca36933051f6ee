//! Report files and console output of `respond`.

use super::columns::declare_written;
use super::respond_files::{arrays, histories};
use super::{Report, write_page};
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::model::{Model, Vec3};
use crate::report::console::{Console, ConsoleTable};
use crate::report::csv_cell;
use crate::report::figure::{GaugePoints, agreement};
use crate::report::page::{KeyNumber, Page, Section, figure_section, number, table_section};
use crate::report::scene::{Field, FieldValues, Mark, scene_of, scene_section};
use crate::report::write_cells_vtu;
use crate::respond::{Place, ResponseRow, von_mises_history};
use crate::units::{factor, plus_minus};
use crate::workflow::respond::{Element, ElementFatigue, StressResponse, grids};

/// Rows of a table on the page.
const MOST_ROWS: usize = 60;
/// Points a drawing takes.
const MOST_POINTS: usize = 2000;

impl Report for Outcome<StressResponse> {
    const FILES: &'static [&'static str] = &[
        "result.json",
        "report.html",
        "elements.csv",
        "histories.csv",
        "envelope.vtu",
    ];

    fn write(&self, out: &mut Output) -> Result<(), Faults> {
        let Some(fields) = &self.prepared.fields else {
            return Ok(());
        };
        let (model, f, unit) = (fields.model(), &self.field, self.stress_unit);
        let u = factor(self.job.units, self.job.report_units.stress);
        out.declare(
            "elements.csv",
            [
                ("element", ""),
                ("surface", ""),
                ("max_von_mises", unit),
                ("sigma", unit),
                ("at", ""),
            ],
        );
        out.write("elements.csv", |w| {
            writeln!(w, "element,surface,max_von_mises,sigma,at")?;
            for e in &self.elements {
                let at = csv_cell(e.at.as_deref().unwrap_or(""));
                writeln!(
                    w,
                    "{},{},{},{},{at}",
                    e.element, e.surface, e.max_von_mises, e.sigma
                )?;
            }
            Ok(())
        })?;
        if !self.fatigue.is_empty() {
            out.declare("fatigue.csv", FATIGUE);
            out.write("fatigue.csv", |w| fatigue_csv(w, &self.fatigue))?;
        }
        out.write("histories.csv", |w| {
            histories(w, &f.rows, &f.order, &f.states, u)
        })?;
        declare_written(out, "histories.csv", |c| history_unit(c, unit))?;
        out.write("envelope.vtu", |w| {
            write_cells_vtu(model, &arrays(model, &f.rows, &f.peaks, u, unit), w)
        })?;
        if !self.check.rows.is_empty() {
            out.write("predicted.csv", |w| write_predicted_strain(w, self))?;
            declare_written(out, "predicted.csv", |c| match c {
                "state" => String::new(),
                _ => "microstrain".to_owned(),
            })?;
        }
        write_page(out, self)
    }

    fn page(&self) -> Option<Page> {
        let mut page = Page::new(
            &self.job.title,
            "Stress from recovered loads",
            &self.findings,
            sections(self),
        );
        if !self.fatigue.is_empty() {
            let at = page.sections.len().min(1);
            page.sections.insert(at, fatigue_section(&self.fatigue));
        }
        Some(page)
    }

    fn key_numbers(&self) -> Vec<KeyNumber> {
        let unit = self.stress_unit;
        let mut numbers = Vec::new();
        if let Some(e) = self.elements.first() {
            let value = format!("{} {unit}", plus_minus(e.max_von_mises, e.half_width()));
            let at =
                e.at.as_ref()
                    .map_or_else(String::new, |at| format!(", {at}"));
            numbers.push(KeyNumber::new(
                value,
                format!(
                    "largest von Mises stress, element {} {}{at}",
                    e.element, e.surface
                ),
            ));
        }
        numbers.push(KeyNumber::new(
            self.hot_spots.len().to_string(),
            "hot spots: stress higher than at all neighbours",
        ));
        numbers.push(KeyNumber::new(self.states.to_string(), "load states"));
        let worst = self
            .fatigue
            .iter()
            .max_by(|a, b| a.damage.total_cmp(&b.damage));
        numbers.extend(worst.map(|f| {
            let range = format!("{} to {}", number(f.damage_low), number(f.damage_high));
            KeyNumber::new(
                number(f.damage),
                format!("largest damage, element {} ({range})", f.element),
            )
        }));
        numbers
    }

    fn console(&self) -> Console {
        let row = |e: &Element| {
            vec![
                e.element.to_string(),
                e.surface.clone(),
                plus_minus(e.max_von_mises, e.half_width()),
                e.at.clone().unwrap_or_default(),
            ]
        };
        let unit = self.stress_unit;
        let table = ConsoleTable::new(
            format!("Largest von Mises stress, {unit} (± half width of the 95 % interval)"),
            &["element", "surface", "stress", "at"],
            self.elements.iter().map(row).collect(),
        );
        Console::new(table, Some("elements.csv")).next("open envelope.vtu in ParaView")
    }
}

const FATIGUE: [(&str, &str); 9] = [
    ("element", ""),
    ("surface", ""),
    ("damage", "report stress to the power of the slope"),
    ("damage_low", "report stress to the power of the slope"),
    ("damage_high", "report stress to the power of the slope"),
    ("angle_deg", "degree"),
    ("life_share", ""),
    ("life_share_low", ""),
    ("life_share_high", ""),
];

fn fatigue_csv(w: &mut dyn std::io::Write, list: &[ElementFatigue]) -> std::io::Result<()> {
    writeln!(w, "{}", FATIGUE.map(|c| c.0).join(","))?;
    let cell = |share: Option<f64>| share.map_or_else(String::new, |s| s.to_string());
    for f in list {
        writeln!(
            w,
            "{},{},{},{},{},{},{},{},{}",
            f.element,
            csv_cell(&f.surface),
            f.damage,
            f.damage_low,
            f.damage_high,
            f.angle_deg,
            cell(f.life_share),
            cell(f.life_share_low),
            cell(f.life_share_high)
        )?;
    }
    Ok(())
}

/// The table of fatigue on the page.
fn fatigue_section(list: &[ElementFatigue]) -> Section {
    let row = |f: &ElementFatigue| {
        vec![
            f.element.to_string(),
            f.surface.clone(),
            number(f.damage),
            format!("{} to {}", number(f.damage_low), number(f.damage_high)),
            number(f.angle_deg),
            f.life_share.map_or_else(String::new, number),
            f.life_share_low
                .zip(f.life_share_high)
                .map_or_else(String::new, |(low, high)| {
                    format!("{} to {}", number(low), number(high))
                }),
        ]
    };
    let rows: Vec<Vec<String>> = list.iter().take(MOST_ROWS).map(row).collect();
    let head = [
        "element",
        "surface",
        "damage",
        "95 % interval",
        "plane, deg",
        "share of life",
        "95 % interval",
    ];
    // Without a fatigue class, the last two columns are empty.
    let columns = match list.iter().any(|f| f.life_share.is_some()) {
        true => head.len(),
        false => head.len() - 2,
    };
    let rows: Vec<Vec<String>> = rows.iter().map(|r| r[..columns].to_vec()).collect();
    table_section(
        "Fatigue",
        &head[..columns],
        &rows,
        "Pseudo-damage of the normal stress on the plane of largest damage; plane: its normal from the x axis of the element.",
    )
}

/// The unit of a column of histories.csv: strains end in exx, eyy, gxy.
fn history_unit(column: &str, stress: &str) -> String {
    match column.rsplit('.').next() {
        Some("state") => String::new(),
        Some("exx" | "eyy" | "gxy") => "microstrain".to_owned(),
        _ => stress.to_owned(),
    }
}

/// A row a state: predicted and measured microstrain of every gauge.
fn write_predicted_strain(w: &mut dyn std::io::Write, r: &StressResponse) -> std::io::Result<()> {
    write!(w, "state")?;
    for g in &r.check.gauges {
        let measured = format!("{g}.measured");
        write!(w, ",{},{}", csv_cell(g), csv_cell(&measured))?;
    }
    writeln!(w)?;
    for (state, pairs) in r.check.states.iter().zip(&r.check.pairs) {
        write!(w, "{}", csv_cell(state))?;
        for (predicted, read) in pairs {
            write!(w, ",{predicted},")?;
            if read.is_finite() {
                write!(w, "{read}")?;
            }
        }
        writeln!(w)?;
    }
    Ok(())
}

fn sections(r: &StressResponse) -> Vec<Section> {
    let unit = r.stress_unit;
    let header = ["element", "surface", unit, "95 %", "at"];
    let mut out = vec![
        table_section(
            "Largest von Mises stress",
            &header,
            &element_rows(&r.elements),
            "Superposition of the loads; the interval contains only the uncertainty of the loads.",
        ),
        table_section(
            "Hot spots",
            &header,
            &element_rows(&r.hot_spots),
            "Elements with a higher stress than all elements that share a grid with them.",
        ),
    ];
    if let Some(fields) = &r.prepared.fields {
        let hottest = r.field.spots.iter().zip(&r.hot_spots);
        let marks = hottest
            .map(|(i, e)| mark_of_row(fields.model(), &r.field.rows[*i], note(e, unit)))
            .collect();
        let mut scene = scene_of(&r.job, fields, marks);
        let stress = stress_fields(r, fields.model());
        if !stress.is_empty() {
            scene.fields = stress;
        }
        scene.caption = "Colour shows the von Mises stress, first of the state with the largest: darker is worse. Marks show the hot spots.".to_owned();
        out.push(scene_section("Hot spots on the model", &scene));
    }
    if !r.check.rows.is_empty() {
        out.extend(check_sections(r));
    }
    out
}

fn element_rows(list: &[Element]) -> Vec<Vec<String>> {
    list.iter()
        .take(MOST_ROWS)
        .map(|e| {
            vec![
                e.element.to_string(),
                e.surface.clone(),
                number(e.max_von_mises),
                format!("± {}", number(e.half_width())),
                e.at.clone().unwrap_or_default(),
            ]
        })
        .collect()
}

fn note(e: &Element, unit: &str) -> String {
    let [value, half] = [e.max_von_mises, e.half_width()].map(number);
    let at = e.at.as_deref().unwrap_or("");
    format!("{} {value} ± {half} {unit} in {at}", e.surface)
}

/// Von Mises stress of the shells in the state in which some element is hottest, and the largest of all states.
fn stress_fields(r: &StressResponse, model: &Model) -> Vec<Field<'static>> {
    let f = &r.field;
    let known = f.peaks.iter().filter(|p| p.von_mises.is_finite());
    let Some(hottest) = known.max_by(|a, b| a.von_mises.total_cmp(&b.von_mises)) else {
        return Vec::new();
    };
    let state = f.states.get(hottest.at..=hottest.at).unwrap_or_default();
    let field = |name: String, of_row: &dyn Fn(usize) -> Option<f64>| {
        let mut shells = vec![[f64::NAN; 2]; model.shells.len()];
        for (i, row) in f.rows.iter().enumerate() {
            if let Place::Shell { shell, surface } = row.place
                && let (Some(slot), Some(v)) = (shells.get_mut(shell.us()), of_row(i))
            {
                slot[surface.ix()] = v;
            }
        }
        Field {
            name,
            unit: r.stress_unit.to_owned(),
            values: FieldValues::Magnitudes(shells),
            scale: factor(r.job.units, r.job.report_units.stress),
        }
    };
    let in_state = |i: usize| {
        let of_row = von_mises_history(f.rows.get(i)?, state);
        Some(of_row.first()?.1)
    };
    let of_all = |i: usize| f.peaks.get(i).map(|p| p.von_mises);
    let label = state.first().map_or("", |s| &s.label);
    let mut out = vec![field(format!("von Mises stress, state {label}"), &in_state)];
    if f.states.len() > 1 {
        let name = "von Mises stress, largest of all states".to_owned();
        out.push(field(name, &of_all));
    }
    out
}

/// An element of a row as a mark of the scene, at the middle of its grids.
fn mark_of_row(model: &Model, row: &ResponseRow, note: String) -> Mark {
    let at: Vec<_> = grids(model, row)
        .iter()
        .filter_map(|g| model.grids.get(g.us()).map(|g| g.x))
        .collect();
    Mark {
        name: row.element.to_string(),
        at: at.iter().sum::<Vec3>() / at.len().max(1) as f64,
        axes: None,
        surface: match row.place {
            Place::Shell { surface, .. } => Some(surface),
            Place::Beam { .. } => None,
        },
        note,
        gap: None,
    }
}

/// Predicted against measured strain at the gauges.
fn check_sections(r: &StressResponse) -> [Section; 2] {
    let check = &r.check;
    let stride = (check.states.len() * check.gauges.len())
        .div_ceil(MOST_POINTS)
        .max(1);
    let points: Vec<GaugePoints> = check
        .gauges
        .iter()
        .enumerate()
        .map(|(g, name)| GaugePoints {
            name: name.clone(),
            residual: check
                .rows
                .iter()
                .find(|c| c.name == *name)
                .map_or(0.0, |c| c.residual_rms),
            points: [
                check
                    .pairs
                    .iter()
                    .step_by(stride)
                    .filter_map(|pairs| pairs.get(g).copied())
                    .collect(),
                Vec::new(),
            ],
        })
        .collect();
    let states: Vec<String> = check.states.iter().step_by(stride).cloned().collect();
    let rows: Vec<Vec<String>> = check
        .rows
        .iter()
        .map(|g| {
            vec![
                g.name.clone(),
                number(g.measured_rms),
                number(g.residual_rms),
                number(g.correlation.unwrap_or(f64::NAN)),
            ]
        })
        .collect();
    [
        figure_section(
            "Measured against predicted strain at the gauges",
            agreement(&points, ["states", ""], [&states, &[]]),
            "",
        ),
        table_section(
            "Gauges, microstrain",
            &["gauge", "measured rms", "residual rms", "correlation"],
            &rows,
            "",
        ),
    ]
}
