//! A report page: what it says as plain blocks, drawn as HTML here and as PDF by `report::pdf`.

mod block;
mod html;

pub use crate::units::number;
pub use block::{
    Block, Card, CellLink, Page, Paper, Section, Table, figure_section, table_section,
};
pub(in crate::report) use html::{block as block_html, judged};
