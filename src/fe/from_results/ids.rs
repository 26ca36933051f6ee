//! From ids of a file to indices of the model.

/// Lookup of ids in an ascending list. A sequence of ids in the order of the list costs one comparison for each id.
pub(super) struct Ids<'a, T, F> {
    list: &'a [T],
    id: F,
    next: usize,
}

impl<'a, T, F: Fn(&T) -> u32> Ids<'a, T, F> {
    pub(super) fn new(list: &'a [T], id: F) -> Self {
        Self { list, id, next: 0 }
    }

    /// Returns the index of `wanted` in the list.
    pub(super) fn find(&mut self, wanted: u32) -> Option<usize> {
        let here = self.next;
        let found = match self.list.get(here) {
            Some(entry) if (self.id)(entry) == wanted => here,
            _ => self.list.binary_search_by_key(&wanted, &self.id).ok()?,
        };
        self.next = found + 1;
        Some(found)
    }
}
