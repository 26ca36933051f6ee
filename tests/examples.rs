//! Runs the examples of the library, which compare their result with a known number.

#[path = "../examples/place.rs"]
mod place;
#[path = "../examples/reconcile.rs"]
mod reconcile;
#[path = "../examples/recover.rs"]
mod recover;

#[test]
fn four_gauges_are_placed_with_their_certificate() {
    place::main().unwrap();
}

#[test]
fn the_intervals_hold_the_loads_that_were_put_on() {
    recover::main().unwrap();
}

#[test]
fn the_gauge_that_reads_the_negative_is_named() {
    reconcile::main().unwrap();
}
