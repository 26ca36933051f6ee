//! Tables of FlatBuffers, as Arrow writes its schema and its messages.

/// Bytes of tables. Places count from the first byte. A place outside of the bytes gives `None`.
///
/// # Reference
/// FlatBuffers, internals.
#[derive(Clone, Copy)]
pub(super) struct Buffer<'a>(pub &'a [u8]);

impl<'a> Buffer<'a> {
    pub(super) fn byte(&self, at: usize) -> Option<u8> {
        self.0.get(at).copied()
    }

    pub(super) fn half(&self, at: usize) -> Option<u16> {
        let bytes = self.0.get(at..)?.first_chunk()?;
        Some(u16::from_le_bytes(*bytes))
    }

    pub(super) fn word(&self, at: usize) -> Option<u32> {
        let bytes = self.0.get(at..)?.first_chunk()?;
        Some(u32::from_le_bytes(*bytes))
    }

    /// Returns a 64-bit integer that is a size or a place. `None` if it is negative.
    pub(super) fn size(&self, at: usize) -> Option<usize> {
        let bytes = self.0.get(at..)?.first_chunk()?;
        usize::try_from(i64::from_le_bytes(*bytes)).ok()
    }

    /// Returns the place to which the offset at place `at` points.
    pub(super) fn follow(&self, at: usize) -> Option<usize> {
        at.checked_add(self.word(at)? as usize)
    }

    /// Returns the place of field `number` of a table. `None` if the field was left out.
    pub(super) fn field(&self, table: usize, number: usize) -> Option<usize> {
        let back = self.word(table)? as i32;
        let list = (table as i64).checked_sub(i64::from(back))?;
        let list = usize::try_from(list).ok()?;
        let place = 4 + 2 * number;
        if place >= usize::from(self.half(list)?) {
            return None;
        }
        let offset = self.half(list.checked_add(place)?)?;
        (offset > 0).then(|| table.checked_add(usize::from(offset)))?
    }

    /// Returns the table to which field `number` of a table refers. `None` if the field was left out.
    pub(super) fn child(&self, table: usize, number: usize) -> Option<usize> {
        self.follow(self.field(table, number)?)
    }

    /// Returns the places of the entries of the list in field `number` of a table. Each entry has `width` bytes. The list is empty if the field was
    /// left out.
    pub(super) fn list(&self, table: usize, number: usize, width: usize) -> Option<Vec<usize>> {
        let Some(at) = self.field(table, number) else {
            return Some(Vec::new());
        };
        let at = self.follow(at)?;
        let (count, first) = (self.word(at)? as usize, at.checked_add(4)?);
        let end = first.checked_add(count.checked_mul(width)?)?;
        self.0.get(first..end)?;
        Some((0..count).map(|i| first + width * i).collect())
    }

    pub(super) fn text(&self, at: usize) -> Option<&'a str> {
        let length = self.word(at)? as usize;
        let bytes = self.0.get(at.checked_add(4)?..)?.get(..length)?;
        std::str::from_utf8(bytes).ok()
    }
}
