//! Cross-sections.
use super::types::Section;

pub(super) struct Shape {
    pub section: Section,
    pub k: [f64; 2],
}
pub(super) enum SectionFault {
    Unknown,
    Count { expected: usize },
    Shape,
}
pub(super) fn bar_section(_: &str, dims: &[f64]) -> Result<Shape, SectionFault> {
    match dims {
        [] => Err(SectionFault::Count { expected: 1 }),
        [0.0, ..] => Err(SectionFault::Shape),
        _ => Err(SectionFault::Unknown),
    }
}
