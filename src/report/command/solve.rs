//! Report files and console output of `solve`.

use super::{Report, write_page};
use crate::fe::Solution;
use crate::finding::list_few;
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::model::Model;
use crate::report::console::{Console, ConsoleTable};
use crate::report::page::{KeyNumber, Page};
use crate::report::scene::scene_of_solution;
use crate::report::strain::solution_page;
use crate::report::{PlannedBlock, planned_blocks, rows_of_block, write_vtu};
use crate::units::number;
use crate::workflow::solve::SolvedCases;
use nastran::op2::{EncodedBlock, Op2Writer, WriteError};
use rayon::prelude::*;

impl Report for Outcome<SolvedCases> {
    const FILES: &'static [&'static str] =
        &["result.json", "report.html", "results.op2", "results.vtu"];

    fn write(&self, out: &mut Output) -> Result<(), Faults> {
        let (model, solution) = (&self.deck.model, &self.solution);
        let plan = planned_blocks(model, solution);
        out.write_both(
            ("results.op2", |w| write_op2(model, solution, &plan, w)),
            ("results.vtu", |w| write_vtu(model, &solution.cases, w)),
        )?;
        write_page(out, self)
    }

    fn page(&self) -> Option<Page> {
        let (model, solution) = (&self.deck.model, &self.solution);
        let scene = scene_of_solution(model, &self.cases, solution);
        let page = solution_page(
            &self.title,
            self.system,
            solution,
            &self.report,
            &scene,
            &self.findings,
        );
        Some(page)
    }

    fn key_numbers(&self) -> Vec<KeyNumber> {
        let mut numbers = vec![
            KeyNumber::new(self.cases.len().to_string(), "load cases solved"),
            KeyNumber::new(
                self.dofs.to_string(),
                format!("unknowns, {} grids", self.grids),
            ),
        ];
        let units = self.model_units.list();
        let unit = units
            .iter()
            .find(|u| u.0 == "mass")
            .map_or("", |u| u.1.as_str());
        numbers
            .extend(self.mass.map(|m| {
                KeyNumber::new(format!("{} {unit}", number(m.mass)), "mass of the model")
            }));
        let first = self.elastic_modes_hz.first();
        numbers.extend(
            first.map(|hz| KeyNumber::new(format!("{} Hz", number(*hz)), "first elastic mode")),
        );
        let balance = self.balance.iter().map(|b| b.residual);
        let residual = balance.fold(f64::NAN, f64::max);
        if residual.is_finite() {
            numbers.push(KeyNumber::new(
                format!("{residual:.0e}"),
                "largest unbalanced share of a load",
            ));
        }
        numbers
    }

    fn console(&self) -> Console {
        let mut fields = vec![
            ("unknowns", self.dofs.to_string()),
            ("entries of the factor", self.factor_nonzeros.to_string()),
        ];
        if !self.balance.is_empty() {
            let residual = (self.balance.iter())
                .map(|b| b.residual)
                .fold(0.0, f64::max);
            fields.push(("largest unbalanced share", format!("{residual:.0e}")));
        }
        let modes: Vec<String> = self.elastic_modes_hz.iter().map(|hz| number(*hz)).collect();
        if !modes.is_empty() {
            fields.push(("elastic modes, Hz", list_few(&modes)));
        }
        Console::new(ConsoleTable::of_fields("", &fields), Some("results.op2"))
            .next("name results.op2 as [model] results of a job (`strainbridge init` writes one)")
    }
}

/// Writes the OP2 file. Blocks are encoded in parallel, a few at a time.
fn write_op2(
    model: &Model,
    solution: &Solution,
    plan: &[PlannedBlock],
    out: &mut dyn std::io::Write,
) -> std::io::Result<()> {
    let encode = |group: &[PlannedBlock]| -> Result<Vec<EncodedBlock>, WriteError> {
        group
            .par_iter()
            .map(|p| {
                let (block, rows) = rows_of_block(model, solution, *p);
                EncodedBlock::new(&block, &rows)
            })
            .collect()
    };
    let mut op2 = Op2Writer::new(out, [1, 1, 2000]).map_err(std::io::Error::other)?;
    for group in plan.chunks(rayon::current_num_threads().clamp(1, 4)) {
        for block in encode(group).map_err(std::io::Error::other)? {
            op2.write_encoded(&block).map_err(std::io::Error::other)?;
        }
    }
    op2.finish().map(|_| ()).map_err(std::io::Error::other)
}
