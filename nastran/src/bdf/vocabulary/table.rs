//! Reads the tables of names.

use super::effect::Effect;

/// A name of a table.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    /// The name as decks write it.
    pub written: &'static str,
    /// The full name.
    pub name: &'static str,
    /// Effect of the name.
    pub effect: Effect,
}

/// Reads a table: groups in brackets, names below them.
pub(super) fn read_table(text: &'static str) -> Vec<Entry> {
    let mut effect = Effect::Acts;
    let mut entries = Vec::new();
    for line in text.lines().filter(|l| !l.starts_with('#')) {
        if let Some(group) = line.strip_prefix('[').and_then(|l| l.strip_suffix(']')) {
            effect = effect_of_group(group);
            continue;
        }
        entries.extend(line.split_whitespace().map(|word| {
            let (written, name) = word.split_once('=').unwrap_or((word, word));
            Entry {
                written,
                name,
                effect,
            }
        }));
    }
    entries
}

fn effect_of_group(group: &'static str) -> Effect {
    match group {
        "carried" => Effect::Carried,
        "output request" => Effect::Request,
        "load" => Effect::Load,
        "executive" => Effect::Executive,
        "executive, acts" => Effect::ExecutiveActs,
        _ => {
            let reason = group.strip_prefix("no influence: ").map(Effect::None);
            let with = group.strip_prefix("acts with ").map(Effect::ActsWith);
            reason.or(with).unwrap_or(Effect::Acts)
        }
    }
}
