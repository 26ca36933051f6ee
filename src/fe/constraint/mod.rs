//! Dependent dofs: rigid elements, averages, equations and supports, all as u = T q + u0.

mod body;
mod mean;
mod reduction;
mod relation;

pub(crate) use reduction::{Reduction, Sets, State, reduce};
