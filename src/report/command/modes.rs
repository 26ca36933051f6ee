//! Report files and console output of `modes`.

use super::{Report, write_page};
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::host::words::count_of;
use crate::report::console::{Console, ConsoleTable};
use crate::report::csv_cell;
use crate::report::mode_blocks::rows_of_mode_block;
use crate::report::page::{Block, KeyNumber, Page, Section, number};
use crate::report::scene::{scene_of_solution, scene_section};
use crate::report::{planned_blocks, write_vtu};
use crate::vehicle::term::{Quantity, UnitNames};
use crate::workflow::modes::{ModeRow, Modes};
use nastran::op2::{EncodedBlock, Op2Writer};
use std::io::Write;

/// Quantity of a column.
#[derive(Clone, Copy)]
enum ColumnQuantity {
    Numbers,
    Hertz,
    Mass,
    Inertia,
}

impl ColumnQuantity {
    /// Returns the name of the unit in the job's units; in the deck's units if `names` is `None`.
    fn unit(self, names: Option<&UnitNames>) -> String {
        let of = |q: Quantity, otherwise: &str| names.map_or(otherwise.into(), |n| n.unit_name(q));
        match self {
            Self::Numbers => String::new(),
            Self::Hertz => "Hz".to_owned(),
            Self::Mass => of(Quantity::Mass, "deck's mass"),
            Self::Inertia => of(Quantity::Inertia, "deck's mass length2"),
        }
    }
}

/// Columns of modes.csv before the columns of the gauges, with their quantities.
const COLUMNS: [(&str, ColumnQuantity); 12] = [
    ("mode", ColumnQuantity::Numbers),
    ("hz", ColumnQuantity::Hertz),
    ("generalised_mass", ColumnQuantity::Mass),
    ("residual", ColumnQuantity::Numbers),
    ("frequency_error", ColumnQuantity::Numbers),
    ("gap", ColumnQuantity::Numbers),
    ("effective_mass_x", ColumnQuantity::Mass),
    ("effective_mass_y", ColumnQuantity::Mass),
    ("effective_mass_z", ColumnQuantity::Mass),
    ("effective_inertia_x", ColumnQuantity::Inertia),
    ("effective_inertia_y", ColumnQuantity::Inertia),
    ("effective_inertia_z", ColumnQuantity::Inertia),
];

impl Report for Outcome<Modes> {
    const FILES: &'static [&'static str] =
        &["result.json", "report.html", "modes.csv", "modes.op2"];

    fn write(&self, out: &mut Output) -> Result<(), Faults> {
        let names = self.system.map(UnitNames::from_system);
        let plain = COLUMNS.map(|(c, u)| (c.to_owned(), u.unit(names.as_ref())));
        let gauges = self.gauges.iter();
        let of_gauges = gauges.map(|g| (g.clone(), "microstrain".to_owned()));
        out.declare("modes.csv", plain.into_iter().chain(of_gauges));
        out.write("modes.csv", |w| table(self, w))?;
        out.write("modes.op2", |w| op2(self, w))?;
        let cases = &self.solution.strain.cases;
        out.write("modes.vtu", |w| write_vtu(&self.model, cases, w))?;
        write_page(out, self)
    }

    fn page(&self) -> Option<Page> {
        Some(page(self))
    }

    fn key_numbers(&self) -> Vec<KeyNumber> {
        let hz = |m: Option<&ModeRow>| m.map_or("-".to_owned(), |m| format!("{} Hz", number(m.hz)));
        let errors = self.modes.iter().map(|m| m.frequency_error);
        vec![
            KeyNumber::new(hz(self.modes.first()), "first elastic mode"),
            KeyNumber::new(
                hz(self.modes.last()),
                format!("last of {}", count_of(self.modes.len(), "mode")),
            ),
            KeyNumber::new(self.rigid_motions.to_string(), "rigid motions left out"),
            KeyNumber::new(
                format!("{:.0e}", errors.fold(0.0, f64::max)),
                "largest relative error of a frequency",
            ),
        ]
    }

    fn console(&self) -> Console {
        let row = |m: &ModeRow| {
            vec![
                m.mode.to_string(),
                number(m.hz),
                format!("{:.0e}", m.frequency_error),
            ]
        };
        let table = ConsoleTable::new(
            match self.rigid_motions {
                0 => "Elastic modes".to_owned(),
                n => format!("Elastic modes, {} left out", count_of(n, "rigid motion")),
            },
            &["mode", "Hz", "relative error"],
            self.modes.iter().map(row).collect(),
        );
        Console::new(table, Some("modes.csv")).next(
            "open modes.vtu in ParaView; with [dynamic] in a job, `strainbridge recover` subtracts this vibration",
        )
    }
}

