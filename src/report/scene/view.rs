//! A scene ready to be shown.

use super::types::Mark;
use crate::model::Vec3;
use crate::report::drawing::picture::Picture;
use maud::Markup;

/// A scene ready to be shown.
#[derive(Clone, Debug)]
pub struct SceneView {
    /// Markup of the three-dimensional scene for a browser.
    pub markup: Markup,
    /// Caption of the scene.
    pub caption: String,
    /// Still picture of the scene from its first point of view; its caption states the range of the colours.
    pub(in crate::report) still: Picture,
    /// Outline of the shells and axes of the bars, basic frame.
    pub lines: Vec<[Vec3; 2]>,
    /// Gauges.
    pub marks: Vec<Mark>,
}
