//! `report.html`, `report.pdf` and spreadsheets of an outcome.

use super::{Report, mistake};
use crate::finding::Severity;
use crate::host::fault::Faults;
use crate::host::other_results::{INDEX, OtherResult, other_results};
use crate::host::outcome::{Answer, Outcome};
use crate::host::output::Output;
use crate::job::Job;
use crate::report::console::ConsoleTable;
use crate::report::page::{Block, Card, FirstScreen, Page, Section, Table};
use crate::report::spreadsheet::{Sheet, UnitOf, WorkbookDescription, spreadsheet};
use crate::units::Quantity;

/// Writes `report.html` if the outcome has a page, and `report.pdf` with the feature `pdf` if the page is meant for paper. If the folder also
/// contains results of other commands, `index.html` lists all results.
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
        .with_links_from(out.folder());
    let others = other_results(out.folder(), A::COMMAND);
    if !others.is_empty() {
        let index = index_of(&page, A::COMMAND, &others);
        out.write_bytes(INDEX, index.to_html().as_bytes())?;
    }
    let page = page.with_first(first_screen(outcome));
    out.write_bytes("report.html", page.to_html().as_bytes())?;
    #[cfg(feature = "pdf")]
    if page.paper != crate::report::page::Paper::None {
        write_paper(out, outcome, &page)?;
    }
    Ok(())
}

/// Returns the page of an outcome that no folder holds.
#[cfg(feature = "open")]
pub fn live_page<A: Answer>(outcome: &Outcome<A>) -> Option<Page>
where
    Outcome<A>: Report,
{
    let page = outcome.page()?.with_summary(outcome.summary());
    Some(page.with_first(first_screen(outcome)))
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

/// Returns the page that lists the result just computed and the results of other commands, with a link to each report.
fn index_of(page: &Page, command: &str, others: &[OtherResult]) -> Page {
    let newest = OtherResult {
        command: command.to_owned(),
        report: "report.html".to_owned(),
        summary: page.summary.clone(),
        has_errors: page.findings.iter().any(|f| f.severity == Severity::Error),
    };
    let results = std::iter::once(&newest).chain(others);
    let cards = results.map(|r| Card {
        title: r.command.clone(),
        text: r.summary.clone(),
        numbers: Vec::new(),
        links: vec![("report".to_owned(), r.report.clone())],
        is_bad: r.has_errors,
        picture: None,
    });
    let sections = vec![Section::new("", vec![Block::Cards(cards.collect())])];
    let count = others.len() + 1;
    Page::new(&page.title, "The newest result is first.", &[], sections)
        .with_summary(format!("This folder contains results of {count} commands."))
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
    let about = WorkbookDescription {
        title: &job.title,
        units: &units,
        findings: &outcome.findings,
    };
    let bytes = spreadsheet(sheets, &about).map_err(|e| mistake(name, &e))?;
    out.write_bytes(name, &bytes)?;
    Ok(())
}
