//! The page of `calibrate`.

use crate::estimate::NORMAL_95;
use crate::finding::Finding;
use crate::report::figure::{Ends, IntervalRow, intervals};
use crate::report::page::{Block, Page, Section, figure_section, number, table_section};
use crate::units::Quantity;
use crate::workflow::calibrate::{
    CalibratedGauge, CalibratedSensitivity, CheckLoad, GlueSummary, LackOfFitSummary, LeftOutLoad,
    LeftOutSummary, LoadResidual, NextRunSummary,
};

/// Returns the page of `calibrate`: result of the calibration, errors of left-out runs, and the model row and calibrated row of each gauge.
pub fn calibrate_page(title: &str, answer: &CalibratedSensitivity, findings: &[Finding]) -> Page {
    let mut sections = vec![summary(answer)];
    sections.extend(errors_of_left_out(answer));
    sections.extend(checks(answer));
    sections.extend([residuals(answer), lack_of_fit(answer), left_out(answer)]);
    sections.extend(installed_positions_section(answer));
    sections.push(gauges(answer));
    Page::new(
        title,
        "Sensitivity calibrated by known loads",
        findings,
        sections,
    )
}

fn summary(answer: &CalibratedSensitivity) -> Section {
    let c = &answer.calibration;
    let percent = |x: f64| format!("{:.2} %", 100.0 * x);
    let mut pairs = vec![
        ("Calibration runs".to_owned(), c.runs.to_string()),
        ("Prior".to_owned(), c.prior.to_owned()),
        (
            "Scatter between repeats".to_owned(),
            c.repeat_scatter_rel
                .map_or("within noise".to_owned(), percent),
        ),
        ("Noise over strain".to_owned(), percent(c.noise_rel)),
        (
            "Left-out runs within their intervals".to_owned(),
            format!("{} of {}", c.coverage.held, c.coverage.of),
        ),
        (
            "Factor on intervals".to_owned(),
            format!("{:.2}", c.coverage.factor),
        ),
    ];
    if let Some(e) = c.model_error {
        pairs.push((
            "Model error, common to a gauge".to_owned(),
            percent(e.common_rel),
        ));
        pairs.push((
            "Model error, entry by entry".to_owned(),
            percent(e.entry_rel),
        ));
    }
    if let Some(n) = &c.next_run {
        let gain = next_words(n);
        pairs.push(("Best next run".to_owned(), gain));
    }
    Section::new("Result of the calibration", vec![Block::pairs(&pairs)])
}

/// Errors of the loads of left-out runs with their 95 % intervals, by load; `None` without known loads.
fn errors_of_left_out(answer: &CalibratedSensitivity) -> Option<Section> {
    let left_out = &answer.calibration.left_out;
    let first = left_out.first()?;
    let of_load = |(l, load): (usize, &LeftOutLoad)| -> (String, Vec<IntervalRow>) {
        let row = |r: &LeftOutSummary| {
            let load = r.loads.get(l)?;
            let known = load.known?;
            let ends = [load.low, load.value, load.high].map(|v| v - known);
            Some((r.run.clone(), ends))
        };
        let rows = left_out.iter().filter_map(row).collect();
        (format!("{}, {}", load.name, load.unit), rows)
    };
    let mut groups: Vec<_> = first.loads.iter().enumerate().map(of_load).collect();
    groups.retain(|g| !g.1.is_empty());
    if groups.is_empty() {
        return None;
    }
    Some(figure_section(
        "Errors of left-out runs",
        intervals(
            &groups,
            "recovered minus known load",
            Ends::Interval,
            "Error of the load in each left-out run with its 95 % interval: an interval that contains 0 is right, and a shorter one is better.",
        ),
        "Each run is recovered with S from the other runs.",
    ))
}

/// Check loads, with the load that is worth applying next; `None` without check runs.
fn checks(answer: &CalibratedSensitivity) -> Option<Section> {
    let c = &answer.calibration;
    let row = |l: &CheckLoad| {
        vec![
            l.run.clone(),
            l.load.clone(),
            number(l.applied),
            format!(
                "{} ± {}",
                number(l.recovered),
                number((l.high - l.low) / 2.0)
            ),
            l.unit.clone(),
            if l.inside { "inside" } else { "outside" }.to_owned(),
        ]
    };
    let rows: Vec<Vec<String>> = c.checks.iter().map(row).collect();
    let next = c.next_run.as_ref().map_or(String::new(), |n| {
        format!(
            " Best load for a further calibration run: {}.",
            next_words(n)
        )
    });
    (!rows.is_empty()).then(|| {
        table_section(
            "Check loads",
            &["run", "load", "applied", "recovered", "unit", "95 % interval"],
            &rows,
            &format!("Known loads that were not used in the calibration. The interval includes the stated error of the applied load.{next}"),
        )
    })
}

/// Range and residual of each load.
fn residuals(answer: &CalibratedSensitivity) -> Section {
    let c = &answer.calibration;
    let percent = |x: Option<f64>| x.map_or_else(|| "-".to_owned(), number);
    let row = |r: &LoadResidual| {
        let [low, high] = c.range.get(&r.load).copied().unwrap_or([f64::NAN; 2]);
        vec![
            r.load.clone(),
            format!("{} to {}", number(low), number(high)),
            r.unit.clone(),
            number(r.rms_percent),
            number(r.max_percent),
            percent(r.left_out_rms_percent),
            percent(r.left_out_max_percent),
            r.left_out_max_run.clone().unwrap_or_default(),
        ]
    };
    let rows: Vec<Vec<String>> = c.residuals.iter().map(row).collect();
    table_section(
        "Range and residual by load",
        &[
            "load",
            "calibrated range",
            "unit",
            "residual, rms",
            "largest",
            "left out, rms",
            "largest",
            "in run",
        ],
        &rows,
        "Recovered minus known load in percent of full scale, the largest known load. Left out: each run is recovered with the other runs.",
    )
}

