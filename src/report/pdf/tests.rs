use super::*;
use crate::finding::{Finding, Severity};
use crate::report::figure::{Ends, GaugePoints, agreement, gap_by_channel, heat_map, intervals};
use crate::report::page::{Block, Page, Paper, Section, figure_section, table_section};

const HASH: &str = "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08";
/// Characters with a special meaning in the template language, JSON, XML or a page.
const NASTY: &str = "#panic(1) *b* $x$ _u_ <a href=\"x\"> `c` \\ @ref ~ [ ] { } // /* \"q\" 'q' = - + / \u{202e}evil µε Δ Ж 中 🚚 \t\n";

fn origin<'a>(inputs: &'a [(String, String)], units: &'a [(String, String)]) -> Origin<'a> {
    Origin {
        program: "strainbridge 0.0.0",
        command: "place",
        inputs,
        units,
    }
}

fn page(sections: Vec<Section>) -> Page {
    let finding = Finding::new(Severity::Warning, "code", NASTY, NASTY, NASTY);
    let findings = [finding.with_numbers(1.0, 2.0)];
    Page::new(NASTY, NASTY, &findings, sections).on_paper(Paper::Signed)
}

fn write_sections(sections: Vec<Section>) -> Vec<u8> {
    let inputs = [(NASTY.to_owned(), HASH.to_owned())];
    let units = [("force".to_owned(), "N".to_owned())];
    write_pdf(&page(sections), &origin(&inputs, &units)).unwrap()
}

/// Returns the number of pages of a PDF from its page tree. If the page tree is in a compressed stream, the number is 0.
fn n_pages(pdf: &[u8]) -> usize {
    let text = String::from_utf8_lossy(pdf);
    let leaf = text.matches("/Type /Page").count() + text.matches("/Type/Page").count();
    let tree = text.matches("/Type /Pages").count() + text.matches("/Type/Pages").count();
    leaf - tree
}

fn rows(n: usize, columns: usize, cell: &str) -> Vec<Vec<String>> {
    (0..n)
        .map(|i| (0..columns).map(|c| format!("{cell}{i}.{c}")).collect())
        .collect()
}

#[test]
fn text_of_users_is_no_markup_and_the_same_page_gives_the_same_bytes() {
    let all = || {
        let names = [NASTY.to_owned(), "plain".to_owned()];
        let bars = vec![
            (NASTY.to_owned(), [1.0, 2.0, 3.0]),
            ("b".into(), [-1.0, f64::NAN, 2.0]),
        ];
        let points = GaugePoints {
            name: NASTY.into(),
            residual: 1.0,
            points: [vec![(1.0, 1.1), (f64::NAN, 2.0)], vec![(5.0, 5.1)]],
        };
        vec![
            Section::new(
                NASTY,
                vec![
                    Block::Text(NASTY.into()),
                    Block::Stressed(NASTY.into(), NASTY.into()),
                    Block::Note(NASTY.into()),
                    Block::Lines(NASTY.into()),
                    Block::pairs(&[(NASTY.into(), NASTY.into())]),
                    Block::Links(vec![(NASTY.into(), NASTY.into())]),
                    Block::Folded {
                        summary: NASTY.into(),
                        blocks: vec![Block::Text(NASTY.into())],
                    },
                ],
            ),
            table_section(
                NASTY,
                &[NASTY, NASTY],
                &[vec![NASTY.into(), "1".into()]],
                NASTY,
            ),
            figure_section(
                "",
                intervals(&[(NASTY.into(), bars)], NASTY, Ends::Interval, NASTY),
                NASTY,
            ),
            figure_section(
                "",
                gap_by_channel(&[(NASTY.into(), [3.0, 1.0, 0.5])], NASTY),
                "",
            ),
            figure_section(
                "",
                heat_map(&names, &names, "", |r, c| r as f64 - c as f64),
                "",
            ),
            figure_section("", agreement(&[points], [NASTY, ""], [&names, &[]]), ""),
        ]
    };
    let pdf = write_sections(all());
    assert!(pdf.starts_with(b"%PDF"));
    assert!(n_pages(&pdf) > 0);
    assert_eq!(pdf, write_sections(all()));
}

#[test]
fn nothing_to_show_is_a_page_too() {
    let empty = vec![
        table_section("", &[], &[], ""),
        table_section("", &["head"], &[], ""),
        figure_section("", intervals(&[], "", Ends::Span, ""), ""),
        figure_section(
            "",
            intervals(&[("run".into(), vec![])], "", Ends::Interval, ""),
            "",
        ),
        figure_section("", gap_by_channel(&[], ""), ""),
        figure_section("", heat_map(&[], &[], "", |_, _| 0.0), ""),
        figure_section("", agreement(&[], ["", ""], [&[], &[]]), ""),
        Section::new("", vec![]),
    ];
    let bare = Page::new("", "", &[], empty);
    let pdf = write_pdf(&bare, &origin(&[], &[])).unwrap();
    assert!(pdf.starts_with(b"%PDF"));
}

#[test]
fn a_table_turns_the_sheet_before_it_is_cut_and_repeats_its_first_column_then() {
    let table = |columns: usize, cell: &str| {
        let head: Vec<String> = (0..columns).map(|c| format!("c{c}")).collect();
        crate::report::page::Table {
            head,
            rows: rows(3, columns, cell),
            links: Vec::new(),
        }
    };
    let narrow = columns::fit_table(&table(4, "1"));
    assert_eq!((narrow.len(), narrow[0].across), (1, false));
    let wide = columns::fit_table(&table(12, "a name of some length "));
    assert!(wide.iter().all(|f| f.across));
    let many = columns::fit_table(&table(90, "12345"));
    assert!(many.len() > 1);
    assert!(many.iter().all(|f| f.across && f.columns[0] == 0));
    // Every column appears once, except for the first, which every part repeats.
    let mut shown: Vec<usize> = many.iter().flat_map(|f| f.columns[1..].to_vec()).collect();
    shown.sort_unstable();
    assert_eq!(shown, (1..90).collect::<Vec<_>>());
}

#[test]
fn a_long_table_goes_over_several_pages() {
    let pdf = write_sections(vec![table_section(
        "Long",
        &["a", "b"],
        &rows(500, 2, "x"),
        "",
    )]);
    // 500 rows of at least 4 mm, and two columns of 253 mm on a page.
    assert!(n_pages(&pdf) >= 4, "{}", n_pages(&pdf));
}

#[test]
fn characters_that_no_font_has_are_written_as_numbers() {
    assert_eq!(glyphs::make_printable("µε Δσ 12 ± 3 °"), "µε Δσ 12 ± 3 °");
    assert_eq!(glyphs::make_printable("中"), "[U+4E2D]");
    assert_eq!(
        glyphs::make_printable("a\u{202e}b\u{200b}\tc"),
        "a[U+202E]b[U+200B] c"
    );
    let broken = glyphs::make_breakable(&"w".repeat(50), 20);
    assert_eq!(broken.replace('\u{200b}', ""), "w".repeat(50));
    assert!(
        broken
            .split('\u{200b}')
            .all(|part| part.chars().count() <= 20)
    );
    assert_eq!(
        glyphs::make_breakable("short words stay", 20),
        "short words stay"
    );
}
