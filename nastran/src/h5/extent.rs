//! Length of the file that the superblock states.

/// Returns the length of the file that the superblock states. Returns `None` if the superblock has an unknown version or is cut.
///
/// # Reference
/// HDF5 file format specification, version 3.0, II.A: The end of file address follows the head and two other addresses. The head has 24 bytes in
/// version 0, 28 in version 1, and 12 in versions 2 and 3.
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
