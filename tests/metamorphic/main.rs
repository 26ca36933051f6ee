//! Relations that hold between the answers on two models of one structure: another form of the deck, another frame, other units, the other
//! side up. Every command that uses strain is asked in memory, and its numbers are compared after names and signs are mapped back.

mod answers;
mod cards;
mod frame;
mod given;
mod job;
mod relations;
mod structures;
