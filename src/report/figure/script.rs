//! The scripts of a page: for figures, for the model, for pointing at it; each only where it is needed.

/// Attributes of what they draw.
const CHART: &str = "data-figure=\"chart\"";
const SCENE: &str = "data-figure=\"scene\"";
const POINTING: &str = "data-pointing";

/// The scripts of a page in their order, each with the attribute of the elements that it draws.
const PARTS: [(&str, &str); 4] = [
    (CHART, include_str!("../page/chart.js")),
    (SCENE, include_str!("../page/scene.js")),
    (SCENE, include_str!("../page/scene_view.js")),
    (POINTING, include_str!("../page/pointing.js")),
];

/// Returns the scripts of all figures together with `own`, which may use their functions.
#[cfg(feature = "open")]
pub fn all_scripts(own: &str) -> String {
    let parts = PARTS.map(|p| p.1).join("\n");
    in_one_scope(&format!("{parts}\n{own}"))
}

/// Returns scripts as one scope, with their common part first and their start last.
fn in_one_scope(parts: &str) -> String {
    format!(
        "\n(function () {{\n\"use strict\";\n{}\n{parts}\n{}}})();\n",
        include_str!("../page/common.js"),
        include_str!("../page/start.js")
    )
}

/// Returns the script elements for a page with this body. The text is empty if the body has nothing to draw.
pub fn scripts(body: &str) -> String {
    let parts: Vec<&str> = PARTS
        .into_iter()
        .filter(|n| body.contains(n.0))
        .map(|n| n.1)
        .collect();
    if parts.is_empty() {
        return String::new();
    }
    format!("<script>{}</script>", in_one_scope(&parts.join("\n")))
}
