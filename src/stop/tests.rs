use super::Stop;

#[test]
fn the_wish_is_shared_by_clones_and_the_default_has_none() {
    let (stop, never) = (Stop::new(), Stop::default());
    let clone = stop.clone();
    assert!(!clone.is_asked());
    stop.ask();
    never.ask();
    assert!(clone.is_asked() && !never.is_asked());
}
