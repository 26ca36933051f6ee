//! Figures of a page: plain numbers in, what the plotting script draws out. The script and its data stand in the page: no network.

mod agreement;
mod chart;
mod curve;
mod gap;
mod heat_map;
mod history;
mod intervals;
mod lines;
mod packed;
mod script;

pub use agreement::{GaugePoints, agreement};
pub use chart::Figure;
pub(in crate::report) use chart::embedded;
pub use curve::{CountPoint, curve};
pub use gap::gap_by_channel;
pub use heat_map::heat_map;
pub use history::{LoadTrace, history};
pub use intervals::{IntervalRow, intervals};
pub use lines::{Line, Scale, lines};
pub(in crate::report) use packed::{packed_f32, packed_i16, packed_u32, short, shorts};
pub(in crate::report) use script::{DRAWN, scripts};

#[cfg(test)]
mod tests;
