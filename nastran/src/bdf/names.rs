//! Names of properties, components and materials in comments, as pre-processors write them.

use super::line::{text_of, trim};
use super::number::{Number, read_number};
use crate::place::Place;

/// Kind of the item that a name belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum NameOwner {
    Property,
    /// A group of elements (HyperMesh component).
    Component,
    Material,
    /// A grid at which a component acts.
    Grid,
}

/// A name from a comment.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Label {
    pub kind: NameOwner,
    pub id: u32,
    /// Property of a component, if the comment states it.
    pub property: Option<u32>,
    pub name: String,
    pub at: Place,
}

/// Reader of names in the comments above a card.
#[derive(Debug, Default)]
pub(super) struct NameReader {
    /// Name for the next property or material card.
    pending: Option<(NameOwner, String, Place)>,
    /// ANSA: the name is on the next comment line.
    next_line: Option<(NameOwner, u32)>,
}

impl NameReader {
    /// Reads a comment line, which begins with `$`.
    pub(super) fn comment(&mut self, comment: &[u8], at: Place, labels: &mut Vec<Label>) {
        let body = trim(comment.get(1..).unwrap_or_default());
        if let Some((kind, id)) = self.next_line.take() {
            if !body.is_empty() {
                labels.push(Label {
                    kind,
                    id,
                    property: None,
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
                read_quoted_names(body.get(6..).unwrap_or_default(), at, labels);
            }
            b'A' if starts(body, b"ANSA_NAME") => self.ansa(body, at, labels),
            b'F' | b'S' if starts(body, b"FEMAP") || starts(body, b"Simcenter") => {
                labels.extend(femap(body, at));
            }
            b'C' => labels.extend(component_at_grid(body, at)),
            b'*' => self.star(trim(body.get(1..).unwrap_or_default()), at),
            b'E' => self.read_name_after(
                body,
                b"Elements and Element Properties for region",
                (NameOwner::Property, at),
            ),
            b'P' => self.read_name_after(body, b"Property", (NameOwner::Property, at)),
            b'M' if starts(body, b"Material Record") => {
                self.read_name_after(body, b"Material Record", (NameOwner::Material, at));
            }
            b'M' => self.read_name_after(body, b"Material", (NameOwner::Material, at)),
            _ => {}
        }
    }

    /// Assigns names to a card below the comments; `fields` begin after the card's name.
    #[inline]
    pub(super) fn card(&mut self, name: &[u8], fields: &[&[u8]], labels: &mut Vec<Label>) {
        if self.pending.is_some() || self.next_line.is_some() {
            self.give(name, fields, labels);
        }
    }

    /// Drops a name that no card follows.
    pub(super) fn forget(&mut self) {
        *self = NameReader::default();
    }

    /// Assigns the pending name to a property or material card, or to the property of an element card.
    #[cold]
    fn give(&mut self, name: &[u8], fields: &[&[u8]], labels: &mut Vec<Label>) {
        let pending = self.pending.take();
        self.forget();
        let Some((kind, text, at)) = pending else {
            return;
        };
        let field = |i: usize| fields.get(i).and_then(|f| number(f));
        let id = match kind {
            NameOwner::Material if name.starts_with(b"MAT") => field(0),
            NameOwner::Property if is_property(name) => field(0),
            NameOwner::Property if has_property(name) => field(1).or(field(0)),
            _ => None,
        };
        labels.extend(id.map(|id| Label {
            kind,
            id,
            property: None,
            name: text,
            at,
        }));
    }

    /// Reads `$* Property: rail`, `$* Property Name: rail`, `$*  NX PHYSICAL PROPERTY: rail`, `$*  I-DEAS property: 1  name: rail`.
    fn star(&mut self, body: &[u8], at: Place) {
        let Some(colon) = memchr::memchr(b':', body) else {
            return;
        };
        let (head, tail) = body.split_at(colon);
        let head = head.to_ascii_uppercase();
        let head = trim(&head);
        let head = head.strip_suffix(b" NAME").map_or(head, trim);
        let kind = if head.ends_with(b"PROPERTY") {
            NameOwner::Property
        } else if head.ends_with(b"MATERIAL") {
            NameOwner::Material
        } else {
            return;
        };
        let tail = trim(tail.get(1..).unwrap_or_default());
        let name = match memchr::memmem::find(tail, b"name:") {
            Some(i) => trim(tail.get(i + 5..).unwrap_or_default()),
            None => tail,
        };
        if !name.is_empty() {
            self.pending = Some((kind, text_of(name), at));
        }
    }

    /// Reads `HEAD : name`.
    fn read_name_after(&mut self, body: &[u8], head: &[u8], (kind, at): (NameOwner, Place)) {
        if starts(body, head)
            && let Some(rest) = body.get(head.len()..).map(trim)
            && let Some(name) = rest.strip_prefix(b":").map(trim)
            && !name.is_empty()
        {
            self.pending = Some((kind, text_of(name), at));
        }
    }

    /// Reads `ANSA_NAME_COMMENT;5;PSHELL;rail;..`, or `ANSA_NAME;5;PSHELL;~` with the name on the next line.
    fn ansa(&mut self, body: &[u8], at: Place, labels: &mut Vec<Label>) {
        let mut parts = body.split(|&c| c == b';').skip(1);
        let (id, card, name) = (
            parts.next().and_then(number),
            parts.next().unwrap_or_default(),
            parts.next().unwrap_or_default(),
        );
        let kind = match card.to_ascii_uppercase().as_slice() {
            c if c.starts_with(b"MAT") => NameOwner::Material,
            c if c.starts_with(b"P") => NameOwner::Property,
            _ => return,
        };
        match (id, trim(name)) {
            (Some(id), b"~") => self.next_line = Some((kind, id)),
            (Some(id), name) if !name.is_empty() => labels.push(Label {
                kind,
                id,
                property: None,
                name: text_of(name),
                at,
            }),
            _ => {}
        }
    }
}

/// Reads `Component: wheel LF, grid 900001`.
fn component_at_grid(body: &[u8], at: Place) -> Option<Label> {
    const HEAD: &[u8] = b"Component";
    let rest = body.get(HEAD.len()..).filter(|_| starts(body, HEAD))?;
    let rest = trim(rest).strip_prefix(b":")?;
    let comma = memchr::memrchr(b',', rest)?;
    let (name, tail) = (trim(rest.get(..comma)?), trim(rest.get(comma + 1..)?));
    let id = number(tail.get(4..).filter(|_| starts(tail, b"grid"))?)?;
    (!name.is_empty()).then(|| Label {
        kind: NameOwner::Grid,
        id,
        property: None,
        name: text_of(name),
        at,
    })
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

/// Returns whether the card defines a property by the id in its first field.
fn is_property(name: &[u8]) -> bool {
    name.starts_with(b"P")
        && !name.starts_with(b"PLOAD")
        && !matches!(
            name,
            b"PARAM" | b"PLOTEL" | b"POINT" | b"PARTN" | b"PRESPT" | b"PSET" | b"PVAL"
        )
}

/// Returns whether the card is an element with a property id in its second field.
fn has_property(name: &[u8]) -> bool {
    name.starts_with(b"C")
        && !matches!(name.get(..4), Some(b"CORD" | b"CONM" | b"CONR"))
        && !matches!(
            name,
            b"CELAS2"
                | b"CELAS4"
                | b"CMASS2"
                | b"CMASS4"
                | b"CDAMP2"
                | b"CDAMP4"
                | b"CSET"
                | b"CSET1"
                | b"CAERO1"
        )
}

/// Reads `COMP 5 "rail"`, `PROP    201     PBARL   "rail"`, and `COMP 5 "rail" 201 "rail section" 4` with property and its name.
fn read_quoted_names(rest: &[u8], at: Place, labels: &mut Vec<Label>) {
    let Some((head, name, tail)) = quotation(rest) else {
        return;
    };
    let mut words = head.split(|&c| c <= b' ').filter(|w| !w.is_empty());
    let kind = match words
        .next()
        .unwrap_or_default()
        .to_ascii_uppercase()
        .as_slice()
    {
        b"COMP" => NameOwner::Component,
        b"PROP" => NameOwner::Property,
        b"MAT" => NameOwner::Material,
        _ => return,
    };
    let Some(id) = words.next().and_then(number) else {
        return;
    };
    let label = |kind, id, property, name| Label {
        kind,
        id,
        property,
        name: text_of(trim(name)),
        at,
    };
    let own = quotation(tail).and_then(|(id, name, _)| Some((number(id)?, name)));
    let property = own
        .map(|(id, _)| id)
        .filter(|_| kind == NameOwner::Component);
    labels.push(label(kind, id, property, name));
    if let Some((id, name)) = own.filter(|(_, name)| !name.is_empty() && property.is_some()) {
        labels.push(label(NameOwner::Property, id, None, name));
    }
}

/// Returns the text before, within and after the first quotation marks.
fn quotation(text: &[u8]) -> Option<(&[u8], &[u8], &[u8])> {
    let open = memchr::memchr(b'"', text)?;
    let rest = text.get(open + 1..)?;
    let close = memchr::memchr(b'"', rest).unwrap_or(rest.len());
    Some((
        text.get(..open)?,
        rest.get(..close)?,
        rest.get(close + 1..).unwrap_or_default(),
    ))
}

/// Reads `Femap with NX Nastran Property 1 : rail`.
fn femap(body: &[u8], at: Place) -> Option<Label> {
    let colon = memchr::memchr(b':', body)?;
    let mut words = body
        .get(..colon)?
        .split(|&c| c <= b' ')
        .filter(|w| !w.is_empty())
        .rev();
    let id = number(words.next()?)?;
    let kind = match words.next()?.to_ascii_uppercase().as_slice() {
        b"PROPERTY" => NameOwner::Property,
        b"MATERIAL" => NameOwner::Material,
        _ => return None,
    };
    Some(Label {
        kind,
        id,
        property: None,
        name: text_of(trim(body.get(colon + 1..)?)),
        at,
    })
}
