//! Names of properties, components and materials in comments, as pre-processors write them.

use super::line::{text_of, trim};
use super::number::{Number, read_number};
use crate::place::Place;

/// What a name belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum Named {
    Property,
    /// A group of elements (HyperMesh component).
    Component,
    Material,
}

/// A name out of a comment.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Label {
    pub kind: Named,
    pub id: u32,
    pub name: String,
    pub at: Place,
}

/// Keeps what a comment says about the card below it.
#[derive(Debug, Default)]
pub(super) struct NameReader {
    /// Name for the next property or material card.
    pending: Option<(Named, String)>,
    /// ANSA: the name stands on the next comment line.
    next_line: Option<(Named, u32)>,
}

impl NameReader {
    /// Takes a comment line, `$` first.
    pub(super) fn comment(&mut self, comment: &[u8], at: Place, labels: &mut Vec<Label>) {
        let body = trim(comment.get(1..).unwrap_or_default());
        if let Some((kind, id)) = self.next_line.take() {
            if !body.is_empty() {
                labels.push(Label {
                    kind,
                    id,
                    name: text_of(body),
                    at,
                });
            }
            return;
        }
        let (Some(first), true) = (body.first(), body.len() > 4) else {
            return;
        };
        match first.to_ascii_uppercase() {
            b'H' | b'S' if starts(body, b"HMNAME") || starts(body, b"SXNAME") => {
                labels.extend(quoted(body.get(6..).unwrap_or_default(), at));
            }
            b'A' if starts(body, b"ANSA_NAME") => self.ansa(body, at, labels),
            b'F' if starts(body, b"FEMAP") => labels.extend(femap(body, at)),
            b'*' => self.star(trim(body.get(1..).unwrap_or_default())),
            b'E' => self.after(
                body,
                b"Elements and Element Properties for region",
                Named::Property,
            ),
            b'P' => self.after(body, b"Property", Named::Property),
            b'M' if starts(body, b"Material Record") => {
                self.after(body, b"Material Record", Named::Material)
            }
            b'M' => self.after(body, b"Material", Named::Material),
            _ => {}
        }
    }

    /// Takes a card: a waiting name is its name, if it is of that kind.
    pub(super) fn card(&mut self, name: &[u8], id: &[u8], labels: &mut Vec<Label>) {
        let Some((kind, text)) = self.pending.take() else {
            return;
        };
        let fits = match kind {
            Named::Material => name.starts_with(b"MAT"),
            Named::Property => {
                name.starts_with(b"P")
                    && !name.starts_with(b"PLOAD")
                    && name != b"PARAM"
                    && name != b"PLOTEL"
            }
            Named::Component => false,
        };
        if fits && let Some(id) = number(id) {
            labels.push(Label {
                kind,
                id,
                name: text,
                at: Place::default(),
            });
        }
    }

    /// `$* Property: rail`, `$*  NX PHYSICAL PROPERTY: rail`, `$*  I-DEAS property: 1  name: rail`.
    fn star(&mut self, body: &[u8]) {
        let Some(colon) = memchr::memchr(b':', body) else {
            return;
        };
        let (head, tail) = body.split_at(colon);
        let head = head.to_ascii_uppercase();
        let kind = if trim(&head).ends_with(b"PROPERTY") {
            Named::Property
        } else if trim(&head).ends_with(b"MATERIAL") {
            Named::Material
        } else {
            return;
        };
        let tail = trim(tail.get(1..).unwrap_or_default());
        let name = match memchr::memmem::find(tail, b"name:") {
            Some(i) => trim(tail.get(i + 5..).unwrap_or_default()),
            None => tail,
        };
        if !name.is_empty() {
            self.pending = Some((kind, text_of(name)));
        }
    }

    /// `HEAD : name`.
    fn after(&mut self, body: &[u8], head: &[u8], kind: Named) {
        if starts(body, head)
            && let Some(rest) = body.get(head.len()..).map(trim)
            && let Some(name) = rest.strip_prefix(b":").map(trim)
            && !name.is_empty()
        {
            self.pending = Some((kind, text_of(name)));
        }
    }

    /// `ANSA_NAME_COMMENT;5;PSHELL;rail;..` or `ANSA_NAME;5;PSHELL;~` with the name on the next line.
    fn ansa(&mut self, body: &[u8], at: Place, labels: &mut Vec<Label>) {
        let mut parts = body.split(|&c| c == b';').skip(1);
        let (id, card, name) = (
            parts.next().and_then(number),
            parts.next().unwrap_or_default(),
            parts.next().unwrap_or_default(),
        );
        let kind = match card.to_ascii_uppercase().as_slice() {
            c if c.starts_with(b"MAT") => Named::Material,
            c if c.starts_with(b"P") => Named::Property,
            _ => return,
        };
        match (id, trim(name)) {
            (Some(id), b"~") => self.next_line = Some((kind, id)),
            (Some(id), name) if !name.is_empty() => labels.push(Label {
                kind,
                id,
                name: text_of(name),
                at,
            }),
            _ => {}
        }
    }
}

fn starts(body: &[u8], head: &[u8]) -> bool {
    body.get(..head.len())
        .is_some_and(|b| b.eq_ignore_ascii_case(head))
}

fn number(field: &[u8]) -> Option<u32> {
    match read_number(trim(field))? {
        Number::Integer(n) => u32::try_from(n).ok(),
        Number::Real(_) => None,
    }
}

/// `COMP 5 "rail"`, `PROP    201     PBARL   "rail"`.
fn quoted(rest: &[u8], at: Place) -> Option<Label> {
    let open = memchr::memchr(b'"', rest)?;
    let name = rest.get(open + 1..)?;
    let name = name.get(..memchr::memchr(b'"', name).unwrap_or(name.len()))?;
    let mut words = rest
        .get(..open)?
        .split(|&c| c <= b' ')
        .filter(|w| !w.is_empty());
    let kind = match words.next()?.to_ascii_uppercase().as_slice() {
        b"COMP" => Named::Component,
        b"PROP" => Named::Property,
        b"MAT" => Named::Material,
        _ => return None,
    };
    let id = words.next().and_then(number)?;
    Some(Label {
        kind,
        id,
        name: text_of(trim(name)),
        at,
    })
}

/// `Femap with NX Nastran Property 1 : rail`.
fn femap(body: &[u8], at: Place) -> Option<Label> {
    let colon = memchr::memchr(b':', body)?;
    let mut words = body
        .get(..colon)?
        .split(|&c| c <= b' ')
        .filter(|w| !w.is_empty())
        .rev();
    let id = number(words.next()?)?;
    let kind = match words.next()?.to_ascii_uppercase().as_slice() {
        b"PROPERTY" => Named::Property,
        b"MATERIAL" => Named::Material,
        _ => return None,
    };
    Some(Label {
        kind,
        id,
        name: text_of(trim(body.get(colon + 1..)?)),
        at,
    })
}
