//! Relations between the answers for two models of one structure: another form of the deck, another frame, other units,
//! the other side up.
//!
//! The tests run every command that uses strain in memory. They convert names and signs back and compare the numbers.

mod answers;
mod cards;
mod frame;
mod given;
mod job;
mod relations;
mod structures;