fn table(modes: &Modes, out: &mut dyn Write) -> std::io::Result<()> {
    let mut head: Vec<String> = COLUMNS.iter().map(|c| c.0.to_owned()).collect();
    head.extend(modes.gauges.iter().map(|g| csv_cell(g).into_owned()));
    writeln!(out, "{}", head.join(","))?;
    for m in &modes.modes {
        let mut row = vec![m.mode.to_string()];
        let numbers = [
            m.hz,
            m.generalised_mass,
            m.residual,
            m.frequency_error,
            m.gap,
        ];
        let cell = |v: &f64| match v.is_finite() {
            true => v.to_string(),
            false => String::new(),
        };
        row.extend(numbers.iter().chain(&m.effective_mass).map(cell));
        let strain = m.gauge_microstrain.iter();
        row.extend(strain.map(|e| e.map_or_else(String::new, |e| e.to_string())));
        writeln!(out, "{}", row.join(","))?;
    }
    Ok(())
}

fn op2(modes: &Modes, out: &mut dyn Write) -> std::io::Result<()> {
    let mut op2 = Op2Writer::new(out, [1, 1, 2000]).map_err(std::io::Error::other)?;
    for plan in planned_blocks(&modes.model, &modes.solution.strain) {
        let (block, rows) = rows_of_mode_block(&modes.model, &modes.solution, plan);
        let encoded = EncodedBlock::new(&block, &rows).map_err(std::io::Error::other)?;
        op2.write_encoded(&encoded).map_err(std::io::Error::other)?;
    }
    op2.finish().map(|_| ()).map_err(std::io::Error::other)
}

fn page(modes: &Outcome<Modes>) -> Page {
    let share = |m: &ModeRow, i: usize| match modes.mass {
        Some(mass) if mass > 0.0 => format!("{:.1}", 100.0 * m.effective_mass[i] / mass),
        _ => String::new(),
    };
    let rows: Vec<Vec<String>> = modes
        .modes
        .iter()
        .map(|m| {
            vec![
                m.mode.to_string(),
                number(m.hz),
                format!("{:.1e}", m.frequency_error),
                number(m.gap),
                share(m, 0),
                share(m, 1),
                share(m, 2),
            ]
        })
        .collect();
    let head = [
        "mode",
        "Hz",
        "largest error, share",
        "gap",
        "mass along x, %",
        "y, %",
        "z, %",
    ];
    let text = format!(
        "The structure is {}; {} rigid motions are left out. Shapes have a generalised mass of 1.",
        modes.support, modes.rigid_motions
    );
    let cases = modes.cases();
    let mut scene = scene_of_solution(&modes.model, &cases, &modes.solution.strain);
    scene.caption = "Colour shows the strain of the shape of one mode: gauges on darker places read more vibration of this mode, which is worse.".to_owned();
    for (field, m) in scene.fields.iter_mut().zip(&modes.modes) {
        field.name = format!("mode {}, {} Hz", m.mode, number(m.hz));
    }
    let sections = vec![
        Section::new(
            "Elastic modes",
            vec![Block::Text(text), Block::table(&head, rows)],
        ),
        scene_section("Shapes and their strain", &scene),
    ];
    Page::new(&modes.title, "Elastic modes", &modes.findings, sections)
}
