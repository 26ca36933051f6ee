//! SET n = 1, 2 THRU 9 EXCEPT 5, ALL.

/// The items of a SET.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Set {
    /// As listed.
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
    /// ALL, but for these.
    All {
        /// Ids left out.
        except: Vec<u32>,
    },
}

impl Set {
    /// Whether the id is in the set.
    pub fn has(&self, id: u32) -> bool {
        self.items.iter().any(|item| match item {
            SetItem::One(one) => *one == id,
            SetItem::Thru {
                first,
                last,
                by,
                except,
            } => {
                (*first..=*last).contains(&id)
                    && (id - first).is_multiple_of((*by).max(1))
                    && !except.contains(&id)
            }
            SetItem::All { except } => !except.contains(&id),
        })
    }

    /// The set in the text behind `=`; `Err` holds the word that cannot be read.
    pub(super) fn from_text(text: &str) -> Result<Set, String> {
        let words: Vec<&str> = text
            .split([',', ' ', '\t'])
            .filter(|w| !w.is_empty())
            .collect();
        let mut items: Vec<SetItem> = Vec::new();
        let mut excepting = false;
        let mut i = 0;
        while let Some(&word) = words.get(i) {
            i += 1;
            match word.to_ascii_uppercase().as_str() {
                "ALL" => items.push(SetItem::All { except: Vec::new() }),
                "EXCEPT" => excepting = true,
                "THRU" => {
                    let last: u32 = words
                        .get(i)
                        .and_then(|w| w.parse().ok())
                        .ok_or_else(|| word.to_owned())?;
                    i += 1;
                    excepting = false;
                    match items.pop() {
                        Some(SetItem::One(first)) if first <= last => {
                            items.push(SetItem::Thru {
                                first,
                                last,
                                by: 1,
                                except: Vec::new(),
                            });
                        }
                        _ => return Err(word.to_owned()),
                    }
                    if words.get(i).is_some_and(|w| w.eq_ignore_ascii_case("BY")) {
                        i += 2;
                        by(&mut items, words.get(i - 1))?;
                    }
                }
                _ => {
                    let id: u32 = word.parse().map_err(|_| word.to_owned())?;
                    let range_holds = match items.last_mut() {
                        Some(SetItem::Thru { last, except, .. }) if excepting && id <= *last => {
                            Some(except)
                        }
                        Some(SetItem::All { except }) if excepting => Some(except),
                        _ => None,
                    };
                    match range_holds {
                        Some(except) => except.push(id),
                        None => {
                            excepting = false;
                            items.push(SetItem::One(id));
                        }
                    }
                }
            }
        }
        Ok(Set { items })
    }
}

/// Gives the last range its step.
fn by(items: &mut [SetItem], step: Option<&&str>) -> Result<(), String> {
    let step = step.and_then(|w| w.parse::<u32>().ok()).filter(|&s| s > 0);
    match (items.last_mut(), step) {
        (Some(SetItem::Thru { by, .. }), Some(step)) => {
            *by = step;
            Ok(())
        }
        _ => Err("BY".to_owned()),
    }
}
