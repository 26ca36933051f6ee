//! `report.html`, `report.pdf` and spreadsheets of an outcome.

use super::{Report, mistake};
use crate::host::fault::Faults;
use crate::host::outcome::{Answer, Outcome};
use crate::host::output::Output;
use crate::job::Job;
use crate::report::console::ConsoleTable;
use crate::report::page::{FirstScreen, Table};
use crate::report::spreadsheet::{About, Sheet, UnitOf, spreadsheet};
use crate::units::Quantity;

/// Writes `report.html`, where there is a page, and with the feature `pdf`, where the page is meant for paper, `report.pdf`.
///
/// # Errors
/// A file that can't be written.
pub fn write_page<A: Answer>(out: &mut Output, outcome: &Outcome<A>) -> Result<(), Faults>
where
    Outcome<A>: Report,
{
    let Some(page) = outcome.page() else {
        return Ok(());
    };
    let page = page
        .with_summary(outcome.summary())
        .with_first(first_screen(outcome))
        .beside(out.folder());
    out.write_bytes("report.html", page.to_html().as_bytes())?;
    #[cfg(feature = "pdf")]
    if page.paper != crate::report::page::Paper::None {
        write_paper(out, outcome, &page)?;
    }
    Ok(())
}

fn first_screen<A: Answer>(outcome: &Outcome<A>) -> FirstScreen
where
    Outcome<A>: Report,
{
    let ConsoleTable { title, head, rows } = outcome.result_table();
    let table = Table {
        head,
        rows,
        links: Vec::new(),
    };
    FirstScreen {
        command: A::COMMAND,
        numbers: outcome.key_numbers(),
        title,
        table,
        file: outcome.console().file,
    }
}

#[cfg(feature = "pdf")]
fn write_paper<A: Answer>(
    out: &mut Output,
    outcome: &Outcome<A>,
    page: &crate::report::page::Page,
) -> Result<(), Faults> {
    use crate::report::pdf::{Origin, write_pdf};
    let inputs: Vec<(String, String)> = outcome
        .inputs
        .iter()
        .map(|i| (i.path.clone(), i.sha256.clone()))
        .collect();
    let stated = outcome.units.list().iter();
    let (system, mut units): (Vec<_>, Vec<_>) = stated
        .map(|(quantity, unit)| ((*quantity).to_owned(), unit.clone()))
        .partition(|(quantity, _)| quantity == "system");
    units.extend(
        system
            .into_iter()
            .map(|s| ("model and job in".to_owned(), s.1)),
    );
    let origin = Origin {
        program: concat!("strainbridge ", env!("CARGO_PKG_VERSION")),
        command: A::COMMAND,
        inputs: &inputs,
        units: &units,
    };
    let bytes = write_pdf(page, &origin).map_err(|e| mistake("report.pdf", &e))?;
    out.write_bytes("report.pdf", &bytes)?;
    Ok(())
}

/// Writes workbook `name`, with the job's units and the findings.
///
/// # Errors
/// A file that can't be written.
pub fn write_book<A>(
    out: &mut Output,
    outcome: &Outcome<A>,
    job: &Job,
    name: &str,
    sheets: &[Sheet],
) -> Result<(), Faults> {
    let reported = [
        ("force", job.report_units.force),
        ("moment", job.report_units.moment),
        ("mass", job.report_units.mass),
    ];
    let mut units: Vec<UnitOf> = reported
        .map(|(quantity, unit)| UnitOf {
            quantity,
            unit: unit.name.to_owned(),
        })
        .to_vec();
    let own = [
        ("position", Quantity::Length),
        ("load unit of `Sensitivity`, force", Quantity::Force),
        ("load unit of `Sensitivity`, moment", Quantity::Moment),
    ];
    units.extend(own.map(|(quantity, q)| UnitOf {
        quantity,
        unit: job.units.unit(q).name.to_owned(),
    }));
    units.push(UnitOf {
        quantity: "strain",
        unit: "microstrain".to_owned(),
    });
    let about = About {
        title: &job.title,
        units: &units,
        findings: &outcome.findings,
    };
    let bytes = spreadsheet(sheets, &about).map_err(|e| mistake(name, &e))?;
    out.write_bytes(name, &bytes)?;
    Ok(())
}
