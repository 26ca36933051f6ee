//! From ids of a file to indices of the model.

/// Finds ids in an ascending list; ids asked for in the list's own order cost one comparison each.
pub(super) struct Ids<'a, T, F> {
    list: &'a [T],
    id: F,
    next: usize,
}

impl<'a, T, F: Fn(&T) -> u32> Ids<'a, T, F> {
    pub(super) fn new(list: &'a [T], id: F) -> Self {
        Self { list, id, next: 0 }
    }

    /// The index of `wanted` in the list.
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
