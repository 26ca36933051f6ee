//! Tables and pages of the strain commands.

mod fields;
mod gap_page;
mod gap_svg;
mod history;
mod page;
mod pages;
mod solution;
mod svg;
mod tables;

pub use fields::strains_page;
pub use gap_page::reconcile_page;
pub use gap_svg::GapMark;
pub use history::{GaugePoints, LoadTrace};
pub use page::{Section, drawing_section, number, page, table, table_section};
pub use pages::{RecoveredRun, place_page, recover_page, sensitivity_page};
pub use solution::solution_page;
pub use svg::{interval_bars, measured_against_predicted, model_with_gauges};
pub(in crate::report) use tables::corner_distances;
pub use tables::{
    PlacedGauge, Role, gauges_csv, gluing_sheet_csv, gluing_sheet_md, sensitivity_csv,
};
