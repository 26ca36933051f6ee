//! Cards as text, with running grid and element numbers.

use std::fmt::Write;

/// Text of a deck that is being written.
pub struct DeckText {
    text: String,
    next_grid: u32,
    next_element: u32,
}

/// A field of a card.
pub enum Field {
    Int(u32),
    Real(f64),
    Text(&'static str),
    Blank,
}

impl From<u32> for Field {
    fn from(value: u32) -> Self {
        Self::Int(value)
    }
}
impl From<f64> for Field {
    fn from(value: f64) -> Self {
        Self::Real(value)
    }
}
impl From<&'static str> for Field {
    fn from(value: &'static str) -> Self {
        if value.is_empty() {
            Self::Blank
        } else {
            Self::Text(value)
        }
    }
}

/// Fields of a card from mixed values; `""` is a blank.
#[macro_export]
macro_rules! fields {
    ($($value:expr),* $(,)?) => { vec![$($crate::deck::Field::from($value)),*] };
}

impl DeckText {
    /// Returns an empty deck; grids and elements count from 1.
    pub fn new() -> Self {
        Self {
            text: String::new(),
            next_grid: 0,
            next_element: 0,
        }
    }

    /// Writes a comment line.
    pub fn comment(&mut self, words: &str) {
        let _ = writeln!(self.text, "$ {words}");
    }

    /// Writes a card in 8-column fields.
    pub fn card(&mut self, name: &str, fields: Vec<Field>) {
        for (i, line) in fields.chunks(8).enumerate() {
            let _ = write!(self.text, "{:<8}", if i == 0 { name } else { "" });
            for field in line {
                let word = match field {
                    Field::Int(v) => v.to_string(),
                    Field::Real(v) => format_real(*v),
                    Field::Text(t) => (*t).to_owned(),
                    Field::Blank => String::new(),
                };
                let _ = write!(self.text, "{word:>8}");
            }
            let end = self.text.trim_end().len();
            self.text.truncate(end);
            self.text.push('\n');
        }
    }

    /// Writes a grid and returns its id.
    pub fn grid(&mut self, x: [f64; 3]) -> u32 {
        self.next_grid += 1;
        self.grid_with_id(self.next_grid, x);
        self.next_grid
    }

    /// Writes a grid with a given id.
    pub fn grid_with_id(&mut self, id: u32, x: [f64; 3]) {
        self.card("GRID", fields![id, "", x[0], x[1], x[2]]);
    }

    /// Returns the next element id.
    pub fn element(&mut self) -> u32 {
        self.next_element += 1;
        self.next_element
    }

    /// Writes an RBE2: all six dofs of `dependent` follow `independent`.
    pub fn rbe2(&mut self, independent: u32, dependent: &[u32]) {
        let mut fields = fields![self.element(), independent, 123456_u32];
        fields.extend(dependent.iter().map(|g| Field::Int(*g)));
        self.card("RBE2", fields);
    }

    /// Writes an RBE3: `reference` moves as the mean of the translations of `arms`.
    pub fn rbe3(&mut self, reference: u32, arms: &[u32]) {
        let mut fields = fields![self.element(), "", reference, 123456_u32, 1.0, 123_u32];
        fields.extend(arms.iter().map(|g| Field::Int(*g)));
        self.card("RBE3", fields);
    }

    /// Returns the complete deck.
    pub fn finish(self, name: &str) -> String {
        format!(
            "SOL 101\nCEND\nTITLE = {name}\nECHO = NONE\nBEGIN BULK\n$ t, mm, s, N; x to the rear, y to the right, z up from the ground\n\
             PARAM,INREL,-2\nPARAM,POST,-1\nPARAM,GRDPNT,0\n{}ENDDATA\n",
            self.text
        )
    }
}

/// Returns a form of a real that fits eight columns, with as many digits as fit.
fn format_real(value: f64) -> String {
    let plain = format!("{value:?}");
    if plain.len() <= 8 && plain.contains('.') && !plain.contains('e') {
        return plain;
    }
    if (1e-2..1e6).contains(&value.abs()) {
        for digits in (1..=6).rev() {
            let word = format!("{value:.digits$}");
            if word.len() <= 8 {
                return word;
            }
        }
    }
    for digits in (0..=5).rev() {
        let word = format!("{value:.digits$e}");
        let (mantissa, exponent) = word.split_once('e').unwrap_or((&word, "0"));
        let point = if mantissa.contains('.') { "" } else { "." };
        let sign = if exponent.starts_with('-') { "" } else { "+" };
        let word = format!("{mantissa}{point}{sign}{exponent}");
        if word.len() <= 8 {
            return word;
        }
    }
    unreachable!("a one-digit mantissa fits eight columns")
}
