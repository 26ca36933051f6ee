//! The page before it has any data: its tools, its style and its scripts.

use super::guard::random_text;
use super::http::Response;
use crate::report::live::{live_scripts, page_style};
use maud::{DOCTYPE, PreEscaped, html};

/// Returns the page with a new nonce. Only the style and the script with this nonce count, and calls go to this server alone.
///
/// # Errors
/// A system without random numbers.
pub fn shell() -> Result<Response, String> {
    let nonce = random_text()?;
    let policy = format!(
        "default-src 'none'; script-src 'nonce-{nonce}'; style-src 'nonce-{nonce}'; connect-src 'self'; base-uri 'none'; form-action 'none'; \
         frame-ancestors 'none'"
    );
    let scripts = live_scripts(include_str!("live.js"));
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width,initial-scale=1";
                title { "strainbridge open" }
                style nonce=(nonce) { (PreEscaped(page_style())) (PreEscaped(include_str!("live.css"))) }
            }
            body {
                main {
                    section.live aria-label="plan" {
                        (tools())
                        p.muted data-live="said" role="status" aria-live="polite" { "Reading the job." }
                        p.muted { "Command with the same result: " code data-live="command" {} }
                        div.lost data-live="lost" role="alert" hidden {
                            p { b { "Connection lost; your lines are here." } " Copy them into the files, or start `strainbridge open` again." }
                            pre tabindex="0" data-live="lines" {}
                            button type="button" data-live="copy" { "copy" }
                        }
                        div.changed data-live="changed" role="alert" hidden {
                            span data-live="changes" {}
                            button type="button" data-live="reload" { "read again" }
                        }
                        ul.faults data-live="faults" role="alert" hidden {}
                        div.scroll data-live="loads" {}
                        details { summary { "Gauges that stay" } div.parts data-live="kept" {} }
                    }
                    div data-live="page" {}
                }
                script nonce=(nonce) { (PreEscaped(scripts)) }
            }
        }
    };
    Ok(Response {
        status: 200,
        kind: "text/html; charset=utf-8",
        policy,
        body: page.into_string().into_bytes(),
    })
}

fn tools() -> maud::Markup {
    let button = |role: &str, word: &str, title: &str| {
        html! { button type="button" data-live=(role) title=(title) disabled { (word) } }
    };
    html! {
        div.controls {
            b { "Live" }
            label { "gauges " input type="range" min="1" max="40" value="12" data-live="count" disabled aria-label="number of gauges"; " " output data-live="counted" {} }
            (button("place", "place again", "choose all gauges again"))
            (button("rest", "keep these, place the rest", "keep the ticked gauges and choose the others again"))
            (button("undo", "undo plan", "return to the plan before"))
            (button("cancel", "cancel", "stop the work in progress"))
            (button("save", "save", "write the two files of the plan next to the job"))
            (button("report", "report", "write the pages and tables of `place` for the saved files"))
        }
    }
}
