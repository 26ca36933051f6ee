//! Bulk data from the geometry blocks, with one reader for each card, selected by the record code.
//!
//! A record begins with three numbers, the card's code. The third number may have a prefix. For example, 4501,45,1120001 is GRID (4501,45,1) with 11
//! words for each card and double precision. 5501,55,620016 is SPC (5501,55,16) with 6 words for each card and double precision.
//!
//! - [`fields`]: the consecutive words of a card. [`records`]: cards of fixed and of varying length.
//! - [`grids`], [`shells`], [`lines`], [`solids`], [`masses`], [`rigid`], [`constraints`], [`loads`], [`properties`], [`sections`], [`materials`],
//!   [`params`]: readers of the cards.
//! - [`dispatch`]: cards by record code. [`tidy`]: removal of cards that solvers add. [`unread_records`]: records without a reader.

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
