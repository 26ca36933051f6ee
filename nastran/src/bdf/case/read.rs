//! Reads the statements of case control.

use super::super::fault::{DeckFaultKind, Fault};
use super::super::fields::note_fault;
use super::super::number::{Number, read_number};
use super::super::sections::Statement;
use super::super::vocabulary::{case_word, request_of};
use super::options::{abbreviates, unknown_option, unknown_value};
use super::{CaseControl, CaseLine, Request, Selection, Set, Subcase, SubcaseKind};
use crate::cards::{Param, ParamValue};

/// Largest size of a statement in bytes, its continuation lines joined.
const MAX_STATEMENT: usize = 4 << 20;

/// Reads case control from its lines.
pub(in super::super) fn read_case_control(
    statements: &[Statement],
    faults: &mut Vec<Fault>,
) -> CaseControl {
    let mut case = CaseControl::default();
    let mut in_packet = false;
    let mut skips = false;
    let mut rest = statements;
    while let Some((first, more)) = rest.split_first() {
        let (text, end, used) = join_continuations(first, more);
        rest = more.get(used..).unwrap_or_default();
        let text = text.trim();
        let name: String = text
            .chars()
            .take_while(|c| c.is_ascii_alphanumeric())
            .collect::<String>()
            .to_ascii_uppercase();
        let word = case_word(&name).map_or("", |w| w.name);
        let mut read = Reader {
            case: &mut case,
            first,
            faults,
        };
        let switch = skip_switch(&name, text);
        let skipped = skips || switch.is_some();
        if skipped {
            skips = switch.unwrap_or(true);
        } else if let Some(kind) = subcase_kind(&name) {
            in_packet = false;
            read.begin(kind, &name, text);
        } else if word == "OUTPUT" && text.contains('(') {
            // OUTPUT(PLOT), (XYPLOT) and (POST) begin plot commands, which extend to the end of case control and are not read.
            in_packet = true;
        } else if !in_packet {
            read.statement(&name, text);
        }
        let subcase = case.subcases.len().checked_sub(1);
        case.lines.push(CaseLine {
            at: first.at,
            subcase,
            name,
            text: text.to_owned(),
            in_packet: in_packet || skipped,
            start: first.start,
            end,
        });
        if skipped {
            continue;
        }
        // Substructure commands, up to ENDSUBS, are not read.
        match word {
            "SUBSTRUCTURE" => in_packet = true,
            "ENDSUBS" => in_packet = false,
            _ => {}
        }
    }
    case
}

/// Returns whether the statement begins (`SKIP ON`, `SKIPON`, `SKIP=ON`) or ends a block of statements that are not executed.
fn skip_switch(name: &str, text: &str) -> Option<bool> {
    let value = match name {
        "SKIPON" => return Some(true),
        "SKIPOFF" | "SKIPOF" => return Some(false),
        "SKIP" => value_of(text, name.len()),
        _ => return None,
    };
    match value.to_ascii_uppercase().as_str() {
        "ON" => Some(true),
        "OFF" => Some(false),
        _ => None,
    }
}

/// Joins a statement with its continuation lines. Returns the text, its end, and the number of continuation lines.
fn join_continuations(first: &Statement, more: &[Statement]) -> (String, usize, usize) {
    let mut text = first.text.trim_end().to_owned();
    let mut end = first.end;
    let mut used = 0;
    let word = text.trim_start().to_ascii_uppercase();
    if ["TITLE", "SUBT", "LABE"]
        .iter()
        .any(|t| word.starts_with(t))
    {
        return (text, end, used);
    }
    while text.ends_with(',')
        && text.len() < MAX_STATEMENT
        && let Some(next) = more.get(used)
        && next.at.source == first.at.source
    {
        text.push(' ');
        text.push_str(next.text.trim());
        end = next.end;
        used += 1;
    }
    (text, end, used)
}

fn subcase_kind(name: &str) -> Option<SubcaseKind> {
    Some(match case_word(name)?.name {
        "SYM" => SubcaseKind::Sym,
        "SUBCOM" => SubcaseKind::Subcom,
        "SUBCASE" => SubcaseKind::Subcase,
        "SYMCOM" => SubcaseKind::Symcom,
        "REPCASE" => SubcaseKind::Repcase,
        _ => return None,
    })
}

/// Requests whose selection lists the grids and elements with results.
const READ_REQUESTS: [&str; 4] = ["DISPLACEMENT", "STRAIN", "STRESS", "FORCE"];

