//! Cross-sections of PBARL and PBEAML: [`shape`] knows the types of the manual, [`area`] integrates over their parts,
//! [`thin`] finds the shear centre of open walls.

mod area;
mod shape;
mod thin;

#[cfg(test)]
mod tests;

pub(super) use shape::{SectionFault, Shape, bar_section};
