//! Report files and console output of `identify`.

use super::columns::declare_written;
use super::{Report, write_page};
use crate::estimate::NORMAL_95;
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::report::console::{Console, ConsoleTable};
use crate::report::page::{KeyNumber, Page};
use crate::report::vehicle::{
    Curve, Curves, identify_page, restoring_curves, restoring_unit, write_chassis_forces,
    write_parameters, write_restoring_force, write_wheel_forces,
};
use crate::series::welch::cross_spectra;
use crate::units::{number, percent, plus_minus};
use crate::vehicle::identify::Estimate;
use crate::vehicle::loads::LoadHistory;
use crate::vehicle::motion::Motion;
use crate::vehicle::term::UnitNames;
use crate::workflow::identify::IdentifiedParameters;

impl Report for Outcome<IdentifiedParameters> {
    const FILES: &'static [&'static str] = &[
        "result.json",
        "report.html",
        "parameters.csv",
        "loads.csv",
        "restoring_force.csv",
    ];

    fn write(&self, out: &mut Output) -> Result<(), Faults> {
        let (found, fitted) = (&self.found, &self.fitted);
        let mut write = |name: &str, text: String| out.write_bytes(name, text.as_bytes());
        write("parameters.csv", write_parameters(found))?;
        write(
            "loads.csv",
            write_wheel_forces(found, &fitted.loads, &fitted.motion),
        )?;
        if let Some(held) = &self.held_out {
            let text = write_wheel_forces(found, &held.loads, &held.motion);
            write("loads_hold_out.csv", text)?;
        }
        let text = write_restoring_force(found, &fitted.motion);
        write("restoring_force.csv", text)?;
        if !self.forces.is_empty() {
            let leaves = self.job.vehicle.as_ref().map(|v| v.leaf.clone());
            let leaves = leaves.unwrap_or_default();
            let text = write_chassis_forces(&self.forces, &leaves, &fitted.motion);
            write("chassis_forces.csv", text)?;
        }
        declare(out, &UnitNames::from_system(self.job.units))?;
        write_page(out, self)
    }

    fn page(&self) -> Option<Page> {
        let found = &self.found;
        let shown = self.held_out.as_ref().unwrap_or(&self.fitted);
        let page = identify_page(
            &self.job.title,
            &UnitNames::from_system(self.job.units),
            found,
            &self.findings,
            &Curves {
                histories: history_curves(&shown.loads, &shown.motion),
                spectra: spectrum_curves(&shown.loads, &shown.motion),
                restoring: restoring_curves(found, &shown.motion),
                band_hz: self.band_hz,
            },
            &self.forces,
        );
        Some(page)
    }

    fn key_numbers(&self) -> Vec<KeyNumber> {
        let asked = || self.parameters.iter().filter(|p| !p.known);
        let found = asked().filter(|p| p.identifiable).count();
        let mut numbers = vec![KeyNumber::new(
            format!("{found} of {}", asked().count()),
            "parameters identified",
        )];
        let worst = self
            .fit
            .iter()
            .max_by(|a, b| a.relative_rms.total_cmp(&b.relative_rms));
        numbers.extend(worst.map(|f| {
            let floor = f.floor.map_or_else(String::new, |v| {
                format!(", expected from noise {}", percent(v))
            });
            KeyNumber::new(
                percent(f.relative_rms),
                format!("largest residual: {} ({}){floor}", f.channel, f.on),
            )
        }));
        numbers.extend(
            self.mass_closure
                .map(|r| KeyNumber::new(number(r), "identified over weighed mass")),
        );
        let [low, high] = self.band_hz;
        numbers.push(KeyNumber::new(
            format!("{} to {} Hz", number(low), number(high)),
            "band of the equations",
        ));
        numbers
    }

    fn console(&self) -> Console {
        let row = |p: &Estimate| {
            let value = match (p.value, p.sigma) {
                (Some(v), Some(_)) if p.known => number(v) + " (known)",
                (Some(v), Some(s)) => plus_minus(v, NORMAL_95 * s),
                _ => "not identifiable".to_owned(),
            };
            vec![p.name.clone(), value, p.unit.clone()]
        };
        let table = ConsoleTable::new(
            "Parameters (± half width of the 95 % interval)",
            &["parameter", "value", "unit"],
            self.parameters.iter().map(row).collect(),
        );
        Console::new(table, Some("parameters.csv")).next(format!(
            "add [reconcile] path = \"dynamic\" to {}, then run `strainbridge reconcile` on it to test the vehicle model",
            self.job.file
        ))
    }
}

/// States the units of the tables; forces are about their means.
fn declare(out: &mut Output, units: &UnitNames) -> Result<(), Faults> {
    declare_written(out, "parameters.csv", |c| match c {
        "name" | "unit" | "identifiable" => String::new(),
        _ => "unit of column unit".to_owned(),
    })?;
    let by_time = |c: &str| match c {
        "time" => "s".to_owned(),
        _ => units.force.clone(),
    };
    for table in ["loads.csv", "loads_hold_out.csv", "chassis_forces.csv"] {
        if out.holds(table) {
            declare_written(out, table, by_time)?;
        }
    }
    let restoring = |c: &str| restoring_unit(c, units);
    Ok(declare_written(out, "restoring_force.csv", restoring)?)
}

/// Seconds of wheel force that the page shows.
const SHOWN_S: f64 = 8.0;

fn loads_with_values(history: &LoadHistory) -> impl Iterator<Item = usize> + '_ {
    (0..history.names.len()).filter(|&i| history.values[i].iter().any(|v| v.is_finite()))
}

fn history_curves(history: &LoadHistory, motion: &Motion) -> Vec<Curve> {
    let n = ((SHOWN_S * history.rate_hz) as usize).min(motion.n_samples());
    let cut = |x: &[f64]| x.iter().take(n).copied().collect::<Vec<f64>>();
    loads_with_values(history)
        .map(|i| Curve {
            name: history.names[i].clone(),
            x: (0..n)
                .map(|t| history.start_s + t as f64 / history.rate_hz)
                .collect(),
            recovered: cut(&history.values[i]),
            measured: motion.forces[i].as_deref().map_or(vec![], cut),
        })
        .collect()
}

fn spectrum_curves(history: &LoadHistory, motion: &Motion) -> Vec<Curve> {
    let segment = (4.0 * history.rate_hz) as usize;
    loads_with_values(history)
        .map(|i| {
            let measured = motion.forces[i].as_ref();
            let s = cross_spectra(
                &history.values[i],
                measured.unwrap_or(&history.values[i]),
                history.rate_hz,
                segment,
            );
            let measured = measured.map_or(vec![], |_| s.yy);
            Curve {
                name: history.names[i].clone(),
                x: s.f_hz,
                recovered: s.xx,
                measured,
            }
        })
        .collect()
}
