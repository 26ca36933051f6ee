//! Jobs with something wrong in them end in an error or a fault that names it, by their commands and by `check` alike.

mod check;
mod copies;
mod files;
mod strange;
mod units;