const WANTED_SELECTION: &str = "ALL, NONE, a set number or a list of ids is needed";

struct Reader<'a> {
    case: &'a mut CaseControl,
    first: &'a Statement,
    faults: &'a mut Vec<Fault>,
}

impl Reader<'_> {
    fn fault(&mut self, name: &str, found: &str, why: &'static str) {
        let found: String = found.chars().take(60).collect();
        let what = DeckFaultKind::Statement { found, why };
        note_fault(
            self.faults,
            Fault {
                at: self.first.at,
                card: name.to_owned(),
                field: None,
                what,
            },
        );
    }

    fn current_subcase(&mut self) -> &mut Subcase {
        match self.case.subcases.last_mut() {
            Some(subcase) => subcase,
            None => &mut self.case.global,
        }
    }

    fn begin(&mut self, kind: SubcaseKind, name: &str, text: &str) {
        let value = value_of(text, name.len());
        let id = value
            .split([' ', '\t', ','])
            .find(|w| !w.is_empty())
            .and_then(|w| w.parse().ok());
        if id.is_none() && kind != SubcaseKind::Sym && kind != SubcaseKind::Symcom {
            self.fault(name, text, "the subcase has no number");
        }
        let next = self
            .case
            .subcases
            .last()
            .map_or(1, |s| s.id.saturating_add(1));
        let id = id.unwrap_or(next);
        self.case.subcases.push(Subcase {
            id,
            kind,
            at: self.first.at,
            ..Subcase::default()
        });
    }

    fn statement(&mut self, name: &str, text: &str) {
        let value = value_of(text, name.len());
        let word = case_word(name).map_or("", |w| w.name);
        if let Some(why) = unknown_option(word, &options_of(text))
            .or_else(|| unknown_value(word, &value.to_ascii_uppercase()))
        {
            return self.fault(name, text, why);
        }
        match word {
            "TITLE" => self.current_subcase().title = Some(value.to_owned()),
            "SUBTITLE" => self.current_subcase().subtitle = Some(value.to_owned()),
            "LABEL" => self.current_subcase().label = Some(value.to_owned()),
            "LOAD" => self.current_subcase().load = self.number(name, value),
            "SPC" => self.current_subcase().spc = self.number(name, value),
            "MPC" => self.current_subcase().mpc = self.number(name, value),
            "NSM" => self.current_subcase().nsm = self.number(name, value),
            "SUPORT1" => self.current_subcase().suport1 = self.number(name, value),
            "DEFORM" => self.current_subcase().deform = self.number(name, value),
            "METHOD" => self.current_subcase().method = self.number(name, value),
            "ANALYSIS" => self.current_subcase().analysis = Some(value.to_ascii_uppercase()),
            "TEMPERATURE" => self.temperature(name, text, value),
            "SUBSEQ" | "SYMSEQ" => self.sequence(name, value),
            "SET" => self.set(text),
            "PARAM" => self.param(text),
            // The AUTOSPC command is equivalent to the parameter.
            "AUTOSPC" => self.param(&format!("PARAM,AUTOSPC,{value}")),
            _ => self.request(name, text, value),
        }
    }

    /// Parses a set number; 0 or NONE selects no set.
    fn number(&mut self, name: &str, value: &str) -> Option<u32> {
        match value.parse::<u32>() {
            Ok(n) => Some(n),
            Err(_) if value.eq_ignore_ascii_case("NONE") => Some(0),
            Err(_) => {
                self.fault(name, value, "a set number is needed");
                None
            }
        }
    }

    fn temperature(&mut self, name: &str, text: &str, value: &str) {
        let id = self.number(name, value);
        let options = options_of(text);
        let is = |o: &str| options.iter().any(|have| abbreviates(have, o));
        let current = self.current_subcase();
        if is("INITIAL") {
            current.temperature_initial = id;
            return;
        }
        if !is("LOAD") {
            current.temperature_material = id;
        }
        if !is("MATERIAL") {
            current.temperature_load = id;
        }
    }

    fn sequence(&mut self, name: &str, value: &str) {
        let mut numbers = Vec::new();
        for word in value.split([',', ' ', '\t']).filter(|w| !w.is_empty()) {
            match read_number(word.as_bytes()) {
                Some(Number::Integer(n)) => numbers.push(n as f64),
                Some(Number::Real(x)) => numbers.push(x),
                None => return self.fault(name, word, "a coefficient is needed"),
            }
        }
        self.current_subcase().sequence = numbers;
    }

    fn set(&mut self, text: &str) {
        let (head, items) = match text.split_once('=') {
            Some(parts) => parts,
            // The equals sign may be missing: `SET 10 SHEAR`.
            None => text.split_at(end_of_number(text, 3)),
        };
        let id = head.get(3..).unwrap_or_default().trim().parse::<u32>();
        match (id, Set::from_text(items)) {
            (Ok(id), Ok(set)) => {
                self.current_subcase().sets.insert(id, set);
            }
            // Sets of times, grid components or set names stay in the deck and are not read.
            (Ok(_), Err(word)) if word.contains(['.', '/', '(']) => {}
            (Ok(_), Err(word)) if word.eq_ignore_ascii_case("THRU") => {
                let why = "THRU needs two ids that ascend before and behind it, and may not be behind EXCEPT within the range";
                self.fault("SET", text, why)
            }
            (Ok(_), Err(word)) => self.fault("SET", &word, "the item of the set is not an id"),
            (Err(_), _) => self.fault("SET", head, "the set has no number"),
        }
    }

    /// Reads a parameter, such as `PARAM,POST,-1`.
    fn param(&mut self, text: &str) {
        let mut words = text
            .split([',', ' ', '\t', '='])
            .filter(|w| !w.is_empty())
            .skip(1);
        let Some(name) = words.next() else {
            return;
        };
        let values = words
            .take(2)
            .map(|w| match read_number(w.as_bytes()) {
                Some(Number::Integer(n)) => ParamValue::Integer(n),
                Some(Number::Real(x)) => ParamValue::Real(x),
                None => ParamValue::Text(w.to_ascii_uppercase()),
            })
            .collect();
        self.current_subcase().params.push(Param {
            name: name.to_ascii_uppercase(),
            values,
        });
    }

    /// Reads an output request; other statements stay in the deck and are not read.
    fn request(&mut self, name: &str, text: &str, value: &str) {
        let Some(full) = request_of(name) else {
            return;
        };
        let value = match value.to_ascii_uppercase().as_str() {
            "ALL" | "YES" | "" => Selection::All,
            "NONE" | "NO" => Selection::None,
            number => match number.parse() {
                Ok(set) => Selection::Set(set),
                Err(_) => match Set::from_text(number) {
                    Ok(ids) => Selection::Ids(ids),
                    // The selection is a list of times or components, or a set name, of a request that is not read.
                    Err(_) if !READ_REQUESTS.contains(&full) => return,
                    Err(_) => return self.fault(name, value, WANTED_SELECTION),
                },
            },
        };
        let options = options_of(text);
        let current = self.current_subcase();
        current.requests.retain(|r| r.what != full);
        current.requests.push(Request {
            what: full.to_owned(),
            options,
            value,
        });
    }
}

