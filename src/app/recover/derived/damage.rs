//! `rainflow.csv`, and `damage` of the result.

use super::{History, PIECE};
use crate::app::fault::Faults;
use crate::app::recover::Task;
use crate::app::{JobArguments, Session};
use crate::finding::{Finding, Severity};
use crate::report::csv_cell;
use crate::series::rainflow::{Cycle, Damage, Point, Rainflow};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::io::Write;

/// Counts the cycles of every load and writes both.
pub(super) fn write(
    session: &mut Session,
    arguments: &JobArguments,
    task: &Task,
    history: &History,
) -> Result<(), Faults> {
    let slope = task.job.recover.slope;
    let all: Vec<Damage> = (0..history.names.len())
        .into_par_iter()
        .map(|l| damage_of(history, l, slope))
        .collect();
    let finite = |x: f64| x.is_finite().then_some(x);
    let rows: Vec<Value> = all
        .iter()
        .enumerate()
        .map(|(l, d)| {
            let unit = &history.units[l].name;
            json!({
                "name": history.names[l],
                "unit": unit,
                "slope": slope,
                "cycles": d.cycles,
                "largest_range": d.largest,
                "damage": d.value,
                "damage_low": finite(d.low),
                "damage_high": finite(d.high),
                "one_cycle_range": d.one_cycle(d.value),
                "one_cycle_range_low": finite(d.one_cycle(d.low)),
                "one_cycle_range_high": finite(d.one_cycle(d.high)),
            })
        })
        .collect();
    session.put("damage", rows)?;
    session.findings.push(Finding::new(
            Severity::Info,
            "pseudo-damage",
            "damage",
            format!(
                "rainflow counts by ASTM E1049-85, open ranges as half cycles; pseudo-damage is the sum of cycles times range to the \
                 power {slope}, without a limit below which ranges do no harm. It compares records; it is no life. Its interval moves all \
                 ranges together by their own 95 % interval"
            ),
            "state the slope of the part's S-N curve: [recover] slope",
        ));
    session
        .output_for(&arguments.job)?
        .write("rainflow.csv", |w| table(w, history, &all))
        .map_err(Faults::from)
}

fn table(w: &mut dyn Write, history: &History, all: &[Damage]) -> std::io::Result<()> {
    writeln!(w, "load,unit,range_from,range_to,cycles,mean,damage")?;
    for (l, d) in all.iter().enumerate() {
        let width = d.limit / d.bins.len() as f64;
        for (b, bin) in d
            .bins
            .iter()
            .enumerate()
            .filter(|(_, bin)| bin.cycles > 0.0)
        {
            writeln!(
                w,
                "{},{},{:.7e},{:.7e},{},{:.7e},{:.7e}",
                csv_cell(&history.names[l]),
                history.units[l].name,
                width * b as f64,
                width * (b + 1) as f64,
                bin.cycles,
                bin.sum_of_means / bin.cycles,
                bin.damage
            )?;
        }
    }
    Ok(())
}

/// Counts one load, report unit.
fn damage_of(history: &History, l: usize, slope: f64) -> Damage {
    let [min, max] = history.extremes(l);
    let mut damage = Damage::new(slope, max - min);
    let mut ends = [Vec::new(), Vec::new()];
    let columns = history.all();
    // Its interval is that of a normal error.
    let wider = history.filter.coverage_factor() / crate::recovery::NORMAL_95;
    let mut add = |cycle: Cycle| {
        for (end, point) in ends.iter_mut().zip([cycle.from, cycle.to]) {
            end.clear();
            history.samples(point.at, point.at + 1, &columns, end);
        }
        let [from, to] = &ends;
        let change: Vec<f64> = from
            .iter()
            .zip(to)
            .zip(history.units)
            .map(|((a, b), u)| (b - a) / u.factor)
            .collect();
        let sigma = wider * history.filter.sigma_of_change(l, &change) * history.units[l].factor;
        damage.add(&cycle, sigma);
    };
    let mut count = Rainflow::default();
    let mut values = Vec::with_capacity(PIECE);
    let n = history.header.samples;
    for from in (0..n).step_by(PIECE) {
        values.clear();
        history.samples(from, (from + PIECE).min(n), &[Some(l)], &mut values);
        for (at, &value) in (from..).zip(&values) {
            count.push(Point { at, value }, &mut add);
        }
    }
    count.finish(&mut add);
    damage
}
