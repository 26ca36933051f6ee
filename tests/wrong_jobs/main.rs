//! A faulty job ends in an error or a fault that names the problem, both with its command and with `check`.

mod check;
mod copies;
mod files;
mod strange;
mod units;
