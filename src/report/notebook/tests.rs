use super::*;
use crate::finding::{Finding, Severity};
use crate::report::figure::{Line, Scale, heat_map, lines};
use crate::report::page::{figure_section, table_section};

fn page(sections: Vec<Section>) -> Page {
    let finding = Finding::new(Severity::Error, "code", "G1", "it <b>fails</b>", "mend it");
    Page::new("A <title>", "lead", &[finding], sections)
}

fn wave(n: usize) -> (Vec<f64>, Vec<f64>) {
    let x: Vec<f64> = (0..n).map(|i| i as f64).collect();
    let y = x.iter().map(|v| (v * 1.7).sin()).collect();
    (x, y)
}

#[test]
fn a_style_holds_for_the_piece_alone() {
    let rules = STYLE.split('}').map(str::trim).filter(|r| !r.is_empty());
    let mut n = 0;
    for rule in rules {
        let (selectors, _) = rule.split_once('{').unwrap();
        for s in selectors.split(',') {
            let own = s == ".strainbridge" || s.starts_with(".strainbridge ");
            assert!(own, "`{s}` would restyle the notebook");
            n += 1;
        }
    }
    assert!(n > 10);
}

#[test]
fn a_piece_has_verdict_findings_and_pictures_and_runs_nothing() {
    let (x, y) = wave(50);
    let curve = Line {
        name: "A <i>",
        x: &x,
        y: &y,
    };
    let groups = [("one".to_owned(), vec![curve])];
    let text = piece_of(&page(vec![
        figure_section(
            "Curve",
            lines(&groups, "t", "v", Scale::Linear, "flatter is better"),
            "a note",
        ),
        table_section("Table", &["h"], &[vec!["<td>cell".into()]], ""),
    ]));
    for word in [
        "<b>error</b>",
        "It &lt;b&gt;fails",
        "Mend it",
        "<svg",
        "a note",
    ] {
        assert!(text.contains(word), "{word}");
    }
    for word in [
        "<script", "<h1", "<body", "<i>", "<title>", "<td>cell", "http",
    ] {
        assert!(!text.contains(word), "{word}");
    }
    // Every element has an end tag: SVG in a page has no self-closing elements.
    for tag in [
        "div", "svg", "path", "text", "p", "table", "tr", "td", "figure",
    ] {
        let begun =
            text.matches(&format!("<{tag} ")).count() + text.matches(&format!("<{tag}>")).count();
        assert_eq!(begun, text.matches(&format!("</{tag}>")).count(), "{tag}");
    }
}

#[test]
fn a_piece_stays_small_and_states_what_it_leaves_out() {
    let (x, y) = wave(4000);
    let names: Vec<String> = (0..8).map(|i| format!("L{i}")).collect();
    let groups: Vec<(String, Vec<Line>)> = names
        .iter()
        .map(|name| (name.clone(), vec![Line { name, x: &x, y: &y }]))
        .collect();
    let gauges: Vec<String> = (0..120).map(|i| format!("G{i}")).collect();
    let rows: Vec<Vec<String>> = (0..900).map(|i| vec![i.to_string()]).collect();
    let text = piece_of(&page(vec![
        figure_section(
            "Curves",
            lines(&groups, "t", "v", Scale::Linear, "flatter is better"),
            "",
        ),
        figure_section(
            "Map",
            heat_map(&gauges, &names, "", |r, c| (r * c) as f64),
            "",
        ),
        figure_section(
            "Curves",
            lines(&groups, "t", "v", Scale::Linear, "flatter is better"),
            "",
        ),
        table_section("Rows", &["i"], &rows, ""),
    ]));
    assert!(text.len() < 300_000, "{} bytes", text.len());
    assert!(text.contains("860 more rows") && text.contains("More of this figure"));
    assert!(text.contains(">39</th>") && !text.contains(">40</th>"));
}
