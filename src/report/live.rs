//! Parts of pages for a page that a server answers: content, style and scripts apart.

use super::command::{Report, live_page};
use super::figure::all_scripts;
use super::page::STYLE;
use crate::host::outcome::{Answer, Outcome};

/// Returns the style of all pages.
pub fn page_style() -> &'static str {
    STYLE
}

/// Returns the scripts of all figures, together with `own`, as one text without its element.
pub fn live_scripts(own: &str) -> String {
    all_scripts(own)
}

/// Returns the content of the page of an outcome, as HTML without scripts that run; empty without a page.
pub fn page_content<A: Answer>(outcome: &Outcome<A>) -> String
where
    Outcome<A>: Report,
{
    live_page(outcome).map_or_else(String::new, |page| page.content().into_string())
}
