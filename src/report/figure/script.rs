//! The scripts of a page: for figures, for the model, for pointing at it; each only where it is needed.

/// Attributes of what they draw.
const CHART: &str = "data-figure=\"chart\"";
const SCENE: &str = "data-figure=\"scene\"";
const POINTING: &str = "data-pointing";

/// Returns the script elements for a page with this body. The text is empty if the body has nothing to draw.
pub fn scripts(body: &str) -> String {
    let needed = [
        (CHART, include_str!("../page/chart.js")),
        (SCENE, include_str!("../page/scene.js")),
        (SCENE, include_str!("../page/scene_view.js")),
        (POINTING, include_str!("../page/pointing.js")),
    ];
    let parts: Vec<&str> = needed
        .into_iter()
        .filter(|n| body.contains(n.0))
        .map(|n| n.1)
        .collect();
    if parts.is_empty() {
        return String::new();
    }
    format!(
        "<script>\n(function () {{\n\"use strict\";\n{}\n{}\n{}}})();\n</script>",
        include_str!("../page/common.js"),
        parts.join("\n"),
        include_str!("../page/start.js")
    )
}
