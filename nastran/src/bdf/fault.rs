//! Faults of a deck, with their places and remedies.

use std::fmt;

use super::source::Source;
use crate::place::Place;

/// A fault of a deck.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// First line of the card.
    pub at: Place,
    /// Card name, or the statement; empty if the fault has neither.
    pub card: String,
    /// The field, if the fault is in one.
    pub field: Option<FieldName>,
    /// Kind of the fault, with its values.
    pub what: DeckFaultKind,
}

/// A field of a card.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FieldName {
    /// Number in the quick reference guides: 2 to 9 on the first line, 12 to 19 on the second ..
    pub number: u32,
    /// Name of the field in the guides of Nastran.
    pub name: &'static str,
}

/// Kinds of faults, with their values.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub enum DeckFaultKind {
    /// A required field is blank.
    Missing,
    NotInteger {
        found: String,
    },
    NotReal {
        found: String,
    },
    /// An integer in a field that requires a real; it was read as a real.
    IntegerForReal {
        found: String,
    },
    NotDofs {
        found: String,
    },
    OutOfRange {
        found: String,
        allowed: &'static str,
    },
    NotOneOf {
        found: String,
        allowed: &'static str,
    },
    /// A value in a field that the card does not have.
    NoSuchField {
        found: String,
    },
    /// A card that asks for a continuation that does not exist.
    NoContinuation {
        label: String,
    },
    /// A line that is neither a card nor a continuation.
    NotACard {
        found: String,
    },
    /// A continuation whose card does not exist.
    Orphan {
        label: String,
    },
    /// A continuation whose name fits more than one card.
    Ambiguous {
        label: String,
        why: String,
    },
    /// A replicated line without a card before it, or a field it cannot repeat.
    Replication {
        found: String,
        why: &'static str,
    },
    /// More generated cards than a deck of this size plausibly needs.
    TooManyReplicated {
        limit: usize,
    },
    IncludeNotFound {
        name: String,
        why: String,
    },
    IncludeCycle {
        name: String,
    },
    IncludeDepth {
        limit: usize,
    },
    IncludeCount {
        limit: usize,
    },
    /// An INCLUDE without a file name or closing quote.
    IncludeName {
        found: String,
    },
    /// The deck ends within a line and without ENDDATA.
    CutShort,
    /// A text without any card or section of a deck.
    NotADeck,
    /// A name that exists in no dialect: the nearest known name, and the number of cards with this name.
    UnknownName {
        near: Option<&'static str>,
        cards: usize,
    },
    /// A case control or executive line that cannot be read.
    Statement {
        found: String,
        why: &'static str,
    },
}

impl DeckFaultKind {
    /// Returns whether part of the deck was not read: the deck is cut, an INCLUDE file is missing, or a name is unknown.
    pub fn is_incomplete(&self) -> bool {
        match self {
            Self::CutShort
            | Self::IncludeNotFound { .. }
            | Self::IncludeCycle { .. }
            | Self::IncludeDepth { .. }
            | Self::IncludeCount { .. }
            | Self::UnknownName { .. }
            | Self::IncludeName { .. } => true,
            Self::Missing
            | Self::NotInteger { .. }
            | Self::NotReal { .. }
            | Self::IntegerForReal { .. }
            | Self::NotDofs { .. }
            | Self::OutOfRange { .. }
            | Self::NotOneOf { .. }
            | Self::NoSuchField { .. }
            | Self::NoContinuation { .. }
            | Self::NotACard { .. }
            | Self::Orphan { .. }
            | Self::Ambiguous { .. }
            | Self::Replication { .. }
            | Self::TooManyReplicated { .. }
            | Self::NotADeck
            | Self::Statement { .. } => false,
        }
    }

    /// Returns the text that was found, if the fault has one.
    pub fn found_text(&self) -> Option<&str> {
        match self {
            Self::NotInteger { found }
            | Self::NotReal { found }
            | Self::IntegerForReal { found }
            | Self::NotDofs { found }
            | Self::OutOfRange { found, .. }
            | Self::NotOneOf { found, .. }
            | Self::NoSuchField { found }
            | Self::NotACard { found }
            | Self::Replication { found, .. }
            | Self::IncludeName { found }
            | Self::Statement { found, .. } => Some(found),
            Self::Orphan { label }
            | Self::Ambiguous { label, .. }
            | Self::NoContinuation { label } => Some(label),
            Self::IncludeNotFound { name, .. } | Self::IncludeCycle { name } => Some(name),
            Self::Missing
            | Self::CutShort
            | Self::NotADeck
            | Self::UnknownName { .. }
            | Self::TooManyReplicated { .. }
            | Self::IncludeDepth { .. }
            | Self::IncludeCount { .. } => None,
        }
    }

