//! Evidence that a file was cut or damaged.

/// A place at which a file contradicts itself. Content after this place may be missing or wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Damage {
    /// Place: table and record, a line, or a path within the file.
    pub at: String,
    /// Description of the damage.
    pub what: String,
}

impl std::fmt::Display for Damage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.at, self.what)
    }
}

/// Readable part of a file, with its damage; an undamaged file has an empty list.
#[derive(Clone, Debug)]
pub struct SalvagedFile<T> {
    /// Readable part.
    pub file: T,
    /// Damage in file order.
    pub damage: Vec<Damage>,
}

impl<T> SalvagedFile<T> {
    /// Returns the file if it is undamaged.
    ///
    /// # Errors
    /// The first damage.
    pub fn require_undamaged(self) -> Result<T, Damage> {
        match self.damage.into_iter().next() {
            None => Ok(self.file),
            Some(damage) => Err(damage),
        }
    }

    /// Converts the file and keeps the damage.
    pub fn map<U>(self, form: impl FnOnce(T) -> U) -> SalvagedFile<U> {
        SalvagedFile {
            file: form(self.file),
            damage: self.damage,
        }
    }
}
