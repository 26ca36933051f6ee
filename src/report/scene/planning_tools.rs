//! Planning by pointing: its tools, and where its lines are written.

use super::types::PickTargets;
use maud::{Markup, html};
use serde_json::{Map, Value, json};

/// Returns the data for the script of the page. It is null without pointing, otherwise the lists and the file of picked places.
pub(super) fn script_data(pointing: &PickTargets) -> Value {
    match pointing {
        PickTargets::Nothing => Value::Null,
        PickTargets::Gauges => json!({}),
        PickTargets::Places(places) => {
            let stated = places.lists.iter();
            let lists: Map<String, Value> = stated
                .map(|(key, ids)| ((*key).to_owned(), json!(ids)))
                .collect();
            json!({ "file": places.file, "lists": lists, "also": places.also })
        }
    }
}

/// Returns the tools above the picture.
pub(super) fn tools(pointing: &PickTargets, gauges: usize) -> Markup {
    let faces = matches!(pointing, PickTargets::Places(_));
    if *pointing == PickTargets::Nothing || !faces && gauges == 0 {
        return html! {};
    }
    let tool = |name: &str, word: &str, title: &str| {
        html! { button type="button" data-tool=(name) aria-pressed=(name == "turn") title=(title) { (word) } }
    };
    html! {
        div.controls.tools data-pointing {
            b { "Plan" }
            span.group role="group" aria-label="tool" {
                (tool("turn", "turn", "drag turns the picture"))
                @if faces {
                    (tool("brush", "brush", "drag over elements"))
                    (tool("box", "box", "drag a rectangle"))
                }
                @if gauges > 0 { (tool("gauge", "move gauges", "drag a gauge to its installed position")) }
            }
            @if faces {
                span.group role="group" aria-label="state of the selected elements" {
                    @for (state, word) in ["nothing", "allowed", "forbidden", "wanted"].iter().enumerate().skip(1).chain([(0, &"nothing")]) {
                        button type="button" class=(format!("s{state}")) data-state=(state) aria-pressed=(state == 1) { (word) }
                    }
                }
                label { "brush " input type="range" min="2" max="60" value="14" data-role="brush" aria-label="radius of the brush"; }
                label { input type="checkbox" data-role="through"; " box also selects hidden elements" }
            }
            button type="button" data-role="undo" disabled { "undo" }
            @if faces { button type="button" data-role="clear" { "clear" } }
        }
    }
}

/// Returns the part of the page below the picture: the properties to pick, and the lines to copy.
pub(super) fn result(pointing: &PickTargets) -> Markup {
    let written = |kind: &str, about: Markup| {
        html! {
            div.written data-written=(kind) hidden {
                p { (about) }
                pre tabindex="0" {}
                button type="button" data-role="copy" { "copy" }
                button type="button" data-role="save" { "save as a file" }
            }
        }
    };
    let gauges = html! {
        "Moved gauges, for the job's table of gauges: these columns replace the columns of the same name, "
        code { "element" } " stays empty."
    };
    match pointing {
        PickTargets::Nothing => html! {},
        PickTargets::Gauges => written("gauges", gauges),
        PickTargets::Places(places) => html! {
            details.properties { summary { "Pick by property" } div.parts data-role="properties" {} }
            p.muted data-role="count" {}
            (written("places", html! {
                "Copy these lines into the job instead of its lists of properties and elements. Or save them in the folder of the job and state "
                code { "file = \"" (places.file) "\"" } " in " code { "[candidates]" } "."
            }))
            (written("gauges", gauges))
        },
    }
}
