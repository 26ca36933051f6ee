//! SET n = 1, 2 THRU 9 EXCEPT 5, ALL, QUAD4 EXCEPT 21.

/// Ids of grids or elements that a SET statement of case control lists. [`Set::has`] tests an id.
///
/// # Example
/// ```
/// use nastran::bdf::{MemoryLoader, read_deck};
///
/// let text = "CEND\nSET 5 = 1 THRU 10 EXCEPT 4, 20\nBEGIN BULK\nENDDATA\n";
/// let deck = read_deck("sets.bdf", text.into(), &mut MemoryLoader::default());
/// let set = &deck.case_control.global.sets[&5];
/// assert!(set.has(1) && set.has(3) && set.has(10) && set.has(20));
/// assert!(!set.has(4) && !set.has(11));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Set {
    /// Items in the order of the statement.
    pub items: Vec<SetItem>,
}

/// An item of a SET.
#[derive(Clone, Debug, PartialEq)]
pub enum SetItem {
    /// An id.
    One(u32),
    /// `first THRU last BY n EXCEPT ..`, both ends included.
    Thru {
        /// First id.
        first: u32,
        /// Last id.
        last: u32,
        /// Step, 1 or more.
        by: u32,
        /// Ids left out.
        except: Vec<u32>,
    },
    /// ALL.
    All,
    /// Every element of a type, such as `QUAD4`.
    Type(String),
    /// Ids that are left out of ALL and of types, both ends included.
    Except(u32, u32),
    /// A type that is left out of ALL.
    ExceptType(String),
}

/// Types of elements that a SET may list, without the leading C.
const TYPES: [&str; 42] = [
    "BAR", "BEAM", "BEAM3", "BEND", "BUSH", "BUSH1D", "CONROD", "DAMP1", "DAMP2", "DAMP3", "DAMP4",
    "ELAS1", "ELAS2", "ELAS3", "ELAS4", "FAST", "GAP", "HEXA", "MASS1", "MASS2", "MASS3", "MASS4",
    "PENTA", "PYRAM", "QUAD4", "QUAD8", "QUADR", "ROD", "SEAM", "SHEAR", "TETRA", "TRIA3", "TRIA6",
    "TRIAR", "TRIAX6", "TUBE", "VISC", "WELD", "CONM1", "CONM2", "PLOTEL", "HBDY",
];

/// Returns the element type of a keyword, with or without the leading C.
fn type_of(word: &str) -> Option<&'static str> {
    let word = word.to_ascii_uppercase();
    let named = |w: &str| TYPES.into_iter().find(|t| *t == w);
    named(&word).or_else(|| named(word.strip_prefix('C')?))
}

impl SetItem {
    fn includes(&self, id: u32, kind: Option<&str>) -> bool {
        match self {
            Self::One(one) => *one == id,
            Self::Thru {
                first,
                last,
                by,
                except,
            } => {
                (*first..=*last).contains(&id)
                    && (id - first).is_multiple_of((*by).max(1))
                    && !except.contains(&id)
            }
            Self::All => true,
            Self::Type(t) => Some(t.as_str()) == kind,
            Self::Except(..) | Self::ExceptType(_) => false,
        }
    }

    fn excludes(&self, id: u32, kind: Option<&str>) -> bool {
        match self {
            Self::Except(first, last) => (*first..=*last).contains(&id),
            Self::ExceptType(t) => Some(t.as_str()) == kind,
            _ => false,
        }
    }
}

impl Set {
    /// Returns whether the id of a grid, or of an element of any type, is in the set.
    pub fn has(&self, id: u32) -> bool {
        self.contains(id, None)
    }

    /// Returns whether the element is in the set; `card` is the element's card, such as `CQUAD4`.
    pub fn has_element(&self, id: u32, card: &str) -> bool {
        self.contains(id, type_of(card))
    }

    fn contains(&self, id: u32, kind: Option<&str>) -> bool {
        self.items.iter().any(|i| i.includes(id, kind))
            && !self.items.iter().any(|i| i.excludes(id, kind))
    }

    /// Reads the set from the text after `=`. `Err` contains the text that cannot be read.
    pub(super) fn from_text(text: &str) -> Result<Set, String> {
        let words: Vec<&str> = text
            .split([',', ' ', '\t'])
            .filter(|w| !w.is_empty())
            .collect();
        let mut set = SetReader::default();
        let mut rest = words.as_slice();
        while let Some((word, more)) = rest.split_first() {
            rest = more;
            match word.to_ascii_uppercase().as_str() {
                "ALL" => set.items.push(SetItem::All),
                "EXCEPT" | "EXCLUDE" => (set.excepting, set.of_grids) = (true, false),
                "INCLUDE" => (set.excepting, set.of_grids) = (false, false),
                "ELEMENT" | "ELEMENTS" => set.of_grids = false,
                "GRID" | "GRIDS" | "POINT" | "POINTS" => set.of_grids = true,
                "THRU" => rest = set.range(word, rest)?,
                _ => set.item(word)?,
            }
        }
        Ok(Set { items: set.items })
    }
}

/// State of the reader of a SET.
#[derive(Default)]
struct SetReader {
    items: Vec<SetItem>,
    /// Whether the next items follow EXCEPT.
    excepting: bool,
    /// Whether the next ids are grids, which are plotted together with the elements.
    of_grids: bool,
}

impl SetReader {
    /// Reads an id or a type.
    fn item(&mut self, word: &str) -> Result<(), String> {
        if let Some(kind) = type_of(word) {
            let kind = kind.to_owned();
            self.items.push(match self.excepting {
                true => SetItem::ExceptType(kind),
                false => SetItem::Type(kind),
            });
            return Ok(());
        }
        let id: u32 = word.parse().map_err(|_| word.to_owned())?;
        if self.of_grids {
            return Ok(());
        }
        match self.items.last_mut() {
            Some(SetItem::Thru {
                first,
                last,
                except,
                ..
            }) if self.excepting && (*first..=*last).contains(&id) => except.push(id),
            Some(SetItem::One(_)) | None if self.excepting => return Err("EXCEPT".to_owned()),
            Some(SetItem::One(_) | SetItem::Thru { .. }) | None => {
                self.excepting = false;
                self.items.push(SetItem::One(id));
            }
            Some(_) if self.excepting => self.items.push(SetItem::Except(id, id)),
            Some(_) => self.items.push(SetItem::One(id)),
        }
        Ok(())
    }

    /// Reads the end and the step of a range; returns the items after them.
    fn range<'w, 's>(&mut self, thru: &str, words: &'w [&'s str]) -> Result<&'w [&'s str], String> {
        let wrong = || thru.to_owned();
        let (last, rest) = words.split_first().ok_or_else(wrong)?;
        let last: u32 = last.parse().map_err(|_| wrong())?;
        let (step, rest) = match rest {
            [by, step, rest @ ..] if by.eq_ignore_ascii_case("BY") => {
                let step = step.parse().ok().filter(|s| *s > 0);
                (step.ok_or_else(|| "BY".to_owned())?, rest)
            }
            _ => (1, rest),
        };
        if self.of_grids {
            return Ok(rest);
        }
        let range = match self.items.pop() {
            Some(SetItem::One(first)) if first <= last => SetItem::Thru {
                first,
                last,
                by: step,
                except: Vec::new(),
            },
            Some(SetItem::Except(first, _)) if first <= last && step == 1 => {
                SetItem::Except(first, last)
            }
            _ => return Err(wrong()),
        };
        self.items.push(range);
        Ok(rest)
    }
}
