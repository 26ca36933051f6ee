//! Tables and pages of the strain commands.

mod calibrate_page;
mod fields;
mod gap_page;
mod gluing_page;
mod gluing_sheet;
mod installed_positions;
mod pages;
mod points;
mod solution;
mod tables;

pub use calibrate_page::calibrate_page;
pub use fields::strains_page;
pub use gap_page::{ADDED, GapReport, RunStrain, reconcile_page};
pub use gluing_page::gluing_page;
pub use gluing_sheet::gluing_sheet_md;
pub use installed_positions::{COLUMNS as GLUED_COLUMNS, write_installed_positions};
pub use pages::{HowMany, RecoveredRun, RecoveryPage, place_page, recover_page, sensitivity_page};
pub use points::gauges_vtu;
pub use solution::solution_page;
pub(in crate::report) use tables::corner_distances;
pub use tables::{GAUGES_HEAD, gauges_csv, gluing_sheet_csv, sensitivity_csv};
