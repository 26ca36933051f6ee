//! Sensitivity `S` in `eps = S f`: what each gauge reads per unit of each load, and what that can tell apart.

mod from_solution;
mod separate;
mod types;

pub use from_solution::*;
pub use separate::*;
pub use types::*;

#[cfg(test)]
mod tests;
