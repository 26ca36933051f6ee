//! Files and words of `fleet`.

use super::{Report, write_page};
use crate::app::fault::Faults;
use crate::app::fleet::{Fleet, VehicleAnswer, VehicleLoadAnswer};
use crate::app::outcome::Outcome;
use crate::app::output::Output;
use crate::report::csv_cell;
use crate::report::figure::{Line, Scale, intervals, lines};
use crate::report::page::{Block, Page, Paper, Section, figure_section, table_section};
use crate::units::number;
use std::fmt::Write;

/// Files listed on the page; `result.json` has all.
const LISTED: usize = 500;
/// Vehicles with figures of their own.
const DRAWN: usize = 12;

impl Report for Outcome<Fleet> {
    fn write(&self, out: &mut Output) -> Result<(), Faults> {
        let unit = |c: &str, u: &str| (c.to_owned(), u.to_owned());
        out.declare(
            "fleet.csv",
            [
                unit("vehicle", ""),
                unit("files", ""),
                unit("hours", "h"),
                unit("load", ""),
                unit("max", "report unit of the load"),
                unit("min", "report unit of the load"),
                unit("damage", "report unit to the power of the slope"),
                unit("damage_low", "report unit to the power of the slope"),
                unit("damage_high", "report unit to the power of the slope"),
            ],
        );
        out.write_bytes("fleet.csv", table(self).as_bytes())?;
        out.declare("fleet_files.csv", FILES.map(|(c, u)| unit(c, u)));
        out.write_bytes("fleet_files.csv", files(self).as_bytes())?;
        out.declare("rainflow.csv", RAINFLOW.map(|(c, u)| unit(c, u)));
        out.write_bytes("rainflow.csv", rainflow(self).as_bytes())?;
        out.declare("levels.csv", LEVELS.map(|(c, u)| unit(c, u)));
        out.write_bytes("levels.csv", levels(self).as_bytes())?;
        out.declare("from_to.csv", FROM_TO.map(|(c, u)| unit(c, u)));
        out.write_bytes("from_to.csv", from_to(self).as_bytes())?;
        #[cfg(feature = "parquet")]
        out.write_bytes("fleet.parquet", &super::fleet_parquet::bytes(self)?)?;
        write_page(out, self)
    }

    fn page(&self) -> Option<Page> {
        Some(page(self))
    }

    fn words(&self) -> String {
        let count = |status: &str| self.files.iter().filter(|f| f.status == status).count();
        let doubtful = match self.files.iter().filter(|f| f.is_doubtful()).count() {
            0 => String::new(),
            n => format!(", {n} done whose loads can't be relied on"),
        };
        let mut text = format!(
            "{} of {} files done ({} kept from before), {} failed, {} second copies{doubtful}\n",
            count("done"),
            self.files.len(),
            self.reused,
            count("failed"),
            count("copy")
        );
        for (v, l) in rows(self) {
            let _ = writeln!(
                text,
                "{} {}: {} to {} {}, damage {} ({} to {})",
                v.name,
                l.load,
                number(l.min.unwrap_or(f64::NAN)),
                number(l.max.unwrap_or(f64::NAN)),
                l.unit,
                number(l.damage),
                number(l.damage_low),
                number(l.damage_high)
            );
        }
        text
    }
}

fn rows(fleet: &Fleet) -> impl Iterator<Item = (&VehicleAnswer, &VehicleLoadAnswer)> {
    fleet
        .vehicles
        .iter()
        .flat_map(|v| v.loads.iter().map(move |l| (v, l)))
}

/// A number as it stands in a table: as many digits as bring it back; nothing where there is none.
fn cell(x: f64) -> String {
    if x.is_finite() {
        format!("{x:e}")
    } else {
        String::new()
    }
}

fn table(fleet: &Fleet) -> String {
    let mut text = "vehicle,files,hours,load,max,min,damage,damage_low,damage_high\n".to_owned();
    for (v, l) in rows(fleet) {
        let numbers = [
            l.max.unwrap_or(f64::NAN),
            l.min.unwrap_or(f64::NAN),
            l.damage,
            l.damage_low,
            l.damage_high,
        ];
        let _ = writeln!(
            text,
            "{},{},{},{},{}",
            csv_cell(&v.name),
            v.files,
            cell(v.hours),
            csv_cell(&l.load),
            numbers.map(cell).join(",")
        );
    }
    text
}

const FILES: [(&str, &str); 8] = [
    ("path", ""),
    ("sha256", ""),
    ("vehicle", ""),
    ("day", ""),
    ("status", ""),
    ("message", ""),
    ("hours", "h"),
    ("rate", "Hz"),
];

