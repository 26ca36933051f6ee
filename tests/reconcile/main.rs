//! Finds the gap, identifies the missing effect, adds it, and shows that the gap shrinks, for cases with a known
//! effect.

mod deck;
mod extended;
mod given;
mod heat;
mod hidden;
mod joint;
mod ladder;
mod local;
mod real;
mod smooth;
mod strips;