    /// Returns the message about the fault.
    pub fn message(&self) -> String {
        match self {
            Self::Missing => "the field is blank".to_owned(),
            Self::NotInteger { found } => format!("an integer is needed, found: {found}"),
            Self::NotReal { found } => format!("a real number is needed, found: {found}"),
            Self::IntegerForReal { found } => {
                format!("a real number is needed, found the integer: {found}")
            }
            Self::NotDofs { found } => {
                format!("degrees of freedom (digits 1 to 6) are needed, found: {found}")
            }
            Self::OutOfRange { found, allowed } => {
                format!("the number is not allowed here ({allowed}), found: {found}")
            }
            Self::NotOneOf { found, allowed } => {
                format!("one of {allowed} is needed, found: {found}")
            }
            Self::NoSuchField { found } => {
                format!("the card has no such field, found: {found}")
            }
            Self::NoContinuation { label } => {
                format!("the card refers to a continuation that does not exist: {label}")
            }
            Self::NotACard { found } if found.is_empty() => {
                "the line is neither a card nor a continuation".to_owned()
            }
            Self::NotACard { found } => {
                format!("the line is neither a card nor a continuation: {found}")
            }
            // A continuation name normally contains a digit. Text without a digit may come from a file that is not a deck, and is not quoted.
            Self::Orphan { label } if !label.contains(|c: char| c.is_ascii_digit()) => {
                "the continuation belongs to no card".to_owned()
            }
            Self::Orphan { label } => format!("the continuation belongs to no card: {label}"),
            Self::Ambiguous { label, why } => {
                format!("the continuation can belong to more than one card, because {why}: {label}")
            }
            Self::Replication { found, why } => {
                format!("the replicated field cannot be filled ({why}): {found}")
            }
            Self::TooManyReplicated { limit } => {
                format!("replication makes more cards than the limit: {limit}")
            }
            Self::IncludeNotFound { name, why } => {
                format!("the included file cannot be read: {name} ({why})")
            }
            Self::IncludeCycle { name } => format!("the file includes itself: {name}"),
            Self::IncludeDepth { limit } => {
                format!("files are included deeper than the limit: {limit}")
            }
            Self::IncludeCount { limit } => {
                format!("more INCLUDE statements than the limit: {limit}")
            }
            Self::IncludeName { found } => {
                format!("the file name of INCLUDE cannot be read: {found}")
            }
            Self::CutShort => {
                "the deck ends within a line and without ENDDATA: it is cut".to_owned()
            }
            Self::NotADeck => {
                "not a Nastran deck: it contains no bulk data card and no section".to_owned()
            }
            Self::Statement { found, why } => format!("{why}: {found}"),
            Self::UnknownName { near, cards } => {
                let more = match cards {
                    0 | 1 => String::new(),
                    n => format!(" ({n} cards)"),
                };
                let meant = near.map_or(String::new(), |n| format!(", did you mean `{n}`?"));
                format!("Nastran has no card of this name{more}{meant}")
            }
        }
    }

    /// Returns the remedy.
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::Missing => "fill in the field",
            Self::NotInteger { .. } => {
                "write an integer without point or exponent, and check that the value is in its own field: between commas, or in columns 9, 17, 25 .. on"
            }
            Self::NotReal { .. } => {
                "write a number such as 1.5 or 1.5-3, and check that the value is in its own field: between commas, or in columns 9, 17, 25 .. on"
            }
            Self::IntegerForReal { .. } => "write the number with a decimal point",
            Self::NotDofs { .. } => "write digits 1 to 6 without blanks, such as 123",
            Self::OutOfRange { .. } => "correct the number",
            Self::NotOneOf { .. } => "write one of the allowed words",
            Self::NoSuchField { .. } => {
                "delete the value, or check that no field before it is missing and that the line belongs to this card"
            }
            Self::NoContinuation { .. } => {
                "add the continuation with this name in columns 1-8, or delete the name in columns 73-80"
            }
            Self::NotACard { .. } => "begin cards with a name in column 1, comments with $",
            Self::Orphan { .. } => {
                "put the continuation below its card, or give both the same name in columns 73-80 and 1-8"
            }
            Self::Ambiguous { .. } => {
                "give each continuation a separate name, or put it directly below its card"
            }
            Self::Replication { .. } => {
                "write the card in full, or put the card to be repeated above"
            }
            Self::TooManyReplicated { .. } => {
                "correct the count in =(n), or write the cards to a file"
            }
            Self::IncludeNotFound { .. } => {
                "put the file at the path of the INCLUDE statement, relative to the first deck, or define the symbol as an environment variable"
            }
            Self::IncludeCycle { .. } => "remove the INCLUDE that causes the loop",
            Self::IncludeDepth { .. } | Self::IncludeCount { .. } => {
                "join some of the included files"
            }
            Self::IncludeName { .. } => "write INCLUDE 'file' with both quotes",
            Self::NotADeck => {
                "give the bulk data file (`.bdf`, `.dat`, `.nas`) that the solver reads"
            }
            Self::CutShort => "copy the deck again, or close it with ENDDATA",
            Self::Statement { .. } => "correct the statement",
            Self::UnknownName { .. } => "correct the name, or make the line a comment with $",
        }
    }
}

impl Fault {
    /// Shows the fault as `file:line: field: problem: remedy`.
    pub fn show<'a>(&'a self, sources: &'a [Source]) -> impl fmt::Display + 'a {
        FaultMessage {
            fault: self,
            sources,
        }
    }
}

struct FaultMessage<'a> {
    fault: &'a Fault,
    sources: &'a [Source],
}

impl fmt::Display for FaultMessage<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let path = self
            .sources
            .get(self.fault.at.source.0 as usize)
            .map_or("deck", |s| s.path.as_str());
        write!(f, "{path}:{}: ", self.fault.at.line)?;
        write!(f, "{}", self.fault)
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.card.is_empty() {
            write!(f, "`{}`", self.card)?;
            if let Some(field) = self.field {
                write!(f, " field {} ({})", field.number, field.name)?;
            }
            f.write_str(": ")?;
        }
        write!(f, "{}: {}", self.what.message(), self.what.remedy())
    }
}
