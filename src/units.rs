//! Units at the door.