fn files(fleet: &Fleet) -> String {
    let mut text = FILES.map(|f| f.0).join(",") + "\n";
    for f in &fleet.files {
        let words = [
            &f.path,
            &f.sha256,
            &f.vehicle,
            &f.day,
            &f.status.to_owned(),
            &f.words(),
        ];
        let words: Vec<_> = words.iter().map(|w| csv_cell(w)).collect();
        let numbers = [f.hours, f.rate_hz].map(|x| cell(x.unwrap_or(f64::NAN)));
        let _ = writeln!(text, "{},{}", words.join(","), numbers.join(","));
    }
    text
}

const RAINFLOW: [(&str, &str); 5] = [
    ("vehicle", ""),
    ("load", ""),
    ("range_from", "report unit of the load"),
    ("range_to", "report unit of the load"),
    ("cycles", ""),
];

fn rainflow(fleet: &Fleet) -> String {
    let mut text = RAINFLOW.map(|f| f.0).join(",") + "\n";
    for (v, l) in rows(fleet) {
        for (apart, cycles) in &l.range_pairs {
            // Ends in classes so far apart differ by no less than one class less and no more than one more.
            let (from, to) = ((f64::from(*apart) - 1.0).max(0.0), f64::from(*apart) + 1.0);
            let ends = [from * l.width, to * l.width].map(cell).join(",");
            let _ = writeln!(
                text,
                "{},{},{ends},{cycles}",
                csv_cell(&v.name),
                csv_cell(&l.load)
            );
        }
    }
    text
}

const LEVELS: [(&str, &str); 4] = [
    ("vehicle", ""),
    ("load", ""),
    ("level", "report unit of the load"),
    ("rises", ""),
];

fn levels(fleet: &Fleet) -> String {
    let mut text = LEVELS.map(|f| f.0).join(",") + "\n";
    for (v, l) in rows(fleet) {
        for (i, n) in &l.levels {
            let level = cell(f64::from(*i) * l.width);
            let _ = writeln!(
                text,
                "{},{},{level},{n}",
                csv_cell(&v.name),
                csv_cell(&l.load)
            );
        }
    }
    text
}

const FROM_TO: [(&str, &str); 6] = [
    ("vehicle", ""),
    ("load", ""),
    ("from", "report unit of the load"),
    ("to", "report unit of the load"),
    ("class_width", "report unit of the load"),
    ("cycles", ""),
];

fn from_to(fleet: &Fleet) -> String {
    let mut text = FROM_TO.map(|f| f.0).join(",") + "\n";
    for (v, l) in rows(fleet) {
        for (a, b, n) in &l.from_to {
            let places = [f64::from(*a) * l.width, f64::from(*b) * l.width, l.width]
                .map(cell)
                .join(",");
            let _ = writeln!(
                text,
                "{},{},{places},{n}",
                csv_cell(&v.name),
                csv_cell(&l.load)
            );
        }
    }
    text
}

