//! Histories as CSV and the envelope as arrays by element.

use crate::estimate::NORMAL_95;
use crate::model::Model;
use crate::respond::{LoadState, Peak, Place, ResponseRow, von_mises_history};
use std::io::Write;

/// Places whose histories are written.
const MOST_HISTORIES: usize = 40;

/// Writes a table with a row for each state: strain (microstrain), stress, and von Mises stress with its 95 % interval, at every listed place.
pub(super) fn histories(
    w: &mut dyn Write,
    rows: &[ResponseRow],
    order: &[usize],
    states: &[LoadState],
    u: f64,
) -> std::io::Result<()> {
    let list: Vec<&ResponseRow> = order
        .iter()
        .take(MOST_HISTORIES)
        .map(|i| &rows[*i])
        .collect();
    write!(w, "state")?;
    for r in &list {
        let place = format!("{}.{}", r.element, r.surface_word().replace(' ', "."));
        for c in [
            "exx",
            "eyy",
            "gxy",
            "sxx",
            "syy",
            "sxy",
            "von_mises",
            "von_mises.low",
            "von_mises.high",
        ] {
            write!(w, ",{place}.{c}")?;
        }
    }
    writeln!(w)?;
    let columns: Vec<Vec<([f64; 3], f64, f64)>> =
        list.iter().map(|r| von_mises_history(r, states)).collect();
    for (i, state) in states.iter().enumerate() {
        write!(w, "{}", state.label)?;
        for (row, column) in list.iter().zip(&columns) {
            let mut strain = [0.0; 3];
            for (e, f) in row.strain.iter().zip(&state.values) {
                strain
                    .iter_mut()
                    .zip(e)
                    .for_each(|(s, e)| *s += e * f * 1e6);
            }
            let (stress, v, sigma) = column[i];
            for x in strain {
                write!(w, ",{x}")?;
            }
            for x in stress {
                write!(w, ",{}", x * u)?;
            }
            let half = NORMAL_95 * sigma;
            write!(
                w,
                ",{},{},{}",
                v * u,
                (v - half).max(0.0) * u,
                (v + half) * u
            )?;
        }
        writeln!(w)?;
    }
    Ok(())
}

/// Returns the envelope by element for ParaView: the largest von Mises stress on the bottom and the top (for bars anywhere), its sd, and its state.
pub(super) fn arrays(
    model: &Model,
    rows: &[ResponseRow],
    peaks: &[Peak],
    u: f64,
    unit: &str,
) -> Vec<(String, Vec<f64>, Vec<f64>)> {
    let blank = || {
        (
            vec![f64::NAN; model.shells.len()],
            vec![f64::NAN; model.beams.len()],
        )
    };
    let (mut bottom, mut top, mut sigma, mut state) = (blank(), blank(), blank(), blank());
    let mut most = blank();
    for (r, p) in rows.iter().zip(peaks) {
        let v = p.von_mises * u;
        let put = |slot: Option<&mut f64>, v: f64| {
            if let Some(s) = slot {
                *s = v;
            }
        };
        let larger = |slot: Option<&f64>| slot.is_none_or(|s| s.is_nan() || v > *s);
        match r.place {
            Place::Shell { shell, surface } => {
                let side = if surface.ix() == 0 {
                    &mut bottom.0
                } else {
                    &mut top.0
                };
                put(side.get_mut(shell.us()), v);
                if larger(most.0.get(shell.us())) {
                    put(most.0.get_mut(shell.us()), v);
                    put(sigma.0.get_mut(shell.us()), p.sigma * u);
                    put(state.0.get_mut(shell.us()), p.at as f64);
                }
            }
            Place::Beam { beam, .. } => {
                if larger(most.1.get(beam.us())) {
                    put(most.1.get_mut(beam.us()), v);
                    put(sigma.1.get_mut(beam.us()), p.sigma * u);
                    put(state.1.get_mut(beam.us()), p.at as f64);
                }
            }
        }
    }
    [
        (format!("largest von Mises, {unit}"), most),
        (format!("largest von Mises bottom, {unit}"), bottom),
        (format!("largest von Mises top, {unit}"), top),
        (format!("its standard deviation, {unit}"), sigma),
        (
            "state of the largest (row of the loads, from 0)".to_owned(),
            state,
        ),
    ]
    .into_iter()
    .map(|(name, (shells, beams))| (name, shells, beams))
    .collect()
}
