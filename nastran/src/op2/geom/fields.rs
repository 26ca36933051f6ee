//! Reads the consecutive words of a card.

use crate::cards::Dofs;
use crate::op2::words::Words;

/// Largest id of an analyst's item; solvers number the items that they add from 100 000 001 on.
pub(super) const LARGEST_ID: i64 = 100_000_000;

/// Reads words in order. Every reader returns `None` at the end of the words, or if the value is impossible.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fields<'a> {
    words: Words<'a>,
    at: usize,
    /// Whether reals take two words, in a 32-bit file.
    double: bool,
}

impl<'a> Fields<'a> {
    pub(super) fn new(words: Words<'a>, double: bool) -> Self {
        Fields {
            words,
            at: 0,
            double: double && words.format.bytes() == 4,
        }
    }

    /// Returns the number of words that are not yet read.
    pub(super) fn words_left(&self) -> usize {
        self.words.len().saturating_sub(self.at)
    }

    /// Returns the next word and does not advance.
    pub(super) fn peek(&self) -> Option<i64> {
        self.words.int(self.at)
    }

    pub(super) fn skip(&mut self, n: usize) -> Option<()> {
        self.at = self
            .at
            .checked_add(n)
            .filter(|at| *at <= self.words.len())?;
        Some(())
    }

    pub(super) fn int(&mut self) -> Option<i64> {
        let value = self.words.int(self.at)?;
        self.at = self.at.checked_add(1)?;
        Some(value)
    }

    /// Reads a required id: 1 or more.
    pub(super) fn id(&mut self) -> Option<u32> {
        u32::try_from(self.int()?).ok().filter(|id| *id > 0)
    }

    /// Reads an id or 0.
    pub(super) fn id_or_zero(&mut self) -> Option<u32> {
        u32::try_from(self.int()?).ok()
    }

    /// Reads an id; 0 and negative numbers are blanks.
    pub(super) fn blank_or_id(&mut self) -> Option<Option<u32>> {
        let word = self.int()?;
        Some(u32::try_from(word).ok().filter(|id| *id > 0))
    }

    /// Reads an id that may be negative.
    pub(super) fn read_signed_id(&mut self) -> Option<i32> {
        i32::try_from(self.int()?).ok()
    }

    pub(super) fn read_real(&mut self) -> Option<f64> {
        let (value, n) = if self.double {
            (self.words.double_at(self.at)?, 2)
        } else {
            (self.words.real_at(self.at)?, 1)
        };
        self.at = self.at.checked_add(n)?;
        Some(value)
    }

    /// Reads a real, and refuses an integer read as a real: the value must be 0 or of a usual size.
    pub(super) fn usual_real(&mut self) -> Option<f64> {
        self.read_real()
            .filter(|x| *x == 0.0 || (1e-30..1e30).contains(&x.abs()))
    }

    /// Reads a real; the solvers' mark for a blank field (1.7368e-18) is `None`.
    pub(super) fn blank_or_real(&mut self) -> Option<Option<f64>> {
        let x = self.read_real()?;
        Some(Some(x).filter(|x| !(1.7366e-18..1.7370e-18).contains(&x.abs())))
    }

    pub(super) fn reals<const N: usize>(&mut self) -> Option<[f64; N]> {
        let mut out = [0.0; N];
        for x in &mut out {
            *x = self.read_real()?;
        }
        Some(out)
    }

    pub(super) fn ids<const N: usize>(&mut self) -> Option<[u32; N]> {
        let mut out = [0; N];
        for id in &mut out {
            *id = self.id()?;
        }
        Some(out)
    }

    /// Reads an 8-byte real from two words of a 32-bit file, or from the first of two words of a 64-bit file.
    pub(super) fn pair(&mut self, narrow: bool) -> Option<f64> {
        let value = if narrow {
            self.words.double_at(self.at)?
        } else {
            self.words.real_at(self.at)?
        };
        self.skip(2)?;
        Some(value)
    }

    /// Reads `n` words of characters.
    pub(super) fn text(&mut self, n: usize) -> Option<String> {
        let text = self.words.part(self.at, n)?.text(0, n);
        self.at = self.at.checked_add(n)?;
        Some(text)
    }

    /// Reads components as digits.
    pub(super) fn dofs(&mut self) -> Option<Dofs> {
        Dofs::from_digits(u32::try_from(self.int()?).ok()?)
    }

    /// Reads components; 0 or a negative number means no components.
    pub(super) fn blank_or_dofs(&mut self) -> Option<Option<Dofs>> {
        match self.peek()? {
            ..=0 => self.skip(1).map(|()| None),
            _ => self.dofs().map(Some),
        }
    }

    /// Reads ids up to the next word that is not positive; that word is read, too.
    pub(super) fn ids_until_mark(&mut self) -> Option<(Vec<u32>, i64)> {
        let mut ids = Vec::new();
        loop {
            match self.int()? {
                mark @ ..=0 => return Some((ids, mark)),
                id => ids.push(u32::try_from(id).ok()?),
            }
        }
    }
}
