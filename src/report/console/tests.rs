use super::*;
use crate::finding::{Finding, Severity};

const ROOM: Room = Room {
    width: WIDTH,
    lines: Some(LINES),
    is_utf8: true,
};

fn all_lines(layout: &Layout) -> Vec<String> {
    let findings = layout.findings.iter().flat_map(|f| &f.lines);
    let before = layout.answer.iter().chain(findings);
    let all = before.chain(&layout.next).chain(&layout.paths);
    all.cloned().collect()
}

/// Returns a table of `n` loads, one per row.
fn loads(n: usize) -> ConsoleTable {
    let row = |i: usize| vec![format!("LOAD{i}.FZ"), format!("{i}.50 ± 0.36"), "kN".into()];
    ConsoleTable::new(
        "Recovered loads",
        &["load", "value", "unit"],
        (0..n).map(row).collect(),
    )
}

fn finding(severity: Severity, code: &'static str, words: usize) -> Finding {
    let message = "a reading differs from its prediction ".repeat(words);
    Finding::new(severity, code, "P01", message, "check the wiring")
}

#[test]
fn thirty_nine_loads_stand_side_by_side_in_a_terminal_with_many_findings() {
    let codes = ["gauge-silent", "gauge-suspect", "lack-of-fit"];
    let mut findings: Vec<Finding> = codes
        .iter()
        .flat_map(|c| {
            [
                finding(Severity::Warning, c, 3),
                finding(Severity::Info, c, 9),
            ]
        })
        .collect();
    findings.push(finding(Severity::Error, "loads-not-separable", 4));
    let console = Console::new(loads(39), Some("loads.csv")).next("glue the gauges");
    let paths = [
        "job.out/report.html".to_owned(),
        "job.out/loads.csv".to_owned(),
    ];
    let texts = Texts {
        summary: "39 loads.",
        findings: &findings,
        notes: &[],
        paths: &paths,
    };
    let layout = lay_out(&console, &texts, &ROOM);
    let lines = all_lines(&layout);
    assert!(lines.len() <= LINES, "{lines:#?}");
    assert!(
        lines.iter().all(|l| l.chars().count() <= WIDTH),
        "{lines:#?}"
    );
    let text = lines.join("\n");
    for i in 0..39 {
        assert!(text.contains(&format!("LOAD{i}.FZ ")), "{text}");
        assert!(text.contains(&format!("{i}.50 ± 0.36  kN")), "{text}");
    }
    // The error is the last finding, and a line counts the findings left out.
    let last = layout.findings.last().unwrap();
    assert_eq!(last.severity, Some(Severity::Error));
    assert!(text.contains("3 notes more: -v prints them"), "{text}");
    // Without a limit, everything is printed.
    let all = lay_out(
        &console,
        &texts,
        &Room {
            lines: None,
            ..ROOM
        },
    );
    assert_eq!(all.findings.len(), findings.len());
    assert_eq!(all.answer.len(), 2 + 39 + 2);
}

#[test]
fn rows_that_do_not_fit_are_counted_with_their_file() {
    let console = Console::new(loads(500), Some("loads.csv"));
    let texts = Texts {
        summary: "500 loads.",
        ..Texts::default()
    };
    let lines = all_lines(&lay_out(&console, &texts, &ROOM));
    assert_eq!(lines.len(), LINES, "{lines:#?}");
    let shown = lines.join(" ").matches("LOAD").count();
    let more = format!("and {} more in loads.csv", 500 - shown);
    assert!(lines.contains(&more), "{lines:#?}");
}

#[test]
fn the_first_table_that_fits_is_shown() {
    let wide = ConsoleTable::new("by run", &["run"], vec![vec!["x".repeat(60); 3]]);
    let console = Console::new(wide, None).or(loads(2));
    let lines = all_lines(&lay_out(&console, &Texts::default(), &ROOM));
    assert_eq!(lines[0], "Recovered loads");
    let wide = Room { width: 200, ..ROOM };
    let lines = all_lines(&lay_out(&console, &Texts::default(), &wide));
    assert_eq!(lines[0], "by run");
}

#[test]
fn a_narrow_terminal_wraps_sentences_and_text_in_the_last_column() {
    let rows = vec![vec!["deck".to_owned(), "grids and elements ".repeat(9)]];
    let console = Console::new(ConsoleTable::new("Files", &[], rows), None);
    let findings = [finding(Severity::Warning, "gauge-silent", 3)];
    let texts = Texts {
        summary: "a sentence with a_word_that_is_wider_than_any_line_of_this_terminal_can_be_here",
        findings: &findings,
        ..Texts::default()
    };
    let room = Room { width: 48, ..ROOM };
    let layout = lay_out(&console, &texts, &room);
    let lines = all_lines(&layout);
    assert!(lines.iter().all(|l| l.chars().count() <= 48), "{lines:#?}");
    assert!(lines[2].starts_with("      grids"), "{lines:#?}");
    let later = layout.findings[0].lines.iter().skip(1);
    assert!(later.clone().count() > 1 && later.clone().all(|l| l.starts_with("    ")));
}

#[test]
fn a_terminal_without_utf_8_shows_signs_in_ascii() {
    let console = Console::new(loads(1), None);
    let texts = Texts {
        summary: "residual 3 µm/m",
        ..Texts::default()
    };
    let room = Room {
        is_utf8: false,
        ..ROOM
    };
    let text = all_lines(&lay_out(&console, &texts, &room)).join("\n");
    assert!(text.is_ascii() && text.contains("0.50 +- 0.36"), "{text}");
    assert!(text.contains("3 um/m"), "{text}");
    // Every character that a table or a message may contain.
    let signs = "± µε μm ∞ ° ² ³ × · ≥ − …";
    assert_eq!(ascii(signs), "+- ue um inf  deg ^2 ^3 x * >= - ...");
}
