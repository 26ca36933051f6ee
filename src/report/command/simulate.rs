//! Report files and console output of `simulate`.

use super::{Report, write_page};
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::report::console::{Console, ConsoleTable};
use crate::report::csv_cell;
use crate::report::figure::{Line, Scale, lines};
use crate::report::page::{Block, KeyNumber, Page, Section, table_section};
use crate::units::{number, percent};
use crate::workflow::simulate::{ChannelRange, Column, SimulatedResponse, UsedParameter};

/// Seconds that the page shows.
const SHOWN_S: f64 = 10.0;

impl Report for Outcome<SimulatedResponse> {
    const FILES: &'static [&'static str] = &["result.json", "report.html", "response.csv"];

    fn write(&self, out: &mut Output) -> Result<(), Faults> {
        let header = |c: &Column| (format!("{} [{}]", c.name, c.unit), c.unit.clone());
        let mut columns = vec![("time [s]".to_owned(), "s".to_owned())];
        columns.extend(self.columns.iter().map(header));
        out.write("response.csv", |w| {
            let names: Vec<String> = columns
                .iter()
                .map(|c| csv_cell(&c.0).into_owned())
                .collect();
            writeln!(w, "{}", names.join(","))?;
            for i in 0..self.samples {
                write!(w, "{:.6}", self.start_s + i as f64 / self.sample_rate_hz)?;
                for column in &self.columns {
                    write!(w, ",{:.9e}", column.values[i])?;
                }
                writeln!(w)?;
            }
            Ok(())
        })?;
        out.declare("response.csv", columns);
        write_page(out, self)
    }

    fn page(&self) -> Option<Page> {
        let shown = ((SHOWN_S * self.sample_rate_hz) as usize).min(self.samples);
        let time: Vec<f64> = (0..shown)
            .map(|i| self.start_s + i as f64 / self.sample_rate_hz)
            .collect();
        let mut kinds: Vec<(&str, &str)> = Vec::new();
        for column in &self.columns {
            let kind = (column.kind, column.unit.as_str());
            if !kinds.contains(&kind) {
                kinds.push(kind);
            }
        }
        let mut sections = vec![table_section(
            "Response",
            &["channel", "unit", "smallest", "largest", "RMS"],
            &self.response.iter().map(range_row).collect::<Vec<_>>(),
            "Motions and forces are about the position at rest. Forces of springs and dampers are positive in tension, wheel forces upwards.",
        )];
        for (kind, unit) in kinds {
            let of_kind = self
                .columns
                .iter()
                .filter(|c| (c.kind, c.unit.as_str()) == (kind, unit));
            let groups: Vec<(String, Vec<Line>)> = of_kind
                .map(|c| {
                    let y = &c.values[..shown];
                    (
                        c.name.clone(),
                        vec![Line {
                            name: "simulated",
                            x: &time,
                            y,
                        }],
                    )
                })
                .collect();
            let span = match shown < self.samples {
                true => format!("over the first {} s", number(SHOWN_S)),
                false => "over the whole record".to_owned(),
            };
            let caption = format!("Simulated {kind} {span}.");
            let label = format!("{kind}, {unit}");
            let figure = lines(&groups, "time, s", &label, Scale::Linear, &caption);
            sections.push(Section::new(capitalise(kind), vec![Block::Figure(figure)]));
        }
        sections.push(table_section(
            "Parameters",
            &["parameter", "value", "unit"],
            &self
                .parameters
                .iter()
                .map(parameter_row)
                .collect::<Vec<_>>(),
            &format!("Integration: {}.", self.integration),
        ));
        let about = "Response of a vehicle with known parameters";
        Some(Page::new(&self.job.title, about, &self.findings, sections))
    }

    fn key_numbers(&self) -> Vec<KeyNumber> {
        let seconds = self.samples as f64 / self.sample_rate_hz;
        let step = match self.step_error > 0.0 {
            true => percent(self.step_error),
            false => "exact".to_owned(),
        };
        vec![
            KeyNumber::new(format!("{} s", number(seconds)), "simulated"),
            KeyNumber::new(
                format!("{} Hz", number(self.fastest_mode_hz)),
                "fastest mode",
            ),
            KeyNumber::new(step, "error of the time steps"),
        ]
    }

    fn console(&self) -> Console {
        let table = ConsoleTable::new(
            "Response",
            &["channel", "unit", "min", "max", "rms"],
            self.response.iter().map(range_row).collect(),
        );
        Console::new(table, Some("response.csv"))
    }
}

fn range_row(r: &ChannelRange) -> Vec<String> {
    vec![
        r.channel.clone(),
        r.unit.clone(),
        number(r.min),
        number(r.max),
        number(r.rms),
    ]
}

fn parameter_row(p: &UsedParameter) -> Vec<String> {
    vec![p.name.clone(), number(p.value), p.unit.clone()]
}

fn capitalise(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}
