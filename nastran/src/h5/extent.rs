//! The length of the file that the superblock states.

/// Bytes that the file must have by its superblock; `None` where the superblock is of no known version or cut itself.
///
/// # Reference
/// HDF5 file format specification, version 3.0, II.A: versions 0 and 1 keep the end of file address after two addresses behind the
/// 24 (28) bytes of the head, versions 2 and 3 behind 12.
pub(super) fn stated_length(bytes: &[u8]) -> Option<u64> {
    let version = *bytes.get(8)?;
    let (size_at, head) = match version {
        0 => (13, 24),
        1 => (13, 28),
        2 | 3 => (9, 12),
        _ => return None,
    };
    let size = usize::from(*bytes.get(size_at)?);
    let at = size.checked_mul(2)?.checked_add(head)?;
    let field = bytes.get(at..at.checked_add(size)?)?;
    let mut address = [0; 8];
    address.get_mut(..size)?.copy_from_slice(field);
    Some(u64::from_le_bytes(address)).filter(|&a| a != u64::MAX)
}
