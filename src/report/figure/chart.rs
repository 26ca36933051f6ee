//! A figure in two dimensions.

use maud::{Markup, PreEscaped, Render, html};
use serde_json::{Value, json};

/// Traces and axes in a common form, which `page/chart.js` draws as SVG and `report::pdf` on paper.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Description of the figure for screen readers and tests.
    pub label: String,
    /// Caption: what the figure shows, and what would be better or worse.
    pub caption: String,
    /// Name and traces of each choice. A single choice is drawn without a selector. `ytitle` of a trace is its axis title, if this differs by choice.
    pub choices: Vec<(String, Vec<Value>)>,
    /// Axes. With `equal`, both axes have the same range and length. `band` is a shaded range of the x axis, with its name.
    pub layout: Value,
    /// Height in pixels.
    pub height: usize,
    /// Number of choices drawn on paper, from the first.
    pub on_paper: usize,
}

impl Render for Figure {
    fn render(&self) -> Markup {
        let traces: Vec<&Vec<Value>> = self.choices.iter().map(|c| &c.1).collect();
        let data = json!({ "choices": traces, "layout": self.layout });
        html! {
            figure.plot aria-label=(self.label) data-figure="chart" {
                @if self.choices.len() > 1 {
                    div.controls { label { "Show " select data-role="choice" {
                        @for (i, c) in self.choices.iter().enumerate() { option value=(i) { (c.0) } }
                    } } }
                }
                div.canvas style=(format!("height:{}px", self.height)) {}
                (embed_data(&data))
                figcaption.muted { (self.caption) }
            }
        }
    }
}

/// Returns the data of a figure for embedding in the page. `<` occurs only in strings. It is written as its code, so that no text can end the script.
pub(in crate::report) fn embed_data(data: &Value) -> Markup {
    let text = data.to_string().replace('<', "\\u003c");
    html! { script type="application/json" { (PreEscaped(text)) } }
}
