//! Cross-sections of PBARL and PBEAML: [`shape`] knows the types of the manual ([`massive`], [`open`]), [`area`] integrates over their parts,
//! [`thin`] finds the shear centre of open walls.

mod area;
mod massive;
mod open;
mod parts;
mod shape;
mod thin;

#[cfg(test)]
mod tests;

pub(super) use parts::Shape;
pub(super) use shape::{SectionFault, bar_section};
