//! What shows that a file was cut or damaged.

/// A place where a file contradicts itself: the rest of it may be missing, or wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Damage {
    /// Where: table and record, a line, or a path within the file.
    pub at: String,
    /// What was found there.
    pub what: String,
}

impl std::fmt::Display for Damage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.at, self.what)
    }
}

/// What could be read of a file, and every damage that was met; of an unharmed file there is none.
#[derive(Clone, Debug)]
pub struct Salvaged<T> {
    /// What could be read.
    pub file: T,
    /// In file order.
    pub damage: Vec<Damage>,
}

impl<T> Salvaged<T> {
    /// The file if it is whole.
    ///
    /// # Errors
    /// The first damage.
    pub fn whole(self) -> Result<T, Damage> {
        match self.damage.into_iter().next() {
            None => Ok(self.file),
            Some(damage) => Err(damage),
        }
    }

    /// The same damage round another form of the file.
    pub fn map<U>(self, form: impl FnOnce(T) -> U) -> Salvaged<U> {
        Salvaged {
            file: form(self.file),
            damage: self.damage,
        }
    }
}
