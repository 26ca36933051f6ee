//! Cross-sections of PBARL and PBEAML. [`shape`] contains the section types of the manual ([`massive`], [`open`], [`boxes`]). [`area`] integrates
//! over the parts of a section. [`thin`] computes the shear centre of open walls, [`cells`] the shear centre and torsion constant of closed walls.

mod area;
mod boxes;
mod cells;
mod massive;
mod open;
mod parts;
mod shape;
mod thin;

#[cfg(test)]
mod tests;

pub(super) use parts::Shape;
pub(super) use shape::{SectionFault, bar_section};
