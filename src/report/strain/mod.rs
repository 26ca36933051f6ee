//! Tables and pages of the strain commands.

mod fields;
mod page;
mod pages;
mod svg;
mod tables;

pub use fields::strains_page;
pub use page::{Section, page, table};
pub use pages::{RecoveredRun, place_page, recover_page, sensitivity_page};
pub use tables::{PlacedGauge, gauges_csv, gluing_sheet_csv, gluing_sheet_md, sensitivity_csv};
