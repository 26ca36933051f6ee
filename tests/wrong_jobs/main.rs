//! Jobs with something wrong in them end in an error or a fault that names it.

mod files;
mod units;
