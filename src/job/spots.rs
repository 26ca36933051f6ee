//! Table of `[candidates] file`: named spots with fixed directions, one spot per row. It has the columns of the gauge file and `cost`.

use super::gauge_table::GaugeColumns;
use super::gauges::read_gauges;
use super::table::Table;
use super::types::{Job, JobGauge, Keep, NamedFile, NamedSpot, StatedPlace};
use crate::host::fault::{Fault, FaultList};
use crate::host::files::Inputs;
use crate::placement::Role;

/// Reads the spots of the table that `[candidates] file` names into the job. Faults are added to the list.
pub(super) fn read_spots(inputs: &mut Inputs, job: &mut Job, faults: &mut FaultList) {
    let is_table = |f: &NamedFile| !f.is_toml();
    let Some(named) = job.candidates.file.clone().filter(is_table) else {
        return;
    };
    check_placement(job, faults);
    let Some((table, columns, gauges)) = read_gauges(inputs, job, &named, faults) else {
        return;
    };
    columns.note_unread(inputs, &table);
    let spots = gauges.into_iter().map(|gauge| {
        let row = table.rows.iter().position(|r| r.0 == gauge.line);
        let row = Row {
            table: &table,
            columns: &columns,
            row: row.unwrap_or(0),
        };
        row.check_spot(job, &gauge, faults);
        let cost = row.cost(faults);
        NamedSpot { gauge, cost }
    });
    job.candidates.spots = Some(spots.collect());
}

/// Refuses keys of `[placement]` that a table of spots makes useless.
fn check_placement(job: &Job, faults: &mut FaultList) {
    let p = &job.placement;
    let stated = [
        (
            "symmetric",
            p.symmetric.is_some(),
            "delete the key: list the spots of both sides in the table",
        ),
        (
            "costs",
            !p.costs.is_empty(),
            "delete the key, and state the column `cost` of the table instead",
        ),
    ];
    for (key, _, remedy) in stated.into_iter().filter(|s| s.1) {
        let wrong = "[candidates] `file` is a table of spots: this key has no use";
        let field = format!("placement.{key}");
        faults.push(Fault::with_line(&*job.file, p.line, field, wrong, remedy));
    }
}

/// A row of the table.
struct Row<'a> {
    table: &'a Table,
    columns: &'a GaugeColumns,
    row: usize,
}

impl Row<'_> {
    fn is_blank(&self, name: &str) -> bool {
        let row = self.table.rows.get(self.row);
        let column = self.columns.column(name);
        let field = column.and_then(|c| row?.1.get(c.at));
        field.is_none_or(String::is_empty)
    }

    /// Adds a fault if the row does not state a place or a direction, or if the name is one of a gauge that stays.
    fn check_spot(&self, job: &Job, spot: &JobGauge, faults: &mut FaultList) {
        let mut fault = |field: &str, wrong: &str, remedy: &str| {
            let wrong = format!("spot `{}`: {wrong}", spot.name);
            faults.push(Fault::with_line(
                &*spot.file,
                spot.line,
                field,
                wrong,
                remedy,
            ));
        };
        let of_model = job.model.is_some();
        let is_bar = matches!(spot.place, StatedPlace::BeamPoint { .. });
        if of_model && spot.place == StatedPlace::Unstated {
            let remedy = "state `element` and `surface`, or `x`, `y`, `z`";
            fault("element", "the place is not stated", remedy);
        }
        if of_model && !is_bar && spot.direction.is_none() && self.is_blank("angle_deg") {
            let remedy = "state `dir_x`, `dir_y`, `dir_z`, or `angle_deg` from the element x axis";
            fault("dir_x", "the direction is not stated", remedy);
        }
        if spot.role == Role::Validation {
            let wrong = "a spot is not a validation gauge before it is chosen";
            let remedy = "delete `validation`, and state [placement] `reserve`, the number of validation gauges";
            fault("role", wrong, remedy);
        }
        let stays = |name: &String| match &job.placement.keep {
            Keep::None => false,
            Keep::All => job.gauges.iter().any(|g| g.name == *name),
            Keep::Named(names) => names.contains(name),
        };
        if stays(&spot.name) {
            let wrong = "[placement] `keep` names this gauge, so the place is taken";
            let remedy = "delete the row, or delete the name from `keep`";
            fault("name", wrong, remedy);
        }
    }

    /// Returns the cost of the spot; `None` without a column of costs. A blank, negative or zero cost is a fault.
    fn cost(&self, faults: &mut FaultList) -> Option<f64> {
        let column = self.columns.column("cost")?;
        let line = self.table.rows.get(self.row).map_or(0, |r| r.0);
        let mut fault = |wrong: String| {
            let remedy = "write a cost above 0. A gauge that is installed already is a gauge of the job: [placement] `keep`";
            faults.push(Fault::with_line(
                &*self.table.file,
                line,
                "cost",
                wrong,
                remedy,
            ));
            None
        };
        match self.table.number(self.row, column.at) {
            Ok(Some(cost)) if cost > 0.0 => Some(cost),
            Ok(Some(cost)) => fault(format!("`{cost}`, expected a cost above 0")),
            Ok(None) => fault("the cost is blank, expected a cost above 0".to_owned()),
            Err(f) => {
                faults.push(f);
                None
            }
        }
    }
}
