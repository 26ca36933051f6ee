//! Tables and pages of the strain commands.

mod calibrate_page;
mod fields;
mod gap_page;
mod glued;
mod gluing;
mod gluing_page;
mod pages;
mod points;
mod solution;
mod tables;

pub use calibrate_page::calibrate_page;
pub use fields::strains_page;
pub use gap_page::{ADDED, GapReport, RunStrain, reconcile_page};
pub use glued::{COLUMNS as GLUED_COLUMNS, glued_csv};
pub use gluing::gluing_sheet_md;
pub use gluing_page::gluing_page;
pub use pages::{HowMany, Recovered, RecoveredRun, place_page, recover_page, sensitivity_page};
pub use points::gauges_vtu;
pub use solution::solution_page;
pub(in crate::report) use tables::corner_distances;
pub use tables::{gauges_csv, gluing_sheet_csv, sensitivity_csv};
