mod bridges;
mod glued;
mod synthetic;
