//! What a name does in linear statics, mass and modes.

/// Effect of a name on linear statics, mass and modes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// The readers of this program carry it.
    Carried,
    /// An output request that is read.
    Request,
    /// It changes none of them, for this reason.
    None(&'static str),
    /// It acts wherever it is in the deck, and is not carried.
    Acts,
    /// A load that is not carried; its first field is its set, and it acts where the set is selected.
    Load,
    /// It acts where this word of case control is stated, or with what is named here (connectors, values of its own), and is not carried.
    ActsWith(&'static str),
    /// A statement of executive control, above CEND.
    Executive,
    /// A statement of executive control that changes the solution sequence, or starts from an earlier run.
    ExecutiveActs,
}

/// A word of case control as Nastran reads it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CaseWord {
    /// Its full name; synonyms have one name.
    pub name: &'static str,
    /// What it does.
    pub effect: Effect,
    /// It is no abbreviation of the full name: its first four letters decide.
    pub misspelt: bool,
}
