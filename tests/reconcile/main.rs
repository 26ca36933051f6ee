//! Find the gap, name the missing effect, add it, show the gap shrink: cases whose effect is known.

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
