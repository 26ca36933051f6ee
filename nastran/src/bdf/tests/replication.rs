use super::{bulk, read_clean_deck};

#[test]
fn fields_are_repeated_and_increased() {
    // Example of the quick reference guide.
    let deck = read_clean_deck("GRID,101,17,1.0,10.5,,17,3456\n=,*(1),=,*(0.2),*(0.1),==\n=(3)\n");
    let ids: Vec<u32> = deck.cards.grids.iter().map(|g| g.id).collect();
    assert_eq!(ids, [101, 102, 103, 104, 105]);
    let last = &deck.cards.grids[4];
    assert_eq!((last.cp, last.cd), (Some(17), Some(17)));
    assert!((last.x[0] - 1.8).abs() < 1e-12 && (last.x[1] - 10.9).abs() < 1e-12);
    assert_eq!(last.ps.map(|p| p.to_string()).as_deref(), Some("3456"));
    assert_eq!(deck.counts["GRID"], 5);
}

#[test]
fn replication_works_in_fixed_fields_and_without_brackets() {
    let deck = read_clean_deck(
        "GRID    1               1.      2.      3.\n=       *1      =       *.5     ==\n=4\n",
    );
    assert_eq!(deck.cards.grids.len(), 6);
    assert_eq!(deck.cards.grids[5].x, [3.5, 2.0, 3.0]);
}

#[test]
fn a_new_value_replaces_the_repeated_one() {
    let deck = read_clean_deck("DEFORM,4,101,.05 $\n=,=,107,= $\n=,=,301,= $\n");
    assert_eq!(deck.counts["DEFORM"], 3);
    let force = read_clean_deck("FORCE,1,5,,1.,0.,0.,1.\n=,=,6,==\n");
    assert_eq!(
        (force.cards.forces[1].grid, force.cards.forces[1].n),
        (6, [0.0, 0.0, 1.0])
    );
}

#[test]
fn a_repetition_without_limit_is_a_fault_and_not_a_matter_of_memory() {
    let deck = bulk("GRID,1,,0.,0.,0.\n=,*1,==\n=(1000000000)\n");
    assert_eq!(deck.faults.len(), 1);
    // The deck keeps the first card and the card of the line with increments. No card of the billion repetitions is made.
    assert_eq!(deck.cards.grids.len(), 2);
}

#[test]
fn a_repetition_of_nothing_is_a_fault() {
    assert_eq!(bulk("=,*1,==\n").faults.len(), 1);
    assert_eq!(bulk("GRID,1\n=(3)\n").faults.len(), 1);
    assert_eq!(bulk("GRID,A\n=,*1,==\n").faults.len(), 2);
}
