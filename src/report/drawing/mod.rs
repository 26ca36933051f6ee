//! Figures, and the model with its gauges, as pictures of lines, areas and text: for paper and for pages without a script.

mod chart;
mod heat;
pub(super) mod picture;
mod scale;
mod sketch;
mod svg;
mod traces;
mod trails;

pub(super) use chart::{card_picture, pictures};
pub(super) use scale::round_step;
pub(super) use sketch::{Look, STROKES, marks, views};
pub(super) use svg::to_svg;

#[cfg(test)]
mod tests;
