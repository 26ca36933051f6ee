//! Layouts of rows and their decoding.

mod decode;
mod layout;

pub(super) use decode::decode;
pub(super) use layout::{Layout, Shape, layout};
