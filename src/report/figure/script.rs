//! The scripts of a page: plotly.js as the crate `plotly` embeds it, and our own that feeds it.

use std::sync::OnceLock;

/// Attribute of everything that the scripts draw; a page without it needs none.
pub const DRAWN: &str = "data-figure";

const END: &str = "</script>";

/// Script elements. The crate's string also holds MathJax, which nothing here needs: only its first script is kept.
pub fn scripts() -> &'static str {
    static SCRIPTS: OnceLock<String> = OnceLock::new();
    SCRIPTS.get_or_init(|| {
        let all = plotly::Plot::offline_js_sources();
        let end = all.find(END).map_or(all.len(), |i| i + END.len());
        let mut out = all[..end].to_owned();
        out.push_str("\n<script>");
        out.push_str(include_str!("../page.js"));
        out.push_str(END);
        out
    })
}
