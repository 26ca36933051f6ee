mod bridges;
mod synthetic;
