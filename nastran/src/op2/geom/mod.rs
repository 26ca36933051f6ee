//! Bulk data out of the geometry blocks: one reader per card, chosen by record code.
//!
//! A record begins with three numbers, the card's code. The third may carry a prefix: 4501,45,1120001 is GRID (4501,45,1) with
//! 11 words a card and double precision, 5501,55,620016 is SPC (5501,55,16) with 6 words and double precision.
//!
//! - [`fields`] the words of a card one after the other; [`records`] cards of fixed and of varying length;
//! - [`grids`], [`shells`], [`lines`], [`solids`], [`masses`], [`rigid`], [`constraints`], [`loads`], [`properties`], [`sections`],
//!   [`materials`], [`params`] the cards; [`dispatch`] which code is which; [`tidy`] what solvers add on their own;
//!   [`unread_records`] records without a reader.

mod constraints;
mod dispatch;
mod fields;
mod grids;
mod lines;
mod loads;
mod masses;
mod materials;
mod params;
mod properties;
mod records;
mod rigid;
mod sections;
mod shells;
mod solids;
mod tidy;
mod unread_records;

pub(super) use dispatch::read_record;
pub(super) use params::read_params;
pub(super) use records::Geometry;
pub(super) use tidy::tidy;