fn page(o: &Outcome<Fleet>) -> Page {
    let hours: f64 = o.vehicles.iter().map(|v| v.hours).sum();
    let lead = format!(
        "Fleet: {} vehicles, {} files, {} hours; S-N slope {}",
        o.vehicles.len(),
        o.files.len(),
        number(hours),
        o.slope
    );
    let head = [
        "vehicle",
        "files",
        "hours",
        "load",
        "unit",
        "max",
        "on",
        "min",
        "on",
        "damage",
        "low",
        "high",
        "damage an hour, mean 1",
    ];
    let cells = |(v, l): (&VehicleAnswer, &VehicleLoadAnswer)| {
        vec![
            v.name.clone(),
            v.files.to_string(),
            number(v.hours),
            l.load.clone(),
            l.unit.clone(),
            number(l.max.unwrap_or(f64::NAN)),
            l.max_day.clone(),
            number(l.min.unwrap_or(f64::NAN)),
            l.min_day.clone(),
            number(l.damage),
            number(l.damage_low),
            number(l.damage_high),
            number(l.relative),
        ]
    };
    let note = "Damage is the sum of ranges to the power of the slope, in that power of the load's unit; it compares, it is no life. \
                Cycles are counted by four points, days of a vehicle one after the other as if they were one record; what closes no cycle \
                counts half, as ASTM E1049 has it. The interval (95 %) holds the error of S, which is the same every day, the scatter of noise, \
                which averages out, and what is left of the bias of noise, which is taken off.";
    let all: Vec<Vec<String>> = rows(o).map(cells).collect();
    let mut sections = vec![table_section("Vehicles", &head, &all, note)];
    let mut by_load: Vec<(String, Vec<(String, [f64; 3])>)> = Vec::new();
    for (v, l) in rows(o) {
        let row = (
            v.name.clone(),
            [l.damage_low, l.damage, l.damage_high].map(|d| d / v.hours),
        );
        match by_load.iter_mut().find(|g| g.0 == l.load) {
            Some(group) => group.1.push(row),
            None => by_load.push((l.load.clone(), vec![row])),
        }
    }
    for (_, list) in &mut by_load {
        list.sort_by(|a, b| b.1[1].total_cmp(&a.1[1]));
    }
    if !by_load.is_empty() {
        sections.push(figure_section(
            "Damage an hour",
            intervals(&by_load, &damage_unit(o)),
            "",
        ));
    }
    sections.extend(o.vehicles.iter().take(DRAWN).map(health));
    if let Some(left) = o.vehicles.len().checked_sub(DRAWN + 1) {
        let text = format!("{} more vehicles are in result.json.", left + 1);
        sections.push(Section::new("Other vehicles", vec![Block::Text(text)]));
    }
    let listed = o.files.iter().take(LISTED).map(|f| {
        let digest = f.sha256.get(..16).unwrap_or_default().to_owned();
        let hours = f.hours.map_or(String::new(), number);
        vec![
            f.path.clone(),
            f.vehicle.clone(),
            f.day.clone(),
            f.status.to_owned(),
            f.words(),
            hours,
            digest,
        ]
    });
    let head = [
        "file",
        "vehicle",
        "day",
        "status",
        "why",
        "hours",
        "sha256 begins",
    ];
    let listed: Vec<Vec<String>> = listed.collect();
    let note = if o.files.len() > LISTED {
        "All files are in fleet_files.csv."
    } else {
        ""
    };
    sections.push(table_section("Files", &head, &listed, note));
    Page::new(&o.title, &lead, &o.findings, sections).on_paper(Paper::Report)
}

/// Damage an hour: the loads' unit to the power of the slope; where loads have several, that of each.
fn damage_unit(o: &Fleet) -> String {
    let mut units = rows(o).map(|(_, l)| l.unit.as_str());
    let first = units.next().unwrap_or_default();
    let unit = match units.all(|u| u == first) && !first.is_empty() {
        true => first,
        false => "unit of the load",
    };
    format!("damage an hour, ({unit})^{}", o.slope)
}

/// Gauges of a vehicle over its days.
fn health(v: &VehicleAnswer) -> Section {
    let x: Vec<f64> = (1..=v.days.len()).map(|i| i as f64).collect();
    let plain =
        |list: &[Option<f64>]| -> Vec<f64> { list.iter().map(|v| v.unwrap_or(f64::NAN)).collect() };
    let groups: Vec<(String, [Vec<f64>; 1])> = v
        .gauges
        .iter()
        .map(|g| (g.name.clone(), [plain(&g.mean)]))
        .collect();
    let drawn: Vec<(String, Vec<Line>)> = groups
        .iter()
        .map(|(name, [y])| {
            (
                name.clone(),
                vec![Line {
                    name: "mean",
                    x: &x,
                    y,
                }],
            )
        })
        .collect();
    let head = [
        "gauge",
        "dead on",
        "mean first, µε",
        "mean last, µε",
        "noise, µε",
        "gain against the others, first",
        "last",
    ];
    let ends = |list: &[Option<f64>]| {
        let of = |x: Option<Option<f64>>| x.flatten().map_or(String::new(), number);
        (of(list.first().copied()), of(list.last().copied()))
    };
    let rows: Vec<Vec<String>> = v
        .gauges
        .iter()
        .map(|g| {
            let ((m0, m1), (n0, _), (g0, g1)) = (ends(&g.mean), ends(&g.noise), ends(&g.gain));
            let dead = match g.dead_days.as_slice() {
                [] => String::new(),
                [one] => one.clone(),
                [first, rest @ ..] => format!("{first} and {} more", rest.len()),
            };
            vec![g.name.clone(), dead, m0, m1, n0, g0, g1]
        })
        .collect();
    let mut blocks = vec![Block::table(&head, rows)];
    if x.len() > 1 && !drawn.is_empty() {
        blocks.push(Block::Figure(lines(
            &drawn,
            "day",
            "mean reading, µε",
            Scale::Linear,
        )));
    }
    Section::new(format!("Gauges of {} over its days", v.name), blocks)
}
