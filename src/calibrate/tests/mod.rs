mod bridges;
mod glued;
mod scatter;
mod synthetic;
mod wrong;
