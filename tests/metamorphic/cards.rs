//! Cards as text: small, large or free field, in any order, split into files, with continuations in place or named at
//! the end.

use strainbridge::host::context::InMemory;

/// Field of a card.
#[derive(Clone)]
pub enum Field {
    Blank,
    Word(String),
    Real(f64),
}

impl From<u32> for Field {
    fn from(id: u32) -> Self {
        Self::Word(id.to_string())
    }
}

impl From<&str> for Field {
    fn from(word: &str) -> Self {
        match word {
            "" => Self::Blank,
            _ => Self::Word(word.to_owned()),
        }
    }
}

impl From<f64> for Field {
    fn from(value: f64) -> Self {
        Self::Real(value)
    }
}

/// Card with its name and the fields from field 2 on.
#[derive(Clone)]
pub struct Card(pub &'static str, pub Vec<Field>);

/// Builds a card from the fields `$f`.
#[macro_export]
macro_rules! card {
    ($name:literal $(, $f:expr)* $(,)?) => {
        $crate::cards::Card($name, vec![$($crate::cards::Field::from($f)),*])
    };
}

/// Width of the fields of a deck.
#[derive(Clone, Copy, PartialEq)]
pub enum Width {
    Free,
    Small,
    Large,
}

/// Files of a deck.
#[derive(Clone, Copy, PartialEq)]
pub enum Files {
    One,
    /// The main file includes `bulk/mesh.bdf`, which includes `bulk/cards.bdf` by its file name only.
    Included,
}

/// Form of a deck.
#[derive(Clone, Copy)]
pub struct Form {
    pub width: Width,
    pub files: Files,
    /// Cards are in random order.
    pub permuted: bool,
    /// In small field, each continuation has a name and is at the end of the deck, in reverse order.
    pub named: bool,
}

pub const FREE: Form = Form {
    width: Width::Free,
    files: Files::One,
    permuted: false,
    named: false,
};

/// Returns the deck `frame.bdf` from case control and bulk data.
pub fn deck(control: &str, mut cards: Vec<Card>, form: Form) -> InMemory {
    if form.permuted {
        permute(&mut cards);
    }
    let mut continuations: Vec<String> = Vec::new();
    let mut text = |cards: &[Card]| -> String {
        let mut lines = Vec::new();
        for card in cards {
            let mut own = match form.width {
                Width::Free => format_free_field(card),
                Width::Large => format_large_field(card),
                Width::Small => format_small_field(card, form.named.then_some(continuations.len())),
            };
            if form.named {
                continuations.extend(own.drain(1..));
            }
            lines.append(&mut own);
        }
        lines.join("\n") + "\n"
    };
    let head = format!("SOL 101\nCEND\n{control}BEGIN BULK\n");
    match form.files {
        Files::One => {
            let bulk = text(&cards);
            continuations.reverse();
            let ends = continuations.join("\n");
            InMemory::default().with_file("frame.bdf", format!("{head}{bulk}{ends}\nENDDATA\n"))
        }
        Files::Included => {
            let third = cards.len() / 3;
            let parts = [
                &cards[..third],
                &cards[third..2 * third],
                &cards[2 * third..],
            ]
            .map(text);
            InMemory::default()
                .with_file(
                    "frame.bdf",
                    format!("{head}{}INCLUDE 'bulk/mesh.bdf'\nENDDATA\n", parts[0]),
                )
                .with_file(
                    "bulk/mesh.bdf",
                    format!("{}INCLUDE 'cards.bdf'\n", parts[1]),
                )
                .with_file("bulk/cards.bdf", parts[2].clone())
        }
    }
}

/// Shuffles a list by Fisher and Yates with Knuth's generator.
pub fn permute<T>(list: &mut [T]) {
    let mut state = 2026_u64;
    for i in (1..list.len()).rev() {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        list.swap(i, (state >> 33) as usize % (i + 1));
    }
}

fn format_free_field(card: &Card) -> Vec<String> {
    let text = |f: &Field| word(f, 25);
    let mut lines: Vec<String> = card
        .1
        .chunks(8)
        .map(|line| line.iter().map(text).collect::<Vec<_>>().join(","))
        .collect();
    let last = lines.len() - 1;
    for (i, line) in lines.iter_mut().enumerate() {
        let name = if i == 0 { card.0 } else { "+" };
        *line = format!("{name},{line}{}", if i < last { ",+" } else { "" });
    }
    lines
}

fn format_large_field(card: &Card) -> Vec<String> {
    let text = |f: &Field| format!("{:>16}", word(f, 16));
    let line = |(i, fields): (usize, &[Field])| {
        let name = if i == 0 {
            format!("{:<8}", format!("{}*", card.0))
        } else {
            "*       ".to_owned()
        };
        name + &fields.iter().map(text).collect::<String>()
    };
    card.1.chunks(4).enumerate().map(line).collect()
}

/// Formats a card in small field. `first` is the number of the first named continuation, or `None` for continuations
/// without names.
fn format_small_field(card: &Card, first: Option<usize>) -> Vec<String> {
    let text = |f: &Field| format!("{:>8}", word(f, 8));
    let n = card.1.chunks(8).len();
    let line = |(i, fields): (usize, &[Field])| {
        let name = |i: usize| first.map_or_else(String::new, |f| format!("+K{}", f + i));
        let head = if i == 0 {
            card.0.to_owned()
        } else {
            name(i - 1)
        };
        let head = if head.is_empty() {
            "+".to_owned()
        } else {
            head
        };
        let body: String = fields.iter().map(text).collect();
        let tail = if i + 1 < n { name(i) } else { String::new() };
        format!("{head:<8}{body:<64}{tail}").trim_end().to_owned()
    };
    card.1.chunks(8).enumerate().map(line).collect()
}

fn word(field: &Field, width: usize) -> String {
    match field {
        Field::Blank => String::new(),
        Field::Word(w) => w.clone(),
        Field::Real(v) => format_real(*v, width),
    }
}

/// Formats a real number with at most `width` characters. Fails if small field would round it.
fn format_real(v: f64, width: usize) -> String {
    // Fifteen digits, because products of short numbers are short.
    let digits: f64 = format!("{v:.14e}").parse().expect("a number");
    let shortest = nastran_form(&format!("{digits:?}"));
    if shortest.len() <= width {
        return shortest;
    }
    assert!(width > 8, "{v} does not fit in small field");
    (1..=16)
        .rev()
        .map(|digits| nastran_form(&format!("{v:.digits$e}")))
        .find(|text| text.len() <= width)
        .expect("a short form")
}

/// Converts `1.5e-9` to `1.5-9`, `0.25` to `.25`, `1500.0` to `1500.`.
fn nastran_form(text: &str) -> String {
    let (mantissa, exponent) = text.split_once('e').unwrap_or((text, ""));
    let mut mantissa = mantissa.to_owned();
    if !mantissa.contains('.') {
        mantissa.push('.');
    }
    let mantissa = mantissa.trim_end_matches('0');
    let mantissa = match mantissa.strip_prefix("-0.") {
        Some(rest) if !rest.is_empty() => format!("-.{rest}"),
        _ => match mantissa.strip_prefix("0.") {
            Some(rest) if !rest.is_empty() => format!(".{rest}"),
            _ => mantissa.to_owned(),
        },
    };
    match exponent {
        "" | "0" => mantissa,
        e if e.starts_with('-') => format!("{mantissa}{e}"),
        e => format!("{mantissa}+{e}"),
    }
}
