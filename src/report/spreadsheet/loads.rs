//! Recovered loads: a row a run, or a row a load of a history.

use super::book::{Cell, Sheet};
use crate::report::strain::RecoveredRun;

/// One load of a history, report unit.
#[derive(Clone, Debug, PartialEq)]
pub struct HistoryLoad {
    /// Name.
    pub name: String,
    /// Report unit; empty for a load set.
    pub unit: String,
    /// Smallest sample.
    pub min: f64,
    /// Mean.
    pub mean: f64,
    /// Largest sample.
    pub max: f64,
    /// Root mean square.
    pub rms: f64,
    /// One standard deviation of a sample at the root mean square of all loads.
    pub sigma: f64,
}

/// Returns the sheet `Loads` with a row for each run: value and 95 % interval of each load.
pub fn runs_sheet(runs: &[RecoveredRun]) -> Sheet {
    let mut columns = vec!["run".to_owned()];
    for (name, _, unit) in runs.first().map_or(&[][..], |r| &r.loads) {
        let with_unit = |what: &str| {
            if unit.is_empty() {
                format!("{name}{what}")
            } else {
                format!("{name}{what}, {unit}")
            }
        };
        columns.extend(["", " low", " high"].map(with_unit));
    }
    let rows = runs.iter().map(|r| {
        let mut row = vec![Cell::from(r.run.clone())];
        for (_, [low, value, high], _) in &r.loads {
            row.extend([*value, *low, *high].map(Cell::from));
        }
        row
    });
    Sheet {
        name: "Loads".to_owned(),
        columns,
        rows: rows.collect(),
    }
}

/// Returns the sheet `Loads` of a history, with a row for each load.
pub fn history_sheet(loads: &[HistoryLoad]) -> Sheet {
    let mut sheet = Sheet::new(
        "Loads",
        &["load", "unit", "min", "mean", "max", "rms", "sigma"],
    );
    sheet.rows = loads
        .iter()
        .map(|l| {
            let mut row: Vec<Cell> = vec![l.name.clone().into(), l.unit.clone().into()];
            row.extend([l.min, l.mean, l.max, l.rms, l.sigma].map(Cell::from));
            row
        })
        .collect();
    sheet
}

/// Returns the sheet `Gauges` with residual (microstrain rms) and leverage of each gauge.
pub fn residual_sheet(gauges: &[(String, f64, f64)]) -> Sheet {
    let mut sheet = Sheet::new(
        "Gauges",
        &["gauge", "residual, microstrain rms", "leverage"],
    );
    sheet.rows = gauges
        .iter()
        .map(|(name, residual, leverage)| {
            vec![
                name.clone().into(),
                Cell::from(*residual),
                Cell::from(*leverage),
            ]
        })
        .collect();
    sheet
}
