//! Figures of a page. This module turns plain numbers into data that the script of the page draws as SVG. Script and data are part of the page, so
//! that it needs no network.

mod agreement;
mod chart;
mod curve;
mod gap;
mod heat_map;
mod history;
mod intervals;
mod lines;
mod load_cross_plot;
mod packed_numbers;
mod script;

pub use agreement::{GaugePoints, agreement};
pub use chart::Figure;
pub(in crate::report) use chart::embed_data;
pub use curve::{CountPoint, curve};
pub use gap::gap_by_channel;
pub use heat_map::heat_map;
pub use history::{LoadTrace, history};
pub use intervals::{Ends, IntervalRow, MOST_RATIO, interval_trace, intervals};
pub use lines::{Line, Scale, lines};
pub use load_cross_plot::{CrossPlot, cross_plot};
pub(in crate::report) use packed_numbers::{
    STEPS, packed_deltas, round_number, round_numbers, steps_of,
};
#[cfg(feature = "open")]
pub(in crate::report) use script::all_scripts;
pub(in crate::report) use script::scripts;

#[cfg(test)]
mod tests;
