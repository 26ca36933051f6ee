//! `loads.bdf`: recovered loads as bulk data, in the job's units.
//!
//! Every load is a FORCE or MOMENT of 1 in a separate set. A run is a LOAD that adds these sets. A history is a TLOAD1 and a TABLED1 for each load,
//! and one DLOAD for all loads.

use super::tables::LoadsFile;
use crate::host::fault::Faults;
use crate::host::output::Output;
use crate::job::{JobLoad, LoadActs};
use crate::model::Model;
use crate::strain_chain::LoadUnits;
use crate::workflow::cases::{dynamic_ids, load_card, load_ids};
use crate::workflow::recover::{RecordHead, RecoveredLoads, RecoveredRuns, Samples};
use nastran::bdf::{Field, format_card};
use nastran::cards::Force;
use std::io::Write;

const NAME: &str = "loads.bdf";
/// Number of the first set if no deck shows which numbers are taken.
const FIRST_SET: u32 = 1001;
/// Samples read at a time.
pub(super) const PIECE: usize = 16_384;

/// Load and the set that contains it with size 1.
struct Unit {
    /// Column of the recovered loads.
    column: usize,
    set: u32,
}

/// Returns the cards of size 1 of each load, the loads of these cards, and the next free set. Loads without a place in the job are left out.
fn unit_sets(recovered: &RecoveredLoads, names: &[String]) -> (String, Vec<Unit>, u32) {
    let fields = recovered.prepared.fields.as_ref();
    let deck = fields.map(|f| &f.deck.deck);
    let model = fields.map(|f| &f.deck.model);
    let taken = deck.and_then(|d| load_ids(d).into_iter().chain(dynamic_ids(d)).max());
    let mut next = taken.map_or(FIRST_SET, |last| (last + 1).max(FIRST_SET));
    let (mut text, mut units) = (String::new(), Vec::new());
    for (column, name) in names.iter().enumerate() {
        let Some(load) = recovered.job.loads.iter().find(|l| &l.name == name) else {
            continue;
        };
        text.push_str(&format!("$ {}\n", clean_text(name)));
        let set = match load.acts {
            LoadActs::Named => continue,
            LoadActs::Set(set) => set,
            LoadActs::AtGrid { .. } => {
                text.push_str(&unit_card(model, load, next));
                next += 1;
                next - 1
            }
        };
        units.push(Unit { column, set });
    }
    (text, units, next)
}

fn unit_card(model: Option<&Model>, load: &JobLoad, sid: u32) -> String {
    let LoadActs::AtGrid {
        grid,
        component,
        cid,
    } = load.acts
    else {
        return String::new();
    };
    let card = Force {
        sid,
        grid,
        cid,
        scale: 1.0,
        n: component.vector(1.0),
    };
    load_card(model, &card, component)
}

/// Text for a comment or a label.
fn clean_text(text: &str) -> String {
    text.chars()
        .filter(|c| !c.is_control() && *c != '$')
        .take(60)
        .collect()
}

fn heading(recovered: &RecoveredLoads, what: &str) -> String {
    format!(
        "$ Recovered loads of {}, units {}\n$ {what}\n",
        clean_text(&recovered.job.title),
        recovered.job.units.name()
    )
}

/// Writes the loads of every run. It writes nothing if the job states no place of a load.
///
/// # Errors
/// A file that can't be written.
pub(super) fn write_runs(
    out: &mut Output,
    recovered: &RecoveredLoads,
    runs: &RecoveredRuns,
) -> Result<(), Faults> {
    let (cards, units, mut next) = unit_sets(recovered, &runs.names);
    if units.is_empty() {
        return Ok(());
    }
    let mut case = String::from("$ For the case control of the deck:\n");
    let mut bulk = String::new();
    for (number, run) in (1..).zip(&runs.recovery.runs) {
        let values: Vec<(f64, u32)> = units
            .iter()
            .map(|u| (round_to_digits(run.estimate.values[u.column], 9), u.set))
            .collect();
        let label = clean_text(&run.estimate.run);
        if values.iter().any(|v| !v.0.is_finite()) {
            bulk.push_str(&format!("$ Run {label}: not recovered\n"));
            continue;
        }
        case.push_str(&format!(
            "$ SUBCASE {number}\n$   LABEL = {label}\n$   LOAD = {next}\n"
        ));
        let mut fields = vec![Field::from(next), Field::Real(1.0)];
        fields.extend(
            values
                .iter()
                .flat_map(|(v, set)| [Field::Real(*v), Field::from(*set)]),
        );
        bulk.push_str(&format!("$ Run {label}\n{}", format_card("LOAD", &fields)));
        next += 1;
    }
    let head = heading(recovered, "1 of each load, then one LOAD for each run");
    out.write_bytes(NAME, [head, case, cards, bulk].concat().as_bytes())?;
    Ok(())
}

/// Writes the loads of a history as tables over time.
///
/// # Errors
/// A file that can't be written.
pub(super) fn write_history(
    out: &mut Output,
    recovered: &RecoveredLoads,
    head: &RecordHead,
    loads: &LoadsFile,
) -> Result<(), Faults> {
    let (cards, units, next) = unit_sets(recovered, &head.names);
    if units.is_empty() || loads.header.samples == 0 {
        return Ok(());
    }
    let n = units.len() as u32;
    // Tables have separate ids. Using one number for TLOAD1 and its table makes the deck easy to follow.
    let (first, all) = (next, next + n);
    let mut text = heading(
        recovered,
        &format!("1 of each load, its history as a table, DLOAD = {all} for all of them"),
    );
    text.push_str(&cards);
    let mut fields = vec![Field::from(all), Field::Real(1.0)];
    for (id, unit) in (first..).zip(&units) {
        let card = [
            Field::from(id),
            Field::from(unit.set),
            Field::Blank,
            Field::Blank,
            Field::from(id),
        ];
        text.push_str(&format_card("TLOAD1", &card));
        fields.extend([Field::Real(1.0), Field::from(id)]);
    }
    text.push_str(&format_card("DLOAD", &fields));
    out.write(NAME, |w| {
        w.write_all(text.as_bytes())?;
        for (id, unit) in (first..).zip(&units) {
            table(w, loads, id, unit.column, &head.units[unit.column])?;
        }
        Ok(())
    })?;
    Ok(())
}

/// TABLED1 of one load: time in s, the load in the job's unit; a gap is left to the straight line across it.
fn table(
    w: &mut dyn Write,
    loads: &LoadsFile,
    id: u32,
    column: usize,
    unit: &LoadUnits,
) -> std::io::Result<()> {
    let h = &loads.header;
    let mut fields = vec![Field::from(id)];
    fields.resize(8, Field::Blank);
    let mut values = Vec::new();
    for from in (0..h.samples).step_by(PIECE) {
        values.clear();
        let to = (from + PIECE).min(h.samples);
        loads.read(from, to, &[column], &mut values);
        for (i, v) in (from..).zip(&values).filter(|(_, v)| v.is_finite()) {
            let time = round_to_digits(h.t0 + h.dt * i as f64, 10);
            fields.extend([
                Field::Real(time),
                Field::Real(round_to_digits(v / unit.factor, 7)),
            ]);
        }
    }
    fields.push(Field::from("ENDT"));
    w.write_all(format_card("TABLED1", &fields).as_bytes())
}

/// The number with so many significant digits; the 32-bit reals of `loads.bin` hold 7.
fn round_to_digits(x: f64, digits: usize) -> f64 {
    format!("{x:.*e}", digits - 1).parse().unwrap_or(x)
}
