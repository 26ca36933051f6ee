//! Report files and console output of `fleet`.

use super::fleet_page::page;
use super::{Report, write_page};
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::report::console::{Console, ConsoleTable};
use crate::report::csv_cell;
use crate::report::page::{KeyNumber, Page};
use crate::series::rainflow::Ratio;
use crate::units::{number, plus_minus};
use crate::workflow::fleet::{Fleet, MissionAnswer, VehicleAnswer, VehicleLoadAnswer};
use std::fmt::Write;

impl Report for Outcome<Fleet> {
    const FILES: &'static [&'static str] = &[
        "result.json",
        "report.html",
        "fleet.csv",
        "fleet_files.csv",
        "rainflow.csv",
        "levels.csv",
        "from_to.csv",
    ];

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
        if self
            .rows()
            .any(|(_, l)| l.to_reference.is_some() || l.to_target.is_some())
        {
            out.declare("fleet_relative.csv", RELATIVE.map(|(c, u)| unit(c, u)));
            out.write_bytes("fleet_relative.csv", relative_damage_csv(self).as_bytes())?;
        }
        if let Some(m) = &self.mission {
            out.declare("fleet_mission.csv", MISSION.map(|(c, u)| unit(c, u)));
            out.write_bytes("fleet_mission.csv", mission(m).as_bytes())?;
        }
        #[cfg(feature = "parquet")]
        out.write_bytes("fleet.parquet", &super::fleet_parquet::bytes(self)?)?;
        write_page(out, self)
    }

    fn page(&self) -> Option<Page> {
        Some(page(self))
    }

    fn key_numbers(&self) -> Vec<KeyNumber> {
        let hours: f64 = self.vehicles.iter().map(|v| v.hours).sum();
        let done = self.files.iter().filter(|f| f.status == "done").count();
        let mut numbers = vec![
            KeyNumber::new(self.vehicles.len().to_string(), "vehicles"),
            KeyNumber::new(format!("{} h", number(hours)), "recorded"),
            KeyNumber::new(format!("{done} of {}", self.files.len()), "files counted"),
        ];
        let worst = self
            .rows()
            .max_by(|a, b| a.1.relative.total_cmp(&b.1.relative));
        numbers.extend(worst.map(|(v, l)| {
            let meaning = format!(
                "damage per hour, ratio to all vehicles, largest: {} {}",
                v.name, l.load
            );
            KeyNumber::new(format!("{} times", number(l.relative)), meaning)
        }));
        numbers
    }

    /// Returns a row for each load of each vehicle, the largest damage against the mean of the fleet first.
    fn result_table(&self) -> ConsoleTable {
        let mut rows: Vec<(&VehicleAnswer, &VehicleLoadAnswer)> = self.rows().collect();
        rows.sort_by(|a, b| b.1.relative.total_cmp(&a.1.relative));
        let row = |(v, l): &(&VehicleAnswer, &VehicleLoadAnswer)| {
            let half = 0.5 * (l.damage_high - l.damage_low) * l.relative / l.damage;
            let [min, max] = [l.min, l.max].map(|v| number(v.unwrap_or(f64::NAN)));
            let load = format!("{}, {}", l.load, l.unit);
            vec![v.name.clone(), load, plus_minus(l.relative, half), min, max]
        };
        ConsoleTable::new(
            "Damage per hour, mean of the fleet = 1 (± half width of the 95 % interval), and extremes",
            &["vehicle", "load", "damage", "smallest", "largest"],
            rows.iter().map(row).collect(),
        )
    }

    fn console(&self) -> Console {
        let row = |(v, l): (&VehicleAnswer, &VehicleLoadAnswer)| {
            let ends = [l.min, l.max].map(|v| number(v.unwrap_or(f64::NAN)));
            let [min, max] = ends;
            let damage = [l.damage, l.damage_low, l.damage_high].map(number);
            let [damage, low, high] = damage;
            let doubtful = match l.doubtful_share {
                share if share > 0.0 => format!("{:.1} %", 100.0 * share),
                _ => String::new(),
            };
            let unit = l.unit.clone();
            let words = [v.name.clone(), l.load.clone(), min, max, unit];
            let damage = [damage, format!("{low} to {high}"), doubtful];
            words.into_iter().chain(damage).collect::<Vec<String>>()
        };
        let mut rows: Vec<Vec<String>> = self.rows().map(row).collect();
        let head = [
            "vehicle",
            "load",
            "smallest",
            "largest",
            "unit",
            "damage",
            "95 % interval",
            "unreliable",
        ];
        // The column `unreliable` is left out if it is empty, as in most fleets.
        let shown = match rows.iter().all(|r| r.last().is_none_or(String::is_empty)) {
            true => head.len() - 1,
            false => head.len(),
        };
        rows.iter_mut().for_each(|r| r.truncate(shown));
        let title = format!("Loads and pseudo-damage, slope {}", self.slope);
        let table = ConsoleTable::new(title, head.get(..shown).unwrap_or(&head), rows);
        Console::new(table, Some("fleet.csv"))
            .next("run the same command with further records: it reads only the new records")
    }
}

/// Returns a number for a table, with enough digits to read back the same number; empty for a number that is not finite.
fn cell(x: f64) -> String {
    if x.is_finite() {
        format!("{x:e}")
    } else {
        String::new()
    }
}

fn table(fleet: &Fleet) -> String {
    let mut text = "vehicle,files,hours,load,max,min,damage,damage_low,damage_high\n".to_owned();
    for (v, l) in fleet.rows() {
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
            cell(l.hours),
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
    for (v, l) in fleet.rows() {
        for (apart, cycles) in &l.range_pairs {
            // Two values whose classes are `apart` classes apart differ by `apart - 1` to `apart + 1` class widths.
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
    for (v, l) in fleet.rows() {
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
    for (v, l) in fleet.rows() {
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

const RELATIVE: [(&str, &str); 8] = [
    ("vehicle", ""),
    ("load", ""),
    ("to_reference", ""),
    ("to_reference_low", ""),
    ("to_reference_high", ""),
    ("to_target", ""),
    ("to_target_low", ""),
    ("to_target_high", ""),
];

fn relative_damage_csv(fleet: &Fleet) -> String {
    let mut text = RELATIVE.map(|f| f.0).join(",") + "\n";
    let cells = |r: Option<Ratio>| {
        let ends = r.map_or([f64::NAN; 3], |r| [r.value, r.low, r.high]);
        ends.map(cell).join(",")
    };
    for (v, l) in fleet.rows() {
        let _ = writeln!(
            text,
            "{},{},{},{}",
            csv_cell(&v.name),
            csv_cell(&l.load),
            cells(l.to_reference),
            cells(l.to_target)
        );
    }
    text
}

const MISSION: [(&str, &str); 6] = [
    ("load", ""),
    ("hours", "h"),
    ("damage", "report unit to the power of the slope"),
    ("damage_low", "report unit to the power of the slope"),
    ("damage_high", "report unit to the power of the slope"),
    (
        "between_days_at_most",
        "report unit to the power of the slope",
    ),
];

fn mission(m: &MissionAnswer) -> String {
    let mut text = MISSION.map(|f| f.0).join(",") + "\n";
    for l in &m.loads {
        let numbers = [
            m.hours,
            l.damage,
            l.damage_low,
            l.damage_high,
            l.between_days_at_most,
        ];
        let _ = writeln!(
            text,
            "{},{}",
            csv_cell(&l.load),
            numbers.map(cell).join(",")
        );
    }
    text
}
