//! Sensitivity `S` in `eps = S f`: what each gauge reads per unit of each load, and what that can tell apart.

mod from_solution;
mod separate;
mod types;
mod uncertainty;

pub use from_solution::*;
pub use separate::*;
pub use types::*;
pub use uncertainty::*;

#[cfg(test)]
mod tests;
