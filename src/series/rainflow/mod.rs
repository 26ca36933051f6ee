//! Rainflow cycles and the pseudo-damage they make.

mod count;
mod damage;

pub use count::{Cycle, Point, Rainflow};
pub use damage::{Bin, Damage};

#[cfg(test)]
mod tests;
