//! Key of a stored solution.

use sha2::{Digest, Sha256};

/// Key of a stored solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Key(pub(super) [u8; 32]);

impl Key {
    /// Returns the key of a text that states all inputs of a solution.
    pub fn from_identity(identity: &str) -> Self {
        Self(Sha256::digest(identity.as_bytes()).into())
    }

    /// Returns the first half of the key in hexadecimal digits: the name of a file.
    pub fn name(&self) -> String {
        self.0[..16].iter().map(|b| format!("{b:02x}")).collect()
    }
}
