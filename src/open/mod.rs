//! `strainbridge open`: a plan of gauges made live in a browser. A server on the loopback addresses answers one page; the state of the plan is two
//! texts, which the page holds and which "save" writes next to the job.

mod calls;
mod guard;
mod http;
mod saved;
mod seen_files;
mod server;
mod session;
mod shell;

pub use http::Limits;
pub use server::Server;
pub use session::{Session, Surroundings};