/// Tests of further terms.
fn lack_of_fit(answer: &CalibratedSensitivity) -> Section {
    let c = &answer.calibration;
    let row = |t: &LackOfFitSummary| vec![t.test.to_owned(), format!("{:.1e}", t.p)];
    let rows: Vec<Vec<String>> = c.lack_of_fit.iter().map(row).collect();
    let held_out = match &c.held_out_error {
        Some(h) => format!(
            " Error of left-out runs by least squares: {} % of full scale with terms = \"linear\", {} % with \"intercept\". Used here: {}. Recommended: {}.",
            number(h.linear_percent),
            number(h.intercept_percent),
            c.terms,
            h.recommended
        ),
        None => String::new(),
    };
    table_section(
        "Terms beyond the straight line",
        &["terms", "chance without this term"],
        &rows,
        &format!(
            "The clearest term over all gauges; its probability is corrected for their number. A term counts if this probability is below 0.001.{held_out}"
        ),
    )
}

fn next_words(n: &NextRunSummary) -> String {
    let loads: Vec<String> = (n.loads.iter())
        .filter(|(_, v)| **v != 0.0)
        .map(|(k, v)| format!("{k} {}", number(*v)))
        .collect();
    format!(
        "{}: sigma of {} {} becomes {} {}",
        loads.join(", "),
        n.load,
        number(n.sigma_before),
        number(n.sigma_after),
        n.unit
    )
}

fn left_out(answer: &CalibratedSensitivity) -> Section {
    let rows: Vec<Vec<String>> = answer
        .calibration
        .left_out
        .iter()
        .flat_map(|r| {
            r.loads.iter().map(|l| {
                vec![
                    r.run.clone(),
                    l.name.clone(),
                    l.known.map_or_else(String::new, number),
                    format!("{} +- {}", number(l.value), number((l.high - l.low) / 2.0)),
                    l.unit.clone(),
                    format!("{:.1}", r.distance),
                ]
            })
        })
        .collect();
    let note = "Each run is recovered with S from the other runs. Distance of the run in sigmas before the factor.";
    table_section(
        "Runs left out",
        &[
            "run",
            "load",
            "known",
            "recovered",
            "unit",
            "distance, sigma",
        ],
        &rows,
        note,
    )
}

/// Returns the section with the installed positions. `None` if no tolerance was stated.
fn installed_positions_section(answer: &CalibratedSensitivity) -> Option<Section> {
    let all = &answer.calibration.gauges;
    all.iter().find(|g| g.as_glued.is_some())?;
    let size = |s: Option<GlueSummary>| match s {
        Some(s) if s.told => format!("{} +- {}", number(s.value), number(NORMAL_95 * s.sigma)),
        Some(s) => format!("({} +- {})", number(s.value), number(NORMAL_95 * s.sigma)),
        None => String::new(),
    };
    let row = |g: &CalibratedGauge| -> Option<Vec<String>> {
        let a = g.as_glued.as_ref()?;
        Some(vec![
            g.name.clone(),
            size(a.along),
            size(a.across),
            size(a.angle_deg),
            size(Some(a.gain)),
        ])
    };
    let length = answer.job.units.unit(Quantity::Length).name;
    let rows: Vec<Vec<String>> = all.iter().filter_map(row).collect();
    Some(table_section(
        "Gauges as glued",
        &[
            "gauge",
            &format!("along its axis, {length}"),
            &format!("across, {length}"),
            "turned, deg",
            "gain",
        ],
        &rows,
        "Deviation from the drawing, with 95 % half widths. Across is left of the axis and angles are right-handed, both seen against the \
         element's normal. In brackets: the runs reduce the stated variance by less than half. gauges_as_glued.csv is a table of them for \
         a job.",
    ))
}

fn gauges(answer: &CalibratedSensitivity) -> Section {
    let s = &answer.sensitivity;
    let halves = s.half_widths();
    let mut head: Vec<String> = vec![
        "gauge".to_owned(),
        "looks like".to_owned(),
        "shift, sigma".to_owned(),
        "scale".to_owned(),
    ];
    for l in &s.loads {
        if answer.model.is_some() {
            head.push(format!("{}, model", l.name));
        }
        head.push(format!("{}, calibrated", l.name));
    }
    let rows: Vec<Vec<String>> = answer
        .calibration
        .gauges
        .iter()
        .enumerate()
        .map(|(g, c)| {
            let mut row = vec![
                c.name.clone(),
                c.looks_like.to_owned(),
                format!("{:.1}", c.shift),
                format!("{:.3}", c.scale),
            ];
            for l in 0..s.loads.len() {
                row.extend(answer.model.as_ref().map(|m| number(1e6 * m[(g, l)])));
                let [value, half] = [s.values[(g, l)], halves[(g, l)]].map(|v| number(1e6 * v));
                row.push(format!("{value} ± {half}"));
            }
            row
        })
        .collect();
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    table_section(
        "Gauges",
        &head,
        &rows,
        "Rows of S in microstrain per job unit of the load, with 95 % half widths.",
    )
}
