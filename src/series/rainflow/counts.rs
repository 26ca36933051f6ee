//! Counts by class. Recent classes are in a small table, all further classes in an ordered map.

use std::collections::BTreeMap;

/// Places of the small table; a power of two.
const PLACES: usize = 1024;

/// A class, or a pair of classes.
pub(super) trait Key: Copy + Ord {
    /// A number that neighbours don't share.
    fn number(self) -> u32;
}

impl Key for i32 {
    #[inline(always)]
    fn number(self) -> u32 {
        self.cast_unsigned()
    }
}

impl Key for (i32, i32) {
    #[inline(always)]
    fn number(self) -> u32 {
        // Successive reversals of a load seldom differ by more than 37 classes.
        let (a, b) = (self.0.cast_unsigned(), self.1.cast_unsigned());
        a.wrapping_mul(37).wrapping_add(b)
    }
}

/// Number of occurrences of each class. A load stays in a few classes for some time. The small table finds these classes fast.
pub(super) struct Counts<K> {
    lately: Vec<Option<(K, u64)>>,
    all: BTreeMap<K, u64>,
}

impl<K: Key> Counts<K> {
    /// Creates empty counts.
    pub(super) fn new() -> Self {
        Self {
            lately: vec![None; PLACES],
            all: BTreeMap::new(),
        }
    }

    /// Adds one to the count.
    #[inline(always)]
    pub(super) fn add(&mut self, key: K) {
        let Some(slot) = self.lately.get_mut(key.number() as usize % PLACES) else {
            return;
        };
        match slot {
            Some((k, n)) if *k == key => *n += 1,
            _ => {
                if let Some((k, n)) = slot.replace((key, 1)) {
                    *self.all.entry(k).or_insert(0) += n;
                }
            }
        }
    }

    /// Returns the classes in order, with the number of occurrences of each class.
    pub(super) fn sort_classes(mut self) -> BTreeMap<K, u64> {
        for (k, n) in self.lately.into_iter().flatten() {
            *self.all.entry(k).or_insert(0) += n;
        }
        self.all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_that_share_a_place_are_counted_each() {
        let mut counts = Counts::new();
        for i in 0..7000_i32 {
            counts.add((i % 7 * 1024, -(i % 5) * 3));
        }
        let all = counts.sort_classes();
        assert_eq!(all.len(), 35);
        assert!(all.values().all(|n| *n == 200));
    }
}
