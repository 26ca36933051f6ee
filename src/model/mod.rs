//! What a deck means: ids resolved, coordinates in the basic frame, defaults applied, faults found.

mod types;
pub use types::*;
