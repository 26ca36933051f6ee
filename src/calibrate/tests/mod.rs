mod bridges;
mod cause;
mod glued;
mod next;
mod repeats;
mod scatter;
mod synthetic;
mod wrong;
