//! Cross-sections of PBARL and PBEAML: [`shape`] knows the types of the manual ([`massive`], [`open`], [`boxes`]), [`area`] integrates
//! over their parts, [`thin`] finds the shear centre of open walls, [`cells`] that and the torsion of closed ones.

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
