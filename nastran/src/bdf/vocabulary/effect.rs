//! Effects of names on linear statics, mass and modes.

/// Effect of a name on linear statics, mass and modes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// The readers of this program carry it.
    Carried,
    /// Output request that is read.
    Request,
    /// No influence, for this reason.
    None(&'static str),
    /// Acts wherever the deck has it, and is not carried.
    Acts,
    /// Load that is not carried and acts where its set, the first field, is selected.
    Load,
    /// Acts together with this word of case control, or with the items named here (connectors, its own values), and is not carried.
    ActsWith(&'static str),
    /// Statement of executive control, above CEND.
    Executive,
    /// Statement of executive control that changes the solution sequence, or starts from an earlier run.
    ExecutiveActs,
}

impl Effect {
    /// Returns whether the name is a statement above CEND.
    pub(crate) fn is_executive(self) -> bool {
        matches!(self, Effect::Executive | Effect::ExecutiveActs)
    }
}

/// A word of case control as Nastran reads it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CaseWord {
    /// Full name of the word; synonyms have one name.
    pub name: &'static str,
    /// Effect of the word.
    pub effect: Effect,
}
