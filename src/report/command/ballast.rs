//! Report files and console output of `ballast`.

use super::{Report, write_page};
use crate::estimate::NORMAL_95;
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::report::console::{Console, ConsoleTable};
use crate::report::csv_cell;
use crate::report::figure::gap_by_channel;
use crate::report::page::{KeyNumber, Page, figure_section, table_section};
use crate::units::{number, plus_minus};
use crate::workflow::ballast::{BallastAnswer, HungMass, Reaction};

/// Columns of masses.csv.
const MASSES: [&str; 9] = [
    "mass",
    "mass.low",
    "mass.high",
    "along",
    "along.low",
    "along.high",
    "across",
    "across.low",
    "across.high",
];

impl Report for Outcome<BallastAnswer> {
    const FILES: &'static [&'static str] =
        &["result.json", "report.html", "reactions.csv", "masses.csv"];

    fn write(&self, out: &mut Output) -> Result<(), Faults> {
        let units = &self.job.report_units;
        let (force, mass, length) = (units.force.name, units.mass.name, units.length.name);
        out.declare(
            "reactions.csv",
            [
                ("name", ""),
                ("measured", force),
                ("before", force),
                ("after", force),
            ],
        );
        out.write("reactions.csv", |w| {
            writeln!(w, "name,measured,before,after")?;
            for r in &self.reactions {
                let name = csv_cell(&r.name);
                writeln!(w, "{name},{},{},{}", r.measured, r.before, r.after)?;
            }
            Ok(())
        })?;
        let unit = |c: &str| if c.starts_with("mass") { mass } else { length };
        out.declare("masses.csv", MASSES.map(|c| (c, unit(c))));
        out.write("masses.csv", |w| {
            writeln!(w, "{}", MASSES.join(","))?;
            for m in &self.masses {
                let line: Vec<String> = numbers(m).iter().map(f64::to_string).collect();
                writeln!(w, "{}", line.join(","))?;
            }
            Ok(())
        })?;
        let folder = out.folder().to_owned();
        for (name, bytes) in self.deck.files(&folder) {
            out.write_bytes(&name, &bytes)?;
        }
        write_page(out, self)
    }

    fn page(&self) -> Option<Page> {
        Some(page(self))
    }

    fn key_numbers(&self) -> Vec<KeyNumber> {
        let units = &self.job.report_units;
        let half = NORMAL_95 * self.together.mass_sigma;
        let off = self.reactions.iter().map(|r| (r.after - r.measured).abs());
        vec![
            KeyNumber::new(
                format!(
                    "{} {}",
                    plus_minus(self.together.mass, half),
                    units.mass.name
                ),
                "mass added, all masses together",
            ),
            KeyNumber::new(self.masses.len().to_string(), "lumped masses"),
            KeyNumber::new(
                format!("{} {}", number(off.fold(0.0, f64::max)), units.force.name),
                "largest remaining difference of a reaction",
            ),
            KeyNumber::new(
                format!("{} of {}", self.numbers_fixed, self.numbers_asked),
                "numbers of the masses that the reactions determine",
            ),
        ]
    }

    fn console(&self) -> Console {
        let force = self.job.report_units.force.name;
        let row = |r: &Reaction| {
            let numbers = [r.measured, r.before, r.after].map(number);
            std::iter::once(r.name.clone()).chain(numbers).collect()
        };
        let table = ConsoleTable::new(
            format!("Reactions of run {}, {force}", self.run),
            &["wheel", "measured", "deck", "completed deck"],
            self.reactions.iter().map(row).collect(),
        );
        Console::new(table, Some("reactions.csv")).next(format!(
            "name `{}` as [model] deck of the job",
            self.completed_deck
        ))
    }
}

/// The numbers of a mass in the order of [`MASSES`].
fn numbers(m: &HungMass) -> [f64; 9] {
    let [along, across] = m.position_range;
    [
        m.mass,
        m.mass_range[0],
        m.mass_range[1],
        m.position[0],
        along[0],
        along[1],
        m.position[1],
        across[0],
        across[1],
    ]
}

fn page(found: &Outcome<BallastAnswer>) -> Page {
    let units = &found.job.report_units;
    let reactions: Vec<Vec<String>> = found
        .reactions
        .iter()
        .map(|r| {
            vec![
                r.name.clone(),
                number(r.measured),
                number(r.before),
                number(r.after),
                format!("{:+.2} %", 100.0 * (r.after / r.measured - 1.0)),
            ]
        })
        .collect();
    let masses: Vec<Vec<String>> = found
        .masses
        .iter()
        .enumerate()
        .map(|(k, m)| {
            let n = numbers(m);
            let range = |a: usize| format!("{} to {}", number(n[a]), number(n[a + 1]));
            vec![
                (k + 1).to_string(),
                number(n[0]),
                range(1),
                number(n[3]),
                range(4),
                number(n[6]),
                range(7),
            ]
        })
        .collect();
    let (mass, length) = (units.mass.name, units.length.name);
    let head = [
        "mass".to_owned(),
        format!("size, {mass}"),
        format!("95 %, {mass}"),
        format!("along, {length}"),
        format!("95 %, {length}"),
        format!("across, {length}"),
        format!("95 %, {length}"),
    ];
    let mut sections = vec![
        table_section(
            &format!("Reactions, {}", units.force.name),
            &["wheel", "measured", "before", "after", "off"],
            &reactions,
            "After: the completed deck, read back and solved.",
        ),
        table_section(
            "Masses",
            &head.each_ref().map(String::as_str),
            &masses,
            &format!(
                "Ranges: possible values of one number if the other numbers are adjusted. Height {} (no influence on a level floor).",
                number(found.height)
            ),
        ),
    ];
    let gap = |r: &Reaction| {
        let gaps = [r.before, r.after].map(|v| (v - r.measured).abs());
        (r.name.clone(), [gaps[0], gaps[1], f64::NAN])
    };
    let gaps: Vec<(String, [f64; 3])> = found.reactions.iter().map(gap).collect();
    sections.push(figure_section(
        "Reactions before and after",
        gap_by_channel(
            &gaps,
            &format!("{}, difference from measured", units.force.name),
        ),
        "Before: the deck as given. After: the completed deck.",
    ));
    let title = &found.job.title;
    Page::new(
        title,
        "Masses that complete the model",
        &found.findings,
        sections,
    )
}