/// Returns the offset of the first byte after the number that begins at or after `from`.
fn end_of_number(text: &str, from: usize) -> usize {
    let tail = text.get(from..).unwrap_or_default();
    let digits = tail.trim_start();
    let length = digits
        .find(|c: char| !c.is_ascii_digit())
        .unwrap_or(digits.len());
    from.min(text.len()) + tail.len() - digits.len() + length
}

/// Returns the text after `=`, or after the name if there is no `=`.
fn value_of(text: &str, name: usize) -> &str {
    let rest = text.get(name..).unwrap_or_default();
    let rest = match rest.trim_start().strip_prefix('(') {
        Some(inner) => {
            find_closing_bracket(inner).map_or("", |i| inner.get(i + 1..).unwrap_or_default())
        }
        None => rest,
    };
    rest.trim_start_matches([' ', '\t', ','])
        .trim_start_matches('=')
        .trim()
}

/// Returns the offset of the closing bracket.
fn find_closing_bracket(inner: &str) -> Option<usize> {
    let mut depth = 1;
    for (i, c) in inner.char_indices() {
        match c {
            '(' => depth += 1,
            ')' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return Some(i);
        }
    }
    None
}

/// Returns the options in brackets after the name, upper case.
fn options_of(text: &str) -> Vec<String> {
    let before = text.split('=').next().unwrap_or_default();
    let Some((_, inner)) = text.split_once('(').filter(|_| before.contains('(')) else {
        return Vec::new();
    };
    let inner = find_closing_bracket(inner)
        .and_then(|i| inner.get(..i))
        .unwrap_or(inner);
    inner
        .split(',')
        .map(|w| w.trim().to_ascii_uppercase())
        .filter(|w| !w.is_empty())
        .collect()
}
