//! A report page as plain blocks, rendered as HTML here and as PDF by `report::pdf`.

mod block;
mod findings;
mod html;
mod key_number;
mod summary_screen;
mod table;

pub use crate::units::number;
pub use block::{
    Block, Card, CellLink, FirstScreen, Page, Paper, Section, Table, figure_section, table_section,
};
pub(in crate::report) use findings::reliability;
#[cfg(feature = "open")]
pub(in crate::report) use html::STYLE;
pub(in crate::report) use html::block as block_html;
pub use key_number::KeyNumber;
