//! Effects of names on linear statics, mass and modes.

/// Effect of a name on linear statics, mass and modes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Read by this program.
    Carried,
    /// Output request that is read.
    Request,
    /// No influence, for this reason.
    None(&'static str),
    /// Acts wherever the deck has it, and is not read.
    Acts,
    /// Load that is not read; it acts if case control selects its set, the first field.
    Load,
    /// Acts together with this case control command, or with the items named here (connectors, its own values), and is not read.
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

/// A case control command as Nastran reads it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CaseWord {
    /// Full name of the command; synonyms have one name.
    pub name: &'static str,
    /// Effect of the command.
    pub effect: Effect,
}
