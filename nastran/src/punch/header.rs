//! The `$` lines of a block.

use crate::results::{Analysis, ElementType, Quantity};

/// Content of the `$` lines read so far, for the entries that follow.
#[derive(Clone, Debug)]
pub(super) struct Header {
    pub titles: [String; 3],
    /// The quantity line as written, without `$`.
    pub table: String,
    pub quantity: Quantity,
    pub complex: bool,
    pub sort2: bool,
    pub subcase: u32,
    pub element: Option<ElementType>,
    /// Text after the number in `$ELEMENT TYPE`.
    pub element_words: String,
    pub analysis: Analysis,
    pub mode: i32,
    pub step: f64,
}

impl Default for Header {
    fn default() -> Self {
        Self {
            titles: Default::default(),
            table: String::new(),
            quantity: Quantity::Other,
            complex: false,
            sort2: false,
            subcase: 0,
            element: None,
            element_words: String::new(),
            analysis: Analysis::Statics,
            mode: 0,
            step: 0.0,
        }
    }
}

impl Header {
    /// Reads one `$` line (columns 73 to 80 already removed).
    pub(super) fn take(&mut self, line: &str) {
        let body = line.trim_start_matches('$').trim_end();
        let Some((key, value)) = body.split_once('=') else {
            return self.take_word(body.trim());
        };
        let (key, value) = (key.trim(), value.trim());
        match key {
            // A title begins a new header: values that apply only to the last block are reset.
            "TITLE" => {
                *self = Self {
                    titles: [value.to_string(), String::new(), String::new()],
                    subcase: self.subcase,
                    ..Self::default()
                }
            }
            "SUBTITLE" => self.titles[1] = value.to_string(),
            "LABEL" => self.titles[2] = value.to_string(),
            "SUBCASE ID" => self.subcase = first_number(value).unwrap_or(0),
            "ELEMENT TYPE" => {
                self.element = first_number(value).map(ElementType);
                self.element_words = value
                    .trim_start_matches(|c: char| c.is_ascii_digit())
                    .trim()
                    .to_string();
            }
            // SORT2, such as `11 IDENTIFIED BY FREQUENCY`: the entries are the steps of entity 11.
            "POINT ID" | "ELEMENT ID" => {
                self.sort2 = true;
                let by = value.split_once("IDENTIFIED BY").map(|by| by.1.trim());
                if let Some(found) = by.and_then(analysis_of) {
                    self.analysis = found;
                }
            }
            _ if analysis_of(key).is_some() => {
                self.analysis = analysis_of(key).unwrap_or(self.analysis);
                let mut parts = value.split_whitespace();
                self.step = parts
                    .next()
                    .and_then(super::entry::parse_real)
                    .unwrap_or(f64::NAN);
                self.mode = value
                    .rsplit_once('=')
                    .and_then(|(_, n)| n.trim().parse().ok())
                    .unwrap_or(0);
            }
            _ => {}
        }
    }

    fn take_word(&mut self, word: &str) {
        let quantity = match word {
            w if w.contains("OUTPUT") => {
                self.complex =
                    w.contains("IMAGINARY") || w.contains("PHASE") || w.contains("COMPLEX");
                return;
            }
            w if w.contains("(SOLUTION SET)") || w.contains("RMS") || w.contains("PSD") => {
                Quantity::Other
            }
            w if w.starts_with("DISPLACEMENT") => Quantity::Displacement,
            w if w.starts_with("VELOCIT") => Quantity::Velocity,
            w if w.starts_with("ACCELERATION") => Quantity::Acceleration,
            w if w.starts_with("EIGENVECTOR") => Quantity::Eigenvector,
            w if w.starts_with("SPCF") => Quantity::SpcForce,
            w if w.starts_with("MPCF") => Quantity::MpcForce,
            w if w.starts_with("OLOAD") => Quantity::AppliedLoad,
            w if w.starts_with("ELEMENT FORCES") => Quantity::ElementForce,
            w if w.starts_with("ELEMENT STRESSES") => Quantity::Stress,
            w if w.starts_with("ELEMENT STRAINS") => Quantity::Strain,
            "" => return,
            _ => Quantity::Other,
        };
        self.quantity = quantity;
        self.table = word.to_string();
        if quantity == Quantity::Eigenvector {
            self.analysis = Analysis::Modes;
        }
    }

    /// Returns the analysis. Results in complex numbers are not static.
    pub(super) fn analysis(&self) -> Analysis {
        match (self.analysis, self.complex) {
            (Analysis::Statics, true) => Analysis::Other(0),
            (Analysis::Modes, true) => Analysis::ComplexEigen,
            (analysis, _) => analysis,
        }
    }

    /// Returns the quantity; results of plies are a separate quantity.
    pub(super) fn quantity(&self) -> Quantity {
        let plies = self
            .element
            .is_some_and(|e| matches!(e.0, 95..=98 | 232 | 233));
        match (self.quantity, plies) {
            (Quantity::Stress, true) => Quantity::PlyStress,
            (Quantity::Strain, true) => Quantity::PlyStrain,
            (q, _) => q,
        }
    }
}

/// Returns the analysis of a keyword that names its steps.
fn analysis_of(word: &str) -> Option<Analysis> {
    Some(match word {
        "FREQUENCY" => Analysis::Frequency,
        "TIME" => Analysis::Transient,
        "COMPLEX EIGENVALUE" => Analysis::ComplexEigen,
        "EIGENVALUE" | "EIGR" | "MODE" => Analysis::Modes,
        "LOAD FACTOR" | "LOAD STEP" => Analysis::NonlinearStatics,
        _ => return None,
    })
}

fn first_number(text: &str) -> Option<u32> {
    let digits = text.split(|c: char| !c.is_ascii_digit()).next()?;
    digits.parse().ok()
}
