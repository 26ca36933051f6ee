//! From plain results to bytes: text, json, csv, html, pdf, spreadsheets. Nothing is computed here.

pub mod command;
pub mod console;
mod covariance;
mod csv_cell;
mod drawing;
pub mod figure;
pub mod gauge_table;
#[cfg(feature = "open")]
pub mod live;
mod mode_blocks;
pub mod notebook;
pub mod page;
#[cfg(feature = "pdf")]
pub mod pdf;
pub mod reference;
mod result_blocks;
pub mod scene;
pub mod spreadsheet;
pub mod strain;
mod strains;
pub mod vehicle;
mod vtu;
mod vtu_arrays;
mod vtu_points;

pub use csv_cell::csv_cell;
pub use result_blocks::{PlannedBlock, planned_blocks, rows_of_block};
pub use strains::{STRAINS_HEADER, strains_columns, write_strains};
pub use vtu::{vtk_cells, write_cells_vtu, write_vtu};
pub use vtu_arrays::{MeshArrays, NamedArray, Numbers, write_arrays_vtu};
pub use vtu_points::{PointValues, write_points_vtu};
