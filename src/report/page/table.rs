//! Tables and links of a page.

use super::block::Table;
use maud::{Markup, html};

/// Returns a table that scrolls sideways on narrow screens. The first column names the rows.
pub(super) fn table(t: &Table, caption: &str) -> Markup {
    html! {
        div.scroll tabindex="0" {
            table.fields[t.head.is_empty()] {
                @if !caption.is_empty() { caption { (caption) } }
                @if !t.head.is_empty() {
                    thead { tr { @for h in &t.head {
                        @if h.is_empty() { td {} } @else { th scope="col" { (keep_on_one_line(h)) } }
                    } } }
                }
                tbody { @for (r, row) in t.rows.iter().enumerate() {
                    tr { @for (c, cell) in row.iter().enumerate() {
                        @if c == 0 && !cell.is_empty() { th scope="row" { (cell_html(t, r, c, cell)) } }
                        @else { td { (cell_html(t, r, c, cell)) } }
                    } }
                } }
            }
        }
    }
}

/// A cell, as a link where it leads to a file.
fn cell_html(t: &Table, row: usize, column: usize, cell: &str) -> Markup {
    // Links are sorted by row.
    let first = t.links.partition_point(|l| l.row < row);
    let mut of_row = t.links.iter().skip(first).take_while(|l| l.row == row);
    match of_row.find(|l| l.column == column) {
        Some(l) => html! { a href=(reference(&l.path)) title=(l.title) { (cell) } },
        None => html! { (keep_on_one_line(cell)) },
    }
}

/// A short cell, such as a unit, stays on one line.
fn keep_on_one_line(cell: &str) -> String {
    const SHORT: usize = 8;
    match cell.chars().count() <= SHORT {
        true => cell.replace(' ', "\u{a0}"),
        false => cell.to_owned(),
    }
}

/// A path as a reference of a page: what has a meaning there by its number.
fn reference(path: &str) -> String {
    let plain = |b: u8| b.is_ascii_alphanumeric() || b"-_.~/".contains(&b);
    let mut out = String::new();
    for b in path.replace('\\', "/").bytes() {
        match plain(b) {
            true => out.push(char::from(b)),
            false => out.push_str(&format!("%{b:02X}")),
        }
    }
    out
}

/// Returns links in one line.
pub(super) fn list_of_links(links: &[(String, String)]) -> Markup {
    html! {
        @for (i, (words, path)) in links.iter().enumerate() {
            @if i > 0 { " · " }
            a href=(path) { (words) }
        }
    }
}
