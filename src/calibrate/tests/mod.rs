mod bridges;
mod cause;
mod glued;
mod next;
mod scatter;
mod synthetic;
mod wrong;
